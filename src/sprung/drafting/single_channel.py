"""Loggers of one or two channels each, all with the same names: joined they show a drop."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePath

import numpy as np

from sprung.campaign import Recording, find_logger_files
from sprung.drafting.channel import Channel
from sprung.drafting.detection import detect_drops
from sprung.drafting.examination import ExaminedRecording
from sprung.drafting.names import load_named, wheels_named
from sprung.formats import read_table
from sprung.preprocess import align_loggers

_FEW = 2
"""Channels of a recording that is no campaign's without others; it would take three on the body."""

_LOGGERS = 3
"""Loggers at least."""

_LONGEST = 3
"""Words that a logger's name may have."""

_WORD = re.compile(r"[^_\-. ]+")

Groups = Mapping[str, Mapping[str, ExaminedRecording]]
"""Recordings by what is common to the names of a drop's files, and by the logger."""


def join_single_channel_loggers(recordings: Sequence[ExaminedRecording], folder: Path) -> tuple[ExaminedRecording, ...]:
    """Join the recordings of such loggers drop by drop.

    Parameters
    ----------
    recordings
        As examined.
    folder
        Of the campaign.

    Returns
    -------
    tuple of Look
        One for each drop; the recordings as they were, where they are of other loggers.
    """
    names = [{channel.name for channel in recording.channels} for recording in recordings]
    if not names or not set.intersection(*names) or max(map(len, names)) > _FEW:
        return tuple(recordings)
    groups = _group_by_names(recordings)
    return tuple(_join_parts(group, folder) for group in groups.values()) if groups else tuple(recordings)


def _group_by_names(recordings: Sequence[ExaminedRecording]) -> Groups:
    """Group the recordings by the words of the files' names: every drop has a file of each logger."""
    found: list[tuple[float, Groups]] = []
    for last, count in [(last, count) for last in (True, False) for count in range(1, _LONGEST + 1)]:
        groups: defaultdict[str, dict[str, ExaminedRecording]] = defaultdict(dict)
        for recording in recordings:
            path = PurePath(recording.file.name)
            words = list(_WORD.finditer(path.stem))
            if len(words) <= count:
                break
            begin, end = (
                (words[-count].start(), words[-1].end()) if last else (words[0].start(), words[count - 1].end())
            )
            groups[f"{path.parent}/{path.stem[:begin]}*{path.stem[end:]}"][path.stem[begin:end]] = recording
        sets = {frozenset(group) for group in groups.values()}
        whole = len(sets) == 1 and sum(map(len, groups.values())) == len(recordings) and len(*sets) >= _LOGGERS
        if whole and _names_are_distinct(groups):
            found.append((_plausibility(groups), groups))
    return max(found, key=lambda candidate: candidate[0])[1] if found else {}


def _plausibility(groups: Groups) -> float:
    """Share of the groups that are named like drops, less the share of the loggers that are."""
    loggers = next(iter(groups.values()))
    drops = [bool(load_named(key) or wheels_named(key)) for key in groups]
    others = [bool(load_named(name)) or len(wheels_named(name)) > 1 for name in loggers]
    return float(np.mean(drops) - np.mean(others))


def _names_are_distinct(groups: Groups) -> bool:
    """Return whether every logger's name distinguishes its own file of each drop from the others."""
    return all(
        find_logger_files([other.file.name for other in group.values()], logger) == [recording.file.name]
        for group in groups.values()
        for logger, recording in group.items()
    )


def _join_parts(group: Mapping[str, ExaminedRecording], folder: Path) -> ExaminedRecording:
    """Align the recordings of one drop by their first motion, and detect the drop."""
    parts = [_part(logger, recording, folder) for logger, recording in group.items()]
    channels = tuple(channel for _, own in parts for channel in own)
    recordings = tuple(recording for recording, _ in parts)
    whole = Recording(
        "", tuple(channel.name for channel in channels), np.empty((len(channels), 0)), 0.0, 1.0, parts=recordings
    )
    joined = align_loggers(whole)
    found = detect_drops([(0, joined.values)], joined.rate, start=joined.start)
    first = next(iter(group.values()))
    scales = {
        f"{logger} {name}": size for logger, recording in group.items() for name, size in recording.full_scale.items()
    }
    file = replace(first.file, drops=len(found.drops), rejected=found.rejected, events=found.events)
    return ExaminedRecording(
        file, channels, found.drops, scales, tuple(recording.file.name for recording in group.values())
    )


def _part(logger: str, recording: ExaminedRecording, folder: Path) -> tuple[Recording, tuple[Channel, ...]]:
    table = read_table(folder / recording.file.name)
    columns = [table.channels.index(channel.name) for channel in recording.channels]
    factors = np.array([[channel.factor] for channel in recording.channels])
    named = tuple(replace(channel, name=f"{logger} {channel.name}", logger=logger) for channel in recording.channels)
    values = factors * table.take(columns)
    return Recording(
        recording.file.name, tuple(channel.name for channel in named), values, recording.file.start, recording.file.rate
    ), named
