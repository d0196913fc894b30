"""Spectra of free decays: their noise floor and their band."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammainccinv

Real = NDArray[np.float64]

_LOWEST, _HIGHEST = 0.01, 0.95
"""Parts of the energy above the noise, in the mean over the channels, between which the band lies."""

_CHANCE = 1e-3
"""Probability that noise alone exceeds the limit anywhere, at one width."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Periodograms of several records on one grid of frequencies.

    Attributes
    ----------
    frequency
        Hz, shape (bin,).
    power
        |FFT|² over the number of samples: for white noise its variance; shape (record, channel, bin).
    """

    frequency: Real
    power: Real

    @classmethod
    def of(cls, records: Sequence[Real], rate: float) -> Spectrum:
        """Transform records of shape (channel, time), the shorter ones filled up with zeros."""
        length = max(record.shape[1] for record in records)
        transformed = (np.fft.rfft(record - record.mean(axis=1, keepdims=True), length) for record in records)
        power = [np.abs(one) ** 2 / record.shape[1] for one, record in zip(transformed, records, strict=True)]
        return cls(np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=float), np.array(power))

    @cached_property
    def floor(self) -> Real:
        """Variance of each channel's noise, from the upper half of the band; shape (channel,)."""
        upper = self.power[:, :, self.power.shape[2] // 2 :]
        return np.asarray(np.median(upper, axis=(0, 2)) / np.log(2))

    @cached_property
    def significant(self) -> NDArray[np.bool_]:
        """Whether each bin belongs to a band, of any width, with more power than noise of that floor; shape (bin,)."""
        records, channels, bins = self.power.shape
        total = (self.power / np.maximum(self.floor, 1e-300)[:, None]).sum(axis=(0, 1))
        total[0] = 0.0  # the mean was subtracted
        sums = np.concatenate([[0.0], np.cumsum(total)])
        found, width = np.zeros(bins, dtype=np.bool_), 1
        while width <= bins:
            # Periodograms of white noise are exponentially distributed, sums of them by a gamma distribution.
            limit = float(gammainccinv(width * records * channels, _CHANCE / bins))
            is_exceeded = (sums[width:] - sums[:-width] > limit).astype(np.int64)
            edges = np.concatenate([is_exceeded, np.zeros(width, dtype=np.int64)])
            edges[width:] -= is_exceeded
            found |= np.cumsum(edges)[:bins] > 0
            width *= 4
        return found

    @cached_property
    def above(self) -> Real:
        """Power above the noise in the significant bins, with the sum 1 in each channel; shape (channel, bin)."""
        power = self.power.mean(axis=0)
        above = np.maximum(power - self.floor[:, None], 0.0) * self.significant
        return np.asarray(above / np.maximum(above.sum(axis=1, keepdims=True), 1e-300))

    @cached_property
    def band(self) -> tuple[float, float]:
        """Frequency band of nearly all of the motion, Hz."""
        share = np.cumsum(self.above.mean(axis=0))
        if not share[-1] > 0:
            return float(self.frequency[1]), float(self.frequency[-1])
        low, high = np.searchsorted(share / share[-1], (_LOWEST, _HIGHEST))
        return float(self.frequency[max(low, 1)]), float(self.frequency[min(max(high, 2), self.frequency.size - 1)])
