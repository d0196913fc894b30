"""The closed forms against plain sums over the samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sprung.identification.sums import BLOCK, blocks, correlate, moments


@given(
    decay=st.floats(-2.0, 0.0),
    turn=st.floats(-3.0, 3.0),
    samples=st.integers(1, 3000),
)
def test_moments_are_the_sums(decay: float, turn: float, samples: int) -> None:
    exponent = complex(decay, turn) * 10.0 ** -float(samples % 7)
    k = np.arange(samples)
    powers = np.exp(exponent * k)
    found = moments(np.array(exponent), np.array(samples))
    for moment, power in zip(found, (0, 1, 2), strict=True):
        # Relative to the largest sum there could be: one that cancels cannot be had better from its terms either.
        size = np.sum((k + 1.0) ** power * np.abs(powers))
        assert abs(moment - np.sum(k**power * powers)) <= 1e-11 * size


@pytest.mark.parametrize("samples", [(1,), (BLOCK - 1, BLOCK), (BLOCK + 1, 1501, 3)])
def test_correlate_is_the_inner_product(samples: tuple[int, ...]) -> None:
    random = np.random.default_rng(1)
    records = [random.standard_normal((5, count)) for count in samples]
    exponent = np.array([-0.01 + 0.1j, -0.3 + 0j, -0.002 - 0.02j])
    cut = [blocks(record) for record in records]
    counts = np.array([len(one) for one in cut])
    zeroth, first = correlate(np.concatenate(cut), counts, exponent)
    for record, found, weighted in zip(records, zeroth, first, strict=True):
        k = np.arange(record.shape[1])
        powers = np.exp(exponent[:, None] * k)
        np.testing.assert_allclose(found, record @ powers.conj().T, rtol=0, atol=1e-11)
        np.testing.assert_allclose(weighted, record @ (k * powers).conj().T, rtol=0, atol=1e-8)
    (alone,) = correlate(np.concatenate(cut), counts, exponent, weighted=False)
    np.testing.assert_allclose(alone, zeroth, rtol=0, atol=1e-12)
