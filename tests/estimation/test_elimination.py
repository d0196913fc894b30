"""Elimination of nuisance unknowns, against the solution of the whole system."""

from __future__ import annotations

import numpy as np

from sprung.estimation import eliminate


def test_the_schur_complement_is_what_the_whole_system_says() -> None:
    random = np.random.default_rng(1)
    root = random.standard_normal((3, 7, 7))
    information, gradient = root @ np.swapaxes(root, 1, 2), random.standard_normal((3, 7))
    reduced, own, response = eliminate(information, gradient, 4)
    whole = np.linalg.solve(information, gradient[..., None])[..., 0]
    step = np.linalg.solve(reduced, own[..., None])[..., 0]
    np.testing.assert_allclose(step, whole[:, :4], rtol=1e-9)
    assert response.shape == (3, 3, 4)


def test_unknowns_that_show_the_same_alone_are_eliminated_together() -> None:
    """Two unknowns of one effect, as initial states of a motion that grows: they take up as much as one would."""
    information = np.array([[4.0, 1.0, 1.0], [1.0, 2.0, 2.0], [1.0, 2.0, 2.0]])
    reduced, own, response = eliminate(information, np.array([1.0, 0.5, 0.5]), 1)
    single, of_single, _ = eliminate(information[:2, :2], np.array([1.0, 0.5]), 1)
    np.testing.assert_allclose(reduced, single)
    np.testing.assert_allclose(own, of_single)
    np.testing.assert_allclose(response, [[-0.25], [-0.25]])
