"""The closed forms against plain sums over the samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sprung.vibration.exponential_sums import (
    BLOCK_LENGTH,
    correlate_with_exponentials,
    exponential_gram,
    exponential_moments,
    split_into_blocks,
)


@given(
    decay=st.floats(-2.0, 0.0),
    turn=st.floats(-3.0, 3.0),
    samples=st.integers(1, 3000),
)
def test_moments_are_the_sums(decay: float, turn: float, samples: int) -> None:
    exponent = complex(decay, turn) * 10.0 ** -float(samples % 7)
    k = np.arange(samples)
    powers = np.exp(exponent * k)
    group = np.zeros(1, dtype=np.int64)
    found = exponential_moments(
        np.array([exponent]), group, np.exp(np.array([exponent]) * samples), np.array([samples])
    )
    for moment, power in zip(found, (0, 1, 2), strict=True):
        # Relative to the largest sum there could be: one that cancels cannot be had better from its terms either.
        size = np.sum((k + 1.0) ** power * np.abs(powers))
        assert abs(moment[0] - np.sum(k**power * powers)) <= 1e-11 * size


@pytest.mark.parametrize("samples", [(1,), (BLOCK_LENGTH - 1, BLOCK_LENGTH), (BLOCK_LENGTH + 1, 1501, 3)])
def test_correlate_is_the_inner_product_with_centred_records(samples: tuple[int, ...]) -> None:
    random = np.random.default_rng(1)
    records = [random.standard_normal((5, count)) for count in samples]
    exponent = np.array([-0.01 + 0.1j, -0.3 + 0j, -0.002 - 0.02j])
    blocks = split_into_blocks(records)
    counts = np.array([-(-count // BLOCK_LENGTH) for count in samples])
    same = np.zeros(len(samples), dtype=np.int64)
    found = correlate_with_exponentials(blocks, counts, exponent[None], same)
    for whole, products in zip(records, found, strict=True):
        k, record = np.arange(whole.shape[1]), whole - whole.mean(axis=1, keepdims=True)
        powers = np.exp(exponent[:, None] * k)
        np.testing.assert_allclose(products[:, 0], record @ powers.conj().T, rtol=0, atol=1e-11)
        np.testing.assert_allclose(products[:, 1], record @ (k * powers).conj().T, rtol=0, atol=1e-8)
    alone = correlate_with_exponentials(blocks, counts, exponent[None], same, secular=False)
    np.testing.assert_allclose(alone, found[:, :, :1], rtol=0, atol=1e-12)


def test_gram_is_of_centred_exponentials() -> None:
    exponent = np.array([-0.01 + 0.1j, -0.3 + 0j, -0.002 - 0.02j, -1e-5 + 0j])
    samples = np.array([40, 1501])
    both = exponential_gram(exponent[None], samples, np.zeros(2, dtype=np.int64))
    for found, count in zip(both, samples, strict=True):
        k = np.arange(count)
        powers = np.exp(exponent[:, None] * k)
        waves = np.vstack([powers, k * powers])
        waves -= waves.mean(axis=1, keepdims=True)
        size = np.linalg.norm(waves, axis=1)
        np.testing.assert_allclose(
            found / np.outer(size, size), waves.conj() @ waves.T / np.outer(size, size), atol=1e-9
        )
    np.testing.assert_allclose(
        exponential_gram(exponent[None].repeat(2, axis=0), samples, secular=False), both[:, :4, :4], atol=1e-9
    )
