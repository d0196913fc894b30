"""Drafting of a campaign: every recording is examined, all of them are combined, the campaign file is written."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from pathlib import Path

from sprung.campaign import CAMPAIGN_FILE
from sprung.drafting.combination import combine_recordings
from sprung.drafting.examination import ExaminedRecording, examine_recording
from sprung.drafting.records import DraftCampaign
from sprung.drafting.single_channel import join_single_channel_loggers
from sprung.drafting.text import campaign_text, missing_in
from sprung.errors import InputError, Problem
from sprung.progress import Progress, Step, silent

_NO_RECORDINGS = frozenset(
    (".toml", ".json", ".npz", ".html", ".htm", ".py", ".md", ".pdf", ".png", ".jpg", ".jpeg", ".svg", ".doc", ".docx", ".ppt",
     ".pptx", ".zip", ".mp4", ".mov", ".ini", ".log", ".db")
)  # fmt: skip
"""File name extensions in a folder of recordings that are ignored."""


def draft(folder: str | os.PathLike[str], progress: Progress = silent, *, overwrite: bool = False) -> DraftCampaign:
    """Draft a campaign from the recordings in a folder and its subfolders.

    Parameters
    ----------
    folder
        Where the recordings are; the campaign file goes there.
    progress
        Called with each recording that is begun, and within long ones, with the part that is done.
    overwrite
        Whether a campaign file that is there already is to be replaced: it is drafted anew.

    Returns
    -------
    Draft
        Not written yet.

    Raises
    ------
    InputError
        If there is no such folder, a campaign file in it already, or no drop in any of its recordings; then with the
        reason for each of them.
    """
    folder = Path(folder)
    _require_no_campaign(folder, overwrite)
    names = tuple(_recordings(folder))
    if not names:
        do = "Put the recordings there, in any format that sprung reads."
        raise InputError([Problem(str(folder), "no recordings", "the recordings of drops", do)])
    sizes = [max((folder / name).stat().st_size, 1) for name in names]
    before = [done / sum(sizes) for done in accumulate(sizes, initial=0)]
    recordings: list[ExaminedRecording] = []
    unreadable: dict[str, tuple[Problem, ...]] = {}
    for i, name in enumerate(names):

        def tell(fraction: float, i: int = i, name: str = name) -> None:
            done = before[i] + (before[i + 1] - before[i]) * fraction
            progress(Step("looking for drops", i + 1, len(names), name, done=done))

        tell(0.0)
        try:
            recordings.append(examine_recording(folder, name, tell))
        except InputError as error:
            unreadable[name] = error.problems
    recordings = list(join_single_channel_loggers(recordings, folder))
    if not any(recording.drops for recording in recordings):
        raise InputError(
            [*_no_drops(recordings), *(problem for problems in unreadable.values() for problem in problems)]
        )
    sensors, drops, still = combine_recordings(recordings)
    files = [recording.file for recording in recordings]
    held = {recording.file.name: {channel.name for channel in recording.channels} for recording in recordings}
    made = DraftCampaign(
        folder=folder,
        name=folder.absolute().name or "vehicle",
        sensors=sensors,
        drops=drops,
        files=tuple(
            replace(
                file,
                left_out={**file.left_out, **{name: why for name, why in still.items() if name in held[file.name]}},
            )
            for file in files
        ),
        unreadable=unreadable,
    )
    text = campaign_text(made)
    return replace(made, text=text, missing=missing_in(text))


def _require_no_campaign(folder: Path, overwrite: bool) -> None:
    if not folder.is_dir():
        found = "a file" if folder.exists() else "no such folder"
        do = "Give the folder that the recordings are in."
        raise InputError([Problem(str(folder), found, "a folder with recordings", do)])
    path = folder / CAMPAIGN_FILE
    if path.exists() and not overwrite:
        do = f"Continue with it (sprung check {path}), or remove it and draft it anew."
        raise InputError([Problem(str(path), "a campaign file", "a folder that has none yet", do)])


def _recordings(folder: Path) -> Iterator[str]:
    """Yield the files that may be recordings, in the order of their names; without hidden files and results."""
    found = []
    for path in folder.rglob("*"):
        relative = path.relative_to(folder)
        hidden = any(part.startswith((".", "~")) for part in relative.parts)
        results = any((parent / "results.json").exists() for parent in path.parents if folder in parent.parents)
        if path.is_file() and not hidden and not results and path.suffix.lower() not in _NO_RECORDINGS:
            found.append(relative)
    # The channel files of ISO-MME, which end in a number, belong to the descriptor beside them or above.
    descriptors = {folder / path.parent for path in found if path.suffix.lower() in {".mme", ".chn"}}
    for relative in sorted(found, key=lambda path: [part.casefold() for part in path.parts]):
        part_of = relative.suffix[1:].isdecimal() and any(
            parent in descriptors for parent in (folder / relative).parents
        )
        if not part_of:
            yield relative.as_posix()


def _no_drops(recordings: Sequence[ExaminedRecording]) -> Iterator[Problem]:
    for recording in recordings:
        why = recording.file.rejected[0].why if recording.file.rejected else "it shows no motion"
        found = f"no drop: {why}"
        expected = "at least one drop, with some rest before it"
        yield Problem(
            recording.file.name,
            found,
            expected,
            "Check that it is the right recording, and state its unit if it has another.",
        )
