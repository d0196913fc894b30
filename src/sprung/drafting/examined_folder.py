"""Examination of a folder: every recording in it, and what the names of all state."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from sprung.campaign import CAMPAIGN_FILE
from sprung.drafting.examination import ExaminedRecording, examine_recording
from sprung.drafting.named_settings import NamedCondition, by_setting, conditions_named
from sprung.drafting.recording_files import find_copies, find_recording_files
from sprung.drafting.single_channel import join_single_channel_loggers
from sprung.errors import InputError, Problem
from sprung.progress import Progress, Step


@dataclass(frozen=True, eq=False)
class ExaminedFolder:
    """A folder with its recordings, and what their names state.

    Attributes
    ----------
    folder
        Where they are.
    recordings
        One for each file.
    joined
        The same, with those of loggers of a single channel joined drop by drop.
    unreadable
        Files that cannot be read, each with the reason.
    copies
        Files that are identical to another, and that other.
    conditions
        What the name of each file states of the vehicle.
    """

    folder: Path
    recordings: tuple[ExaminedRecording, ...]
    joined: tuple[ExaminedRecording, ...]
    unreadable: Mapping[str, tuple[Problem, ...]]
    copies: Mapping[str, str]
    conditions: Mapping[str, NamedCondition]


def examine_folder(
    folder: Path, target: Path, progress: Progress, *, overwrite: bool, settings: bool = False
) -> ExaminedFolder:
    """Examine all recordings of a folder.

    Parameters
    ----------
    folder
        Where they are.
    target
        Folder of the campaign file, or of those of several settings.
    progress
        Called with each recording that is begun, and within long ones, with the part that is done.
    overwrite
        Whether a campaign file may be there already.
    settings
        Whether each setting has a campaign file of its own.

    Returns
    -------
    ExaminedFolder

    Raises
    ------
    InputError
        If there is no such folder, a campaign file already, or no drop in any recording.
    """
    if not folder.is_dir():
        found = "a file" if folder.exists() else "no such folder"
        do = "Give the folder that the recordings are in."
        raise InputError([Problem(str(folder), found, "a folder with recordings", do)])
    _require_no_campaign(target, overwrite)
    found_files = tuple(find_recording_files(folder))
    copies = find_copies(folder, found_files)
    names = tuple(name for name in found_files if name not in copies)
    if not names:
        do = "Put the recordings there, in any format that sprung reads."
        raise InputError([Problem(str(folder), "no recordings", "the recordings of drops", do)])
    conditions = conditions_named(names)
    for setting in by_setting(conditions) if settings else ():
        _require_no_campaign(target / (setting or ""), overwrite)
    recordings, unreadable = _examine_files(folder, names, progress)
    joined = join_single_channel_loggers(recordings, folder)
    if not shows_drops(joined):
        raise InputError([*_no_drops(joined), *(problem for problems in unreadable.values() for problem in problems)])
    unreadable |= {name: unreadable[original] for name, original in copies.items() if original in unreadable}
    copies = {name: original for name, original in copies.items() if name not in unreadable}
    return ExaminedFolder(folder, tuple(recordings), joined, unreadable, copies, conditions)


def _examine_files(
    folder: Path, names: Sequence[str], progress: Progress
) -> tuple[list[ExaminedRecording], dict[str, tuple[Problem, ...]]]:
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
    return recordings, unreadable


def shows_drops(recordings: Sequence[ExaminedRecording]) -> bool:
    """Return whether any of the recordings shows a drop, another release, or pads that move."""
    return any(recording.shows_excitation for recording in recordings)


def _require_no_campaign(folder: Path, overwrite: bool) -> None:
    path = folder / CAMPAIGN_FILE
    if path.exists() and not overwrite:
        do = f"Continue with it (`sprung check {shlex.quote(str(path))}`), or remove it and draft it anew."
        raise InputError([Problem(str(path), "a campaign file", "a folder that has none yet", do)])


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
