"""From the channels of a binary file, each with its own clock, to one table on one clock."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Problem
from sprung.formats.interpolation import MIN_RATE
from sprung.formats.reading_errors import check_declared_size, input_error
from sprung.formats.resampling import ResampledChannel, resample
from sprung.formats.sample_store import Samples, join_samples, missing_samples
from sprung.formats.table import SampleTable

AGREE = 1e-3
"""Fraction of a step up to which the times of two clocks, or of a clock and a regular one, are equal."""


@dataclass(frozen=True, eq=False)
class ChannelClock:
    """When the samples of a channel were taken.

    Attributes
    ----------
    start, end
        Time of the first and the last sample, s.
    count
        Number of samples.
    rate
        Samples per second; None where the steps are uneven.
    times
        Time of every sample, s, shape (time,), where the file keeps them.
    """

    start: float
    end: float
    count: int
    rate: float | None
    times: NDArray[np.float64] | None = None

    @property
    def of_table(self) -> NDArray[np.float64] | float:
        """The clock of a table: the rate where it is even and starts at 0, otherwise the times, s."""
        if self.rate is not None and self.start == 0:
            return self.rate
        return self.all_times()

    def agrees(self, other: ChannelClock) -> bool:
        """Return whether two clocks agree within rounding."""
        if self is other or self.count != other.count or self.count == 0:
            return self.count == other.count
        slack = AGREE * (self.end - self.start) / max(self.count - 1, 1)
        if not (abs(self.start - other.start) <= slack and abs(self.end - other.end) <= slack):
            return False
        if self.rate is not None and other.rate is not None:
            return True
        return bool(np.abs(self.all_times() - other.all_times()).max() <= slack)

    def all_times(self) -> NDArray[np.float64]:
        """Return the time of every sample, s; shape (time,)."""
        if self.times is not None:
            return self.times
        assert self.rate is not None  # noqa: S101 (a clock has a rate or times; for the type checker)
        return self.start + np.arange(self.count) / self.rate


@dataclass(frozen=True, eq=False)
class Column:
    """One channel of a file, not yet read.

    Attributes
    ----------
    name
        As written in the file.
    fallback_name
        Its name where another channel has the same name, or where it has none.
    unit
        Unit stated in the file; None without one.
    clock
        When its samples were taken.
    samples
        Its samples; None where they are not numbers.
    """

    name: str
    fallback_name: str
    unit: str | None
    clock: ChannelClock
    samples: Samples | None


def regular_clock(start: float, step: float, count: int, uncertainty: float, where: str) -> ChannelClock:
    """Return the clock of samples at a fixed rate.

    Parameters
    ----------
    start
        Time of the first, s.
    step
        Time from one to the next, as the file has it, s.
    count
        How many there are.
    uncertainty
        Rounding error of the step, s: within it, a rate in whole hertz is preferred.
    where
        File and channel, for the message.

    Raises
    ------
    InputError
        If the start or the step is not a possible number.
    """
    if not (1e-9 <= step <= 1e6 and abs(start) <= 1e12):
        found, do = f"a step of {step:g} s between samples from {start:g} s on", "Export the recording again."
        raise input_error(where, found, "a time step that is a positive number", do)
    rate = _rate(step, uncertainty)
    return ChannelClock(start, start + max(count - 1, 0) / rate, count, rate)


def clock_from_times(times: NDArray[np.float64], rounding: float = 0.0) -> ChannelClock:
    """Return the clock of samples that each have a time, with its rate if it is regular.

    Parameters
    ----------
    times
        Shape (time,), s.
    rounding
        Largest rounding error of the times, s: within it they count as regular.
    """
    count = len(times)
    if count == 0:
        return ChannelClock(0.0, 0.0, 0, None, times)
    start, end = float(times[0]), float(times[-1])
    # Of a damaged file's numbers nothing may be computed: even a difference may overflow.
    sound = bool(np.isfinite(times).all()) and float(np.abs(times).max()) <= 1e12 and end - start > 1e-9 * count
    if count == 1 or not sound:
        return ChannelClock(start, end, count, None, times)
    step = (end - start) / (count - 1)
    off = float(np.abs(times - np.linspace(start, end, count)).max())
    uncertainty = 2 * off + 4 * float(np.spacing(max(abs(start), abs(end))))
    rate = _rate(step, uncertainty / (count - 1)) if off <= max(AGREE * step, rounding) else None
    return ChannelClock(start, end, count, rate, times)


def _rate(step: float, uncertainty: float) -> float:
    """Return the rate that a rounded step stands for: of a short decimal step, or in whole hertz."""
    for meant in (float(f"{step:.3e}"), 1 / max(round(1 / step), 1)):
        if abs(meant - step) <= uncertainty:
            whole = float(round(1 / meant))
            return whole if abs(1 / meant - whole) < 1e-9 else 1 / meant
    return 1 / step


def assemble_table(columns: Sequence[Column], file: str, largest: float, notes: Sequence[str] = ()) -> SampleTable:
    """Return the channels that share one clock as a table.

    Of several clocks the one with the most numbers on it is taken, channels times samples. The channels on other clocks
    are read at its times. Those that are too slow to see wheels hop, or on a clock of another time, are spoilt: a problem
    only where somebody needs them.

    Parameters
    ----------
    columns
        The channels of the file.
    file
        Its name.
    largest
        Bytes that the table may take, see `reading_errors.memory_limit`.
    notes
        Notes of the format.

    Raises
    ------
    InputError
        If no channel holds numbers, or if there are more than the file can hold.
    """
    expected = "the samples of at least one channel over time"
    clocks = _sets([column for column in columns if column.clock.count])
    if not clocks:
        raise input_error(file, "no channel with samples over time", expected, "Export the recording again.")
    chosen = max(clocks, key=lambda members: len(members) * members[0].clock.count)
    clock = chosen[0].clock
    if clock.times is not None and not np.isfinite(clock.times).all():
        raise input_error(
            file, "times that are no numbers", "the time of every sample, in s", "Export the recording again."
        )
    check_declared_size(len(chosen) * clock.count, file, largest)
    names = _names(columns)
    rows = {column: column.samples for column in chosen if column.samples is not None}
    if not rows:
        raise input_error(file, "no channel whose samples are numbers", expected, "Export the recording again.")
    within = set(chosen)
    others: dict[Column, ResampledChannel] = {}
    elsewhere: list[Column] = []
    for column in columns:
        if column in within or not column.clock.count:
            continue
        read = _at_times_of(clock, column)
        if read is not None:
            rows[column], others[column] = read
            continue
        elsewhere.append(column)
        problem = _other_clock(column, clock, f"{file}: channel '{names[column]}'")
        rows[column] = missing_samples(clock.count, problem)
    left_out = {
        "renamed, as several channels have one name or none": [n for c, n in names.items() if n != c.name],
        "left out, as their samples are no numbers": [names[column] for column in chosen if column not in rows],
        "on another clock, interpolated to the times of the others": [names[column] for column in others],
        "left out, as they are on another clock": [names[column] for column in elsewhere],
    }
    return SampleTable(
        channels=tuple(names[column] for column in rows),
        units=tuple(column.unit for column in rows),
        store=join_samples(tuple(rows.values())),
        clock=clock.of_table,
        resampled={number: others[column] for number, column in enumerate(rows) if column in others},
        notes=(*notes, *(f"{why}: {', '.join(which)}" for why, which in left_out.items() if which)),
    )


def _at_times_of(clock: ChannelClock, column: Column) -> tuple[Samples, ResampledChannel] | None:
    """Read a column at the times of another clock; None where its rate is too low or its time span another."""
    own = column.clock
    if column.samples is None or own.count < 2 or (own.count - 1) < MIN_RATE * (own.end - own.start):
        return None
    every = clock.all_times()
    return resample(column.samples, own.all_times(), clock.count, lambda first, last: every[first:last])


def _sets(columns: Sequence[Column]) -> list[list[Column]]:
    """Group the channels by their clocks."""
    sets: list[list[Column]] = []
    for column in columns:
        members = next((members for members in sets if column.clock.agrees(members[0].clock)), None)
        if members is None:
            sets.append([column])
        else:
            members.append(column)
    return sets


def _names(columns: Sequence[Column]) -> dict[Column, str]:
    """Return a unique name for every channel."""
    often = Counter(column.name for column in columns)
    names: dict[Column, str] = {}
    taken: set[str] = set()
    for column in columns:
        name = column.name if column.name and often[column.name] == 1 else column.fallback_name
        own, number = name, 1
        while own in taken or (own != column.name and often[own]):
            number += 1
            own = f"{name} ({number})"
        taken.add(own)
        names[column] = own
    return names


def _other_clock(column: Column, clock: ChannelClock, where: str) -> Problem:
    found, expected = (
        f"{c.count} samples from {c.start:.6g} to {c.end:.6g} s" + (f" at {c.rate:.6g} Hz" if c.rate else "")
        for c in (column.clock, clock)
    )
    do = "Export all channels that are needed at one rate and over one time."
    return Problem(where, found, f"the clock of most samples of the file, {expected}", do)
