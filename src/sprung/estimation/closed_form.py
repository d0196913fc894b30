"""The likelihood of all decays at once, with initial states and offsets eliminated, and its exact derivatives.

Every sum over samples is one of `sums`, so an evaluation touches the records in one matrix product and everything else
is small. Where modal coordinates do not exist, at critical damping, the evaluation goes `longhand`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.expm_likelihood import ExpmLikelihood, evaluate_drop
from sprung.estimation.projected_response import ExponentialSums, ProjectedResponse
from sprung.estimation.records import RecordBatch, Records
from sprung.estimation.solution import ModalSlopes, ModalSolution, differentiate_modes, solve_modes
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, Rows

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BEYOND_MEASURE = 100.0
"""Powers of e by which no motion grows within a record."""

_BACKWARD = 30.0
"""Powers of e by which a motion may grow on its way back in time: long before, it is no motion of a vehicle."""

_DEFECTIVE = 300.0
"""Condition number of a pole from which two modes have all but met in one shape, and the long way is taken."""


class Evaluation(NamedTuple):
    """What one evaluation of the likelihood gives; parameters in SI, drops in the fit's order.

    Attributes
    ----------
    residual
        Residual sum of squares, (m/s²)², shape (drop, channel).
    leverage
        How many of the amplitudes each channel pays for, shape (channel,).
    gradient
        Σ derivative · residual / σ², shape (parameter,).
    information
        Fisher information of the parameters, amplitudes and offsets eliminated; shape (parameter, parameter).
    penalty
        What delays of clocks cost that are not as expected, in twice the log-likelihood.
    """

    residual: Real
    leverage: Real
    gradient: Real
    information: Real
    penalty: float = 0.0


@dataclass(frozen=True, eq=False)
class Likelihood:
    """All decays of a campaign, ready to be fitted.

    Attributes
    ----------
    decays
        What is fitted.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors' rows over the fit's parameters, in the order of the decays' channels.
    """

    decays: Sequence[FreeDecay]
    models: Mapping[str, LinearModel]
    sensors: Rows

    def with_decays(self, decays: Sequence[FreeDecay]) -> Likelihood:
        """Return the likelihood of other decays with the same models and sensors."""
        return Likelihood(decays, self.models, self.sensors)

    @cached_property
    def records(self) -> Records:
        """The decays, centred and cut into blocks."""
        return Records.of(self.decays, next(iter(self.models.values())).names)

    @cached_property
    def model_of(self) -> tuple[LinearModel, ...]:
        """Equations of motion by the position of the load in the records."""
        return tuple(self.models[load] for load in self.records.loads)

    @cached_property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return self.records.in_order([run.present * run.samples[:, None] for run in self.records.runs])

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        energy: Real = np.sum([run.present * run.energy.sum(axis=0) for run in self.records.runs], axis=0)
        return energy

    @cached_property
    def loads(self) -> LinearModel:
        """The models of all loads side by side."""
        return LinearModel.stack(self.model_of)

    @cached_property
    def span(self) -> float:
        """Length of the longest record, s."""
        return max(float((run.samples * run.step[run.group]).max()) for run in self.records.runs)

    def beginning(self, states: Real) -> Likelihood:
        """Give itself: initial states, {X, Ẋ}, SI, shape (drop, state), are eliminated, whatever one starts from."""
        return self

    def at(self, values: Real) -> LikelihoodAt:
        """Go to parameter values, SI, shape (parameter,)."""
        return LikelihoodAt(self, values)


@dataclass(frozen=True, eq=False)
class LikelihoodAt:
    """A likelihood at some parameter values. Weights are 1/σ² of each channel, shape (channel,).

    Attributes
    ----------
    likelihood
        Of which decays.
    values
        Parameters, SI, shape (parameter,).
    """

    likelihood: Likelihood
    values: Real

    @cached_property
    def modes(self) -> ModalSolution:
        """Poles and shapes of every load."""
        return solve_modes(self.likelihood.loads, self.likelihood.sensors, self.values)

    @cached_property
    def _sums(self) -> list[ExponentialSums]:
        modes = self.modes
        runs, values = self.likelihood.records.runs, self.values
        return [ExponentialSums.of(run, values, modes.poles, modes.right, modes.shapes) for run in runs]

    @cached_property
    def _slopes(self) -> list[Complex]:
        """σ and τ of every run beside each other, τ per sample; each of shape (group, channel, parameter, 2 mode)."""
        likelihood = self.likelihood
        slopes = differentiate_modes(likelihood.loads, likelihood.sensors, self.values, self.modes, likelihood.span)
        return self._of_runs(slopes)

    def _of_runs(self, slopes: ModalSlopes) -> list[Complex]:
        return [
            np.concatenate([slopes.shapes[run.load], slopes.secular[run.load] * run.step[:, None, None, None]], axis=-1)
            for run in self.likelihood.records.runs
        ]

    @cached_property
    def _defective(self) -> bool:
        # Delays turn shapes: they have no long way, and bear with what rounding leaves near a critical damping.
        delayed = any(run.late.shape[1] for run in self.likelihood.records.runs)
        return not delayed and self.modes.condition > _DEFECTIVE

    @property
    def _runs_away(self) -> bool:
        """Whether this vehicle's motion grows beyond all measure: rates that may be negative can do that."""
        longest = max(float((run.step[run.group] * run.samples).max()) for run in self.likelihood.records.runs)
        return float(self.modes.poles.real.max()) * longest > _BEYOND_MEASURE

    def moved(self, values: Real, weights: Real) -> LikelihoodAt:
        """Go to other parameter values, SI, shape (parameter,)."""
        return self.likelihood.at(values)

    def misfit(self, weights: Real) -> tuple[Real, float]:
        """Give the residual sums of squares alone, (m/s²)², shape (drop, channel), and what delays cost beside them."""
        if self._runs_away:
            return np.full_like(self.likelihood.observations, np.inf, dtype=np.float64), 0.0
        solved = self._solve(weights)
        return self.likelihood.records.in_order([one.residual for one in solved]), sum(one.penalty for one in solved)

    def evaluate(self, weights: Real) -> Evaluation:
        """Evaluate fit and derivatives."""
        if self._defective:
            drops = self._longhand(weights)
            return Evaluation(
                np.array([drop.residual for drop in drops]),
                np.sum([drop.leverage for drop in drops], axis=0),
                np.sum([drop.gradient for drop in drops], axis=0),
                np.sum([drop.information for drop in drops], axis=0),
            )
        pairs = self._solve_with(weights, self._slopes)
        return Evaluation(
            self.likelihood.records.in_order([one.residual for one, _ in pairs]),
            np.sum([one.leverage for one, _ in pairs], axis=0),
            np.concatenate([one.gradient(slopes) for one, slopes in pairs]).sum(axis=0),
            np.concatenate([one.information(slopes) for one, slopes in pairs]).sum(axis=0),
            sum(one.penalty for one, _ in pairs),
        )

    def by_drop(self, weights: Real) -> tuple[Real, Real]:
        """Give each drop's own gradient and information; shapes (drop, parameter), (drop, parameter, parameter)."""
        if self._defective:
            drops = self._longhand(weights)
            return np.array([drop.gradient for drop in drops]), np.array([drop.information for drop in drops])
        pairs = self._solve_with(weights, self._slopes)
        in_order = self.likelihood.records.in_order
        gradients = in_order([solved.gradient(slopes) for solved, slopes in pairs])
        return gradients, in_order([solved.information(slopes, apart=True) for solved, slopes in pairs])

    def beside(self, weights: Real, more: ModalSlopes) -> tuple[Real, Real] | None:
        """Give gradient and information of the parameters and of other changes beside them.

        Parameters
        ----------
        weights
            1/σ², s⁴/m², shape (channel,).
        more
            What the other changes do to the response of each load.

        Returns
        -------
        gradient, information
            Shapes (parameter + change,) and its square; None where modal coordinates do not exist.
        """
        if self._defective:
            return None
        pairs = zip(self._slopes, self._of_runs(more), strict=True)
        slopes = [np.ascontiguousarray(np.concatenate([own, other], axis=2)) for own, other in pairs]
        solved = self._solve_with(weights, slopes)
        gradient = np.sum([one.gradient(those).sum(axis=0) for one, those in solved], axis=0)
        return gradient, np.sum([one.information(those).sum(axis=0) for one, those in solved], axis=0)

    def noise_bias_of_information(self, weights: Real) -> Real:
        """Give the information that noise alone feigns.

        A motion that no drop excites has amplitudes too: those that noise fits. The information is quadratic in the
        amplitudes, so on average it is too large by what their covariance puts in their place. Shape (parameter, parameter).
        """
        if self._defective:  # modes of their own cannot be told apart
            return np.zeros((len(self.values), len(self.values)))
        pairs = self._solve_with(weights, self._slopes)
        noise_bias_of_information: Real = np.sum(
            [solved.noise_bias_of_information(slopes) for solved, slopes in pairs], axis=0
        )
        return noise_bias_of_information

    def fitted(self, weights: Real) -> list[Real]:
        """Give what the model makes of every record, its mean taken off; each of shape (channel, time)."""
        if self._defective:
            return [one.fitted for one in self._longhand(weights)]
        found = {}
        for solved in self._solve(weights):
            run = solved.sums.run
            for position, record in zip(run.order.tolist(), solved.fitted(self.modes.poles), strict=True):
                found[position] = record
        return [found[position] for position in range(self.likelihood.records.drops)]

    def delays(self, weights: Real, covariance: Real) -> dict[int, tuple[Real, Real]]:
        """Give the delays of the drops with several loggers, by the drop's position.

        Parameters
        ----------
        weights
            1/σ², s⁴/m², shape (channel,).
        covariance
            Of the parameters, SI, shape (parameter, parameter).

        Returns
        -------
        dict
            How late each logger is, s, shape (logger,), and the covariance of that.
        """
        found: dict[int, tuple[Real, Real]] = {}
        for solved, slopes in self._solve_with(weights, self._slopes):
            if solved.delays is not None:
                positions, spreads = solved.sums.run.order.tolist(), solved.delay_covariances(slopes, covariance)
                found |= dict(zip(positions, zip(solved.delays.values, spreads, strict=True), strict=True))
        return found

    def align_by_likelihood(self, weights: Real, shifts: Real) -> dict[int, Real]:
        """Slide the clocks of loggers about, one after the other, to where each drop's records are most likely.

        Parameters
        ----------
        weights
            1/σ², s⁴/m², shape (channel,).
        shifts
            s, shape (shift,): what is tried beside what is expected of each clock.

        Returns
        -------
        dict
            By the drop's position how late its loggers are, s, shape (logger,).
        """
        return {
            position: late
            for sums in self._sums
            if sums.run.late.shape[1]
            for position, late in zip(sums.run.order.tolist(), sums.align_by_likelihood(weights, shifts), strict=True)
        }

    def states(self, weights: Real) -> Real:
        """Give {X, Ẋ} of each drop at its first sample, SI, shape (drop, state)."""
        if self._defective:
            return np.array([one.state for one in self._longhand(weights)])
        found = []
        for solved in self._solve(weights):
            right = self.modes.right[solved.sums.run.load][solved.sums.run.group]
            found.append((right @ solved.amplitudes[:, :, None])[:, :, 0].real)
        return self.likelihood.records.in_order(found)

    def motion(self, weights: Real, position: int, before: int, after: int) -> Real:
        """Follow the drop at a position, from samples before its first to samples after: {X, Ẋ}, SI, shape (state, time)."""
        run, group = self.run_of(position)
        poles, shapes = self.modes.poles[run.load[group]], self.modes.right[run.load[group]]
        exponent = poles[:, None] * np.arange(-before, after) * run.step[group]
        powers = np.exp(np.minimum(exponent.real, _BACKWARD) + 1j * exponent.imag)
        amplitudes = np.linalg.solve(shapes, self.states(weights)[position].astype(np.complex128))
        motion: Real = ((shapes * amplitudes) @ powers).real
        return motion

    def run_of(self, position: int) -> tuple[RecordBatch, int]:
        """Give the run of one drop, by its position in the fit's list, and its group in that."""
        run = next(run for run in self.likelihood.records.runs if position in run.order)
        return run, int(run.group[np.flatnonzero(run.order == position)[0]])

    def slopes_of(self, position: int) -> Complex:
        """Give σ and τ of the drop at a position beside each other, τ per sample; shape (channel, parameter, 2 mode)."""
        run, group = self.run_of(position)
        slopes: Complex = self._slopes[[one is run for one in self.likelihood.records.runs].index(True)][group]
        return slopes

    def _solve(self, weights: Real) -> list[ProjectedResponse]:
        return [sums.solve(weights) for sums in self._sums]

    def _solve_with(self, weights: Real, slopes: Sequence[Complex]) -> list[tuple[ProjectedResponse, Complex]]:
        """Solve every run, and give its slopes where its delays are."""
        return [(one, one.turned(own)) for one, own in zip(self._solve(weights), slopes, strict=True)]

    def _longhand(self, weights: Real) -> list[ExpmLikelihood]:
        """Evaluate every drop the long way, in the fit's order."""
        likelihood = self.likelihood
        found = {}
        for run in likelihood.records.runs:
            for i, position in enumerate(run.order.tolist()):
                group = run.group[i]
                model, rate = likelihood.model_of[run.load[group]], 1.0 / float(run.step[group])
                found[position] = evaluate_drop(
                    model, likelihood.sensors, self.values, run.record(i), rate, run.present * weights
                )
        return [found[position] for position in range(likelihood.records.drops)]
