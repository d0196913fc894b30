"""What goes wrong with a recording or its file, done to a campaign that was sound."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from campaigns import Real
from fleet import VehicleTest
from injuries import Act, Injured, Injury, Lines
from scipy.interpolate import CubicSpline

import sprung


def cells(how: Callable[[np.random.Generator, VehicleTest], Callable[[list[str]], list[str]]]) -> Act:
    """Change the cells of any one column in any one file."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        drop, channel = int(random.integers(len(campaign.drops))), int(random.integers(len(campaign.sensors)))
        change = how(random, test)

        def rewrite(lines: Lines) -> Lines:
            column = change([line[channel + 1] for line in lines[1:]])
            return [
                lines[0],
                *(
                    [*line[: channel + 1], cell, *line[channel + 2 :]]
                    for line, cell in zip(lines[1:], column, strict=True)
                ),
            ]

        name = campaign.recordings[drop].name
        return Injured(campaign, (campaign.sensors[channel].channel, name), name, rewrite)

    return act


def gap(seconds: float | None, samples: int = 0) -> Act:
    """Leave cells empty during the motion."""

    def how(random: np.random.Generator, test: VehicleTest) -> Callable[[list[str]], list[str]]:
        length = samples if seconds is None else round(seconds * test.rate)
        start = int(random.uniform(test.rest + 0.3, test.rest + 2.5) * test.rate)
        return lambda column: [*column[:start], *([""] * length), *column[start + length :]]

    return cells(how)


def column_gone(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
    """Take one column out of one file."""
    drop, channel = int(random.integers(len(campaign.drops))), int(random.integers(len(campaign.sensors)))
    name = campaign.recordings[drop].name
    where = (campaign.sensors[channel].channel, name)
    return Injured(
        campaign, where, name, lambda lines: [[*line[: channel + 1], *line[channel + 2 :]] for line in lines]
    )


def lines_of_one(change: Callable[[Lines, np.random.Generator, VehicleTest], Lines]) -> Act:
    """Change the lines below the head of any one file."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        name = campaign.recordings[int(random.integers(len(campaign.drops)))].name
        return Injured(campaign, (name,), name, lambda lines: [lines[0], *change(lines[1:], random, test)])

    return act


def jittered(lines: Lines, random: np.random.Generator, test: VehicleTest) -> Lines:
    """Stamp every sample up to 30 % of a step early or late."""
    off = random.uniform(-0.3, 0.3, len(lines)) / test.rate
    return [[f"{float(line[0]) + by:.7f}", *line[1:]] for line, by in zip(lines, off.tolist(), strict=True)]


def uneven(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
    """Take every sample up to 30 % of a step early or late, and stamp it rightly."""
    i = int(random.integers(len(campaign.drops)))
    recordings, exact = list(campaign.recordings), test.exact.recordings[i]
    off = random.uniform(-0.3, 0.3, (exact.values.shape[1],)) / test.rate
    moved = CubicSpline(exact.time, exact.values, axis=1)(exact.time + off) - exact.values
    recordings[i] = replace(recordings[i], values=recordings[i].values + moved)

    def rewrite(lines: Lines) -> Lines:
        stamped = zip(lines[1:], off.tolist(), strict=True)
        return [lines[0], *([f"{float(line[0]) + by:.7f}", *line[1:]] for line, by in stamped)]

    name = recordings[i].name
    return Injured(campaign.with_recordings(recordings), (name,), name, rewrite)


def lines_lost(lines: Lines, random: np.random.Generator, test: VehicleTest) -> Lines:
    """Lose three lines during the motion."""
    lost = set(random.choice(np.arange(int((test.rest + 0.3) * test.rate), len(lines)), 3, replace=False).tolist())
    return [line for i, line in enumerate(lines) if i not in lost]


def too_slow(lines: Lines, _: np.random.Generator, test: VehicleTest) -> Lines:
    """Keep 50 samples a second."""
    return lines[:: round(test.rate / 50)]


def just_after(random: np.random.Generator) -> float:
    """Return a time of 0.03 to 0.1 s."""
    return random.uniform(0.03, 0.1)


def cut(seconds: Callable[[np.random.Generator], float], to_end: bool) -> Act:
    """Keep one recording only from so long after its release on, or only up to then."""

    def act(test: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
        i, at = int(random.integers(len(campaign.drops))), round((test.rest + seconds(random)) * test.rate)
        recordings = list(campaign.recordings)
        values: Real = recordings[i].values
        recordings[i] = replace(recordings[i], values=values[:, at:] if to_end else values[:, :at])
        return Injured(campaign.with_recordings(recordings), (recordings[i].name,))

    return act


def copied(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
    """Replace the recording of one drop by that of another."""
    one, other = random.choice(len(campaign.drops), 2, replace=False).tolist()
    recordings = list(campaign.recordings)
    recordings[other] = replace(recordings[other], values=recordings[one].values.copy())
    return Injured(campaign.with_recordings(recordings), (recordings[one].name, recordings[other].name))


def fast_clock(_: VehicleTest, campaign: sprung.Campaign, random: np.random.Generator) -> Injured:
    """Let the clock of one recording run two to five percent fast or slow."""
    i = int(random.integers(len(campaign.drops)))
    factor = 1 + random.choice([-1.0, 1.0]) * random.uniform(0.02, 0.05)
    recordings = list(campaign.recordings)
    recordings[i] = replace(recordings[i], rate=recordings[i].rate * factor)
    return Injured(campaign.with_recordings(recordings), (recordings[i].name,))


OF_RECORDINGS: Sequence[Injury] = (
    Injury("missing column", ("missing",), "a column is missing in one file", column_gone),
    Injury("missing, 5 samples", ("missing",), "five cells of a column are empty", gap(None, 5)),
    Injury("missing, 0.3 s", ("missing",), "cells of a column are empty for 0.3 s", gap(0.3)),
    Injury("clock, jitter", ("clock",),
           "the time stamps of one file, not its samples, have an error of 30 % of an interval", lines_of_one(jittered)),
    Injury("clock, uneven", ("clock",),
           "the samples of one file are irregular by 30 % of an interval, as its time stamps state", uneven),
    Injury("clock, lines lost", ("clock", "missing"), "three lines of one file are missing", lines_of_one(lines_lost)),
    Injury("rate", ("rate",), "one file has 50 samples per second", lines_of_one(too_slow), "50 samples per second"),
    Injury("no release", ("no-release",), "one recording begins 0.03 to 0.1 s after the release", cut(just_after, True)),
    Injury("no decay", ("no-decay",), "one recording ends 0.3 s after the release", cut(lambda _: 0.3, False)),
    Injury("clock, too fast", ("clock",), "the clock of one recording is 2 to 5 % fast or slow", fast_clock),
    Injury("copy", ("copy",), "one drop has the recording of another", copied),
)  # fmt: skip
"""Of recordings and their files."""
