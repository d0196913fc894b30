"""A basis that depends on nothing but the subspace it spans."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]

_EQUAL = 1e-6
"""Relative difference below which two lengths are the same: rounding does not choose between them."""


def canonical_basis(directions: Real) -> Real:
    """Orthonormal basis of the span of some directions, the same whichever directions of that span are given.

    Eigenvectors of equal eigenvalues, such as those of directions without any information, are arbitrary: the rounding of the
    processor chooses them. Here the coordinate that the subspace holds most of gives the first vector, by projection; what
    the rest of the subspace holds most of gives the next (Gram-Schmidt with pivoting on the projection matrix).

    Parameters
    ----------
    directions
        Linearly independent, dimensionless, shape (parameter, direction).

    Returns
    -------
    ndarray
        Dimensionless, each column positive in the coordinate that gave it, shape (parameter, direction).
    """
    span = np.linalg.qr(directions)[0]
    left = span @ span.T
    basis = np.empty_like(span)
    for column in range(span.shape[1]):
        held = np.diag(left)
        pivot = int(np.argmax(held >= (1 - _EQUAL) * held.max()))
        # Twice is enough: what rounding left of the vectors before is taken off.
        vector = left[:, pivot] - basis[:, :column] @ (basis[:, :column].T @ left[:, pivot])
        basis[:, column] = vector / np.linalg.norm(vector)
        left = left - np.outer(basis[:, column], basis[:, column])
    return basis
