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
    try:
        solved = np.linalg.solve(others, right)
    except np.linalg.LinAlgError:
        # Of a motion that grows, every initial state shows the same growth alone: what it hides keeps its value.
        solved = np.linalg.pinv(others, rcond=_HIDDEN, hermitian=True) @ right
    response, moved = -solved[..., :kept], solved[..., kept]
    transposed = np.swapaxes(across, -1, -2)
    reduced = information[..., :kept, :kept] + transposed @ response
    return reduced, gradient[..., :kept] - (transposed @ moved[..., None])[..., 0], response
