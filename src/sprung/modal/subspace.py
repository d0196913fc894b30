"""The signal subspace of the block Hankel matrix of all records: start of the fit, and number of poles above the noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decimation import DecimatedRecords, triangular_factor
from sprung.modal.likelihood import Poles
from sprung.modal.spectrum import Spectrum

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_ROWS = 150
"""Rows of the block Hankel matrix at the most."""

_NOISE_FACTOR = 1.3
"""Factor of the largest singular value of white noise."""

_ROUNDING = 1e-12

_CONSTANT = 1e-6
"""Change of the exponent over the longest record below which a pole is rejected as constant."""

_GROWTH = 1.0
"""Powers of e by which a motion may appear to grow over the longest record."""


@dataclass(frozen=True, eq=False)
class SignalSubspace:
    """Column space of the block Hankel matrix of all records, by singular value.

    Attributes
    ----------
    decimated
        The records.
    left
        Orthonormal, shape (block row · channel, direction).
    singular
        Shape (direction,).
    noise
        Upper limit of a singular value of noise alone.
    """

    decimated: DecimatedRecords
    left: Real
    singular: Real
    noise: float

    @classmethod
    def of(cls, records: Sequence[Real], spectrum: Spectrum) -> SignalSubspace:
        """Decompose the block Hankel matrix of all records side by side."""
        decimated = DecimatedRecords.of(records, spectrum)
        hankel = decimated.hankel(decimated.shifts_within(_ROWS))
        # Of each record only R of its QR factorisation is kept: the span is the same, its size independent of time.
        factors = np.hstack([triangular_factor(matrix.T).T for matrix in hankel])
        left, singular, _ = np.linalg.svd(triangular_factor(factors.T).T)
        columns = sum(matrix.shape[1] for matrix in hankel)
        # Largest singular value of averaged white noise (edge of the Marchenko-Pastur law).
        edge = (np.sqrt(columns) + np.sqrt(left.shape[0])) / np.sqrt(decimated.every)
        return cls(decimated, left, singular, _NOISE_FACTOR * float(edge))

    @property
    def most(self) -> int:
        """Highest order."""
        return min(int(self.left.shape[0]) - self.decimated.channels, int(self.left.shape[1]))

    @property
    def significant(self) -> int:
        """Number of directions above noise and rounding."""
        return int(np.sum(self.singular > max(self.noise, _ROUNDING * float(self.singular[0]))))

    def poles(self, order: int) -> Poles:
        """Return poles and shapes of a system of some order, as far as a free decay can have them."""
        return realise_poles(self.left[:, :order], self.decimated)


def realise_poles(observability: Real, decimated: DecimatedRecords, block: int | None = None) -> Poles:
    """Return poles and shapes of an observability matrix, as far as a free decay can have them.

    The shift from block row to block row is the transition matrix over a lag.

    Parameters
    ----------
    observability
        Shape (block row · channel, order).
    decimated
        The records.
    block
        Rows in a block row, the channels first; the number of channels unless given.
    """
    block = decimated.channels if block is None else block
    transition = np.linalg.lstsq(observability[:-block], observability[block:], rcond=None)[0]
    return poles_of_transition(np.asarray(transition, dtype=float), observability[: decimated.channels], decimated)


def poles_of_transition(transition: Real, observation: Real, decimated: DecimatedRecords) -> Poles:
    """Return poles and shapes of a transition matrix, as far as a free decay can have them.

    Parameters
    ----------
    transition
        Of the state over a lag, shape (order, order).
    observation
        Observation matrix of the decimated channels, shape (channel, order).
    decimated
        The records.
    """
    z, vectors = np.linalg.eig(transition)
    return poles_of_recursion(z, observation @ vectors, decimated, decimated.step)


def poles_of_recursion(z: Complex, shapes: Complex, decimated: DecimatedRecords, step: int = 1) -> Poles:
    """Return poles from those of a recursion, without those that no sampled decay has: a negative real z, and growth.

    Parameters
    ----------
    z
        e^λ over so many samples of the decimated records, with conjugates; shape (pole,).
    shapes
        At the decimated channels, shape (channel, pole).
    decimated
        The records.
    step
        How many.
    """
    usable = (np.abs(z) > 1e-12) & ~((z.imag == 0) & (z.real < 0)) & (z.imag >= 0)
    exponent = np.log(z[usable].astype(complex)) / (step * decimated.every)
    decaying = (exponent.real * decimated.longest < _GROWTH) & (np.abs(exponent) * decimated.longest > _CONSTANT)
    at_channels = decimated.scale[:, None] * shapes[:, usable]
    return Poles.of(exponent[decaying], at_channels[:, decaying].astype(np.complex128))
