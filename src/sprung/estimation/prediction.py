"""Each drop left out of the fit in turn, and predicted by what all others say of the vehicle.

Nothing is fitted again: where the others would have the summit follows from what each drop says at the joint one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import LikelihoodAt
from sprung.estimation.fit import FitResult
from sprung.estimation.problem import NormalEquations, identifiable_subspace
from sprung.estimation.time_stepping import SteppedLikelihood, SteppedLikelihoodAt
from sprung.preprocess import FreeDecay

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


def predictions(optimum: FitResult) -> tuple[Prediction, ...]:
    """Predict each drop from all others.

    Parameters
    ----------
    summit
        Where the fit of all of them ended.

    Returns
    -------
    tuple of Prediction
        In their order.

    Notes
    -----
    With gradient g_d and information J_d of one drop, and those of everything, g and J, the others have their summit a
    step (J - J_d)⁻¹ (g - g_d) away, to second order. What both say differs with the covariance (J - J_d)⁻¹ + J_d⁻¹, and the
    drop's sum of squares is a sum of squares λ larger than with its own summit and λ + λ / (1 + λ) larger than with the joint
    one on average, λ being the eigenvalues of J_d (J - J_d)⁻¹.
    """
    problem, point = optimum.problem, optimum.point
    information, gradient, free = problem.system(point)
    gradients, informations = problem.by_drop(point)
    fitted = point.evaluation.residual @ point.weights
    found = []
    for position, (decay, own, of_own) in enumerate(zip(optimum.decays, gradients, informations, strict=True)):
        slope = NormalEquations(information - of_own, gradient - own, free)
        move = slope.newton[0]
        move *= min(1.0, _LONGEST_STEP / np.abs(move).max(initial=1e-300))
        along = free.T @ move
        squares = float(fitted[position] - 2 * own @ along + along @ of_own @ along)
        if squares > (1 + _SLIGHT) * fitted[position]:
            values = problem.priors.coordinates.values(problem.priors.bind(point.u + move))
            alone = _alone(point.place, position, decay, values, point.weights)
            squares = float(alone.misfit(point.weights)[0][0] @ point.weights)
        told = identifiable_subspace(slope.information)
        seen = told.T @ of_own @ told
        spread = np.linalg.solve(told.T @ slope.information @ told, seen)
        each = np.maximum(np.linalg.eigvals(spread).real, 0.0)
        growth = each + each / (1 + each)
        by_chance = float(growth.sum()), float(np.sqrt(2 * np.sum(growth**2)))
        distance = _distance(told.T @ (own - of_own @ along), seen, spread)
        found.append(Prediction(float(fitted[position]), max(squares, float(fitted[position])), by_chance, distance))
    return tuple(found)


def _distance(score: Real, own: Real, spread: Real) -> tuple[float, int]:
    """Weigh the gradient that is left in a drop where the others would have the summit by its own covariance there."""
    covariance = own + own @ spread
    eigenvalues, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    seen = eigenvalues > max(1.0, 1e-9 * float(eigenvalues.max(initial=0.0)))
    return float(np.sum((vectors.T @ score)[seen] ** 2 / eigenvalues[seen])), int(seen.sum())


def _alone(
    joint: LikelihoodAt | SteppedLikelihoodAt, position: int, decay: FreeDecay, values: Real, weights: Real
) -> LikelihoodAt | SteppedLikelihoodAt:
    """Go to parameter values with one drop alone, and the initial state that explains it best there."""
    if isinstance(joint, LikelihoodAt):
        likelihood = joint.likelihood
        return likelihood.with_decays([decay]).at(values)
    moved = joint.moved(values, weights)
    place = SteppedLikelihoodAt(_of_one(moved.likelihood, position), values, moved.begin[[position]])
    settled = place.moved(values, weights)
    return settled if _better(settled, place, weights) else place


def _better(one: SteppedLikelihoodAt, other: SteppedLikelihoodAt, weights: Real) -> bool:
    (now, pull), (before, pulled) = one.misfit(weights), other.misfit(weights)
    return float(now[0] @ weights) + pull < float(before[0] @ weights) + pulled


def _of_one(likelihood: SteppedLikelihood, position: int) -> SteppedLikelihood:
    """Give the likelihood of one drop alone."""
    chosen, samples = slice(position, position + 1), int(likelihood.samples[position])
    kind = int(likelihood.kind[position])
    return replace(
        likelihood,
        models=likelihood.models[kind : kind + 1],
        times=likelihood.times[kind : kind + 1],
        kind=np.zeros(1, dtype=np.int64),
        samples=likelihood.samples[chosen],
        values=likelihood.values[chosen, :, :samples],
        present=likelihood.present[chosen],
        begin=likelihood.begin[chosen],
    )
