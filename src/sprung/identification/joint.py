"""The joint fit: maximise the likelihood of all drops and loads at once, from starts of its own, and say how sure it is.

The step is Gauss-Newton on the parameters that exact knowledge leaves free, damped after Levenberg and Marquardt; the
noise level of each channel is estimated along with them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimate import Known
from sprung.identification.colour import inflation
from sprung.identification.knowledge import Coordinates, Knowledge
from sprung.identification.likelihood import Evaluation, Likelihood
from sprung.identification.start import catalogue
from sprung.prepare import Decay
from sprung.vehicle import PARAMETERS, LinearModel, Rows, Sensor

Real = NDArray[np.float64]

NOISE_FLOOR = 1e-6
"""Smallest noise level, as a part of a channel's root-mean-square: below it, rounding in the sums of squares would show."""

_CONVERGED = 1e-8  # expected gain in log-likelihood: the parameters are within 1e-4 of a standard error
_ITERATIONS = 100
_LONGEST_STEP = 1.0  # in logarithms: no parameter changes by more than a factor of e at once
_STARTS = 3
_NO_INFORMATION = 1.0
"""Fisher information below which a direction is not determined: its value cannot be told from e times it."""
_RANK = 1e-12
"""Information, as a part of the largest, that is nothing but rounding."""


@dataclass(frozen=True, eq=False)
class Fit:
    """The joint fit of all decays.

    Attributes
    ----------
    names
        The parameters.
    values
        SI, shape (parameter,).
    slopes
        Derivative of each value by the coordinate it is fitted in: the value itself for those that must be positive,
        which are fitted by their logarithms; shape (parameter,).
    relative_covariance
        Covariance of the fit's coordinates.
    covariance
        Of the values, SI, shape (parameter, parameter); directions without information are left out of it.
    undetermined
        Directions of the coordinates that neither data nor knowledge determine, shape (parameter, direction).
    noise
        Noise level of each channel, m/s², shape (channel,).
    residual
        Residual sums of squares, (m/s²)², shape (drop, channel).
    inflation
        By how much the colour of the residuals has enlarged the variance of the estimates; 1 for white ones.
    fitted
        What the model makes of every record, its mean taken off; each of shape (channel, time).
    prior_residual
        For each uncertain known quantity (known - estimated) / std.
    loglikelihood
        Up to a constant.
    iterations
        Steps taken from the winning start.
    converged
        Whether the last step promised no further gain.
    starts_agreeing, starts
        How many of the refined starts ended in the same place, and how many there were.
    """

    names: tuple[str, ...]
    values: Real
    slopes: Real
    relative_covariance: Real
    covariance: Real
    undetermined: Real
    noise: Real
    residual: Real
    inflation: float
    fitted: tuple[Real, ...]
    prior_residual: Mapping[str, float]
    loglikelihood: float
    iterations: int
    converged: bool
    starts_agreeing: int
    starts: int


@dataclass(frozen=True, eq=False)
class _Point:
    """Where the climb stands."""

    u: Real
    weights: Real
    evaluation: Evaluation
    iterations: int
    converged: bool

    @property
    def residual(self) -> Real:
        return self.evaluation.residual


def fit_jointly(
    decays: Sequence[Decay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, Known],
    *,
    start: Mapping[str, float] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Fit:
    """Fit one vehicle to all decays.

    Parameters
    ----------
    decays
        The decays, their channels in the order of `sensors`.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors.
    known
        Quantities measured beforehand: parameters, or derived ones as ``total_mass`` and ``wheelbase``.
    start
        Parameter values, SI, to start from; the catalogue of usual vehicles is tried where it is left out.
    progress
        Told what is being done.

    Returns
    -------
    Fit
    """
    names = next(iter(models.values())).names
    likelihood = Likelihood.of(decays, models, Rows.of([sensor.row for sensor in sensors], names))
    candidates = list(catalogue(known, sensors)) if start is None else [dict(start)]
    references = np.array([_reference(name, candidates[0]) for name in names])
    coordinates = Coordinates(names, references)
    knowledge = Knowledge(coordinates, known)
    climb = _Climb(likelihood, knowledge)

    tried = [knowledge.bind(coordinates.of(np.array([values[name] for name in names]))) for values in candidates]
    if start is None:
        progress(f"trying {len(tried)} usual vehicles")
        tried = sorted(tried, key=climb.first_cost)[:_STARTS]
    ends = []
    for number, u in enumerate(tried, start=1):
        progress(f"fitting from start {number} of {len(tried)}")
        ends.append(climb.to_the_top(u))
    best = min(ends, key=climb.cost)
    agreeing = sum(climb.cost(end) - climb.cost(best) < 1e-3 for end in ends)
    return _conclude(climb, best, decays, agreeing, len(ends))


def _reference(name: str, typical: Mapping[str, float]) -> float:
    if PARAMETERS[name].positive:
        return 1.0
    return typical["c_sf"] if name.startswith("c") else typical["k_sf"]


@dataclass(frozen=True, eq=False)
class _Climb:
    """The likelihood and what is known, and the way up."""

    likelihood: Likelihood
    knowledge: Knowledge

    @property
    def observations(self) -> Real:
        counts: Real = np.maximum(self.likelihood.observations.sum(axis=0), 1.0)
        return counts

    @property
    def energy(self) -> Real:
        total = np.zeros(self.likelihood.channels)
        for group in self.likelihood.groups:
            total += group.energy.sum(axis=0)
        energy: Real = np.maximum(total, np.finfo(float).tiny)
        return energy

    def variance(self, residual: Real, leverage: Real | float = 0.0) -> Real:
        """Estimate each channel's noise variance, (m/s²)², the eliminated unknowns taken off the number of samples."""
        used = (self.likelihood.observations > 0).sum(axis=0) + np.sum(leverage, axis=0)
        floor = NOISE_FLOOR**2 * self.energy / self.observations
        variance: Real = residual.sum(axis=0) / np.maximum(self.observations - used, 1.0) + floor
        return variance

    def first_cost(self, u: Real) -> float:
        """Rate a start: minus twice the log-likelihood, the channels weighted by their energy."""
        weights = self.observations / self.energy
        residual = self.likelihood.misfit(self.knowledge.coordinates.values(u), weights)
        return float(self.observations @ np.log(self.variance(residual)))

    def cost(self, point: _Point) -> float:
        """Give minus twice the log-likelihood, up to a constant."""
        prior = self.knowledge.prior(point.u).residual
        return float(
            self.observations @ np.log(self.variance(point.residual, point.evaluation.leverage)) + prior @ prior
        )

    def evaluate(self, u: Real, weights: Real) -> Evaluation:
        return self.likelihood.evaluate(self.knowledge.coordinates.values(u), weights)

    def system(self, point: _Point) -> tuple[Real, Real, Real]:
        """Give information and gradient in the free directions, and those directions."""
        slopes = self.knowledge.coordinates.slopes(point.u)
        prior = self.knowledge.prior(point.u)
        free = self.knowledge.free(point.u)
        information = point.evaluation.information * np.outer(slopes, slopes) + prior.slopes.T @ prior.slopes
        gradient = point.evaluation.gradient.sum(axis=0) * slopes + prior.slopes.T @ prior.residual
        return free.T @ information @ free, free.T @ gradient, free

    def to_the_top(self, u: Real) -> _Point:
        """Climb from a start."""
        weights = self.observations / self.energy
        point = self._reweigh(_Point(u, weights, self.evaluate(u, weights), 0, False))
        damping = 1e-3
        for iteration in range(1, _ITERATIONS + 1):
            information, gradient, free = self.system(point)
            if not gradient.size:
                return _Point(point.u, point.weights, point.evaluation, iteration, True)
            next_point, damping, gain = self._step(point, information, gradient, free, damping)
            if next_point is None:
                return _Point(point.u, point.weights, point.evaluation, iteration, gain < 1e-3)
            settled = np.abs(np.log(self._weights(next_point.evaluation) / next_point.weights)).max() < 1e-3
            point = self._reweigh(next_point)
            if gain < _CONVERGED and settled:
                return _Point(point.u, point.weights, point.evaluation, iteration, True)
        return _Point(point.u, point.weights, point.evaluation, _ITERATIONS, False)

    def _step(
        self, point: _Point, information: Real, gradient: Real, free: Real, damping: float
    ) -> tuple[_Point | None, float, float]:
        """Take one damped step that does not lose; give None where there is none left to take."""
        now = self._weighted(point.u, point.evaluation, point.weights)
        diagonal = np.diag(information)
        diagonal = np.maximum(diagonal, _RANK * diagonal.max())
        gain = np.inf
        while damping < 1e8:
            step = np.linalg.solve(information + np.diag(damping * diagonal), gradient)
            gain = float(gradient @ step)
            move = free @ step
            move *= min(1.0, _LONGEST_STEP / np.abs(move).max(initial=1e-300))
            u = self.knowledge.bind(point.u + move)
            evaluation = self.evaluate(u, point.weights)
            if self._weighted(u, evaluation, point.weights) <= now + 1e-10 * abs(now):
                trial = _Point(u, point.weights, evaluation, point.iterations + 1, False)
                return trial, max(damping / 10, 1e-12), gain
            damping = max(damping, 1e-8) * 8
        return None, damping, gain

    def _weighted(self, u: Real, evaluation: Evaluation, weights: Real) -> float:
        prior = self.knowledge.prior(u).residual
        return float(evaluation.residual.sum(axis=0) @ weights + prior @ prior)

    def _weights(self, evaluation: Evaluation) -> Real:
        weights: Real = 1.0 / self.variance(evaluation.residual, evaluation.leverage)
        return weights

    def _reweigh(self, point: _Point) -> _Point:
        """Take the noise levels from the residuals, and evaluate again where that changes them enough to matter."""
        weights = self._weights(point.evaluation)
        if np.abs(np.log(weights / point.weights)).max() < 1e-4:
            return point
        return _Point(point.u, weights, self.evaluate(point.u, weights), point.iterations, point.converged)


def _conclude(climb: _Climb, best: _Point, decays: Sequence[Decay], agreeing: int, starts: int) -> Fit:
    knowledge, values = climb.knowledge, climb.knowledge.coordinates.values(best.u)
    fitted = climb.likelihood.fitted(values, best.weights)
    residuals = [d.values - d.values.mean(axis=1, keepdims=True) - f for d, f in zip(decays, fitted, strict=True)]
    inflated = float(inflation(residuals, [decay.rate for decay in decays]).max())

    information, _, free = climb.system(best)
    eigenvalues, vectors = np.linalg.eigh(information)
    directions = free @ vectors
    rounding = _RANK * eigenvalues.max(initial=0.0)
    resolved = eigenvalues > rounding
    variances = np.where(resolved, inflated / np.where(resolved, eigenvalues, 1.0), 0.0)
    relative = directions @ (variances[:, None] * directions.T)
    slopes = knowledge.coordinates.slopes(best.u)
    uncertain = [name for name, known in knowledge.statements.items() if not known.exact]
    return Fit(
        names=knowledge.coordinates.names,
        values=values,
        slopes=slopes,
        relative_covariance=relative,
        covariance=relative * np.outer(slopes, slopes),
        undetermined=directions[:, eigenvalues < max(rounding, _NO_INFORMATION)],
        noise=np.sqrt(climb.variance(best.residual, best.evaluation.leverage)),
        residual=best.residual,
        inflation=inflated,
        fitted=tuple(fitted),
        prior_residual=dict(zip(uncertain, knowledge.prior(best.u).residual.tolist(), strict=True)),
        loglikelihood=-0.5 * climb.cost(best),
        iterations=best.iterations,
        converged=best.converged,
        starts_agreeing=agreeing,
        starts=starts,
    )
