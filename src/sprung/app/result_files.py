"""Results folders in the folder of the page: which there are, and what they contain."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sprung.app.workspace import OutsideError, Workspace, inside, parent_of
from sprung.errors import InputError

_MARK = "results.json"

MOST_OPENED = 200
"""Most campaign files and results of a list that are opened for what they say, the newest first."""

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
        Campaign file from which it was made, by its name; empty where that is not known.
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
    names, found = set(), []
    for entry in workspace.listing().entries:
        names.add(entry.name)
        folder = folder_of(entry.name)
        if folder is not None:
            found.append((folder, entry.modified))
    found.sort(key=lambda pair: -pair[1])
    documents = (
        stored_result(workspace, folder) if number < MOST_OPENED else {} for number, (folder, _) in enumerate(found)
    )
    return tuple(
        ResultsFolder(folder, modified, campaign_of(document, folder, names))
        for (folder, modified), document in zip(found, documents, strict=True)
    )


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


def source_of(document: Mapping[str, Any]) -> str:
    """Return the name of the campaign file from which a result was made; empty where results.json does not state it.

    Parameters
    ----------
    document
        Content of results.json.

    Examples
    --------
    >>> source_of({"setup": {"files": [{"name": "summer.toml"}, {"name": "empty.csv"}]}})
    'summer.toml'
    """
    try:
        name = document["setup"]["files"][0]["name"]
    except (LookupError, TypeError):
        return ""
    return name if isinstance(name, str) and name.endswith(".toml") else ""


def campaign_of(document: Mapping[str, Any], results: str, names: Collection[str]) -> str:
    """Return the campaign file from which a results folder was made.

    Parameters
    ----------
    document
        Content of its results.json, which states the name of the file.
    results
        Name of the results folder.
    names
        Files in the folder of the page.

    Returns
    -------
    str
        The file of this name in the nearest folder above; where results.json states none, the only one or the usual one in the
        next folder above. Empty if there is none.

    Examples
    --------
    >>> document = {"setup": {"files": [{"name": "winter.toml"}]}}
    >>> campaign_of(document, "bus/results", ["bus/summer.toml", "bus/winter.toml"])
    'bus/winter.toml'
    """
    source = source_of(document)
    if not source:
        return _campaign_beside(results, names)
    folders = [results]
    while folders[-1]:
        folders.append(parent_of(folders[-1]))
    return next((name for folder in folders if (name := inside(folder, source)) in names), "")


def default_results(workspace: Workspace, campaign: str) -> str:
    """Return the results folder of a campaign: ``results`` beside it, unless another campaign has its result there.

    Parameters
    ----------
    workspace
        The folder of the page.
    campaign
        Name of the campaign file.
    """
    folder, _, file = campaign.rpartition("/")
    usual = inside(folder, "results")
    try:
        source = source_of(stored_result(workspace, usual))
    except OutsideError:  # a link that leads out
        source = ""
    return usual if source in {"", file} else inside(folder, f"results-{file.removesuffix('.toml')}")


def _campaign_beside(results: str, names: Collection[str]) -> str:
    """Return the campaign file in the folder above a results folder: the only one, or the usual one."""
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
