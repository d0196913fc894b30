"""Several loggers: recordings of one drop that hold different channels and differ in one word of their names."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import reduce
from pathlib import PurePath

from sprung.drafting.detected_drop import DetectedDrop
from sprung.drafting.drop_features import DropFeatures
from sprung.drafting.examination import ExaminedRecording
from sprung.drafting.names import tokens

RecordedDrop = tuple[tuple[str, ...], DetectedDrop, tuple[str, ...]]
"""Files, drop, and the channels whose readings the drop has."""


def group_by_drop(recordings: Sequence[ExaminedRecording]) -> Iterator[RecordedDrop]:
    """Group the recordings by drop.

    Parameters
    ----------
    recordings
        As examined.

    Yields
    ------
    tuple
        The files, the drop as the first of them shows it but with the channels of all, and these channels.
    """
    belonging = _group_loggers(recordings)
    done: set[str] = set()
    for recording in recordings:
        name = recording.file.name
        if name in done or not recording.drops:
            continue
        if recording.files:
            yield recording.files, recording.drops[0], tuple(channel.name for channel in recording.channels)
            continue
        group = [other for other in recordings if belonging.get(other.file.name) == belonging.get(name, name)] or [
            recording
        ]
        if len(group) > 1:
            done.update(each.file.name for each in group)
            yield _join_loggers(group)
            continue
        held = tuple(channel.name for channel in recording.channels)
        for drop in recording.drops:
            yield (name,), drop, held


def common_name(files: Sequence[str]) -> str:
    """Return what the names of the files of one drop have in common, without the words of its loggers.

    Parameters
    ----------
    files
        Its recordings.
    """
    if len(files) == 1:
        return files[0]
    words = [re.split(r"[_\-. ]+", PurePath(file).stem) for file in files]
    first = _common_words(words)
    last = min(_common_words([own[::-1] for own in words]), min(map(len, words)) - first)
    shared = [*words[0][:first], *words[0][len(words[0]) - last :]]
    return str(PurePath(files[0]).with_name("_".join(shared) or "drop"))


def _common_words(words: Sequence[Sequence[str]]) -> int:
    """Return how many words all begin with."""
    return (*(len(set(each)) == 1 for each in zip(*words, strict=False)), False).index(False)


def _group_loggers(recordings: Sequence[ExaminedRecording]) -> dict[str, str]:
    """Return, by file, what the names of the files of one drop have in common; for the files of several loggers only."""
    alone = [recording for recording in recordings if len(recording.drops) <= 1 and not recording.files]
    words = {recording.file.name: tokens(str(PurePath(recording.file.name).with_suffix(""))) for recording in alone}
    held = {recording.file.name: frozenset(channel.name for channel in recording.channels) for recording in recordings}
    longest = max(map(len, words.values()), default=0)
    for place in range(-1, -longest - 1, -1):
        groups: defaultdict[str, dict[str, str]] = defaultdict(dict)
        for name, own in words.items():
            if len(own) >= -place:
                groups[" ".join([*own[:place], "*", *own[len(own) + place + 1 :]])][own[place]] = name
        several = [group for group in groups.values() if len(group) > 1]
        loggers = {logger for group in several for logger in group}
        channels = {logger: {held[group[logger]] for group in several if logger in group} for logger in loggers}
        # One set of channels for each logger, and no channel in two of them.
        alike = all(len(sets) == 1 for sets in channels.values())
        every = [channel for sets in channels.values() for own in sets for channel in own]
        if several and alike and len(every) == len(set(every)):
            return {name: key for key, group in groups.items() if len(group) > 1 for name in group.values()}
    return {}


def _join_loggers(group: Sequence[ExaminedRecording]) -> RecordedDrop:
    """Join the features of several loggers; each has a clock of its own, and the times are those of the first."""
    seen = [recording for recording in group if recording.drops]
    readings = reduce(DropFeatures.joined_with, (recording.drops[0].features for recording in seen))
    held = tuple(channel.name for recording in seen for channel in recording.channels)
    files = tuple(recording.file.name for recording in group)
    return files, replace(seen[0].drops[0], features=readings, slow_motion=None), held
