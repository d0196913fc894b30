"""M, C and K from two state matrices and a known added mass, eqs. (15)-(18) of the paper as printed."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems
from sprung.vehicle import COORDINATES, Matrices

Real = NDArray[np.float64]

_SINGULAR = 1e-10
"""Relative size below which a singular value of the added mass is zero."""


def added_mass(empty: ArrayLike, loaded: ArrayLike, added: ArrayLike) -> Matrices:
    """Return M, C and K from the state matrices of the empty and the loaded vehicle.

    M = ΔM Ā₂₁ (A₂₁ - Ā₂₁)⁻¹, eq. (18); then K = -M A₂₁ and C = -M A₂₂ from eqs. (3) and (4).

    Parameters
    ----------
    empty, loaded
        A and Ā, state matrices for the state {X, Ẋ}, 1/s; shape (14, 14). Only their lower halves are read.
    added
        ΔM, shape (7, 7), kg, kg m and kg m².

    Returns
    -------
    Matrices
        Of the empty vehicle, in general neither symmetric nor with the pattern of eq. (2).

    Raises
    ------
    InputError
        If ΔM is singular, as for a load on the body alone: A₂₁ - Ā₂₁ then has no inverse. Use
        `structured_least_squares`.
    """
    A, A_loaded, added = np.asarray(empty, dtype=float), np.asarray(loaded, dtype=float), np.asarray(added, dtype=float)
    _refuse_singular(added)
    difference = A[7:, :7] - A_loaded[7:, :7]
    M: Real = np.linalg.solve(difference.T, (added @ A_loaded[7:, :7]).T).T
    return Matrices(M, -M @ A[7:, 7:], -M @ A[7:, :7])


def _refuse_singular(added: Real) -> None:
    scale = np.sqrt(np.abs(np.diag(added)))
    without = [name for name, size in zip(COORDINATES[: len(scale)], scale, strict=True) if size == 0]
    size = np.where(scale > 0, scale, 1.0)
    singular = np.linalg.svd(added / np.outer(size, size), compute_uv=False)
    rank = int((singular > _SINGULAR * max(float(singular[0]), _SINGULAR)).sum())
    if rank == 7:
        return
    where = f", no added mass on {', '.join(without)}" if without else ""
    problems = Problems()
    problems.add(
        "added_mass: the added mass matrix",
        f"rank {rank} of 7{where}",
        "full rank: eq. (18) divides by A21 - Ā21, which has the rank of the added mass",
        "Use structured_least_squares, for which a load on the body alone is sufficient.",
    )
    problems.raise_if_any()
