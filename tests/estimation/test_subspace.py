"""A subspace that nothing determines has one basis, whatever the order in which arithmetic meets its vectors."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.estimation import canonical_basis
from sprung.estimation.identifiability import identifiable_equations


@pytest.mark.parametrize("seed", range(5))
def test_any_vectors_of_a_subspace_give_one_basis(seed: int) -> None:
    random = np.random.default_rng(seed)
    vectors = random.standard_normal((15, 4))
    first = canonical_basis(vectors)
    turned = canonical_basis(vectors @ random.standard_normal((4, 4)))
    # Rounding, enlarged by the condition of four random vectors.
    np.testing.assert_allclose(turned, first, atol=1e-10)
    np.testing.assert_allclose(first.T @ first, np.eye(4), atol=1e-12)
    inside = np.linalg.lstsq(vectors, first, rcond=None)[0]
    np.testing.assert_allclose(vectors @ inside, first, atol=1e-10)


def test_equal_parts_do_not_wait_for_rounding_to_choose() -> None:
    # Left and right belong to the subspace alike: the first of them leads, whichever rounding has made the larger.
    for rounding in (-1e-15, 1e-15):
        [vector] = canonical_basis(np.array([[0.0], [1.0], [-1.0 + rounding]])).T
        assert vector == pytest.approx([0.0, 0.5**0.5, -(0.5**0.5)])


def test_nothing_has_no_basis() -> None:
    assert canonical_basis(np.zeros((15, 0))).shape == (15, 0)


@pytest.mark.parametrize("overflow", [np.nan, np.inf])
def test_derivatives_that_overflow_lead_nowhere(overflow: float) -> None:
    """The eigenvalues of such an information do not converge: the identification of a half-car rig ended so."""
    information = np.diag([1e6, overflow, 1e3])
    step, gain = identifiable_equations(information, np.array([1.0, overflow, 2.0]), np.eye(3)).step(1e-3)
    assert not step.any()
    assert gain == 0
