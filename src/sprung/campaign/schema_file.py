"""The JSON Schema of the campaign file, as it is published with the package."""

from __future__ import annotations

from importlib.resources import files

SCHEMA = 1
"""The schema that this version reads and writes."""

SCHEMA_FILE = "campaign.schema.json"
"""The name of the file that holds the JSON Schema, in this package and beside a campaign."""

SCHEMA_LINE = f"#:schema ./{SCHEMA_FILE}\n"
"""First line of a campaign file that has its JSON Schema beside it: editors with a TOML language server go by it."""


def schema_text() -> str:
    """Return the JSON Schema of campaign.toml, as text."""
    return files("sprung.campaign").joinpath(SCHEMA_FILE).read_text(encoding="utf-8")
