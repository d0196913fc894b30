"""Score tests of several larger models from one evaluation of a model that has everything they have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.problem import EstimationProblem, Iterate
from sprung.estimation.score_test import score_test

Real = NDArray[np.float64]

_BOUND = 1e-9
"""Part of a direction, of length one, that constraints forbid, from which they do."""


def score_directions(
    problem: EstimationProblem,
    iterate: Iterate,
    together: Sequence[Sequence[str]],
    candidates: Mapping[str, Sequence[Sequence[str]]],
) -> dict[str, float]:
    """Return what larger models would gain over one that is fitted already, from one evaluation of a model that has everything.

    Parameters
    ----------
    problem
        Of the model that has everything.
    iterate
        Where it equals the fitted one, or nearly so.
    together
        The directions of the fitted model: parameters that move together in it.
    candidates
        The further directions of each larger one.

    Returns
    -------
    dict
        In twice the log-likelihood, to second order.
    """
    names = problem.priors.coordinates.names
    information, gradient, null_space = problem.system(iterate)

    def project(directions: Sequence[Sequence[str]]) -> Real:
        """Return what constraints leave of directions, in the null space; as columns."""
        basis = np.array([[float(name in direction) for name in names] for direction in directions]).T
        along = null_space.T @ basis
        _, forbidden, combinations = np.linalg.svd(basis - null_space @ along)
        unconstrained: Real = along @ combinations[int(np.sum(forbidden > _BOUND)) :].T
        return unconstrained

    fitted = project(together)
    gains = {}
    for name, directions in candidates.items():
        basis = np.hstack([fitted, project([*together, *directions])])
        # Of the larger model's directions those that the smaller one has not.
        added = (
            basis[:, fitted.shape[1] :] - fitted @ np.linalg.lstsq(fitted, basis[:, fitted.shape[1] :], rcond=None)[0]
        )
        left, sizes, _ = np.linalg.svd(added, full_matrices=False)
        basis = np.hstack([fitted, left[:, sizes > _BOUND]])
        gains[name] = score_test(basis.T @ information @ basis, basis.T @ gradient, fitted.shape[1]).gain()
    return gains
