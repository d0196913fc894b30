"""Records with fewer samples and the same poles: what every method but the likelihood works on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.spectrum import Spectrum

Real = NDArray[np.float64]

_LAG = 0.4
"""Periods of the highest frequency between block rows: more than half a period would take it for another one."""

_WINDOW = 0.5
"""Periods of the lowest frequency that the block rows span: longer gains nothing."""

_LEAST_ROWS = 40
"""Rows of a block Hankel matrix at the least, where the records are long enough: an order may be asked for."""

_FINE = 2
"""Samples in a lag, once neighbours are averaged."""

_QUIET, _DIFFERENCES = 1e-9, 6
"""Noise of a channel, as a part of its root-mean-square, that is taken at the least; and the order of the differences in
which it is looked for: they leave next to nothing of a motion that is sampled a few times in a radian."""


@dataclass(frozen=True, eq=False)
class Thinned:
    """Records of which neighbouring samples were averaged, each channel divided by its noise.

    The mean of e^{λk} over a block of samples is e^{λk} again, times a constant, so that nothing but noise is lost, and no
    filter has a transient.

    Attributes
    ----------
    records
        Shape (channel, time) each.
    every
        Samples in one of them.
    step
        Samples of these between block rows.
    shifts
        How many steps half a period of the lowest frequency is.
    scale
        By which the channels were divided, shape (channel,).
    longest
        Samples of the longest record as it was.
    """

    records: tuple[Real, ...]
    every: int
    step: int
    shifts: int
    scale: Real
    longest: int

    @classmethod
    def of(cls, records: Sequence[Real], spectrum: Spectrum) -> Thinned:
        """Average as many neighbours as the records' band allows."""
        rate = 2 * float(spectrum.frequency[-1])
        low, high = spectrum.band
        channels, shortest = records[0].shape[0], min(record.shape[1] for record in records)
        every = max(int(_LAG / high * rate / _FINE), 1)
        step = min(max(round(_LAG / high * rate / every), 1), max(shortest // every // 4, 1))
        scale = np.sqrt(noise_floor(records))
        thin = []
        for record in records:
            count = record.shape[1] // every
            means = record[:, : count * every].reshape(channels, count, every).mean(axis=2)
            thin.append(means / scale[:, None])
        shifts = round(_WINDOW / low * rate / every / step)
        return cls(tuple(thin), every, step, shifts, scale, max(record.shape[1] for record in records))

    @property
    def channels(self) -> int:
        """How many channels there are."""
        return len(self.scale)

    @property
    def shortest(self) -> int:
        """Samples of the shortest record."""
        return int(min(record.shape[1] for record in self.records))

    def shifted(self, rows: int) -> int:
        """How many shifts a block Hankel matrix of at most so many rows can have, each of a lag."""
        wanted = min(max(self.shifts, -(-_LEAST_ROWS // self.channels)), rows // self.channels - 1)
        room = min(wanted, self.shortest // (2 * self.step))
        return int(max(room, min(2, self.shortest // self.step - 1), 1))

    def hankel(self, shifts: int) -> list[Real]:
        """Stack each record delayed by 0, 1, ... lags.

        Every row's mean is taken off, and with it the channels' offsets, exactly; the span of the columns stays.

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


def noise_floor(records: Sequence[Real]) -> Real:
    """Estimate the variance of each channel's noise from what is left of it in differences, most of the time.

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


def triangle(matrix: Real) -> Real:
    """Give R of the QR factorisation of a matrix."""
    return np.asarray(np.linalg.qr(matrix, mode="r"), dtype=float)
