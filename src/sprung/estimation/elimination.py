"""Elimination of nuisance unknowns from normal equations: the Schur complement."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]

_HIDDEN = 1e-14
"""Information about a direction, beside that about the best known one, below which rounding hides it."""


def eliminate(information: Real, gradient: Real, kept: int) -> tuple[Real, Real, Real]:
    """Eliminate the last unknowns from normal equations.

    Parameters
    ----------
    information, gradient
        Of all unknowns, shapes (..., unknown, unknown) and (..., unknown), in the units of their products.
    kept
        Number of the first unknowns that are kept.

    Returns
    -------
    information, gradient
        Of those kept, whatever the others are: the Schur complement; shapes (..., kept, kept) and (..., kept).
    response
        Change of each of the others with those kept, at the maximum over them, shape (..., other, kept).
    """
    across, others = information[..., kept:, :kept], information[..., kept:, kept:]
    right = np.concatenate([across, gradient[..., kept:, None]], axis=-1)
    solved = solve_normal_equations(others, right)
    response, moved = -solved[..., :kept], solved[..., kept]
    transposed = np.swapaxes(across, -1, -2)
    reduced = information[..., :kept, :kept] + transposed @ response
    return reduced, gradient[..., :kept] - (transposed @ moved[..., None])[..., 0], response


def solve_normal_equations(information: Real, right: Real) -> Real:
    """Solve normal equations; what rounding hides keeps its value.

    Of a motion that grows every initial state shows the same growth alone, and their information is singular.

    Parameters
    ----------
    information
        Symmetric, shape (..., unknown, unknown), in the units of the products of the unknowns.
    right
        Right-hand sides, shape (..., unknown, column).

    Returns
    -------
    ndarray
        Shape (..., unknown, column).
    """
    try:
        return np.asarray(np.linalg.solve(information, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(information, rcond=_HIDDEN, hermitian=True) @ right)
