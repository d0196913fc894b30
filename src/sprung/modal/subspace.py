"""Where the fit of poles and shapes starts: the span of a block Hankel matrix of all records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.likelihood import Poles
from sprung.modal.spectrum import Spectrum

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LAG = 0.4
"""Periods of the highest frequency between block rows: more than half a period would take it for another one."""

_WINDOW = 0.5
"""Periods of the lowest frequency that the block rows span: longer gains nothing."""

_ROWS = 150
"""Rows of the block Hankel matrix at the most."""

_FINE = 2
"""Samples in a lag, once neighbours are averaged."""

_ABOVE = 1.3
"""Times what white noise of a matrix without structure reaches."""

_ROUNDING = 1e-12

_QUIET, _DIFFERENCES = 1e-9, 6
"""Noise of a channel, as a part of its root-mean-square, that is taken at the least; and the order of the differences in
which it is looked for: they leave next to nothing of a motion that is sampled a few times in a radian."""

_GROWTH = 1.0
"""Powers of e by which a motion may seem to grow over the longest record."""


@dataclass(frozen=True, eq=False)
class Span:
    """The span of delayed records, in the order of the energy they put into it.

    Attributes
    ----------
    left
        Orthonormal, shape (block row · channel, direction).
    singular
        Shape (direction,).
    noise
        What noise alone may put into a direction.
    scale
        By which the channels were divided, shape (channel,).
    lag
        Samples of the records between block rows.
    longest
        Samples of the longest record.
    """

    left: Real
    singular: Real
    noise: float
    scale: Real
    lag: int
    longest: int

    @classmethod
    def of(cls, records: Sequence[Real], spectrum: Spectrum) -> Span:
        """Decompose the block Hankel matrix of all records side by side.

        Neighbouring samples are averaged first: the mean of e^{λk} over a block of samples is e^{λk} again, times a
        constant, so that nothing but noise is lost, and no filter has a transient.
        """
        rate = 2 * float(spectrum.frequency[-1])
        low, high = spectrum.band
        channels, shortest = records[0].shape[0], min(record.shape[1] for record in records)
        every = max(int(_LAG / high * rate / _FINE), 1)
        shortest //= every
        step = min(max(round(_LAG / high * rate / every), 1), max(shortest // 4, 1))
        wanted = round(_WINDOW / low * rate / every / step)
        shifts = max(min(wanted, _ROWS // channels - 1, shortest // (2 * step)), min(2, shortest // step - 1), 1)
        scale = np.sqrt(noise_floor(records))
        factors, columns = [], 0
        for record in records:
            count = record.shape[1] // every
            thin = record[:, : count * every].reshape(channels, count, every).mean(axis=2) / scale[:, None]
            factor, own = hankel_factor(thin, step, shifts)
            factors.append(factor)
            columns += own
        left, singular, _ = np.linalg.svd(triangle(np.hstack(factors).T).T)
        # Of white noise, with what the averages leave of it (the edge of Marchenko's and Pastur's law).
        edge = (np.sqrt(columns) + np.sqrt(left.shape[0])) / np.sqrt(every)
        longest = max(record.shape[1] for record in records)
        return cls(left, singular, _ABOVE * edge, scale, step * every, longest)

    @property
    def most(self) -> int:
        """The highest order that it allows."""
        return min(int(self.left.shape[0]) - len(self.scale), int(self.left.shape[1]))

    @property
    def standing_out(self) -> int:
        """How many directions stand out from noise, and from rounding."""
        return int(np.sum(self.singular > max(self.noise, _ROUNDING * float(self.singular[0]))))

    def poles(self, order: int) -> Poles:
        """Give the poles that can be those of a free decay, and their shapes, of a system of some order."""
        channels = len(self.scale)
        kept = self.left[:, :order]
        transition = np.linalg.lstsq(kept[:-channels], kept[channels:], rcond=None)[0]
        z, vectors = np.linalg.eig(transition)
        # A negative real z no sampled decay can give.
        usable = (np.abs(z) > 1e-12) & ~((z.imag == 0) & (z.real < 0)) & (z.imag >= 0)
        exponent = np.log(z[usable].astype(complex)) / self.lag
        shapes = self.scale[:, None] * (kept[:channels] @ vectors[:, usable])
        decaying = exponent.real * self.longest < _GROWTH
        return Poles.of(exponent[decaying], shapes[:, decaying].astype(np.complex128))


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


def hankel_factor(record: Real, step: int, shifts: int) -> tuple[Real, int]:
    """Stack a record delayed by 0, 1, ... lags, and keep R of its QR factorisation, which has the same span.

    Parameters
    ----------
    record
        Shape (channel, time).
    step
        Samples in a lag.
    shifts
        Lags; there is one more block row.

    Returns
    -------
    factor
        Shape (block row · channel, at most as many), each row's mean taken off: offsets of channels are gone with it.
    columns
        Of the matrix it stands for.
    """
    length = record.shape[1] - shifts * step
    hankel = np.vstack([record[:, i * step : i * step + length] for i in range(shifts + 1)])
    hankel -= hankel.mean(axis=1, keepdims=True)
    return triangle(hankel.T).T, length
