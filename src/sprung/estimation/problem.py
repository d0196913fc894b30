"""The estimation problem: an objective, and what is known beforehand; how it is maximised.

The noise level of each channel is estimated along with the parameters: after every step the weights are taken from the
residuals, so that what is maximised is the likelihood itself, not a sum of squares with weights that somebody chose.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.identifiability import identifiable_equations
from sprung.estimation.objective import NoiseCoupling, Objective, ObjectiveAt
from sprung.estimation.priors import PriorsAndConstraints
from sprung.optimisation import Maximum, NormalEquations, maximise
from sprung.vehicle import PARAMETERS, is_of_sensor

Real = NDArray[np.float64]

NOISE_FLOOR = 1e-6
"""Smallest noise level, as a part of a channel's root-mean-square: below it, rounding in the sums of squares would show."""

CONVERGED = 1e-8
"""Expected gain in log-likelihood at which a fit has converged: the parameters are within 1e-4 of a standard error."""

FAR, NEARER, CLOSE_BY = 1e-3, 1e-6, 1e-9
"""Damping of the first step, as a part of each parameter's own information."""

_SAME = 100.0  # distance in standard errors, squared, within which a fit will end where another one has
_REACHED = 0.05  # part of the distance, squared, that a step may miss another fit's end by and still lead there
_EXACT_ENOUGH = 0.005  # relative error that a quantity called exact may have before it is reported
MOST_STEPS, _PROVISIONAL_STEPS = 100, 40  # at the most, where the end counts and where it is only a stage
_LONGEST_STEP = 1.0  # in logarithms: no parameter changes by more than a factor of e at once
_RUNAWAY = 2 * np.log(1e6)
"""Loss of twice the log-likelihood by each sample from which a motion has run away: noise that would be a million times larger.
No derivative is to be had there, and no step leads back."""

_ROUNDING = 1e-10  # of the cost
_DIGITS = 4  # of the gain by which a statement is tested: it is a difference of larger ones
_LARGEST_FALL = 0.25  # factor by which a step may lower a noise variance at the most, where unknowns couple them
_NOISE_ROUNDS = 2  # after the first, in which noise levels settle that unknowns couple
_MOST_ROUNDS, _SETTLED = 8, 3e-3  # in which they settle in the end, and relative change from which they have


@dataclass(frozen=True, eq=False)
class Iterate:
    """A point on the way to a maximum.

    Attributes
    ----------
    u
        Coordinates of the parameters, shape (parameter,).
    at
        The objective there, with the noise levels that its residuals show.
    """

    u: Real
    at: ObjectiveAt


@dataclass(frozen=True, eq=False)
class EstimationProblem:
    """An objective, and what is known of the parameters beforehand.

    Attributes
    ----------
    objective
        The likelihood of the records.
    priors
        What is known beforehand, and the coordinates.
    overdispersion
        Of the records, by which they count less than they would by their samples; 1 as long as nothing is known of it.
    """

    objective: Objective
    priors: PriorsAndConstraints
    overdispersion: float = 1.0

    @cached_property
    def _observations(self) -> Real:
        counts: Real = np.maximum(self.objective.observations.sum(axis=0), 1.0)
        return counts

    @cached_property
    def _offsets(self) -> Real:
        """Number of offsets of each channel: one for each drop."""
        offsets: Real = (self.objective.observations > 0).sum(axis=0)
        return offsets

    @cached_property
    def signal_weights(self) -> Real:
        """Inverse mean square of each channel's records: weights where nothing is known of the noise, shape (channel,)."""
        weights: Real = self._observations / np.maximum(self.objective.energy, np.finfo(float).tiny)
        return weights

    @property
    def least_variance(self) -> Real:
        """Least noise variance, so that rounding is not taken for information; (m/s²)², shape (channel,)."""
        return NOISE_FLOOR**2 / self.signal_weights

    def noise_variance(self, residual_sums: Real, near: ObjectiveAt | None = None) -> Real:
        """Estimate each channel's noise variance, the eliminated unknowns subtracted from the number of samples.

        Parameters
        ----------
        residual_sums
            As of an `ObjectiveAt`, shape (drop, channel).
        near
            Where the eliminated unknowns are counted, of the same weights; None to neglect them.

        Returns
        -------
        ndarray
            (m/s²)², shape (channel,).
        """
        sums = residual_sums.sum(axis=0)
        if near is not None and near.coupling is not None:
            return self._restricted_variance(sums, near.weights, near.coupling)
        freedom = self._freedom(0.0 if near is None else near.leverage)
        # A channel that no drop has weighs nothing, whatever its noise.
        return np.where(self._offsets > 0, sums / freedom + self.least_variance, 1.0)

    def _freedom(self, leverage: Real | float) -> Real:
        """Return the samples of each channel beyond offsets and other unknowns that it determines, shape (channel,)."""
        freedom: Real = np.maximum(self._observations - self._offsets - leverage, 1.0)
        return freedom

    def _restricted_variance(self, sums: Real, weights: Real, coupling: NoiseCoupling) -> Real:
        """Estimate noise variances by restricted maximum likelihood, one step of Fisher's scoring; shape (channel,).

        Where many unknowns are eliminated, residuals of a channel are made of the noise of several: what remains of them all is
        set equal to what is expected.
        """
        used = self._offsets > 0
        variance = np.ones(len(sums))
        matrix, scaled = coupling.expected[np.ix_(used, used)], (sums * weights)[used]
        # In units of the variances that the weights were taken from. None shrinks beyond all bounds at once.
        found = np.linalg.lstsq(matrix, scaled, rcond=None)[0]
        variance[used] = np.maximum(found, _LARGEST_FALL)
        return np.where(used, np.maximum(variance / weights, self.least_variance + coupling.least), 1.0)

    def cost(self, iterate: Iterate) -> float:
        """Return minus twice the log-likelihood, up to a constant.

        Parameters
        ----------
        iterate
            Where.
        """
        at = iterate.at
        sums = at.residual_sums
        if not np.isfinite(sums).all():
            return np.inf
        residual, _ = self.priors.residuals(iterate.u)
        if at.coupling is None:
            of_records = float(self._observations @ np.log(self.noise_variance(sums, at))) + at.penalty
        else:
            of_records = self._restricted_cost(at, at.coupling) + at.penalty
        return of_records / self.overdispersion + float(residual @ residual)

    def _restricted_cost(self, at: ObjectiveAt, coupling: NoiseCoupling) -> float:
        """Return minus twice the :term:`restricted likelihood <restricted maximum likelihood>` of the records.

        At the noise levels that maximise it the residuals are what is expected, and a small error of these does not matter.
        """
        used = self._offsets > 0
        residual = float((at.weights * at.residual_sums.sum(axis=0))[used].sum())
        expected = float((self._observations - at.leverage)[used].sum())
        logarithms = -float(self._observations[used] @ np.log(at.weights[used]))
        return logarithms + residual - expected + coupling.restriction

    def gain(self, before: Iterate, after: Iterate) -> float:
        """Return what twice the log-likelihood gains from one point to another one near by.

        How the eliminated unknowns are shared out among the channels is no observation, and stays as it is at the first point.
        Where unknowns couple the noise of channels, residuals are compared with the noise levels there, as the gradient does.

        Parameters
        ----------
        before, after
            The points.
        """
        sums = after.at.residual_sums.sum(axis=0)
        if not np.isfinite(sums).all():
            return -np.inf
        used, is_coupled = self._offsets > 0, before.at.coupling is not None
        rounding = self.least_variance * (self._observations if is_coupled else self._freedom(before.at.leverage))
        left, remains = before.at.residual_sums.sum(axis=0) + rounding, sums + rounding
        counted = before.at.weights * left if is_coupled else self._observations
        of_records = float(counted[used] @ np.log(left[used] / remains[used]))
        of_records += before.at.penalty - after.at.penalty
        (first, _), (second, _) = self.priors.residuals(before.u), self.priors.residuals(after.u)
        return of_records / self.overdispersion + float(first @ first - second @ second)

    def start(self, u: Real, weights: Real | None = None) -> Iterate:
        """Return the first iterate, with the noise that the residuals show there.

        Parameters
        ----------
        u
            Coordinates.
        weights
            1/σ² of each channel, SI, shape (channel,), where a fit near by has found them.
        """
        values = self.priors.coordinates.values(u)
        at = self.objective.at(values, self.signal_weights if weights is None else weights)
        if not np.isfinite(at.residual_sums).all():
            return Iterate(u, at)
        if weights is None:
            at = at.reweighted(1 / self.noise_variance(at.residual_sums))
        for _ in range(_NOISE_ROUNDS if weights is None and at.coupling is not None else 1):
            at = at.reweighted(1 / self.noise_variance(at.residual_sums, at))
        return Iterate(u, at)

    def system(self, iterate: Iterate, inflation: float = 1.0) -> tuple[Real, Real, Real]:
        """Return information and gradient in the null space of the constraints, and its basis.

        Parameters
        ----------
        iterate
            Where.
        inflation
            Overdispersion of the records, by which they count less.

        Returns
        -------
        information, gradient, null_space
            Shapes (direction, direction), (direction,) and (parameter, direction).
        """
        less = inflation * self.overdispersion
        return self.joint_system(iterate, iterate.at.information / less, iterate.at.gradient / less)

    def joint_system(self, iterate: Iterate, information: Real, gradient: Real) -> tuple[Real, Real, Real]:
        """Return the same with further unknowns behind the parameters.

        Parameters
        ----------
        iterate
            Where.
        information, gradient
            Of the records, by the parameters in SI and then by other unknowns, shapes (unknown, unknown) and (unknown,).

        Returns
        -------
        information, gradient, null_space
            Shapes (direction + other, direction + other), (direction + other,) and (parameter, direction).
        """
        residual, by_coordinate = self.priors.residuals(iterate.u)
        null_space = self.priors.null_space(iterate.u)
        parameters, directions = null_space.shape
        others = len(gradient) - parameters
        basis = np.zeros((parameters + others, directions + others))
        basis[:parameters, :directions] = self.priors.coordinates.derivatives(iterate.u)[:, None] * null_space
        basis[parameters:, directions:] = np.eye(others)
        prior = by_coordinate @ null_space
        whole, slope = basis.T @ information @ basis, basis.T @ gradient
        whole[:directions, :directions] += prior.T @ prior
        slope[:directions] += prior.T @ residual
        return whole, slope, null_space

    def by_drop(self, iterate: Iterate) -> tuple[Real, Real]:
        """Gradient and information of each drop in the null space of the constraints."""
        return self.in_null_space(iterate, *iterate.at.by_drop)

    def in_null_space(self, iterate: Iterate, gradients: Real, informations: Real) -> tuple[Real, Real]:
        """Return gradients and informations of parts of the records in the null space of the constraints."""
        null_space = self.priors.null_space(iterate.u)
        basis = null_space * self.priors.coordinates.derivatives(iterate.u)[:, None]
        return gradients @ basis, basis.T @ informations @ basis

    def normal_equations(self, iterate: Iterate, damping: float = 0.0) -> NormalEquations:
        """Return how twice the log-likelihood rises from an iterate, with so much damping of eliminated unknowns."""
        information, gradient, gain = iterate.at.damped(damping)
        less = self.overdispersion
        equations = identifiable_equations(*self.joint_system(iterate, information / less, gradient / less))
        return equations._replace(eliminated=gain / less)

    def trial(self, iterate: Iterate, step: Real, damping: float = 0.0) -> tuple[Iterate, float]:
        """Return the iterate a step of the coordinates away, and what twice the log-likelihood gains."""
        u = self.priors.project(iterate.u + step)
        at = iterate.at.moved(self.priors.coordinates.values(u), damping)
        gain = self.gain(iterate, Iterate(u, at))
        if not gain > -_RUNAWAY * float(self._observations.sum()):
            return iterate, -np.inf
        tried = Iterate(u, at.reweighted(1 / self.noise_variance(at.residual_sums, iterate.at)))
        return tried, 0.0 if 0 > gain >= -_ROUNDING * abs(self.cost(iterate)) else gain

    def maximise(
        self,
        u: Real,
        other: Maximum[Iterate] | None = None,
        tolerance: float = CONVERGED,
        damping: float = FAR,
        most: int = MOST_STEPS,
        cautious: bool = False,
        weights: Real | None = None,
    ) -> Maximum[Iterate]:
        """Maximise the likelihood from a start.

        Parameters
        ----------
        u
            Coordinates to start from, constraints fulfilled.
        other
            Where another fit has ended: coming within ten standard errors of it, or where the next step leads there, this
            one ends there too.
        tolerance
            Expected gain in log-likelihood at which to stop.
        damping
            At the first step: `FAR` from a start that is only a guess, `NEARER` from a direct one, `CLOSE_BY` from one that
            is nearly there.
        most
            Steps at the most.
        cautious
            Whether the start is far away and forces are not linear.
        weights
            1/σ² of each channel, SI, shape (channel,), where a fit near by has found them.

        Returns
        -------
        Maximum
        """

        def reaches_other(iterate: Iterate, equations: NormalEquations) -> bool:
            return other is not None and _leads_to(equations, other.point.u - iterate.u)

        start = self.start(u, weights)
        if not np.isfinite(start.at.residual_sums).all():
            return Maximum(start, 0, converged=False)
        steps = min(most, MOST_STEPS if tolerance <= CONVERGED else _PROVISIONAL_STEPS)
        found = maximise(
            self,
            start,
            tolerance=tolerance,
            damping=damping,
            most_steps=steps,
            longest_step=_LONGEST_STEP,
            stop=reaches_other,
            cautious=cautious,
        )
        reached = (
            other is not None and not found.converged and reaches_other(found.point, self.normal_equations(found.point))
        )
        if other is not None and reached:
            return other
        return found._replace(point=replace(found.point, at=self._with_settled_noise(found.point.at)))

    def _with_settled_noise(self, at: ObjectiveAt) -> ObjectiveAt:
        """Return the likelihood with the noise levels that maximise it, where unknowns couple them."""
        for _ in range(0 if at.coupling is None else _MOST_ROUNDS):
            weights = 1 / self.noise_variance(at.residual_sums, at)
            change = np.abs(np.log(weights / at.weights)).max()
            at = at.reweighted(weights)
            if change < _SETTLED:
                break
        return at

    def conflicts(self, iterate: Iterate, inflation: float) -> dict[str, float]:
        """Test each known quantity of vehicle and loads against everything else.

        Parameters
        ----------
        iterate
            The optimum, or where a fit ended near it.
        inflation
            Overdispersion of the records.

        Returns
        -------
        dict
            By name: the root of what twice the log-likelihood would gain without that statement, to second order; for an
            uncertain one this is its distance from what the rest says, in standard uncertainties of the difference.
        """
        found = {}
        every, _ = self.priors.residuals(iterate.u)
        _, left = identifiable_equations(*self.system(iterate, inflation)).step()
        for name, known in self.priors.statements.items():
            if is_of_sensor(name):
                continue  # what is beyond them is a fault
            if name in PARAMETERS and PARAMETERS[name].usual_std > 0:
                continue  # nobody stated it
            without = self.priors.without(name)
            relaxed = replace(self, priors=without)
            move, gain = identifiable_equations(*relaxed.system(iterate, inflation)).step()
            # What the optimum still misses of an uncertain statement would be gained as well.
            missed, _ = without.residuals(iterate.u)
            gain += float(every @ every - missed @ missed)
            gain -= left  # what a fit that ended early would gain with the statement is not gained without it
            away = abs(self.priors.change(name, iterate.u, move))
            if not known.is_exact or away > _EXACT_ENOUGH * abs(known.value):
                found[name] = max(round(gain, _DIGITS), 0.0) ** 0.5
        return found


def _leads_to(equations: NormalEquations, difference: Real) -> bool:
    """Whether the next step leads to a point so far away in the coordinates, or is there already."""
    distance = equations.directions.T @ difference
    squared = float(distance @ equations.information @ distance)
    if squared < _SAME:
        return True
    missed = distance - np.linalg.solve(equations.information, equations.gradient)
    return float(missed @ equations.information @ missed) < _REACHED * squared
