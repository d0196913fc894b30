"""What the shell offers when a word of the command line is completed: campaigns, results, parameters, methods."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

CAMPAIGN_FILE, RESULTS_FILE = "campaign.toml", "results.json"


def campaigns(incomplete: str) -> list[str]:
    """Offer the campaign files and vehicle files that begin like this, and the folders on the way to them."""
    return list(_paths(incomplete, CAMPAIGN_FILE, ".toml"))


def results(incomplete: str) -> list[str]:
    """Offer the results folders that begin like this, and the folders on the way to them."""
    return list(_paths(incomplete, RESULTS_FILE, ".json"))


def parameters(incomplete: str) -> list[str]:
    """Offer the names of parameters that begin like this, and `all`."""
    from sprung.vehicle import PARAMETERS  # noqa: PLC0415 (only where it is asked for: --help waits for no numerics)

    return [name for name in ("all", *PARAMETERS) if name.startswith(incomplete)]


def methods(incomplete: str) -> list[str]:
    """Offer the names of modal methods that begin like this."""
    from sprung.modal import METHODS  # noqa: PLC0415

    return [name for name in METHODS if name.startswith(incomplete)]


def _paths(incomplete: str, marks: str, suffix: str) -> Iterator[str]:
    """List files of an ending, and folders: those that hold the marking file as they are, others to go on from."""
    before, _, begun = incomplete.rpartition("/")
    folder = Path(f"{before}/" if before or incomplete.startswith("/") else ".")
    try:
        found = sorted(folder.iterdir())
    except OSError:
        return
    for path in found:
        name = f"{incomplete[: len(incomplete) - len(begun)]}{path.name}"
        if not path.name.startswith(begun) or (path.name.startswith(".") and not begun):
            continue
        if path.is_dir():
            yield name if (path / marks).is_file() else f"{name}/"
        elif path.suffix == suffix:
            yield name
