"""Which directions of the coordinates the records determine, and normal equations in these.

The others are left alone by every fit: what is not determined is said, not guessed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.optimisation import NormalEquations

Real = NDArray[np.float64]

RANK = 1e-12
"""Information, as a part of the largest, that is nothing but rounding."""

NO_INFORMATION = 1.0
"""Fisher information of a logarithm below which its value is not determined to a factor of e."""


def identifiable_subspace(information: Real) -> Real:
    """Return the :term:`identifiable subspace`: the directions of which data and priors have information.

    Parameters
    ----------
    information
        Fisher information in logarithms of the parameters, shape (direction, direction).

    Returns
    -------
    ndarray
        Orthonormal columns, shape (direction, identifiable direction).
    """
    if not np.isfinite(information).all():  # derivatives of a motion that runs away overflow: they determine nothing
        return np.zeros((len(information), 0))
    eigenvalues, vectors = np.linalg.eigh(information)
    identifiable = eigenvalues >= least_information(eigenvalues)
    return np.eye(len(information)) if identifiable.all() else vectors[:, identifiable]


def least_information(eigenvalues: Real) -> float:
    """Information below which a direction is not determined: one, or rounding beside the largest information there is."""
    return max(NO_INFORMATION, RANK * float(eigenvalues.max(initial=0.0)))


def identifiable_equations(information: Real, gradient: Real, null_space: Real) -> NormalEquations:
    """Return normal equations in the identifiable directions of a null space of constraints.

    The other directions are left alone: they would only wander.

    Parameters
    ----------
    information, gradient
        In the null space, shapes (direction, direction) and (direction,).
    null_space
        Orthonormal columns, shape (coordinate, direction).
    """
    subspace = identifiable_subspace(information)
    scaling = subspace.T @ (np.diag(information)[:, None] * subspace)
    return NormalEquations(subspace.T @ information @ subspace, subspace.T @ gradient, scaling, null_space @ subspace)
