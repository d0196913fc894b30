"""Shell completion of campaigns, results folders, parameters, methods and formats."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

CAMPAIGN_FILE, RESULTS_FILE = "campaign.toml", "results.json"


def campaigns(incomplete: str) -> list[str]:
    """Return the campaign and vehicle files that begin with the text, and folders that may contain them."""
    return list(_paths(incomplete, CAMPAIGN_FILE, ".toml"))


def results(incomplete: str) -> list[str]:
    """Return the results folders that begin with the text, and folders that may contain them."""
    return list(_paths(incomplete, RESULTS_FILE, ".json"))


def parameters(incomplete: str) -> list[str]:
    """Return the names of parameters that begin with the text, and `all`."""
    from sprung.vehicle import PARAMETERS  # noqa: PLC0415 (only where it is asked for: --help waits for no numerics)

    return [name for name in ("all", *PARAMETERS) if name.startswith(incomplete)]


def methods(incomplete: str) -> list[str]:
    """Return the names of modal methods that begin with the text."""
    from sprung.modal import METHODS  # noqa: PLC0415

    return [name for name in METHODS if name.startswith(incomplete)]


def export_formats(incomplete: str) -> list[str]:
    """Return the names of export formats that begin with the text."""
    from sprung.export import FORMATS  # noqa: PLC0415

    return [name for name in FORMATS if name.startswith(incomplete)]


def _paths(incomplete: str, marks: str, suffix: str) -> Iterator[str]:
    """Return files with a suffix, and folders: complete if they contain the marker file, otherwise to be continued."""
    before, _, prefix = incomplete.rpartition("/")
    folder = Path(f"{before}/" if before or incomplete.startswith("/") else ".")
    try:
        found = sorted(folder.iterdir())
    except OSError:
        return
    for path in found:
        name = f"{incomplete[: len(incomplete) - len(prefix)]}{path.name}"
        if not path.name.startswith(prefix) or (path.name.startswith(".") and not prefix):
            continue
        if path.is_dir():
            yield name if (path / marks).is_file() else f"{name}/"
        elif path.suffix == suffix:
            yield name
