"""Decimation of records: fewer samples and the same poles, for every method but maximum likelihood."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.spectrum import Spectrum

Real = NDArray[np.float64]

_LAG = 0.4
"""Periods of the highest frequency between block rows: more than half a period would alias it."""

_WINDOW = 0.5
"""Periods of the lowest frequency that the block rows span: a longer span gains nothing."""

_LEAST_ROWS = 40
"""Least number of rows of a block Hankel matrix, where the records are long enough, for orders given by the user."""

_FINE = 2
"""Samples in a lag, once neighbours are averaged."""

_QUIET, _DIFFERENCES = 1e-9, 6
"""Noise of a channel, as a part of its root-mean-square, its lower limit; and the order of the differences from which it
is estimated: they remove a motion that is sampled a few times in a radian."""


@dataclass(frozen=True, eq=False)
class DecimatedRecords:
    """Records of averages of neighbouring samples, each channel divided by its noise.

    The mean of e^{λk} over a block of samples is e^{λk} again, times a constant, so that only noise is lost, and there is no
    filter transient.

    Attributes
    ----------
    records
        Shape (channel, time) each.
    every
        Original samples in each average.
    step
        Averages between block rows.
    shifts
        Steps in half a period of the lowest frequency.
    scale
        Divisors of the channels, shape (channel,).
    longest
        Original samples of the longest record.
    """

    records: tuple[Real, ...]
    every: int
    step: int
    shifts: int
    scale: Real
    longest: int

    @classmethod
    def of(cls, records: Sequence[Real], spectrum: Spectrum) -> DecimatedRecords:
        """Average as many neighbours as the band of the records allows."""
        rate = 2 * float(spectrum.frequency[-1])
        low, high = spectrum.band
        channels, shortest = records[0].shape[0], min(record.shape[1] for record in records)
        every = max(int(_LAG / high * rate / _FINE), 1)
        step = min(max(round(_LAG / high * rate / every), 1), max(shortest // every // 4, 1))
        scale = np.sqrt(estimate_noise_variance(records))
        decimated_records = []
        for record in records:
            count = record.shape[1] // every
            means = record[:, : count * every].reshape(channels, count, every).mean(axis=2)
            decimated_records.append(means / scale[:, None])
        shifts = round(_WINDOW / low * rate / every / step)
        return cls(tuple(decimated_records), every, step, shifts, scale, max(record.shape[1] for record in records))

    @property
    def channels(self) -> int:
        """Number of channels."""
        return len(self.scale)

    @property
    def shortest(self) -> int:
        """Samples of the shortest record."""
        return int(min(record.shape[1] for record in self.records))

    def shifts_within(self, rows: int) -> int:
        """Return the number of shifts of a block Hankel matrix with at most so many rows, each of a lag."""
        shifts = min(max(self.shifts, -(-_LEAST_ROWS // self.channels)), rows // self.channels - 1)
        possible = min(shifts, self.shortest // (2 * self.step))
        return int(max(possible, min(2, self.shortest // self.step - 1), 1))

    def hankel(self, shifts: int) -> list[Real]:
        """Stack each record delayed by 0, 1, ... lags.

        Every row's mean is subtracted, and with it the channels' offsets, exactly; the span of the columns stays.

        Parameters
        ----------
        shifts
            Lags; there is one more block row.

        Returns
        -------
        list of ndarray
            Shape (block row · channel, time).
        """
        found = []
        for record in self.records:
            length = record.shape[1] - shifts * self.step
            stacked = np.vstack([record[:, i * self.step : i * self.step + length] for i in range(shifts + 1)])
            found.append(stacked - stacked.mean(axis=1, keepdims=True))
        return found


def estimate_noise_variance(records: Sequence[Real]) -> Real:
    """Estimate the variance of each channel's noise from the median square of its differences.

    Parameters
    ----------
    records
        Shape (channel, time) each.

    Returns
    -------
    ndarray
        Shape (channel,), never 0.
    """
    order = min(_DIFFERENCES, min(record.shape[1] for record in records) - 1)
    gain = float((np.poly(np.ones(order)) ** 2).sum())
    squares = np.hstack([np.diff(record, order, axis=1) ** 2 for record in records])
    # The median of a squared normal number is 0.455 times its variance.
    floor = np.median(squares, axis=1) / (0.455 * gain)
    energy = np.hstack(list(records)).var(axis=1)
    return np.asarray(np.maximum(floor, np.where(energy > 0, _QUIET**2 * energy, 1.0)))


def triangular_factor(matrix: Real) -> Real:
    """Return R of the QR factorisation of a matrix."""
    return np.asarray(np.linalg.qr(matrix, mode="r"), dtype=float)
