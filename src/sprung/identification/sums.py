"""Sums over samples of decaying exponentials, without any array of the size of the records.

Whatever the fit needs from the samples are inner products of e^{λt} and t e^{λt} with each other and with the records.
The first have closed forms (geometric sums). The second factorise: the sample k = bL + l has e^{λk} = e^{λbL} e^{λl}, so
one product of the records, cut into blocks of L samples, with a table of L rows, and one with a table over the blocks,
give them all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]

BLOCK = 48
"""Samples in a block: near the square root of a usual record, so that both tables are small."""

_FLAT = 0.05
"""Below this change of the exponent over the record the closed forms cancel, and the few sums are added up directly."""


class Moments(NamedTuple):
    """Σ z^k, Σ k z^k and Σ k² z^k over the samples k = 0 ... N - 1, with z = exp(exponent)."""

    zeroth: Complex
    first: Complex
    second: Complex


def moments(exponent: Complex, samples: NDArray[np.int64]) -> Moments:
    """Sum powers of exponentials over the samples.

    Parameters
    ----------
    exponent
        Logarithm of z, dimensionless; any shape.
    samples
        N; broadcasts with the exponents.

    Returns
    -------
    Moments
        Each of the broadcast shape.

    Notes
    -----
    Geometric sums and their derivatives by the exponent. With d = 1 - z taken from expm1, only exponents that hardly
    change over the record would cancel; those are summed directly.
    """
    exponent, count = np.broadcast_arrays(exponent, samples)
    flat = np.abs(exponent) * count < _FLAT
    safe = np.where(flat, -1.0, exponent)
    z, d = np.exp(safe), -np.expm1(safe)
    end = np.exp(safe * count)
    zeroth = np.array((1 - end) / d)
    first = np.array((z * zeroth - count * end) / d)
    second = np.array((z * (2 * first + zeroth) - count**2 * end) / d)
    for where in map(tuple, np.argwhere(flat)):
        k = np.arange(count[where])
        powers = np.exp(exponent[where] * k)
        zeroth[where], first[where], second[where] = powers.sum(), (k * powers).sum(), (k**2 * powers).sum()
    return Moments(zeroth, first, second)


def blocks(values: Real) -> Real:
    """Cut records into blocks, the last one filled with zeros.

    Parameters
    ----------
    values
        Shape (..., time).

    Returns
    -------
    ndarray
        Shape (..., block, BLOCK).
    """
    samples = values.shape[-1]
    count = -(-samples // BLOCK)
    padded = np.zeros((*values.shape[:-1], count * BLOCK))
    padded[..., :samples] = values
    return padded.reshape(*values.shape[:-1], count, BLOCK)


def correlate(blocked: Real, exponent: Complex, weighted: bool = True) -> tuple[Complex, ...]:
    """Give the inner products of records with exponentials.

    Parameters
    ----------
    blocked
        Records cut by `blocks`, shape (..., block, BLOCK).
    exponent
        λ times the sampling interval, shape (mode,).
    weighted
        Whether the second of the results is wanted.

    Returns
    -------
    tuple of ndarray
        Σ conj(z^k) y_k and, if wanted, Σ k conj(z^k) y_k, each of shape (..., mode).
    """
    inside = np.arange(BLOCK)
    across = BLOCK * np.arange(blocked.shape[-2])
    fine = np.exp(np.conj(exponent) * inside[:, None])
    coarse = np.exp(np.conj(exponent) * across[:, None])
    columns = [fine.real, fine.imag]
    if weighted:
        columns += [inside[:, None] * fine.real, inside[:, None] * fine.imag]
    products = (blocked @ np.hstack(columns)).reshape(*blocked.shape[:-1], len(columns), exponent.size)
    plain = products[..., 0, :] + 1j * products[..., 1, :]
    zeroth = (coarse * plain).sum(axis=-2)
    if not weighted:
        return (zeroth,)
    lagged = products[..., 2, :] + 1j * products[..., 3, :]
    return zeroth, (coarse * (lagged + across[:, None] * plain)).sum(axis=-2)
