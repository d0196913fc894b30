"""The span of a block Hankel matrix of all records: where the fit of poles and shapes starts, and how many stand out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.likelihood import Poles
from sprung.modal.spectrum import Spectrum
from sprung.modal.thinning import Thinned, triangle

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_ROWS = 150
"""Rows of the block Hankel matrix at the most."""

_ABOVE = 1.3
"""Times what white noise of a matrix without structure reaches."""

_ROUNDING = 1e-12

_STILL = 1e-6
"""Change of the exponent over the longest record below which a pole is no motion."""

_GROWTH = 1.0
"""Powers of e by which a motion may seem to grow over the longest record."""


@dataclass(frozen=True, eq=False)
class Span:
    """The span of delayed records, in the order of the energy they put into it.

    Attributes
    ----------
    thinned
        The records.
    left
        Orthonormal, shape (block row · channel, direction).
    singular
        Shape (direction,).
    noise
        What noise alone may put into a direction.
    """

    thinned: Thinned
    left: Real
    singular: Real
    noise: float

    @classmethod
    def of(cls, records: Sequence[Real], spectrum: Spectrum) -> Span:
        """Decompose the block Hankel matrix of all records side by side."""
        thinned = Thinned.of(records, spectrum)
        hankel = thinned.hankel(thinned.shifted(_ROWS))
        # Of each record only R of its QR factorisation is kept: the same span, and nothing grows with time.
        factors = np.hstack([triangle(matrix.T).T for matrix in hankel])
        left, singular, _ = np.linalg.svd(triangle(factors.T).T)
        columns = sum(matrix.shape[1] for matrix in hankel)
        # Of white noise, with what the averages leave of it (the edge of Marchenko's and Pastur's law).
        edge = (np.sqrt(columns) + np.sqrt(left.shape[0])) / np.sqrt(thinned.every)
        return cls(thinned, left, singular, _ABOVE * float(edge))

    @property
    def most(self) -> int:
        """The highest order that it allows."""
        return min(int(self.left.shape[0]) - self.thinned.channels, int(self.left.shape[1]))

    @property
    def standing_out(self) -> int:
        """How many directions stand out from noise, and from rounding."""
        return int(np.sum(self.singular > max(self.noise, _ROUNDING * float(self.singular[0]))))

    def poles(self, order: int) -> Poles:
        """Give the poles that can be those of a free decay, and their shapes, of a system of some order."""
        return realised(self.left[:, :order], self.thinned)


def realised(observability: Real, thinned: Thinned, block: int | None = None) -> Poles:
    """Give poles and shapes of what an observability matrix spans, those that can be of a free decay.

    The shift from block row to block row is the transition matrix over a lag.

    Parameters
    ----------
    observability
        Shape (block row · channel, order).
    thinned
        The records it is of.
    block
        Rows in a block row, the channels the first of them; just the channels unless given.
    """
    block = thinned.channels if block is None else block
    transition = np.linalg.lstsq(observability[:-block], observability[block:], rcond=None)[0]
    return recurring(np.asarray(transition, dtype=float), observability[: thinned.channels], thinned)


def recurring(transition: Real, seen: Real, thinned: Thinned) -> Poles:
    """Give poles and shapes of a state that recurs every lag, those that can be of a free decay.

    Parameters
    ----------
    transition
        Of the state over a lag, shape (order, order).
    seen
        What the thinned channels see of the state, shape (channel, order).
    thinned
        The records.
    """
    z, vectors = np.linalg.eig(transition)
    return vibrating(z, seen @ vectors, thinned, thinned.step)


def vibrating(z: Complex, shapes: Complex, thinned: Thinned, step: int = 1) -> Poles:
    """Give poles from those of a recursion, without what no sampled decay can give: a negative real z, and growth.

    Parameters
    ----------
    z
        e^λ over so many samples of the thinned records, with conjugates; shape (pole,).
    shapes
        At the thinned channels, shape (channel, pole).
    thinned
        The records.
    step
        How many.
    """
    usable = (np.abs(z) > 1e-12) & ~((z.imag == 0) & (z.real < 0)) & (z.imag >= 0)
    exponent = np.log(z[usable].astype(complex)) / (step * thinned.every)
    decaying = (exponent.real * thinned.longest < _GROWTH) & (np.abs(exponent) * thinned.longest > _STILL)
    at_channels = thinned.scale[:, None] * shapes[:, usable]
    return Poles.of(exponent[decaying], at_channels[:, decaying].astype(np.complex128))
