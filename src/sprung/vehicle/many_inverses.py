"""Inverses of very many small matrices: side by side, where a library calls itself for each."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Real = TypeVar("Real", np.float32, np.float64)

SIDE_BY_SIDE = 512
"""Matrices that are inverted at once: a dozen rows of so many stay in a processor's cache."""

_LEAST_PIVOT = 0.1
"""Part of one below which a pivot is too small to go on without exchange of rows."""


def invert_many(matrices: NDArray[Real]) -> NDArray[Real]:
    """Invert matrices that are nearly unit matrices, as those are that solve for forces at the end of a short step.

    Parameters
    ----------
    matrices
        Dimensionless, shape (..., row, row).

    Returns
    -------
    ndarray
        Of the same shape.

    Notes
    -----
    The method of Gauss and Jordan without exchange of rows; where that needs a small pivot, `numpy.linalg.inv`.
    """
    size = matrices.shape[-1]
    flat = matrices.reshape(-1, size, size)
    inverses = np.empty_like(flat)
    for first in range(0, len(flat), SIDE_BY_SIDE):
        some = slice(first, first + SIDE_BY_SIDE)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # of a pivot that is zero
            found, least = _eliminate(np.moveaxis(flat[some], 0, -1).copy())
        inverses[some] = np.moveaxis(found, -1, 0) if least > _LEAST_PIVOT else np.linalg.inv(flat[some])
    return inverses.reshape(matrices.shape)


def _eliminate(system: NDArray[Real]) -> tuple[NDArray[Real], float]:
    """Return inverses of matrices (row, row, matrix), in the memory of these, and the smallest pivot."""
    least = np.inf
    for row in range(len(system)):
        pivots = system[row, row].copy()
        least = min(least, float(np.abs(pivots).min(initial=np.inf)))
        system[row, row] = 1.0
        kept, factors = system[row] / pivots, system[:, row].copy()
        system[:, row] = 0.0
        system -= factors[:, None] * kept
        system[row] = kept
    return system, least
