"""Sums over samples of decaying exponentials, without any array of the size of the records.

All that a fit needs from the samples are inner products of e^{λk} and k e^{λk} with each other and with the records; k counts
the samples and λ is per sample. The first have closed forms (geometric sums). The second factorise: the sample
k = bL + l has e^{λk} = e^{λbL} e^{λl}, so one product of the records, cut into blocks of L samples, with a table of L rows, and
one with a table over the blocks, give them all.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]
Index = NDArray[np.int64]

BLOCK_LENGTH = 128
"""Samples in a block: a usual record has a dozen of them, so that both tables are small."""

_FLAT = 0.05
"""Below this change of the exponent over the record the closed forms cancel, and the few sums are added up directly."""


def exponential_moments(
    exponent: Complex, group: Index, last: Complex, samples: Index, powers: int = 3
) -> list[Complex]:
    """Sum powers of k times exponentials over the samples k = 0 ... N - 1.

    Parameters
    ----------
    exponent
        Logarithm of z, shape (group, ...).
    group
        Group of each record, shape (record,).
    last
        z^N, shape (record, ...).
    samples
        N of each record; broadcasts with `last`, shape (record, ...).
    powers
        Number of sums.

    Returns
    -------
    list of ndarray
        Σ z^k, Σ k z^k and Σ k² z^k, the first `powers` of them, each of shape (record, ...).

    Notes
    -----
    Geometric sums and their derivatives by the exponent. With 1 - z taken from expm1, only exponents that hardly change
    over the record would cancel; those are summed directly.
    """
    flat = np.abs(exponent) * samples.max() < _FLAT
    safe = np.where(flat, -1.0, exponent)
    scale = (-1 / np.expm1(safe))[group]
    found = [(1 - last) * scale]
    if powers > 1:
        z, end = np.exp(safe)[group], samples * last
        found.append((z * found[0] - end) * scale)
        found.append((z * (2 * found[1] + found[0]) - samples * end) * scale)
    if flat.any():
        counts = np.broadcast_to(samples, last.shape)
        for where in map(tuple, np.argwhere(flat[group])):
            k = np.arange(counts[where])
            powers_of_z = np.exp(exponent[(group[where[0]], *where[1:])] * k)
            for power, sums in enumerate(found):
                sums[where] = (k**power * powers_of_z).sum()
    return found[:powers]


def exponential_gram(exponent: Complex, samples: Index, group: Index | None = None, secular: bool = True) -> Complex:
    """Return the Gram matrices of e^{λk} and k e^{λk}, centred over each record.

    They are centred because every channel of every record has its own offset.

    Parameters
    ----------
    exponent
        λ of each group of records per sample, dimensionless, shape (group, mode).
    samples
        N of each record, shape (record,).
    group
        Group of each record, shape (record,); a group for each record unless given.
    secular
        Whether to return those with k e^{λk} too.

    Returns
    -------
    ndarray
        Conjugated by rows; shape (record, 2 mode, 2 mode), or (record, mode, mode) where secular is False.
    """
    powers = 3 if secular else 1
    of_record = np.arange(len(exponent)) if group is None else group
    count = samples[:, None]
    last = np.exp(exponent[of_record] * count)
    mean = exponential_moments(exponent, of_record, last, count, powers)
    pair = exponential_moments(
        exponent.conj()[:, :, None] + exponent[:, None, :],
        of_record,
        last.conj()[:, :, None] * last[:, None, :],
        count[:, None],
        powers,
    )
    if secular:
        modes = exponent.shape[1]
        whole = np.empty((len(last), 2 * modes, 2 * modes), dtype=np.complex128)
        whole[:, :modes, :modes], whole[:, modes:, modes:] = pair[0], pair[2]
        whole[:, :modes, modes:] = whole[:, modes:, :modes] = pair[1]
        sums = np.concatenate(mean[:2], axis=1)
    else:
        whole, sums = pair[0], mean[0]
    whole -= (sums.conj() / count)[:, :, None] * sums[:, None, :]
    return whole


def split_into_blocks(records: Sequence[Real], usable: NDArray[np.bool_] | None = None) -> Real:
    """Centre records and cut them into blocks, the last one of each filled with zeros.

    Parameters
    ----------
    records
        Of any one unit, shape (channel, time) each.
    usable
        Which channels are used, shape (channel,); the others become zero.

    Returns
    -------
    ndarray
        In the unit of the records, one after the other, shape (block, channel, BLOCK_LENGTH).
    """
    channels = len(records[0])
    blocks = np.zeros((sum(-(-record.shape[1] // BLOCK_LENGTH) for record in records), channels, BLOCK_LENGTH))
    chosen = (np.ones(channels, dtype=bool) if usable is None else usable)[:, None]
    begin = 0
    for record in records:
        count, rest = divmod(record.shape[1], BLOCK_LENGTH)
        mean = np.where(chosen, record.mean(axis=1, keepdims=True), 0.0)
        whole = record[:, : count * BLOCK_LENGTH].reshape(channels, count, BLOCK_LENGTH)
        np.subtract(whole.swapaxes(0, 1), mean, out=blocks[begin : begin + count], where=chosen)
        begin += count
        if rest:
            np.subtract(record[:, count * BLOCK_LENGTH :], mean, out=blocks[begin, :, :rest], where=chosen)
            begin += 1
    return blocks


def correlate_with_exponentials(
    padded_blocks: Real, counts: Index, exponent: Complex, group: Index, secular: bool = True
) -> Complex:
    """Return the inner products of records with exponentials.

    Parameters
    ----------
    padded_blocks
        Records cut by `split_into_blocks`, one after the other, those of one group beside each other, of any one
        unit, shape (block, channel, BLOCK_LENGTH).
    counts
        Number of blocks of each record, shape (record,).
    exponent
        λ of each group per sample, dimensionless, shape (group, mode).
    group
        Group of each record, ascending, shape (record,).
    secular
        Whether to return those with k e^{λk} too.

    Returns
    -------
    ndarray
        Σ conj(e^{λk}) y_k and, if secular, Σ k conj(e^{λk}) y_k, in the unit of the records; shape
        (record, channel, 1 or 2, mode).
    """
    ends = np.cumsum(counts)
    of_block = np.concatenate([np.arange(count) for count in counts])
    inside = np.arange(BLOCK_LENGTH)[:, None]
    flat = []
    for number, poles in enumerate(exponent):
        fine = exponentials(poles.conj())
        table = np.concatenate([fine, inside * fine], axis=1) if secular else fine
        own = ends[group == number]
        begin = own[0] - counts[np.searchsorted(group, number)]
        flat.append(padded_blocks[begin : own[-1]].reshape(-1, BLOCK_LENGTH) @ table.view(float))
    products = np.concatenate(flat).view(complex).reshape(*padded_blocks.shape[:2], -1, exponent.shape[1])
    coarse = np.exp(exponent.conj()[:, None] * (BLOCK_LENGTH * np.arange(counts.max())[:, None]))
    products *= coarse[np.repeat(group, counts), of_block][:, None, None]
    if secular:
        products[:, :, 1] += (BLOCK_LENGTH * of_block)[:, None, None] * products[:, :, 0]
    return np.add.reduceat(products, np.concatenate([[0], ends[:-1]]), axis=0)


def exponentials(exponent: Complex, samples: int = BLOCK_LENGTH) -> Complex:
    """Return e^{λk}, as products of a few exponentials.

    Parameters
    ----------
    exponent
        λ per sample, dimensionless, shape (mode,).
    samples
        How many.

    Returns
    -------
    ndarray
        Dimensionless, shape (samples, mode).
    """
    width = 1 << (samples.bit_length() // 2)
    across = np.exp(exponent * (width * np.arange(-(-samples // width))[:, None]))
    product = across[:, None] * np.exp(exponent * np.arange(width)[:, None])
    return product.reshape(-1, exponent.size)[:samples]


def real_product(coefficients: Complex, waves: Complex) -> Real:
    """Return the real part of a product of coefficients and exponentials, as a product of pairs of real numbers.

    Parameters
    ----------
    coefficients
        In any unit, shape (..., mode).
    waves
        Dimensionless, shape (time, mode).

    Returns
    -------
    ndarray
        In the unit of the coefficients, shape (..., time).
    """
    pairs = np.ascontiguousarray(coefficients.conj()).view(float)
    product: Real = pairs.reshape(-1, pairs.shape[-1]) @ np.ascontiguousarray(waves).view(float).T
    return product.reshape(*coefficients.shape[:-1], len(waves))
