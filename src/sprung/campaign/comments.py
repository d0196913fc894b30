"""Comments in a written campaign file: what each section is for, and what each key means where it first appears."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from textwrap import wrap
from typing import Any

from sprung.campaign.schema_file import schema_text

AXES = """\
# Lengths m, masses kg, times s, angles rad. x forward from the front axle, y left from the centreline, z up from the ground.
"""

SECTIONS: Mapping[str, str] = {
    "vehicle": "The vehicle, as measured with a tape.",
    "test": "For the record: nothing is computed from it.",
    "known": "Measured beforehand, for example on scales: a number counts as exact, { value, std } has a standard uncertainty.",
    "model": "What the vehicle model has. Left out, sprung decides, and says why.",
    "sensor": "One for each channel of the recordings.",
    "load": 'One for each load that was put on the vehicle; the load "empty" always exists. A piece on a wheel has\n'
    'on = "fl" in place of a position. Where only totals are known, added = { mass = ..., I_yy = ..., I_xx = ... } takes the\n'
    "place of items.",
    "drop": "One for each release off the blocks.",
}
"""What stands above the first section of each kind."""

_MODELS = {
    "": "",
    "vehicle": "VehicleSection",
    "test": "TestRecord",
    "model": "ModelChoice",
    "sensor": "Sensor",
    "load": "Load",
    "drop": "Drop",
}

_COLUMN, _WIDTH = 44, 124
"""Where comments begin behind a key, and how wide a line may be; others stand above their key."""


def add_comments(text: str) -> str:
    """Add comments to a campaign file.

    Parameters
    ----------
    text
        TOML as `sprung.campaign.write` makes it: every key on a line of its own.

    Returns
    -------
    str
        The same TOML with comments.
    """
    return AXES + "\n".join(_lines(text)) + "\n"


def _lines(text: str) -> Iterator[str]:
    section = ""
    seen: set[tuple[str, str]] = set()
    # A name may hold what Unicode takes for the end of a line, and TOML does not.
    for line in text.removesuffix("\n").split("\n"):
        header = re.fullmatch(r"\[+([a-z]+)\]+", line)
        key = re.match(r"(\w+) *= ", line)
        if header is not None:
            section = header[1]
            if (section, "") not in seen and section in SECTIONS:
                yield from (f"# {said}" for said in SECTIONS[section].splitlines())
            seen.add((section, ""))
            yield line
        elif key is not None and (section, key[1]) not in seen:
            seen.add((section, key[1]))
            yield from _with_comment(line, describe_key(section, key[1]))
        else:
            yield line


def _with_comment(line: str, text: str) -> Iterator[str]:
    beside = f"{line:<{_COLUMN - 2}}  # {text}"
    if text and len(beside) > _WIDTH:
        yield from wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="# ")
    yield beside if text and len(beside) <= _WIDTH else line


def describe_key(section: str, key: str) -> str:
    """Return the meaning of a key of the campaign file, from its JSON Schema.

    Parameters
    ----------
    section
        Without brackets, empty for keys above all sections.
    key
        In that section.

    Returns
    -------
    str
        Empty where nothing is known of the key.
    """
    document = _schema()
    entry = document["properties"]["known"] if section == "known" else document
    if model := _MODELS.get(section):
        entry = document["$defs"][model]
    return str(entry.get("properties", {}).get(key, {}).get("description", "")).removesuffix(".")


@cache
def _schema() -> Any:
    return json.loads(schema_text())
