"""Loggers of one or two channels each, all with the same names: only together do they show a drop."""

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
from sprung.drafting.look import Look
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

Groups = Mapping[str, Mapping[str, Look]]
"""Looks by what is common to the names of a drop's files, and by the logger."""


def join_single_channel_loggers(looks: Sequence[Look], folder: Path) -> tuple[Look, ...]:
    """Look at the recordings of such loggers together, in place of each by itself.

    Parameters
    ----------
    looks
        At each recording.
    folder
        Of the campaign.

    Returns
    -------
    tuple of Look
        One for each drop; the looks as they were, where they are of other loggers.
    """
    names = [{channel.name for channel in one.channels} for one in looks]
    if not names or not set.intersection(*names) or max(map(len, names)) > _FEW:
        return tuple(looks)
    groups = _groups(looks)
    return tuple(_together(group, folder) for group in groups.values()) if groups else tuple(looks)


def _groups(looks: Sequence[Look]) -> Groups:
    """Tell the loggers by the words of the files' names: every drop has a file of each."""
    found: list[tuple[float, Groups]] = []
    for last, count in [(last, count) for last in (True, False) for count in range(1, _LONGEST + 1)]:
        groups: defaultdict[str, dict[str, Look]] = defaultdict(dict)
        for one in looks:
            path = PurePath(one.file.name)
            words = list(_WORD.finditer(path.stem))
            if len(words) <= count:
                break
            begin, end = (
                (words[-count].start(), words[-1].end()) if last else (words[0].start(), words[count - 1].end())
            )
            groups[f"{path.parent}/{path.stem[:begin]}*{path.stem[end:]}"][path.stem[begin:end]] = one
        sets = {frozenset(group) for group in groups.values()}
        whole = len(sets) == 1 and sum(map(len, groups.values())) == len(looks) and len(*sets) >= _LOGGERS
        if whole and _told_apart(groups):
            found.append((_likely(groups), groups))
    return max(found, key=lambda one: one[0])[1] if found else {}


def _likely(groups: Groups) -> float:
    """Give how many drops are named after drops, less how many loggers are."""
    loggers = next(iter(groups.values()))
    drops = [bool(load_named(key) or wheels_named(key)) for key in groups]
    others = [bool(load_named(name)) or len(wheels_named(name)) > 1 for name in loggers]
    return float(np.mean(drops) - np.mean(others))


def _told_apart(groups: Groups) -> bool:
    """Say whether every logger's name tells its own file of each drop from the others."""
    return all(
        find_logger_files([other.file.name for other in group.values()], logger) == [one.file.name]
        for group in groups.values()
        for logger, one in group.items()
    )


def _together(group: Mapping[str, Look], folder: Path) -> Look:
    """Put the recordings of one drop on one clock by their first motion, and look for the drop."""
    parts = [_part(logger, one, folder) for logger, one in group.items()]
    channels = tuple(channel for _, own in parts for channel in own)
    recordings = tuple(recording for recording, _ in parts)
    whole = Recording(
        "", tuple(channel.name for channel in channels), np.empty((len(channels), 0)), 0.0, 1.0, parts=recordings
    )
    joined = align_loggers(whole)
    found = detect_drops([(0, joined.values)], joined.rate, start=joined.start)
    first = next(iter(group.values()))
    scales = {f"{logger} {name}": size for logger, one in group.items() for name, size in one.full_scale.items()}
    file = replace(first.file, drops=len(found.drops), rejected=found.rejected, events=found.events)
    return Look(file, channels, found.drops, scales, tuple(one.file.name for one in group.values()))


def _part(logger: str, one: Look, folder: Path) -> tuple[Recording, tuple[Channel, ...]]:
    table = read_table(folder / one.file.name)
    columns = [table.channels.index(channel.name) for channel in one.channels]
    factors = np.array([[channel.factor] for channel in one.channels])
    named = tuple(replace(channel, name=f"{logger} {channel.name}", logger=logger) for channel in one.channels)
    values = factors * table.take(columns)
    return Recording(
        one.file.name, tuple(channel.name for channel in named), values, one.file.start, one.file.rate
    ), named
