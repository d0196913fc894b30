"""Stepped motions of all drops at parameter values, what the sensors read of them, and how it follows the unknowns."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Stepper, Trajectory, differentiate_motion

if TYPE_CHECKING:
    from sprung.estimation.low_pass import SampledLowPass
    from sprung.estimation.time_stepping import TimeSteppingObjective

Real = NDArray[np.float64]

_NEAR = 1e-3
"""Part of the corner by which readings are differentiated: the error is of second order."""

_UNBOUNDED = 1e12
"""Residual sum of squares, as a part of the records' own, of a motion without bounds: its derivatives soon are no numbers."""

_FIRST_WINDOW, _WINDOWS = 0.05, 8
"""Length of the first window of time, s, and how many there are, each twice as long as the one before."""


@dataclass(frozen=True, eq=False)
class SteppedMotion:
    """Motions of all drops, whatever the noise of the sensors.

    Attributes
    ----------
    objective
        What is fitted, and the equations of motion.
    values
        Parameters, SI, shape (parameter,).
    begin
        {X, Ẋ} and memories of each drop at its first sample, from where the empty vehicle rests, shape (drop, state + memory).
    stepper
        What steps.
    trajectory
        The motion of every drop.
    """

    objective: TimeSteppingObjective
    values: Real
    begin: Real
    stepper: Stepper
    trajectory: Trajectory

    def of_drop(self, drop: int, alone: TimeSteppingObjective) -> SteppedMotion:
        """Return the motion of one drop, by its position, with an objective of it alone that takes the same steps."""
        steps = alone.every * (alone.samples[0] - 1)
        trajectory = Trajectory(*(part[: steps + 1, [drop]] for part in self.trajectory))
        return SteppedMotion(alone, self.values, self.begin[[drop]], self.stepper.of_drop(drop), trajectory)

    @cached_property
    def _forces(self) -> Real:
        """Forces of the rows as sensors read them, N, shape (step + 1, drop, row)."""
        forces = self.trajectory.forces
        if self.objective.low_pass is None:
            return forces
        # A low-pass sees where in a step a kink was passed: both of its ends share what the mean force is more.
        before = self.stepper.unresolved(self.trajectory)
        read: Real = forces + 0.5 * (before + np.concatenate([before[1:], np.zeros_like(before[:1])]))
        return read

    def _inputs(self, every: int) -> Real:
        """Return {X, Ẋ, u, 1} of one in so many steps, shape (time, drop, input)."""
        states, forces = self.trajectory.states[::every], self._forces[::every]
        return np.concatenate([states, forces, np.ones((*states.shape[:-1], 1))], axis=-1)

    def _observed(self, inputs: Real) -> Real:
        """Return what the sensors read rows of, shape (time, drop, column)."""
        sensors = self.objective.sensors
        by_kind = [
            sensors.observed_of_states(model.accelerations(self.values)[0], model.linear.massive)
            for model in self.objective.models_by_kind
        ]
        rows = np.stack(by_kind)[self.objective.kind]
        observed: Real = np.einsum("dij,kdj->kdi", rows, inputs, optimize=True)
        return observed

    @cached_property
    def _gravity(self) -> Real | None:
        """What each sensor measures less of where it turns, m/s², shape (channel, 1); None where that is not modelled."""
        felt = STANDARD_GRAVITY * self.objective.sensors.reads_accelerations.astype(np.float64)
        return felt[:, None] if self.objective.sensors_tilt else None

    @cached_property
    def _before_low_pass(self) -> Real:
        """What the sensors read before the low-pass, shape (drop, channel, time), `_of_sample` times for each sample."""
        sensors, of_sample = self.objective.sensors, self._of_sample
        inputs = self._inputs(self.objective.every // of_sample)
        angles = inputs[:, :, self.objective.angles]
        readings: Real = sensors.at(self.values) @ self._observed(inputs).transpose(1, 2, 0)
        if self._gravity is not None:
            readings -= 0.5 * self._gravity * np.einsum("kdi,kdi->dk", angles, angles)[:, None, :]
        if sensors.has_delays:
            # To the second order: a delay is a small part of a period.
            samples = sensors.delays(self.values)[:, None] * (of_sample * self._rates)
            rising = np.gradient(readings, axis=-1, edge_order=2)
            readings += 0.5 * samples**2 * np.gradient(rising, axis=-1, edge_order=2) - samples * rising
        return readings

    @property
    def _of_sample(self) -> int:
        """How many readings a sample needs: between its samples a low-pass sees where friction turns round."""
        return 1 if self.objective.low_pass is None else self.objective.every

    @cached_property
    def _low_passes(self) -> tuple[SampledLowPass, ...]:
        """The low-pass of each drop."""
        return self.objective.low_passes_at(self.values)

    @cached_property
    def _readings(self) -> Real:
        """What the sensors read, shape (drop, channel, time)."""
        return np.stack([self._behind(low_pass, drop) for drop, low_pass in enumerate(self._low_passes)])

    def _behind(self, low_pass: SampledLowPass, drop: int) -> Real:
        """Return what the sensors read of a drop behind a low-pass, shape (channel, time)."""
        return self._passed(low_pass, self._before_low_pass[drop])

    def _passed(self, low_pass: SampledLowPass, readings: Real) -> Real:
        """Return samples of readings behind a low-pass, shape (..., time)."""
        return low_pass.filtered(readings, self._of_sample)

    def _differentiate_by_corner(self, drop: int, corner: float) -> Real:
        """Differentiate what the records of a drop show by the corner: of the motion, and of what the low-pass remembers.

        Returns
        -------
        ndarray
            m/s² per Hz, shape (channel, sample).
        """
        samples, width = self.objective.samples[drop], 2 * _NEAR * corner
        lower, higher = (self.objective.low_passes_at(self.values, 1 + step)[drop] for step in (-_NEAR, _NEAR))
        of_motion = (self._behind(higher, drop) - self._behind(lower, drop))[:, :samples]
        shown = np.linalg.pinv(self._low_passes[drop].remembered(samples)) @ self._deviations[drop, :, :samples].T
        of_memory = (higher.remembered(samples) - lower.remembered(samples)) @ shown
        slopes: Real = (of_motion + of_memory.T) / width
        return slopes

    @property
    def _rates(self) -> Real:
        """Samples per second of every drop, shape (drop, 1, 1)."""
        return np.array([decay.rate for decay in self.objective.decays])[:, None, None]

    @cached_property
    def _free_signals(self) -> Real:
        return self.objective.free_signals(self._low_passes)

    @cached_property
    def _deviations(self) -> Real:
        """Measured minus modelled, shape (drop, channel, time)."""
        deviations: Real = (self.objective.records - self._readings) * self.objective.is_sample[:, None, :]
        return deviations

    @cached_property
    def residuals(self) -> Real:
        """Measured minus modelled and what no motion explains, shape (drop, channel, time); zero where no sample counts."""
        objective = self.objective
        with np.errstate(over="ignore", invalid="ignore"):
            residuals = self._deviations.copy()
            residuals -= (residuals @ self._free_signals) @ np.swapaxes(self._free_signals, 1, 2)
        counted: Real = residuals * (objective.channel_weights > 0)[:, :, None]
        return counted

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); infinite where the motion has no bounds."""
        with np.errstate(over="ignore", invalid="ignore"):
            sums = self.objective.channel_weights * np.einsum("dct,dct->dc", self.residuals, self.residuals)
        return np.where(sums < _UNBOUNDED * self.objective.energy.max(), sums, np.inf)

    @cached_property
    def products(self) -> Real:
        """Inner products of derivatives, and of the residual as the last, with each other, by drop and channel.

        Shape (drop, channel, unknown + 1, unknown + 1); what a record may show whatever the motion is subtracted.
        """
        with np.errstate(invalid="ignore"):
            products: Real = self.products_by_window.sum(axis=0)
        return products

    @cached_property
    def products_by_window(self) -> Real:
        """The products by window, shape (window, drop, channel, unknown + 1, unknown + 1).

        Not finite where the motion is not, as at the start of a fit that diverges.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            return self._linearise()

    def _linearise(self) -> Real:
        objective = self.objective
        S, by_S = objective.sensors.at(self.values), objective.sensors.slopes(self.values)
        shared = objective.sensors.shared
        by_kind = [model.accelerations(self.values) for model in objective.models_by_kind]
        observed = [
            objective.sensors.observed_of_states(rows, model.linear.massive)
            for model, (rows, _) in zip(objective.models_by_kind, by_kind, strict=True)
        ]
        outputs = np.stack([S @ rows[:, :-1] for rows in observed])
        direct = [np.swapaxes(by_S, 0, 1) @ rows for rows in observed]
        for by_row, (_, slopes) in zip(direct, by_kind, strict=True):
            by_row[:shared] += objective.sensors.of_accelerations(S) @ slopes
        of_same_motion = [by_row.transpose(1, 0, 2) for by_row in direct]
        if self._gravity is not None:
            # Sensors that turn measure the less of gravity: their readings depend on pitch and roll.
            units = np.eye(outputs.shape[2])[objective.angles]
            angles = np.broadcast_to(units, (len(outputs), *units.shape))
            outputs = np.concatenate([outputs, angles], axis=1)
        at_readings = np.ascontiguousarray(self._inputs(objective.every // self._of_sample).transpose(1, 2, 0))
        columns = len(self.values) + self.begin.shape[1] + 1
        products = np.empty((_WINDOWS, *objective.channel_weights.shape, columns, columns))

        def fill(drop: int) -> None:
            """Fill in the products of one drop in each window."""
            with np.errstate(over="ignore", invalid="ignore"):  # of this thread
                kind, every = objective.kind[drop], objective.every // self._of_sample
                moved = differentiate_motion(self.stepper, self.trajectory, drop, outputs[kind], every)
                derivatives = self._derivatives_of_drop(at_readings[drop], of_same_motion[kind], moved, drop)
                for window, own in zip(products, self._windows(derivatives, drop), strict=True):
                    np.matmul(own, np.swapaxes(own, 1, 2), out=window[drop])
                products[:, drop] *= objective.channel_weights[drop, :, None, None]

        # Each drop may have a processor of its own.
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(fill, range(len(objective.decays))))
        return products

    def _derivatives_of_drop(self, at_readings: Real, same: Real, moved: Real, drop: int) -> Real:
        """Return how the readings of one drop follow the unknowns, and as the last its residual.

        Parameters
        ----------
        at_readings
            {X, Ẋ, u, 1} at each reading, shape (input, time).
        same
            What each parameter changes in the readings of the same motion, shape (channel, parameter, input).
        moved
            What the unknowns change in the readings by the motion, from `differentiate_motion`.
        drop
            Its position.

        Returns
        -------
        ndarray
            Shape (channel, unknown + 1, time).
        """
        objective, parameters = self.objective, len(self.values)
        samples, channels, shared = objective.samples[drop], len(objective.energy), objective.sensors.shared
        read = self._of_sample * (samples - 1) + 1
        moved, inputs = moved[..., :read], at_readings[:, :read]
        if self._gravity is not None:
            turned = np.einsum("at,aut->ut", inputs[objective.angles], moved[channels:])
            moved[:channels] -= self._gravity[:, :, None] * turned
        # The unknowns of the sensors come between the parameters of the model and the initial states.
        readings = np.empty((channels, moved.shape[1] + parameters - shared + 1, read))
        readings[:, :parameters] = same @ inputs
        readings[:, :shared] += moved[:channels, :shared]
        readings[:, parameters:-1] = moved[:channels, shared:]
        readings[:, -1] = 0.0
        readings = np.ascontiguousarray(self._passed(self._low_passes[drop], readings))
        for channel, position in objective.sensors.delay_positions:
            readings[channel, position] = -np.gradient(self._readings[drop, channel, :samples], edge_order=2)
            readings[channel, position] *= objective.decays[drop].rate
        if (of_corner := objective.sensors.corner_position) is not None:
            readings[:, of_corner] = self._differentiate_by_corner(drop, float(self.values[of_corner]))
        readings[..., samples - objective.low_passes[drop].lag :] = 0.0
        free = self._free_signals[drop, :samples]
        by_sample = readings.reshape(-1, samples)
        by_sample -= (by_sample @ free) @ free.T
        readings[:, -1] = self.residuals[drop, :, :samples]
        return readings

    def _windows(self, derivatives: Real, drop: int) -> list[Real]:
        """Return derivatives of one drop cut into windows of time, shape (channel, unknown + 1, time) each."""
        ends = (self.objective.decays[drop].rate * _FIRST_WINDOW * 2.0 ** np.arange(_WINDOWS - 1)).astype(np.int64)
        return np.split(derivatives, np.minimum(ends, derivatives.shape[2]), axis=2)
