"""Free decays of one load, prepared once for fits of poles and shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.modal.spectrum import Spectrum
from sprung.vibration import (
    BLOCK_LENGTH,
    correlate_with_exponentials,
    exponential_gram,
    exponentials,
    split_into_blocks,
)

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Decays:
    """Records of the same channels and rate, each with the mean of every channel subtracted.

    Attributes
    ----------
    values
        One array of shape (channel, time) for each record, in its own unit.
    rate
        Samples per second.
    samples
        Of each record, shape (record,).
    energy
        Sum of squares of each channel, shape (record, channel).
    padded_blocks
        The records cut into blocks for `correlate_with_exponentials`, one after the other.
    """

    values: tuple[Real, ...]
    rate: float
    samples: Index
    energy: Real
    padded_blocks: Real

    @classmethod
    def of(cls, records: Sequence[Real], rate: float) -> Decays:
        """Prepare records of shape (channel, time)."""
        values = tuple(record - record.mean(axis=1, keepdims=True) for record in records)
        return cls(
            values=values,
            rate=rate,
            samples=np.array([record.shape[1] for record in records]),
            energy=np.array([np.einsum("ct,ct->c", record, record) for record in values]),
            padded_blocks=split_into_blocks(records),
        )

    @cached_property
    def spectrum(self) -> Spectrum:
        """Spectrum of the records."""
        return Spectrum.of(self.values, self.rate)

    @property
    def channels(self) -> int:
        """Number of channels."""
        return int(self.energy.shape[1])

    @property
    def count(self) -> int:
        """Number of records."""
        return len(self.values)

    @property
    def sample_count(self) -> float:
        """Number of samples of each channel, all records together."""
        return float(self.samples.sum())

    @property
    def seconds(self) -> Real:
        """Length of each record, s."""
        return np.asarray(self.samples / self.rate)

    def gram(self, exponent: Complex) -> Complex:
        """Return the Gram matrices of (e^{λk}, k e^{λk}), λ per sample; shape (record, 2 pole, 2 pole)."""
        lengths, which = np.unique(self.samples, return_inverse=True)
        return exponential_gram(exponent[None], lengths, np.zeros(len(lengths), dtype=np.int64))[which]

    def correlate(self, exponent: Complex) -> Complex:
        """Return the inner products of (e^{λk}, k e^{λk}) with the records, shape (record, channel, 2 pole)."""
        counts, group = -(-self.samples // BLOCK_LENGTH), np.zeros(self.count, dtype=np.int64)
        products = correlate_with_exponentials(self.padded_blocks, counts, exponent[None], group)
        return products.reshape(*products.shape[:2], -1)

    def subtract(self, exponent: Complex, coefficients: Complex) -> tuple[Real, ...]:
        """Subtract a motion from the records: coefficients of e^{λk}, shape (record, channel, pole), conjugates included."""
        motion = exponentials(exponent, int(self.samples.max()))
        motion = np.ascontiguousarray(motion.conj()).view(float)
        left = []
        for values, own, count in zip(self.values, coefficients, self.samples, strict=True):
            # The real part of a product of complex numbers is that of pairs of real ones, one of them conjugated.
            fitted = np.ascontiguousarray(own).view(float) @ motion[:count].T
            left.append(values - fitted + fitted.mean(axis=1, keepdims=True))
        return tuple(left)
