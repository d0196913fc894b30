"""The closed form: the likelihood of all decays of a linear vehicle, its initial states and offsets eliminated.

Every sum over samples is a sum of exponentials, so an evaluation meets the records in one matrix product and everything else is
small. Where modal coordinates do not exist, at critical damping, `MatrixExponentialAt` takes over.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.modal_solution import (
    ModalSolution,
    differentiate_modes,
    differentiate_response,
    solve_modes,
    turns,
)
from sprung.estimation.objective import ObjectiveAt
from sprung.estimation.projected_response import ExponentialSums, ProjectedResponse
from sprung.estimation.records import RecordBatch, batch_records, in_order
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, Readout
from sprung.vibration import exponentials, real_product

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_UNBOUNDED = 100.0
"""Powers of e by which no motion grows within a record."""

_DEFECTIVE = 300.0
"""Condition number of a pole from which two modes have all but met in one shape."""


@dataclass(frozen=True, eq=False)
class ClosedFormObjective:
    """The likelihood of decays of a linear vehicle.

    Attributes
    ----------
    decays
        What is fitted.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors over the fit's parameters, in the order of the decays' channels.
    """

    decays: Sequence[FreeDecay]
    models: Mapping[str, LinearModel]
    sensors: Readout

    @cached_property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads, sorted."""
        return tuple(sorted({decay.load for decay in self.decays}))

    @cached_property
    def batches(self) -> tuple[RecordBatch, ...]:
        """The decays, centred and cut into blocks."""
        return batch_records(self.decays, self.sensors.names)

    @cached_property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return in_order(self.batches, [batch.channel_weights * batch.samples[:, None] for batch in self.batches])

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        energy: Real = np.sum([batch.channel_weights * batch.energy.sum(axis=0) for batch in self.batches], axis=0)
        return energy

    @cached_property
    def side_by_side(self) -> LinearModel:
        """The models of all loads side by side."""
        return LinearModel.stack([self.models[load] for load in self.loads])

    @cached_property
    def span(self) -> float:
        """Length of the longest record, s."""
        return max(batch.duration for batch in self.batches)

    @cached_property
    def _has_clocks(self) -> bool:
        return any(batch.clock_design.shape[1] for batch in self.batches)

    def with_decays(self, decays: Sequence[FreeDecay]) -> ClosedFormObjective:
        """Return the objective of other decays with the same models and sensors."""
        return ClosedFormObjective(decays, self.models, self.sensors)

    def at(self, values: Real, weights: Real) -> ObjectiveAt:
        """Evaluate at parameter values, SI, shape (parameter,), with weights 1/σ² of the channels, s⁴/m², shape (channel,)."""
        modes = solve_modes(self.side_by_side, self.sensors, values)
        # Rates that may be negative can make a motion that grows beyond all bounds.
        if float(modes.poles.real.max()) * self.span > _UNBOUNDED:
            return ClosedFormAt(self, values, weights, modes, ())
        # Delays turn shapes: they need modal coordinates, and bear with what rounding leaves near a critical damping.
        if not (self._has_clocks or self.sensors.has_delays) and modes.condition > _DEFECTIVE:
            from sprung.estimation.matrix_exponential import MatrixExponentialAt  # noqa: PLC0415 (hardly ever needed)

            return MatrixExponentialAt(self, self.models, self.sensors, values, weights)
        sums = tuple(ExponentialSums.of(batch, values, modes) for batch in self.batches)
        return ClosedFormAt(self, values, weights, modes, sums)


@dataclass(frozen=True, eq=False)
class ClosedFormAt:
    """The closed form at parameter values and noise levels.

    Attributes
    ----------
    objective
        The likelihood.
    values
        Parameters, SI, shape (parameter,).
    weights
        1/σ² of each channel, s⁴/m², shape (channel,).
    modes
        Poles and shapes of every load.
    sums
        Sums over the samples of every batch; none where the motion has no bounds.
    """

    objective: ClosedFormObjective
    values: Real
    weights: Real
    modes: ModalSolution
    sums: tuple[ExponentialSums, ...]

    is_reversible = True

    def reweighted(self, weights: Real) -> ClosedFormAt:
        """Return the likelihood with other weights, its sums over the samples being the same."""
        return replace(self, weights=weights)

    def moved(self, values: Real) -> ObjectiveAt:
        """Return the likelihood at other parameter values, SI, shape (parameter,)."""
        return self.objective.at(values, self.weights)

    def with_optimal_states(self) -> ClosedFormAt:
        """Return the likelihood itself: initial states are eliminated."""
        return self

    def of_drop(self, drop: int) -> ObjectiveAt:
        """Return the likelihood of one drop alone, by its position."""
        return self.objective.with_decays([self.objective.decays[drop]]).at(self.values, self.weights)

    @cached_property
    def _projected(self) -> list[ProjectedResponse]:
        return [sums.project(self.weights) for sums in self.sums]

    @cached_property
    def _derivatives(self) -> list[Complex]:
        """σ and τ of every batch beside each other, τ per sample; each of shape (group, channel, parameter, 2 mode)."""
        objective = self.objective
        _, readings = differentiate_modes(
            objective.side_by_side, objective.sensors, self.values, self.modes, objective.span
        )
        return self._of_batches(readings)

    def _of_batches(self, readings: Complex) -> list[Complex]:
        """Return derivatives by load, τ per second, for every batch and its delays, τ per sample."""
        m, found = self.modes.poles.shape[-1], []
        for projected in self._projected:
            batch = projected.sums.batch
            own = readings[batch.load]
            own[..., m:] *= batch.step[:, None, None, None]
            found.append(projected.turned(own))
        return found

    def _in_order(self, by_batch: Sequence[Real]) -> Real:
        return in_order(self.objective.batches, by_batch)

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); infinite where the motion has no bounds."""
        if not self.sums:
            return np.full_like(self.objective.observations, np.inf)
        return self._in_order([projected.residual_sums for projected in self._projected])

    @cached_property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of the clocks' delays under their priors."""
        return sum(projected.penalty for projected in self._projected)

    @cached_property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""
        leverage: Real = np.sum([projected.leverage for projected in self._projected], axis=0)
        return leverage

    @cached_property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""
        return self._gradient(self._derivatives)

    @cached_property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""
        return self._information(self._derivatives)

    def _gradient(self, derivatives: list[Complex]) -> Real:
        pairs = zip(self._projected, derivatives, strict=True)
        gradient: Real = np.sum([projected.gradient(own).sum(axis=0) for projected, own in pairs], axis=0)
        return gradient

    def _information(self, derivatives: list[Complex]) -> Real:
        pairs = zip(self._projected, derivatives, strict=True)
        information: Real = np.sum([projected.information(own).sum(axis=0) for projected, own in pairs], axis=0)
        return information

    @cached_property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop; shapes (drop, parameter) and (drop, parameter, parameter)."""
        pairs = list(zip(self._projected, self._derivatives, strict=True))
        gradients = self._in_order([projected.gradient(own) for projected, own in pairs])
        return gradients, self._in_order([projected.information(own, by_record=True) for projected, own in pairs])

    def noise_bias_of_information(self) -> Real:
        """Return the information that noise alone adds: a motion that no drop excites has amplitudes too, those of noise."""
        pairs = zip(self._projected, self._derivatives, strict=True)
        bias: Real = np.sum([projected.noise_bias_of_information(own) for projected, own in pairs], axis=0)
        return bias

    @cached_property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        if not self.sums:  # a motion without bounds is no model of anything
            return tuple(np.zeros_like(decay.values) for decay in self.objective.decays)
        found: dict[int, Real] = {}
        for projected in self._projected:
            positions = projected.sums.batch.positions.tolist()
            found |= dict(zip(positions, projected.fitted(self.modes.poles), strict=True))
        return tuple(found[position] for position in range(len(found)))

    @cached_property
    def states(self) -> Real:
        """{X, Ẋ} of each drop at its first sample, SI, shape (drop, state)."""
        found = []
        for projected in self._projected:
            batch = projected.sums.batch
            right = self.modes.right[batch.load][batch.group]
            found.append((right @ projected.amplitudes[:, :, None])[:, :, 0].real)
        return self._in_order(found)

    def motion(self, drop: int, before: int, after: int) -> Real:
        """{X, Ẋ} of a drop from samples before its first to samples from it on, SI, shape (state, time)."""
        load, step = self._load(drop)
        poles, shapes = self.modes.poles[load], self.modes.right[load]
        amplitudes = self.modes.left[load] @ self.states[drop]
        # A pole and its conjugate add the same real part twice.
        upper = poles.imag >= 0
        coefficients = shapes[:, upper] * (amplitudes[upper] * np.where(poles[upper].imag > 0, 2.0, 1.0))
        motion = np.empty((len(shapes), before + after))
        motion[:, before:] = real_product(coefficients, exponentials(poles[upper] * step, after))
        powers = turns(np.outer(np.arange(-before, 0) * step, poles[upper]))
        motion[:, :before] = real_product(coefficients, powers)
        return motion

    def _load(self, drop: int) -> tuple[int, float]:
        """Return the position of a drop's load, and its sampling interval, s."""
        decay = self.objective.decays[drop]
        return self.objective.loads.index(decay.load), 1.0 / decay.rate

    def clock_delays(self, covariance: Real) -> dict[int, tuple[Real, Real]]:
        """Return the delays of the loggers' clocks; see `HasClockDelays`."""
        found: dict[int, tuple[Real, Real]] = {}
        for projected, derivatives in zip(self._projected, self._derivatives, strict=True):
            clocks = projected.clocks
            if clocks is not None:
                covariances = projected.delay_covariances(clocks, derivatives, covariance)
                positions = projected.sums.batch.positions.tolist()
                found |= dict(zip(positions, zip(clocks.values, covariances, strict=True), strict=True))
        return found

    def most_likely_delays(self, shifts: Real) -> dict[int, Real]:
        """Search for the delays of clocks that are hardly known; see `HasClockDelays`."""
        return {
            position: delays
            for sums in self.sums
            if sums.batch.clock_design.shape[1]
            for position, delays in zip(
                sums.batch.positions.tolist(), sums.most_likely_delays(self.weights, shifts), strict=True
            )
        }

    @property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads in the order of the modes."""
        return self.objective.loads

    @property
    def sensor_rows(self) -> Real:
        """Rows of the sensors, shape (channel, coordinate)."""
        return np.asarray(self.objective.sensors.at(self.values))

    def differentiate_response(self, forces: Complex) -> Complex:
        """Return the derivatives of the readings by changes of the equations of motion; see `HasModalResponse`."""
        objective = self.objective
        _, readings = differentiate_response(
            objective.side_by_side, objective.sensors, self.values, self.modes, forces, objective.span
        )
        return readings

    def with_changes(self, readings: Complex) -> tuple[Real, Real]:
        """Return gradient and information of the parameters and of changes behind them; see `HasModalResponse`."""
        pairs = zip(self._derivatives, self._of_batches(readings), strict=True)
        both = [np.ascontiguousarray(np.concatenate([own, added], axis=2)) for own, added in pairs]
        return self._gradient(both), self._information(both)

    def response_of(self, drop: int) -> tuple[Complex, Complex, Complex, Complex]:
        """Return the poles, left eigenvectors, shapes and derivatives (τ per sample) of one drop."""
        load, _ = self._load(drop)
        batch, group = next(
            (i, group) for i, batch in enumerate(self.objective.batches) if (group := batch.find(drop)) is not None
        )
        modes = self.modes
        return modes.poles[load], modes.left[load], modes.shapes[load], self._derivatives[batch][group]
