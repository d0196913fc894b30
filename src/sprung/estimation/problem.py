"""The way up the likelihood: Gauss-Newton on what exact knowledge leaves free, damped after Levenberg and Marquardt.

The noise level of each channel is estimated along with the parameters: after every step the weights are taken from the
residuals, so that what is maximised is the likelihood itself, not a sum of squares with weights that somebody chose.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import Evaluation, Likelihood, LikelihoodAt
from sprung.estimation.priors import PriorsAndConstraints
from sprung.estimation.start_ranking import rank_starts
from sprung.estimation.time_stepping import SteppedLikelihood, SteppedLikelihoodAt

Real = NDArray[np.float64]

NOISE_FLOOR = 1e-6
"""Smallest noise level, as a part of a channel's root-mean-square: below it, rounding in the sums of squares would show."""

RANK = 1e-12
"""Information, as a part of the largest, that is nothing but rounding."""

NO_INFORMATION = 1.0
"""Fisher information of a logarithm below which its value cannot be told from e times it."""

CONVERGED = 1e-8
"""Expected gain in log-likelihood at which a climb has ended: the parameters are within 1e-4 of a standard error."""

FAR, NEARER, CLOSE_BY = 1e-3, 1e-6, 1e-9
"""Damping of the first step, as a part of each parameter's own information."""

_SETTLED = 1e-3  # relative change of the noise levels
_SAME = 100.0  # distance in standard errors, squared, within which a climb will end where another one has
_LEADS_THERE = 0.05  # part of the distance, squared, that a step may miss another climb's end by and still lead there
_EXACT_ENOUGH = 0.005  # relative error that a quantity called exact may have before anybody is told
_ITERATIONS, _PROVISIONAL = 100, 40  # steps at the most, where the end counts and where it is only a stage
_LONGEST_STEP = 1.0  # in logarithms: no parameter changes by more than a factor of e at once
_LEAST_DAMPING, _MOST_DAMPING = 1e-12, 1e8


def identifiable_subspace(information: Real) -> Real:
    """Give the directions of which the records and what is known say anything.

    Parameters
    ----------
    information
        Fisher information in logarithms of the parameters, shape (direction, direction).

    Returns
    -------
    ndarray
        Orthonormal columns, shape (direction, told).
    """
    eigenvalues, vectors = np.linalg.eigh(information)
    return vectors[:, eigenvalues >= least_information(eigenvalues)]


def least_information(eigenvalues: Real) -> float:
    """Give the information below which a direction is not determined.

    That is one, where a value cannot be told from e times it, or rounding beside the largest information there is.
    """
    return max(NO_INFORMATION, RANK * float(eigenvalues.max(initial=0.0)))


@dataclass(frozen=True, eq=False)
class Iterate:
    """Where a climb stands.

    Attributes
    ----------
    u
        Coordinates of the parameters, shape (parameter,).
    place
        The likelihood there.
    weights
        1/σ² of each channel with which `evaluation` was made, shape (channel,).
    evaluation
        Fit and derivatives.
    steps
        How many were taken.
    converged
        Whether the last step promised no further gain.
    """

    u: Real
    place: LikelihoodAt | SteppedLikelihoodAt
    weights: Real
    evaluation: Evaluation
    steps: int = 0
    converged: bool = False


@dataclass(frozen=True, eq=False)
class EstimationProblem:
    """A likelihood and what is known beside it.

    Attributes
    ----------
    likelihood
        The records.
    knowledge
        What is known beforehand, and the coordinates.
    """

    likelihood: Likelihood | SteppedLikelihood
    priors: PriorsAndConstraints

    @cached_property
    def _observations(self) -> Real:
        counts: Real = np.maximum(self.likelihood.observations.sum(axis=0), 1.0)
        return counts

    @cached_property
    def _constants(self) -> Real:
        """Offsets by channel: one for each drop."""
        offsets: Real = (self.likelihood.observations > 0).sum(axis=0)
        return offsets

    @cached_property
    def _energy(self) -> Real:
        energy: Real = np.maximum(self.likelihood.energy, np.finfo(float).tiny)
        return energy

    def variance(self, residual: Real, leverage: Real) -> Real:
        """Estimate each channel's noise variance, the eliminated unknowns taken off the number of samples.

        Parameters
        ----------
        residual, leverage
            As in an `Evaluation`, shapes (drop, channel) and (channel,).

        Returns
        -------
        ndarray
            (m/s²)², shape (channel,).
        """
        freedom = np.maximum(self._observations - self._constants - leverage, 1.0)
        variance = residual.sum(axis=0) / freedom + self.least_variance
        # A channel that no drop has weighs nothing, whatever its noise.
        return np.where(self._constants > 0, variance, 1.0)

    @property
    def least_variance(self) -> Real:
        """What every noise variance is above, so that rounding is not taken for information; (m/s²)², shape (channel,)."""
        least: Real = NOISE_FLOOR**2 * self._energy / self._observations
        return least

    def cost(self, point: Iterate) -> float:
        """Give minus twice the log-likelihood, up to a constant."""
        prior = self.priors.prior(point.u).residual
        variance = self.variance(point.evaluation.residual, point.evaluation.leverage)
        return float(self._observations @ np.log(variance) + prior @ prior) + point.evaluation.penalty

    def first_costs(self, likelihood: Likelihood, starts: Sequence[Real]) -> Real:
        """Rate starts: the same from a sketch of the records, its channels weighted by their energy; shape (start,)."""
        values = np.array([self.priors.coordinates.values(u) for u in starts])
        weights = self._observations / self._energy
        # In two halves, for the sake of memory.
        shares = np.concatenate([rank_starts(likelihood, half, weights) for half in np.array_split(values, 2)])
        costs: Real = np.log(shares + NOISE_FLOOR**2) @ self._observations
        return costs

    def system(self, point: Iterate, inflation: float = 1.0) -> tuple[Real, Real, Real]:
        """Give information and gradient in the free directions, and those directions.

        Parameters
        ----------
        point
            Where.
        inflation
            By how much the records tell less than they would with white residuals.

        Returns
        -------
        information, gradient, free
            Shapes (direction, direction), (direction,) and (parameter, direction).
        """
        slopes = self.priors.coordinates.slopes(point.u)
        prior = self.priors.prior(point.u)
        free = self.priors.free(point.u)
        data = point.evaluation.information * np.outer(slopes, slopes) / inflation
        gradient = point.evaluation.gradient * slopes / inflation + prior.slopes.T @ prior.residual
        return free.T @ (data + prior.slopes.T @ prior.slopes) @ free, free.T @ gradient, free

    def by_drop(self, point: Iterate) -> tuple[Real, Real]:
        """Give each drop's own gradient and information in the free directions."""
        free = self.priors.free(point.u) * self.priors.coordinates.slopes(point.u)[:, None]
        gradients, informations = point.place.by_drop(point.weights)
        return gradients @ free, free.T @ informations @ free

    def contradictions(self, point: Iterate, inflation: float) -> dict[str, float]:
        """Hold each known quantity against everything else.

        Parameters
        ----------
        point
            The summit.
        inflation
            By how much the records tell less than they would with white residuals.

        Returns
        -------
        dict
            By name: the root of what the likelihood would gain without that statement, to second order; for an uncertain
            one this is its distance from what the rest says, in standard uncertainties of the difference.
        """
        found = {}
        every = self.priors.prior(point.u).residual
        for name, known in self.priors.statements.items():
            without = self.priors.without(name)
            move, gain = replace(self, priors=without).slope(point, inflation).newton
            # What the summit still misses of an uncertain statement would be gained as well.
            missed = without.prior(point.u).residual
            gain += float(every @ every - missed @ missed)
            away = self.priors.change(name, point.u, move) / known.value
            if not known.is_exact or abs(away) > _EXACT_ENOUGH:
                found[name] = max(gain, 0.0) ** 0.5
        return found

    def maximise(
        self,
        u: Real,
        optimum: Iterate | None = None,
        enough: float = CONVERGED,
        damping: float = FAR,
        most: int = _ITERATIONS,
    ) -> Iterate:
        """Climb from a start.

        Parameters
        ----------
        u
            Coordinates to start from, exact knowledge fulfilled.
        summit
            Where another climb has ended: coming within ten standard errors of it, or where the next step leads there, this
            one ends there too.
        enough
            Expected gain in log-likelihood at which to stop.
        damping
            At the first step: `FAR` from a start that is only a guess, `NEARER` from a direct one, `CLOSE_BY` from one that
            is nearly there.
        most
            Steps at the most.

        Returns
        -------
        Point
        """
        point = self.at(u)
        before, settled = np.inf, False
        while point.steps < min(most, _ITERATIONS if enough <= CONVERGED else _PROVISIONAL):
            slope = self.slope(point)
            if not slope.gradient.size:
                return replace(point, converged=True)
            if optimum is not None and slope.leads(slope.free.T @ (optimum.u - point.u)):
                return optimum
            if settled and slope.newton[1] < enough:
                return replace(point, converged=True)
            moved, damping, gain = self._step(point, slope, damping)
            if moved is None:
                return replace(point, converged=gain < 1e-3)
            settled = bool(np.abs(np.log(moved.weights / point.weights)).max() < _SETTLED)
            point = moved
            # What the steps to come will gain, if they go on shrinking as the last two did.
            ratio = min(gain / before, 0.9) if before < np.inf else 0.9
            before = gain
            if gain * min(ratio / (1 - ratio), 1.0) < enough and (settled or enough > CONVERGED):
                return replace(point, converged=True)
        return point

    def at(self, u: Real) -> Iterate:
        """Stand somewhere, with the noise that the residuals show there."""
        weights, place = self._observations / self._energy, self._at(u)
        variance = self.variance(place.misfit(weights)[0], np.zeros_like(weights))
        return _evaluated(u, place, 1 / variance, 0)

    def _at(self, u: Real) -> LikelihoodAt | SteppedLikelihoodAt:
        return self.likelihood.at(self.priors.coordinates.values(u))

    def slope(self, point: Iterate, inflation: float = 1.0) -> NormalEquations:
        """Give where it goes up from a point, as `system` does."""
        return NormalEquations(*self.system(point, inflation))

    def _step(self, point: Iterate, slope: NormalEquations, damping: float) -> tuple[Iterate | None, float, float]:
        """Take one damped step that does not lose; give None where there is none left to take.

        In a bent valley the straight way leads up its wall, and only the next step down again, further along: where the first
        step loses, one more is tried from there (the watchdog of Chamberlain and others, Math. Prog. Study 16 (1982) 1).
        """
        now = self._weighted(point.u, point.evaluation.residual, point.weights) + point.evaluation.penalty
        first = True
        gain = 0.0
        while damping < _MOST_DAMPING:
            move, gain = slope.step(damping)
            moved, won = self._tried(point, self.priors.bind(point.u + move), now)
            if won >= -1e-10 * abs(now):
                damping = (
                    max(damping / (100 if won > 0.75 * gain else 10), _LEAST_DAMPING)
                    if won > 0.25 * gain
                    else 8 * damping
                )
                return moved(), damping, gain
            if first and np.isfinite(won):
                above = moved()
                back, _ = self.slope(above).step(damping)
                moved, won = self._tried(point, self.priors.bind(above.u + back), now)
                if won > 0:
                    return moved(), damping, max(gain, won)
                first = False
            damping = max(damping, 1e-8) * 8
        return None, damping, gain

    def _tried(self, point: Iterate, u: Real, now: float) -> tuple[Callable[[], Iterate], float]:
        """Give what going to other coordinates wins, and the way to stand there."""
        place = point.place.moved(self.priors.coordinates.values(u), point.weights)
        residual, penalty = place.misfit(point.weights)

        def moved() -> Iterate:
            return _evaluated(u, place, 1 / self.variance(residual, point.evaluation.leverage), point.steps + 1)

        return moved, now - self._weighted(u, residual, point.weights) - penalty

    def _weighted(self, u: Real, residual: Real, weights: Real) -> float:
        squares, prior = residual.sum(axis=0), self.priors.prior(u).residual
        # A vehicle that runs away within the record is infinitely far from it.
        return float(squares @ weights + prior @ prior) if np.isfinite(squares).all() else np.inf


def _evaluated(u: Real, place: LikelihoodAt | SteppedLikelihoodAt, weights: Real, steps: int) -> Iterate:
    return Iterate(u, place, weights, place.evaluate(weights), steps)


@dataclass(frozen=True, eq=False)
class NormalEquations:
    """Where it goes up from a point: information and gradient in the free directions, and these."""

    information: Real
    gradient: Real
    free: Real

    @cached_property
    def _told(self) -> tuple[Real, Real, Real]:
        """Give the directions of which the records say anything, and information and gradient in them.

        The others are left alone: they would only wander.
        """
        told = identifiable_subspace(self.information)
        return told, told.T @ self.information @ told, told.T @ self.gradient

    @cached_property
    def newton(self) -> tuple[Real, float]:
        """The step to where the summit would be if the likelihood were quadratic, in the coordinates, and its gain.

        The gain is that of twice the log-likelihood.
        """
        told, system, slope = self._told
        step = np.linalg.solve(system, slope)
        return self.free @ (told @ step), float(slope @ step)

    def step(self, damping: float) -> tuple[Real, float]:
        """Give a damped step in the coordinates, and what it should gain."""
        told, system, slope = self._told
        scale = told.T @ (np.diag(self.information)[:, None] * told)
        step = np.linalg.solve(system + damping * scale, slope)
        move = self.free @ (told @ step)
        return move * min(1.0, _LONGEST_STEP / np.abs(move).max(initial=1e-300)), float(slope @ step)

    def leads(self, distance: Real) -> bool:
        """Say whether the next step leads to a place that far away, or is there already."""
        squared = float(distance @ self.information @ distance)
        if squared < _SAME:
            return True
        told, system, slope = self._told
        missed = told.T @ distance - np.linalg.solve(system, slope)
        return float(missed @ system @ missed) < _LEADS_THERE * squared
