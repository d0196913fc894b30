"""The likelihood of a linear vehicle at parameter values, in modal coordinates: derivatives, motions, clocks, changes.

Initial states and offsets are eliminated (variable projection), as their readings are linear in them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.eliminated_coordinates import eliminate_coordinates
from sprung.estimation.modal_solution import ModalSolution, differentiate_modes, differentiate_response, turns
from sprung.estimation.objective import ObjectiveAt
from sprung.estimation.projected_response import ExponentialSums, ProjectedResponse
from sprung.estimation.records import in_order
from sprung.vehicle import LinearModel, Readout
from sprung.vibration import exponentials, real_product

if TYPE_CHECKING:
    from sprung.estimation.closed_form import ClosedFormObjective

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


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
    by_window = None
    coupling = None

    @property
    def modal(self) -> ClosedFormAt:
        """The likelihood itself."""
        return self

    def reweighted(self, weights: Real) -> ClosedFormAt:
        """Return the likelihood with other weights, its sums over the samples being the same."""
        return replace(self, weights=weights)

    def damped(self, _damping: float, /) -> tuple[Real, Real, float]:
        """Return information and gradient, whatever `_damping`: what is eliminated is at its maximum."""
        return self.information, self.gradient, 0.0

    def moved(self, values: Real, _damping: float = 0.0, /) -> ObjectiveAt:
        """Return the likelihood at other parameter values, SI, shape (parameter,); no step of states has any `_damping`."""
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
        """Return the information that noise alone adds on average, per SI units, shape (parameter, parameter).

        A motion that no drop excites has amplitudes too, those of noise.
        """
        pairs = zip(self._projected, self._derivatives, strict=True)
        bias: Real = np.sum([projected.noise_bias_of_information(own) for projected, own in pairs], axis=0)
        return bias

    @property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        if not self.sums:  # a motion without bounds is no model of anything
            return tuple(np.zeros_like(decay.values) for decay in self.objective.decays)
        found: dict[int, Real] = {}
        for projected in self._projected:
            positions = projected.sums.batch.positions.tolist()
            found |= dict(zip(positions, projected.fitted(), strict=True))
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
        """Return {X, Ẋ} of a drop, from `before` samples before its first to `after` samples from it on.

        SI, shape (state, before + after).
        """
        load, step = self._load(drop)
        poles, left, shapes = self._upper[load]
        coefficients = shapes * (left @ self.states[drop])
        motion = np.empty((len(shapes), before + after))
        motion[:, before:] = real_product(coefficients, exponentials(poles * step, after))
        if before:
            powers = turns(np.outer(np.arange(-before, 0) * step, poles))
            motion[:, :before] = real_product(coefficients, powers)
        return motion

    @cached_property
    def _upper(self) -> list[tuple[Complex, Complex, Complex]]:
        """Of each load one pole of every pair, its left eigenvector, and the right one of both."""
        found = []
        for poles, left, right in zip(self.modes.poles, self.modes.left, self.modes.right, strict=True):
            upper = poles.imag >= 0
            # A pole and its conjugate add the same real part twice.
            twice = np.where(poles[upper].imag > 0, 2.0, 1.0)
            found.append((poles[upper], left[upper], right[:, upper] * twice))
        return found

    def _load(self, drop: int) -> tuple[int, float]:
        """Return the position of a drop's load, and its sampling interval, s."""
        decay = self.objective.decays[drop]
        return self.objective.loads.index(decay.load), 1.0 / decay.rate

    def clock_delays(self, covariance: Real) -> dict[int, tuple[Real, Real]]:
        """Return the delays of the loggers' clocks.

        Parameters
        ----------
        covariance
            Of the parameters, SI, shape (parameter, parameter).

        Returns
        -------
        dict
            By the position of the drop the delays, s, shape (logger,), and their covariance, s²; without drops of one logger.
        """
        found: dict[int, tuple[Real, Real]] = {}
        for projected, derivatives in zip(self._projected, self._derivatives, strict=True):
            clocks = projected.clocks
            if clocks is not None:
                covariances = projected.delay_covariances(clocks, derivatives, covariance)
                positions = projected.sums.batch.positions.tolist()
                found |= dict(zip(positions, zip(clocks.values, covariances, strict=True), strict=True))
        return found

    def most_likely_delays(self, shifts: Real) -> dict[int, Real]:
        """Search for the delays of clocks that are hardly known.

        Parameters
        ----------
        shifts
            What is tried beside what is expected of each clock, s, shape (shift,).

        Returns
        -------
        dict
            By the position of the drop the delays of its loggers, s, shape (logger,).
        """
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
        """Rows by which the sensors read accelerations, shape (channel, coordinate)."""
        sensors = self.objective.sensors
        return sensors.of_accelerations(sensors.at(self.values))

    def differentiate_response(self, forces: Complex, direct: Complex | float = 0.0) -> Complex:
        """Return the derivatives of the readings by changes of the equations of motion.

        Parameters
        ----------
        forces
            (dM λ² + dC λ + dK) v of every mode v, SI, shape (load, coordinate, change, mode).
        direct
            What the sensors read in every mode of what else a change moves, SI, shape (load, channel, change, mode).

        Returns
        -------
        ndarray
            σ and τ, τ per second, as from `differentiate_modes`; shape (load, channel, change, 2 mode).
        """
        objective = self.objective
        _, readings = differentiate_response(
            objective.side_by_side, objective.sensors, self.values, self.modes, forces, objective.span, direct
        )
        return readings

    def with_changes(self, readings: Complex) -> tuple[Real, Real]:
        """Return gradient and information of the parameters and of changes of the readings behind them.

        Parameters
        ----------
        readings
            Derivatives by the changes, SI, shape (load, channel, change, 2 mode).

        Returns
        -------
        gradient, information
            Shapes (parameter + change,) and its square.
        """
        pairs = zip(self._derivatives, self._of_batches(readings), strict=True)
        both = [np.ascontiguousarray(np.concatenate([own, added], axis=2)) for own, added in pairs]
        return self._gradient(both), self._information(both)

    def with_larger_model(
        self, models: Mapping[str, LinearModel], sensors: Readout, ways: Sequence[tuple[Real, Real]]
    ) -> tuple[Real, Real]:
        """Return gradient and information of the parameters and of changes of a larger model behind them.

        Parameters
        ----------
        models, sensors, ways
            The larger model, as for `ObjectiveAt.with_larger_model`.

        Returns
        -------
        gradient, information
            SI, shapes (parameter + change,) and its square.
        """
        larger = LinearModel.stack([models[load] for load in self.loads])
        names, readings = self.objective.sensors.names, []
        for values, changes in ways:
            forces, added = eliminate_coordinates(self.modes, names, larger, values, changes)
            read = np.tensordot(sensors.of_accelerations(sensors.rows.at(values)), added, axes=(1, 1))
            readings.append(self.differentiate_response(forces, np.swapaxes(read, 0, 1)))
        return self.with_changes(np.concatenate(readings, axis=2))

    def group_of(self, drop: int) -> tuple[int, int]:
        """Return batch and group of a drop, by its position: drops of one group share their modes."""
        return next(
            (i, group) for i, batch in enumerate(self.objective.batches) if (group := batch.find(drop)) is not None
        )

    def response_of(self, drop: int) -> tuple[Complex, Complex, Complex, Complex]:
        """Return the poles, left eigenvectors, shapes and derivatives (τ per sample) of one drop, by its position."""
        load, _ = self._load(drop)
        batch, group = self.group_of(drop)
        modes = self.modes
        return modes.poles[load], modes.left[load], modes.shapes[load], self._derivatives[batch][group]
