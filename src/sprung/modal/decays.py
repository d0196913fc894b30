"""Free decays of one load, taken up once: whatever a fit of poles and shapes needs of their samples."""

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
    """Records of the same channels and rate, each with the mean of every channel taken off.

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
    blocked
        The records cut into blocks for `correlate_with_exponentials`, one after the other.
    """

    values: tuple[Real, ...]
    rate: float
    samples: Index
    energy: Real
    blocked: Real

    @classmethod
    def of(cls, records: Sequence[Real], rate: float) -> Decays:
        """Take up records of shape (channel, time)."""
        values = tuple(record - record.mean(axis=1, keepdims=True) for record in records)
        return cls(
            values=values,
            rate=rate,
            samples=np.array([record.shape[1] for record in records]),
            energy=np.array([np.einsum("ct,ct->c", record, record) for record in values]),
            blocked=np.concatenate([split_into_blocks(record) for record in records]),
        )

    @cached_property
    def spectrum(self) -> Spectrum:
        """Of the records."""
        return Spectrum.of(self.values, self.rate)

    @property
    def channels(self) -> int:
        """How many channels there are."""
        return int(self.energy.shape[1])

    @property
    def count(self) -> int:
        """How many records there are."""
        return len(self.values)

    @property
    def numbers(self) -> float:
        """How many numbers each channel has, all records together."""
        return float(self.samples.sum())

    @property
    def seconds(self) -> Real:
        """Length of each record, s."""
        return np.asarray(self.samples / self.rate)

    def gram(self, exponent: Complex) -> Complex:
        """Give the inner products of (e^{λk}, k e^{λk}) with each other, λ per sample; shape (record, 2 pole, 2 pole)."""
        lengths, which = np.unique(self.samples, return_inverse=True)
        return exponential_gram(exponent[None], lengths, np.zeros(len(lengths), dtype=np.int64))[which]

    def correlate(self, exponent: Complex) -> Complex:
        """Give the inner products of (e^{λk}, k e^{λk}) with the records, shape (record, channel, 2 pole)."""
        counts, group = -(-self.samples // BLOCK_LENGTH), np.zeros(self.count, dtype=np.int64)
        products = correlate_with_exponentials(self.blocked, counts, exponent[None], group)
        return products.reshape(*products.shape[:2], -1)

    def less(self, exponent: Complex, coefficients: Complex) -> tuple[Real, ...]:
        """Take a motion off the records: coefficients of e^{λk}, shape (record, channel, pole), conjugates included."""
        motion = exponentials(exponent, int(self.samples.max()))
        motion = np.ascontiguousarray(motion.conj()).view(float)
        left = []
        for values, own, count in zip(self.values, coefficients, self.samples, strict=True):
            # The real part of a product of complex numbers is that of pairs of real ones, one of them conjugated.
            fitted = np.ascontiguousarray(own).view(float) @ motion[:count].T
            left.append(values - fitted + fitted.mean(axis=1, keepdims=True))
        return tuple(left)
