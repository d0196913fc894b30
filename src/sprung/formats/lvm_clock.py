"""When the samples of a channel of a LabVIEW measurement file were taken."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from datetime import date
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sprung.formats.channels import ChannelClock, clock_from_times, regular_clock
from sprung.formats.reading_errors import input_error

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_ROUNDING = 1.1e-6
"""s by which times with six decimals deviate from regular ones between two rounded ends."""

_SINCE_1904 = 1e9
"""s from which a time under X_Value counts from 1904 on, not from the date in the header."""

_TIME = re.compile(r"(\d{1,2}):(\d{1,2}):(\d{1,2}(?:[.,]\d+)?)")
_DATE = re.compile(r"(\d{4})\D(\d{1,2})\D(\d{1,2})")
_DO = "Save every recording to a file of its own, and the file with X values."


class Stamp(NamedTuple):
    """A date and a time of day."""

    day: int
    seconds: float

    def since(self, other: Stamp) -> float:
        """Return the time from another one on, s."""
        return 86400.0 * (self.day - other.day) + self.seconds - other.seconds


def parse_stamp(day: str, time: str) -> Stamp | None:
    """Return what a date and a time say; None where they say nothing."""
    found, clock = _DATE.fullmatch(day), _TIME.fullmatch(time)
    if found is None or clock is None:
        return None
    try:
        ordinal = date(*map(int, found.groups())).toordinal()
    except ValueError:
        return None
    hours, minutes, seconds = (float(text.replace(",", ".")) for text in clock.groups())
    return Stamp(ordinal, 3600 * hours + 60 * minutes + seconds)


@dataclass(frozen=True, eq=False)
class Stretch:
    """The samples of a channel in one segment.

    Attributes
    ----------
    line
        Number of the line with which the segment begins.
    count
        How many samples it has.
    stamp
        When it begins, as its header says; None where it says nothing.
    x0
        Time of the first sample after that, s.
    step
        Time from one sample to the next, s; None where the header says nothing.
    rounding
        Rounding error of the step, s.
    times
        Time of every sample, s, shape (time,), where the file keeps them.
    """

    line: int
    count: int
    stamp: Stamp | None
    x0: float
    step: float | None
    rounding: float
    times: NDArray[np.float64] | None

    @property
    def first(self) -> float:
        """Time of the first sample after the stamp, s."""
        return self.x0 if self.times is None else float(self.times[0])

    def starts_at(self, zero: Stretch) -> float:
        """Return the time of the first sample after the stamp of another stretch, s."""
        if max(self.first, zero.first) >= _SINCE_1904:
            return self.first - zero.first
        return self.first + (self.stamp.since(zero.stamp) if self.stamp and zero.stamp else 0.0)

    @property
    def length(self) -> float:
        """Time from the first sample to the one after the last, s."""
        if self.times is None or self.count == 1:
            return (self.step or 0.0) * self.count
        return (float(self.times[-1]) - float(self.times[0])) * self.count / (self.count - 1)

    @property
    def slack(self) -> float:
        """Error of the length, s: half a step, and the rounding of all."""
        return self.length / self.count / 2 + (self.rounding * self.count if self.times is None else _ROUNDING)


def clock_of(stretches: Sequence[Stretch], zero: Stretch, file: str, channel: str) -> ChannelClock:
    """Return the clock of a channel.

    Parameters
    ----------
    stretches
        Its samples, one or more, in the order of the file.
    zero
        With whose stamp the time begins.
    file, channel
        Their names, for messages.

    Raises
    ------
    InputError
        If the stretches do not follow on one another in time, or have neither times nor a step.
    """
    begins = [0.0]
    for one, other in pairwise(stretches):
        begins.append(begins[-1] + _from_one_to_the_next(one, other, file))
    start, count = stretches[0].starts_at(zero), sum(one.count for one in stretches)
    times = [one.times for one in stretches if one.times is not None]
    if len(times) < len(stretches):
        step = stretches[0].step
        if step is None or step <= 0:
            found = "neither numbers under X_Value nor a positive Delta_X"
            raise input_error(f"{file}: channel '{channel}'", found, "the time of its samples", _DO)
        mean = begins[-1] / (count - stretches[-1].count) if begins[-1] else step
        step = mean if abs(mean - step) <= stretches[0].rounding else step
        return regular_clock(start, step, count, stretches[0].rounding, f"{file}: channel '{channel}'")
    with np.errstate(all="ignore"):  # of damaged times nothing can be computed
        joined = np.concatenate([begin + (own - own[0]) for begin, own in zip(begins, times, strict=True)])
        clock = clock_from_times(start + joined, _ROUNDING)
    return clock if clock.rate is None else replace(clock, times=None)


def _from_one_to_the_next(one: Stretch, other: Stretch, file: str) -> float:
    """Return the time between the first samples of two stretches, by their stamps, or by their numbers alone."""
    between = (other.starts_at(one) - one.starts_at(one), other.first - one.first)
    for found in between:
        if abs(found - one.length) <= one.slack:
            return found
    what = f"a segment that begins {between[0]:.6g} s after the one before, which has {one.count} samples"
    expected = f"segments that follow on one another, this one after {one.length:.6g} s"
    raise input_error(f"{file}: line {other.line}", what, expected, _DO)
