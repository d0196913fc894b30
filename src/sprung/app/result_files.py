"""Results folders in the folder of the page: which there are, and what they contain."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sprung.app.workspace import OutsideError, Workspace, inside, parent_of
from sprung.errors import InputError

_MARK = "results.json"

_LARGEST = 2_000_000
"""Largest results.json that is opened for what it says, bytes."""


@dataclass(frozen=True, slots=True)
class ResultsFolder:
    """A results folder.

    Attributes
    ----------
    name
        Of the folder, relative to that of the page; empty for that itself.
    modified
        Time at which its results.json was written, s since 1970.
    campaign
        Campaign file beside it, by its name; empty if there is none.
    """

    name: str
    modified: float
    campaign: str

    @property
    def title(self) -> str:
        """Name for people."""
        return self.name or "this folder"


def results_folders(workspace: Workspace) -> tuple[ResultsFolder, ...]:
    """Return the results folders, the newest first."""
    entries = {entry.name: entry for entry in workspace.listing().entries}
    found = [
        ResultsFolder(folder, entry.modified, campaign_beside(folder, tuple(entries)))
        for name, entry in entries.items()
        if (folder := folder_of(name)) is not None
    ]
    return tuple(sorted(found, key=lambda one: -one.modified))


def folder_of(name: str) -> str | None:
    """Return the folder of a results.json by its name; None for another file."""
    folder = parent_of(name)
    return folder if name == inside(folder, _MARK) else None


def stored_result(workspace: Workspace, folder: str) -> dict[str, Any]:
    """Return the content of the results.json in a folder; empty where there is none that can be opened."""
    try:
        document = json.loads(workspace.read_text(inside(folder, _MARK), _LARGEST)[0])
    except (InputError, OutsideError, ValueError, RecursionError):
        return {}
    return document if isinstance(document, dict) else {}


def campaign_beside(results: str, names: Sequence[str]) -> str:
    """Return the campaign file from which a results folder was probably made: the one in the folder above it.

    Parameters
    ----------
    results
        Name of the results folder.
    names
        Files in the folder of the page.

    Returns
    -------
    str
        Empty if there is none, or several.

    Examples
    --------
    >>> campaign_beside("bus/results", ["bus/campaign.toml", "bus/empty.csv"])
    'bus/campaign.toml'
    """
    if not results:
        return ""
    above = parent_of(results)
    start = inside(above, "")
    own = [
        name
        for name in names
        if name.startswith(start) and name.endswith(".toml") and "/" not in name.removeprefix(start)
    ]
    usual = f"{start}campaign.toml"
    return usual if usual in own else own[0] if len(own) == 1 else ""


def results_path(workspace: Workspace, name: str) -> Path:
    """Return the path of a results folder, whose files all lie in the folder of the page.

    Parameters
    ----------
    workspace
        The folder of the page.
    name
        Of the results folder in it; empty for the folder itself.

    Raises
    ------
    OutsideError
        If the folder or a file in it leads out.
    """
    for file in (_MARK, "series.npz"):
        workspace.path(inside(name, file))
    return workspace.path(name)
