"""Each drop left out of the fit in turn, and predicted by what all others say of the vehicle.

Nothing is fitted again: the optimum of the others follows from gradient and information of each drop at the joint one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.estimation.problem import identifiable_equations

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
    found = []
    for drop, (own, own_information) in enumerate(zip(gradients, informations, strict=True)):
        others = identifiable_equations(information - own_information, gradient - own, null_space)
        move, _ = others.step()
        move *= min(1.0, _LONGEST_STEP / np.abs(move).max(initial=1e-300))
        along = null_space.T @ move
        squares = float(fitted[drop] - 2 * own @ along + along @ own_information @ along)
        if squares > (1 + _SLIGHT) * fitted[drop]:
            values = problem.priors.coordinates.values(problem.priors.project(optimum.u + move))
            alone = optimum.at.moved(values).of_drop(drop).with_optimal_states()
            squares = float(alone.residual_sums[0] @ alone.weights)
        subspace = null_space.T @ others.directions
        within = subspace.T @ own_information @ subspace
        spread = np.linalg.solve(others.information, within)
        eigenvalues = np.maximum(np.linalg.eigvals(spread).real, 0.0)
        growth = eigenvalues + eigenvalues / (1 + eigenvalues)
        by_chance = float(growth.sum()), float(np.sqrt(2 * np.sum(growth**2)))
        distance = _distance(subspace.T @ (own - own_information @ along), within, spread)
        found.append(Prediction(float(fitted[drop]), max(squares, float(fitted[drop])), by_chance, distance))
    return tuple(found)


def _distance(score: Real, own: Real, spread: Real) -> tuple[float, int]:
    """Weigh the gradient of a drop at the optimum of the others by its own covariance there."""
    covariance = own + own @ spread
    eigenvalues, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    kept = eigenvalues > max(1.0, 1e-9 * float(eigenvalues.max(initial=0.0)))
    return float(np.sum((vectors.T @ score)[kept] ** 2 / eigenvalues[kept])), int(kept.sum())
