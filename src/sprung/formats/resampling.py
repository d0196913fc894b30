"""Channels of one file with a clock of their own, interpolated to the times of the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.formats.interpolation import interpolate
from sprung.formats.sample_store import Samples, Store, store_by_ranges

_BESIDE = 64
"""Samples on either side of a stretch that are read with it: more distant ones do not influence a cubic spline."""

_GAP = 1.5
"""Steps between two samples from which a sample is missing between them."""

_FEW = 4
"""Samples that a cubic spline needs."""


class ResampledChannel(NamedTuple):
    """A column sampled by another clock, interpolated to the times of the table.

    Attributes
    ----------
    rate_ratio
        Ratio of its sampling rate to that of the table; at most 1.
    first, last
        First and last sample of the table, last excluded, within its time span.
    """

    rate_ratio: float
    first: int
    last: int

    def within(self, first: int, last: int) -> ResampledChannel:
        """Return the record for the part of the column from first up to last, last excluded."""
        return ResampledChannel(self.rate_ratio, max(self.first - first, 0), max(min(self.last, last) - first, 0))


def resample(
    samples: Samples, own: NDArray[np.float64], length: int, times: Callable[[int, int], NDArray[np.float64]]
) -> tuple[Samples, ResampledChannel] | None:
    """Read a column at the times of another clock, stretch by stretch.

    Parameters
    ----------
    samples
        The column.
    own
        When its samples were taken, s, shape (time,).
    length
        Samples of the other clock.
    times
        Gives the times of the other clock from one sample up to another, last excluded.

    Returns
    -------
    Samples and Resampled
        None where its times do not increase, or reach over nothing of the other clock.
    """
    if own.size < _FEW or not np.isfinite(own).all() or not (np.diff(own) > 0).all():
        return None
    every = times(0, length)
    first, last = np.searchsorted(every, own[0]), np.searchsorted(every, own[-1], side="right")
    if last - first < _FEW:
        return None
    step = float(np.median(np.diff(own)))

    def get(columns: Sequence[int], begin: int, end: int) -> NDArray[np.float64]:
        wanted = times(begin, end)
        low = max(int(np.searchsorted(own, wanted[0])) - _BESIDE, 0)
        high = min(int(np.searchsorted(own, wanted[-1])) + _BESIDE, own.size)
        values = np.full(end - begin, np.nan)
        if high > low:
            [read] = np.concatenate(list(samples.store.read([samples.column], low, high, high - low)), axis=1)
            values = _at(read, own[low:high], wanted, step)
        return np.tile(values, (len(columns), 1))

    rate_ratio = min((every[-1] - every[0]) / (length - 1) / step, 1.0)
    store = store_by_ranges(1, length, get)
    store = Store(1, length, store.read, lambda _, *__: samples.store.find_non_number(samples.column, 0, own.size))
    return Samples(store, 0), ResampledChannel(float(rate_ratio), int(first), int(last))


def _at(
    values: NDArray[np.float64], own: NDArray[np.float64], wanted: NDArray[np.float64], step: float
) -> NDArray[np.float64]:
    """Read samples at other times; where one is missing beside such a time, nothing is read."""
    there = np.isfinite(values)
    if there.sum() < _FEW:
        return np.full(wanted.size, np.nan)
    taken = own[there]
    read = interpolate(values[there], taken, wanted)
    after = np.clip(np.searchsorted(taken, wanted), 1, taken.size - 1)
    read[taken[after] - taken[after - 1] > _GAP * step] = np.nan
    return read
