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
from sprung.drafting.look import Look
from sprung.drafting.names import tokens

RecordedDrop = tuple[tuple[str, ...], DetectedDrop, tuple[str, ...]]
"""Files, drop, and the channels whose readings the drop has."""


def together(looks: Sequence[Look]) -> Iterator[RecordedDrop]:
    """Give every drop with the files that recorded it.

    Parameters
    ----------
    looks
        At each recording.

    Yields
    ------
    tuple
        The files, the drop as the first of them shows it but with the channels of all, and these channels.
    """
    belonging = _belonging(looks)
    done: set[str] = set()
    for one in looks:
        name = one.file.name
        if name in done or not one.drops:
            continue
        if one.files:
            yield one.files, one.drops[0], tuple(channel.name for channel in one.channels)
            continue
        group = [other for other in looks if belonging.get(other.file.name) == belonging.get(name, name)] or [one]
        if len(group) > 1:
            done.update(each.file.name for each in group)
            yield _merged(group)
            continue
        held = tuple(channel.name for channel in one.channels)
        for drop in one.drops:
            yield (name,), drop, held


def called(files: Sequence[str]) -> str:
    """Give what the names of the files of one drop have in common, words of its loggers left out.

    Parameters
    ----------
    files
        Its recordings.
    """
    if len(files) == 1:
        return files[0]
    words = [re.split(r"[_\-. ]+", PurePath(file).stem) for file in files]
    first = _alike(words)
    last = min(_alike([own[::-1] for own in words]), min(map(len, words)) - first)
    shared = [*words[0][:first], *words[0][len(words[0]) - last :]]
    return str(PurePath(files[0]).with_name("_".join(shared) or "drop"))


def _alike(words: Sequence[Sequence[str]]) -> int:
    """Give how many words all begin with."""
    return (*(len(set(each)) == 1 for each in zip(*words, strict=False)), False).index(False)


def _belonging(looks: Sequence[Look]) -> dict[str, str]:
    """Give, by file, what the names of the files of one drop have in common; for the files of several loggers only."""
    alone = [one for one in looks if len(one.drops) <= 1 and not one.files]
    words = {one.file.name: tokens(str(PurePath(one.file.name).with_suffix(""))) for one in alone}
    held = {one.file.name: frozenset(channel.name for channel in one.channels) for one in looks}
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
        every = [channel for sets in channels.values() for one in sets for channel in one]
        if several and alike and len(every) == len(set(every)):
            return {name: key for key, group in groups.items() if len(group) > 1 for name in group.values()}
    return {}


def _merged(group: Sequence[Look]) -> RecordedDrop:
    """Put the readings of several loggers side by side; each has a clock of its own, and the first one's times are given."""
    seen = [one for one in group if one.drops]
    readings = reduce(DropFeatures.joined_with, (one.drops[0].features for one in seen))
    held = tuple(channel.name for one in seen for channel in one.channels)
    return tuple(one.file.name for one in group), replace(seen[0].drops[0], features=readings, slow_motion=None), held
