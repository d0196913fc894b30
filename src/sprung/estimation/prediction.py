"""Each drop left out of the fit in turn, and predicted by what all others say of the vehicle.

Nothing is fitted again: the optimum of the others follows from gradient and information of each drop at the joint one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.estimation.identifiability import least_information

Real = NDArray[np.float64]

_LONGEST_STEP = 0.5
"""In logarithms: no parameter follows the other drops by more at once; a drop without which it would is hardly replaceable."""

_SLIGHT = 0.05
"""Part of the sum of squares up to which its growth is taken from the second order, which is then all there is to it."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """One drop as the vehicle fitted to all others has it, its own initial state being free.

    Attributes
    ----------
    fitted, squares
        Sum of the squares of all residuals, each over its channel's variance, dimensionless, in the joint fit and as predicted.
    by_chance
        By how much noise alone makes the sum of the squares, over their variances, larger than in the joint fit: what it is
        on average, and its standard deviation.
    distance
        How far what this drop says of the vehicle is from what the others say, squared, in standard errors, and the number
        of directions in which both say anything: with the right model, chi-squared with so many degrees of freedom.
    """

    fitted: float
    squares: float
    by_chance: tuple[float, float]
    distance: tuple[float, int]


def predictions(fit: FitResult) -> tuple[Prediction, ...]:
    """Predict each drop from all others.

    Parameters
    ----------
    fit
        The fit of all of them.

    Returns
    -------
    tuple of Prediction
        In their order.

    Notes
    -----
    With gradient g_d and information J_d of one drop, and those of everything, g and J, the others have their optimum a
    step (J - J_d)⁻¹ (g - g_d) away, to second order. What both say differs with the covariance (J - J_d)⁻¹ + J_d⁻¹, and the
    drop's sum of squares is a sum of squares λ larger than with its own optimum and λ + λ / (1 + λ) larger than with the joint
    one on average, λ being the eigenvalues of J_d (J - J_d)⁻¹.
    """
    problem, optimum = fit.problem, fit.iterate
    information, gradient, null_space = problem.system(optimum)
    gradients, informations = problem.by_drop(optimum)
    fitted = fit.residual_sums @ fit.weights
    eigenvalues, vectors = np.linalg.eigh(information - informations)
    # Only the directions that the others determine, all drops in one array: in the others there is no information.
    identifiable = eigenvalues >= np.array([least_information(own) for own in eigenvalues])[:, None]
    kept = vectors * identifiable[:, None]
    variances = np.where(identifiable, 1 / np.where(identifiable, eigenvalues, 1.0), 0.0)
    along = _times(kept, variances * _times(_transposed(kept), gradient - gradients))
    along *= np.minimum(1.0, _LONGEST_STEP / np.abs(along @ null_space.T).max(axis=1, initial=1e-300))[:, None]
    turned = _times(informations, along)
    squares = fitted - 2 * np.sum(gradients * along, axis=1) + np.sum(along * turned, axis=1)
    for drop in np.flatnonzero(squares > (1 + _SLIGHT) * fitted).tolist():
        values = problem.priors.coordinates.values(problem.priors.project(optimum.u + null_space @ along[drop]))
        alone = optimum.at.of_drop(drop).moved(values).with_optimal_states()
        squares[drop] = float(alone.residual_sums[0] @ alone.weights)
    within, scales = _transposed(kept) @ informations @ kept, np.sqrt(variances)
    growth = np.maximum(np.linalg.eigvalsh(scales[:, :, None] * within * scales[:, None]), 0.0)
    growth += growth / (1 + growth)
    covariances = within + within @ (variances[:, :, None] * within)
    distances, directions = _distances(_times(_transposed(kept), gradients - turned), covariances)
    columns = fitted, np.maximum(squares, fitted), growth.sum(axis=1), np.sqrt(2 * np.sum(growth**2, axis=1)), distances
    return tuple(
        Prediction(own, predicted, (mean, deviation), (distance, count))
        for own, predicted, mean, deviation, distance, count in zip(
            *(column.tolist() for column in (*columns, directions)), strict=True
        )
    )


def _distances(scores: Real, covariances: Real) -> tuple[Real, NDArray[np.int64]]:
    """Weigh the gradient of each drop at the optimum of the others by its own covariance there; and count the directions."""
    eigenvalues, vectors = np.linalg.eigh((covariances + _transposed(covariances)) / 2)
    kept = eigenvalues > np.maximum(1.0, 1e-9 * eigenvalues.max(axis=1, initial=0.0, keepdims=True))
    parts = _times(_transposed(vectors), scores) ** 2 / np.where(kept, eigenvalues, np.inf)
    return parts.sum(axis=1), kept.sum(axis=1)


def _transposed(matrices: Real) -> Real:
    return np.swapaxes(matrices, -1, -2)


def _times(matrices: Real, vectors: Real) -> Real:
    """Multiply each matrix by a vector of its own, shapes (drop, row, column) and (drop, column)."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])
