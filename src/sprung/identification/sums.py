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
    """Cut a record into blocks, the last one filled with zeros.

    Parameters
    ----------
    values
        Shape (channel, time).

    Returns
    -------
    ndarray
        Shape (block, channel, BLOCK).
    """
    channels, samples = values.shape
    count = -(-samples // BLOCK)
    padded = np.zeros((channels, count * BLOCK))
    padded[:, :samples] = values
    return np.ascontiguousarray(padded.reshape(channels, count, BLOCK).swapaxes(0, 1))


def correlate(
    blocked: Real, counts: NDArray[np.int64], exponent: Complex, weighted: bool = True
) -> tuple[Complex, ...]:
    """Give the inner products of records with exponentials.

    Parameters
    ----------
    blocked
        Records cut by `blocks`, one after the other, shape (block, channel, BLOCK).
    counts
        How many blocks each record has, shape (record,).
    exponent
        λ times the sampling interval, shape (mode,).
    weighted
        Whether the second of the results is wanted.

    Returns
    -------
    tuple of ndarray
        Σ conj(z^k) y_k and, if wanted, Σ k conj(z^k) y_k, each of shape (record, channel, mode).
    """
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    inside = np.arange(BLOCK)
    across = BLOCK * (np.arange(len(blocked)) - np.repeat(first, counts))
    fine = np.exp(np.conj(exponent) * inside[:, None])
    coarse = np.exp(np.conj(exponent) * (BLOCK * np.arange(counts.max()))[:, None])[across // BLOCK, None, :]
    columns = [fine.real, fine.imag]
    if weighted:
        columns += [inside[:, None] * fine.real, inside[:, None] * fine.imag]
    products = blocked @ np.hstack(columns)
    modes = exponent.size
    plain = coarse * (products[..., :modes] + 1j * products[..., modes : 2 * modes])
    zeroth = np.add.reduceat(plain, first, axis=0)
    if not weighted:
        return (zeroth,)
    lagged = coarse * (products[..., 2 * modes : 3 * modes] + 1j * products[..., 3 * modes :])
    return zeroth, np.add.reduceat(lagged + across[:, None, None] * plain, first, axis=0)
