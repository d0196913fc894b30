"""Completion of arguments in the shell: campaigns, results, parameters, methods."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

CAMPAIGN_FILE, RESULTS_FILE = "campaign.toml", "results.json"


def campaigns(incomplete: str) -> list[str]:
    """Return campaign files, vehicle files and folders that begin like this."""
    return list(_paths(incomplete, CAMPAIGN_FILE, ".toml"))


def results(incomplete: str) -> list[str]:
    """Return results folders and other folders that begin like this."""
    return list(_paths(incomplete, RESULTS_FILE, ".json"))


def parameters(incomplete: str) -> list[str]:
    """Return names of parameters that begin like this, `all` included."""
    from sprung.vehicle import PARAMETERS  # noqa: PLC0415 (slow to import; --help must be fast)

    return [name for name in ("all", *PARAMETERS) if name.startswith(incomplete)]


def methods(incomplete: str) -> list[str]:
    """Return names of modal methods that begin like this."""
    from sprung.modal import METHODS  # noqa: PLC0415

    return [name for name in METHODS if name.startswith(incomplete)]


def _paths(incomplete: str, marks: str, suffix: str) -> Iterator[str]:
    """Yield files with a suffix, and folders: with a slash, unless they contain the marking file."""
    before, _, beginning = incomplete.rpartition("/")
    folder = Path(f"{before}/" if before or incomplete.startswith("/") else ".")
    try:
        found = sorted(folder.iterdir())
    except OSError:
        return
    for path in found:
        name = f"{incomplete[: len(incomplete) - len(beginning)]}{path.name}"
        if not path.name.startswith(beginning) or (path.name.startswith(".") and not beginning):
            continue
        if path.is_dir():
            yield name if (path / marks).is_file() else f"{name}/"
        elif path.suffix == suffix:
            yield name
