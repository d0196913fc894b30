"""What is in the folder of the page: campaigns, recordings by their folders, results, and pages of checks.

Names and the texts of small files only; no recording is opened, so that hundreds of them are listed at once.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from sprung.app.result_files import MOST_OPENED, campaign_of, folder_of, stored_result
from sprung.app.workspace import Entry, Listing, OutsideError, Workspace, inside, parent_of
from sprung.errors import InputError
from sprung.files import NO_RECORDINGS


@dataclass(frozen=True, slots=True)
class CampaignEntry:
    """A campaign file.

    Attributes
    ----------
    name
        In the folder of the page.
    vehicle
        Name of the vehicle, empty where the file has none.
    drops, gaps
        Number of drops and of places that are still to be filled in.
    fault
        Why it cannot be read; empty where it can.
    modified
        Time of the last change, s since 1970.
    results
        The newest results folder that was made from it, if there is one.
    """

    name: str
    vehicle: str
    drops: int
    gaps: int
    fault: str
    modified: float
    results: ResultEntry | None = None


@dataclass(frozen=True, slots=True)
class ResultEntry:
    """A results folder.

    Attributes
    ----------
    name
        In the folder of the page; empty for that itself.
    vehicle, verdict
        As results.json says; empty where it cannot be read.
    modified
        Time at which it was written, s since 1970.
    campaign
        The campaign file from which it was made; empty where that is not known.
    """

    name: str
    vehicle: str
    verdict: str
    modified: float
    campaign: str


@dataclass(frozen=True, slots=True)
class RecordingFolder:
    """A folder with recordings.

    Attributes
    ----------
    name
        In the folder of the page; empty for that itself.
    files
        Its recordings, without those of folders in it.
    campaign
        The campaign file in it or in the next folder above that has one; empty where there is none.
    """

    name: str
    files: tuple[Entry, ...]
    campaign: str

    @property
    def size(self) -> int:
        """Size of all its recordings, bytes."""
        return sum(file.size for file in self.files)


@dataclass(frozen=True, slots=True)
class FolderContent:
    """What is in the folder of the page.

    Attributes
    ----------
    campaigns, results
        The last changed first.
    recordings
        By folder, in alphabetical order.
    folders
        Names of all folders; that of the page, which is empty, first.
    is_complete
        Whether everything was listed.
    """

    campaigns: tuple[CampaignEntry, ...]
    recordings: tuple[RecordingFolder, ...]
    results: tuple[ResultEntry, ...]
    folders: tuple[str, ...]
    is_complete: bool


def folder_content(workspace: Workspace) -> FolderContent:
    """Return what is in the folder of the page."""
    listing = workspace.listing()
    results = tuple(_results(workspace, listing))
    made = {result.name for result in results} | {
        parent_of(entry.name) for entry in listing.entries if PurePosixPath(entry.name).name == "check.html"
    }
    own = [entry for entry in listing.entries if not any(_is_in(entry.name, folder) for folder in made if folder)]
    newest = {result.campaign: result for result in reversed(results)}
    campaigns = tuple(_campaigns(workspace, own, newest))
    recordings = tuple(_recordings(own, {campaign.name for campaign in campaigns}))
    folders = ("", *(entry.name for entry in own if entry.is_folder and entry.name not in made))
    return FolderContent(campaigns, recordings, results, folders, listing.is_complete)


def _campaigns(
    workspace: Workspace, entries: list[Entry], results: Mapping[str, ResultEntry]
) -> Iterator[CampaignEntry]:
    files = [entry for entry in entries if entry.name.endswith(".toml") and not entry.is_folder]
    for entry in sorted(files, key=lambda entry: -entry.modified)[:MOST_OPENED]:
        document, fault = _read_toml(workspace, entry.name)
        if "parameters" in document or not (fault or {"drop", "sensor", "vehicle", "known"} & document.keys()):
            continue  # a vehicle file of `sprung simulate`, or another program's
        vehicle, drops = document.get("vehicle"), document.get("drop")
        name = vehicle.get("name") if isinstance(vehicle, dict) else ""
        yield CampaignEntry(
            entry.name,
            name if isinstance(name, str) else "",
            len(drops) if isinstance(drops, list) else 0,
            _gaps(document),
            fault,
            entry.modified,
            results.get(entry.name),
        )


def _read_toml(workspace: Workspace, name: str) -> tuple[dict[str, Any], str]:
    """Return the content of a TOML file and, where it is none, why."""
    try:
        text, _ = workspace.read_text(name)
        return tomllib.loads(text.removeprefix("\ufeff")), ""
    except InputError as error:
        return {}, f"{error.problems[0].found}. {error.problems[0].do}"
    except (tomllib.TOMLDecodeError, OutsideError, RecursionError) as error:
        return {}, str(error)


def _gaps(node: Any) -> int:
    """Return the number of placeholders of a draft."""
    if isinstance(node, dict | list):
        return sum(map(_gaps, node.values() if isinstance(node, dict) else node))
    return isinstance(node, str) and node.startswith("TODO:")


def _results(workspace: Workspace, listing: Listing) -> Iterator[ResultEntry]:
    names = {entry.name for entry in listing.entries}
    found = [(entry, folder) for entry in listing.entries if (folder := folder_of(entry.name)) is not None]
    for number, (entry, folder) in enumerate(sorted(found, key=lambda pair: -pair[0].modified)):
        document = stored_result(workspace, folder) if number < MOST_OPENED else {}
        vehicle, verdict = document.get("vehicle"), document.get("verdict")
        name = vehicle.get("name") if isinstance(vehicle, dict) else vehicle
        state = verdict.get("state") if isinstance(verdict, dict) else ""
        campaign = campaign_of(document, folder, names)
        yield ResultEntry(folder, str(name or ""), str(state or ""), entry.modified, campaign)


def _recordings(entries: list[Entry], campaigns: set[str]) -> Iterator[RecordingFolder]:
    files: dict[str, list[Entry]] = {}
    for entry in entries:
        if not entry.is_folder and PurePosixPath(entry.name).suffix.lower() not in NO_RECORDINGS:
            files.setdefault(parent_of(entry.name), []).append(entry)
    for folder, own in sorted(files.items()):
        yield RecordingFolder(folder, tuple(own), _campaign_of(folder, campaigns))


def _campaign_of(folder: str, campaigns: set[str]) -> str:
    while True:
        here = sorted(name for name in campaigns if parent_of(name) == folder)
        if here:
            usual = inside(folder, "campaign.toml")
            return usual if usual in here else here[0]
        if not folder:
            return ""
        folder = parent_of(folder)


def _is_in(name: str, folder: str) -> bool:
    return name.startswith(f"{folder}/")
