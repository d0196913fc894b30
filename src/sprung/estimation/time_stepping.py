"""Time stepping: the likelihood of all decays of a vehicle with nonlinear forces, all drops and all derivatives in one batch.

The initial states of a linear vehicle are eliminated in closed form; here each evaluation has its own, and those of the
next one are predicted from the derivatives at this one. Memories of dry friction are part of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.elimination import eliminate
from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.records import channel_rate_ratios
from sprung.preprocess import FreeDecay
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import (
    ElementInput,
    NonlinearModel,
    Prediction,
    Readout,
    Stepper,
    Trajectory,
    coordinates,
    differentiate_motions,
    integrate_near,
    segments_of,
)

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_MEMORY_STD = 1.0
"""Prior standard uncertainty of a friction's memory when a decay begins, as a part of the friction."""

_MOST_MEMORY = 1.15
"""Memory that no friction has: it slides at one, and noise adds little."""

_WITHOUT_WEIGHTS = (
    "_acceleration_rows",
    "_inputs",
    "_accelerations",
    "_residuals",
    "residual_sums",
    "_linearised",
    "_products",
)
"""Cached properties of a `TimeSteppingAt` that do not depend on the weights."""

_FIRST_WINDOW, _WINDOWS = 0.05, 8
"""Length of the first window of time, s, and how many there are, each twice as long as the one before."""

_STATE_STEPS, _STATE_GAIN = 20, 1e-2
"""Gauss-Newton steps of initial states alone, at the most, and gain in twice the log-likelihood below which they end."""


@dataclass(frozen=True, eq=False)
class TimeSteppingObjective:
    """The likelihood of decays of a vehicle with nonlinear forces.

    Attributes
    ----------
    decays
        What is fitted.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors over the fit's parameters, in the order of the decays' channels.
    states
        {X, Ẋ} of each drop at its first sample, from which an evaluation starts, and memories where they are known, from where
        the vehicle rests with its load; shape (drop, state) or (drop, state + memory).
    sensors_tilt
        Whether the sensors turn with the body, and measure the less of gravity.
    longest_step
        s: over a longer one forces do not run straight.
    longest_derivative_step
        s, of the steps by which motions are differentiated, if that is longer: rougher derivatives lead to the same optimum.
    """

    decays: Sequence[FreeDecay]
    models: Mapping[str, NonlinearModel]
    sensors: Readout
    states: Real
    sensors_tilt: bool
    longest_step: float
    longest_derivative_step: float = 0.0

    @cached_property
    def _kinds(self) -> list[tuple[str, float]]:
        """Kinds of steps: a load and a rate."""
        return sorted({(decay.load, decay.rate) for decay in self.decays})

    @cached_property
    def kind(self) -> Index:
        """Which kind of step each drop takes, shape (drop,)."""
        return np.array([self._kinds.index((decay.load, decay.rate)) for decay in self.decays])

    @cached_property
    def models_by_kind(self) -> tuple[NonlinearModel, ...]:
        """Equations of motion of each kind of step."""
        return tuple(self.models[load] for load, _ in self._kinds)

    @cached_property
    def times(self) -> tuple[float, ...]:
        """Length of each kind of step, s."""
        return tuple(1.0 / (rate * self.every) for _, rate in self._kinds)

    @cached_property
    def every(self) -> int:
        """Steps from one sample to the next."""
        return max(int(np.ceil(1.0 / (min(decay.rate for decay in self.decays) * self.longest_step))), 1)

    @cached_property
    def derivative_every(self) -> int:
        """Steps over each of which the derivatives make one."""
        most = self.longest_derivative_step / max(self.times)
        return max(part for part in range(1, self.every + 1) if self.every % part == 0 and part <= max(most, 1))

    @cached_property
    def samples(self) -> Index:
        """Of each drop, shape (drop,)."""
        return np.array([decay.samples for decay in self.decays])

    @cached_property
    def records(self) -> Real:
        """Centred records, m/s², zero beyond their end and in channels that are left out; shape (drop, channel, time)."""
        records = np.zeros((len(self.decays), len(self.decays[0].values), int(self.samples.max())))
        for record, decay in zip(records, self.decays, strict=True):
            centred = decay.values - decay.values.mean(axis=1, keepdims=True)
            record[:, : decay.samples] = np.where(decay.usable[:, None], centred, 0.0)
        return records

    @cached_property
    def channel_weights(self) -> Real:
        """0 for a channel that is left out, else the samples that were taken for each one; shape (drop, channel)."""
        return np.array([decay.usable * channel_rate_ratios(decay) for decay in self.decays])

    @cached_property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return self.channel_weights * self.samples[:, None]

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        squares = np.einsum("dct,dct->dc", self.records, self.records)
        energy: Real = (self.channel_weights * squares).sum(axis=0)
        return energy

    @cached_property
    def is_sample(self) -> Real:
        """1 where a drop has a sample, shape (drop, time)."""
        is_sample: Real = (np.arange(self.records.shape[2]) < self.samples[:, None]).astype(float)
        return is_sample

    @property
    def state_size(self) -> int:
        """How many numbers {X, Ẋ} has."""
        return self.models_by_kind[0].state_size

    @property
    def coordinates(self) -> int:
        """How many numbers X has."""
        return len(coordinates(self.models_by_kind[0].names))

    @cached_property
    def prior_std(self) -> Real:
        """Prior standard uncertainty of initial states and memories, shape (state + memory,)."""
        memories = self.models_by_kind[0].forces.memories
        return np.concatenate(
            [initial_state_prior_std(self.coordinates, self.state_size), np.full(memories, _MEMORY_STD)]
        )

    def with_decays(self, decays: Sequence[FreeDecay]) -> TimeSteppingObjective:
        """Return the objective of other decays; those of the same recordings start from the same states, others from rest."""
        known = {decay.file: state for decay, state in zip(self.decays, self.states, strict=True)}
        rest = np.zeros(self.states.shape[1])
        return replace(self, decays=decays, states=np.array([known.get(decay.file, rest) for decay in decays]))

    def with_states(self, states: Real) -> TimeSteppingObjective:
        """Return the objective with other initial states and memories to start from, shape (drop, state + memory)."""
        return replace(self, states=states)

    def at(self, values: Real, weights: Real) -> TimeSteppingAt:
        """Evaluate at parameter values, SI, shape (parameter,), with 1/σ² of each channel, s⁴/m², shape (channel,)."""
        begin = self.sag(values)
        begin[:, : self.states.shape[1]] += self.states[:, : begin.shape[1]]
        return self.at_states(values, weights, begin)

    def at_states(self, values: Real, weights: Real, begin: Real, near: Prediction | None = None) -> TimeSteppingAt:
        """Evaluate with initial states and memories from where the empty vehicle rests, shape (drop, state + memory).

        A prediction of the motions saves time.
        """
        stepper = Stepper.of(self.models_by_kind, self.times, self.kind, values[: self.sensors.shared])
        states, memories = np.split(begin, [self.state_size], axis=1)
        steps = self.every * (self.records.shape[2] - 1)
        if near is None:
            trajectory = stepper.integrate(states, memories, steps)
        else:
            trajectory = integrate_near(stepper, states, memories, steps, self.every, near)
        return TimeSteppingAt(self, values, weights, begin, stepper, trajectory)

    def sag(self, values: Real) -> Real:
        """Displacement of each drop's resting point under its load; (drop, state + memory), only X is not zero."""
        sag = np.zeros((len(self.decays), len(self.prior_std)))
        by_kind = np.array([model.sag(values) for model in self.models_by_kind])[self.kind]
        sag[:, : by_kind.shape[1]] = by_kind
        return sag

    def without_impossible_memories(self, values: Real, states: Real) -> Real | None:
        """Return initial states without memories that no friction can have, None where there are none such.

        Accelerations do not tell a friction's force from a spring's while neither changes: a drop may be explained for a
        while by a friction that holds against where the vehicle stands. Its memory is set to zero, and the vehicle to where
        all forces are what they were.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).
        states
            {X, Ẋ} and memories, shape (drop, state + memory).
        """
        forces, size = self.models_by_kind[0].forces, self.state_size
        X, V, memories = np.split(states + self.sag(values), [self.coordinates, size], axis=1)
        impossible = np.abs(memories) > _MOST_MEMORY
        if not impossible.any():
            return None
        rows = forces.rows.at(values)
        travel = X @ rows.T
        still = np.zeros_like(travel)  # a friction's force is its memory, whatever the rate
        answer = forces.evaluate(forces.parameters(values), ElementInput(travel, still, still, memories))
        lost = np.where(impossible, memories, 0.0) * answer.by_memory @ rows[forces.memory_rows]
        stiffness = np.array([model.linear.matrices(values).K for model in self.models_by_kind])[self.kind]
        X = X + np.linalg.solve(stiffness, lost[:, :, None])[:, :, 0]
        return np.hstack([X, V, np.where(impossible, 0.0, memories)]) - self.sag(values)


@dataclass(frozen=True, eq=False)
class TimeSteppingAt:
    """Time stepping at parameter values and noise levels.

    Attributes
    ----------
    objective
        The likelihood.
    values
        Parameters, SI, shape (parameter,).
    weights
        1/σ² of each channel, s⁴/m², shape (channel,).
    begin
        {X, Ẋ} and memories of each drop at its first sample, from where the empty vehicle rests, shape (drop, state + memory).
    stepper
        What steps.
    trajectory
        The motion of every drop.
    """

    objective: TimeSteppingObjective
    values: Real
    weights: Real
    begin: Real
    stepper: Stepper
    trajectory: Trajectory

    is_reversible = False

    def reweighted(self, weights: Real) -> TimeSteppingAt:
        """Return the likelihood with other weights; motion and derivatives are the same, and are not computed again."""
        reweighted = replace(self, weights=weights)
        vars(reweighted).update({name: value for name, value in vars(self).items() if name in _WITHOUT_WEIGHTS})
        return reweighted

    def moved(self, values: Real) -> TimeSteppingAt:
        """Return the likelihood at other parameter values, with the initial states that should explain the records there."""
        information, gradient = self._normal_equations
        parameters = len(self.values)
        right = gradient[:, parameters:] - np.einsum(
            "dzp,p->dz", information[:, parameters:, :parameters], values - self.values
        )
        step = np.linalg.solve(information[:, parameters:, parameters:], right[:, :, None])[:, :, 0]
        of_model = (values - self.values)[: self.objective.sensors.shared]
        change = np.hstack([np.tile(of_model, (len(step), 1)), step])
        return self.objective.at_states(values, self.weights, self.begin + step, self._predict(change))

    def _predict(self, change: Real) -> Prediction:
        """Predict the motions after a small change of the model's parameters and initial states, shape (drop, unknown)."""
        _, by_unknown, transitions = self._linearised
        steps = len(self.trajectory.states) - 1
        number, length = segments_of(steps, self.objective.every)
        first = np.minimum(np.arange(number) * length, steps)
        starts = np.concatenate([self.trajectory.states[first], self.trajectory.memories[first]], axis=-1)
        return Prediction(
            np.swapaxes(starts, 0, 1) + np.einsum("dsiu,du->dsi", by_unknown, change, optimize=True), transitions
        )

    def with_optimal_states(self) -> TimeSteppingAt:
        """Return the likelihood with the initial states that maximise it at these parameters."""
        best = self
        for _ in range(_STATE_STEPS):
            tried = best.moved(self.values)
            gain = best._cost - tried._cost
            best = tried if gain > 0 else best
            if not gain > _STATE_GAIN:
                break
        return best

    @property
    def _cost(self) -> float:
        return float(self.residual_sums.sum(axis=0) @ self.weights) + self.penalty

    def of_drop(self, drop: int) -> TimeSteppingAt:
        """Return the likelihood of one drop alone, by its position."""
        alone = self.objective.with_decays([self.objective.decays[drop]])
        return alone.at_states(self.values, self.weights, self.begin[[drop]])

    @cached_property
    def _acceleration_rows(self) -> tuple[Real, Real]:
        """Accelerations from {X, Ẋ, u, 1} of every drop, (drop, coordinate, input), and by parameter, next to it."""
        by_kind = [model.accelerations(self.values) for model in self.objective.models_by_kind]
        rows, derivatives = (np.stack(part)[self.objective.kind] for part in zip(*by_kind, strict=True))
        return rows, derivatives

    @cached_property
    def _inputs(self) -> Real:
        """{X, Ẋ, u, 1} at every sample, shape (time, drop, input)."""
        every = self.objective.every
        states, forces = self.trajectory.states[::every], self.trajectory.forces[::every]
        return np.concatenate([states, forces, np.ones((*states.shape[:-1], 1))], axis=-1)

    @cached_property
    def _accelerations(self) -> Real:
        """Accelerations of the coordinates at every sample, shape (time, drop, coordinate)."""
        accelerations: Real = np.einsum("dij,kdj->kdi", self._acceleration_rows[0], self._inputs, optimize=True)
        return accelerations

    @property
    def _gravity(self) -> float:
        """What the sensors measure less of where they turn, m/s²."""
        return STANDARD_GRAVITY if self.objective.sensors_tilt else 0.0

    @property
    def _readings(self) -> Real:
        """What the sensors read, shape (drop, channel, time)."""
        sensors, angles = self.objective.sensors, self._inputs[:, :, 1:3]
        readings: Real = sensors.at(self.values) @ self._accelerations.transpose(1, 2, 0)
        if self._gravity:
            readings -= 0.5 * self._gravity * np.einsum("kdi,kdi->dk", angles, angles)[:, None, :]
        if sensors.has_delays:
            # To the second order: a delay is a small part of a period.
            samples = sensors.delays(self.values)[:, None] * self._rates
            rising = np.gradient(readings, axis=-1, edge_order=2)
            readings += 0.5 * samples**2 * np.gradient(rising, axis=-1, edge_order=2) - samples * rising
        return readings

    @property
    def _rates(self) -> Real:
        """Samples per second of every drop, shape (drop, 1, 1)."""
        return np.array([decay.rate for decay in self.objective.decays])[:, None, None]

    @cached_property
    def _residuals(self) -> Real:
        """Measured minus modelled, centred, shape (drop, channel, time); zero where there is no sample."""
        objective = self.objective
        with np.errstate(over="ignore", invalid="ignore"):
            residuals = objective.records - self._readings
            residuals -= (residuals @ objective.is_sample[:, :, None]) / objective.samples[:, None, None]
            residuals *= objective.is_sample[:, None, :]
        counted: Real = residuals * (objective.channel_weights > 0)[:, :, None]
        return counted

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, (m/s²)², shape (drop, channel); infinite where the motion has no bounds."""
        with np.errstate(over="ignore", invalid="ignore"):
            sums = self.objective.channel_weights * np.einsum("dct,dct->dc", self._residuals, self._residuals)
        return np.where(np.isfinite(sums), sums, np.inf)

    @property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of the initial states under their prior."""
        return float(np.sum((self.begin / self.objective.prior_std) ** 2))

    @cached_property
    def _products(self) -> Real:
        """Inner products of derivatives, and of the residual as the last, with each other, by drop and channel.

        Shape (drop, channel, unknown + 1, unknown + 1); what offsets explain is subtracted.
        """
        products: Real = self._linearised[0].sum(axis=0)
        return products

    @cached_property
    def _linearised(self) -> tuple[Real, Real, Real]:
        """The products by window, and what predicts motions nearby: `Sensitivities.starts` and `Sensitivities.transitions`."""
        objective = self.objective
        S, by_S = objective.sensors.at(self.values), objective.sensors.slopes(self.values)
        channels, shared = len(S), objective.sensors.shared
        by_kind = [model.accelerations(self.values) for model in objective.models_by_kind]
        outputs = np.stack([S @ rows[:, :-1] for rows, _ in by_kind])
        direct = [np.swapaxes(by_S, 0, 1) @ rows for rows, _ in by_kind]
        for by_row, (_, slopes) in zip(direct, by_kind, strict=True):
            by_row[:shared] += S @ slopes
        if self._gravity:
            # Sensors that turn measure the less of gravity: their readings depend on pitch and roll.
            angles = np.broadcast_to(np.eye(2, outputs.shape[2], k=1), (len(outputs), 2, outputs.shape[2]))
            outputs = np.concatenate([outputs, angles], axis=1)
        stepper, trajectory, skipped = self.stepper, self.trajectory, objective.derivative_every
        if skipped > 1:
            longer = [skipped * time for time in objective.times]
            stepper = Stepper.of(objective.models_by_kind, longer, objective.kind, self.values[:shared])
            trajectory = Trajectory(*(part[::skipped] for part in trajectory))
        found = differentiate_motions(stepper, trajectory, outputs, objective.every // skipped)
        products = []
        for drop, (moved, samples) in enumerate(zip(found.outputs, objective.samples, strict=True)):
            inputs, readings = self._inputs[:samples, drop], moved[:samples, :channels]
            if self._gravity:
                readings -= self._gravity * (inputs[:, None, 1:3] @ moved[:samples, channels:])
            # The unknowns of the sensors come between the parameters of the model and the initial states.
            readings = np.insert(readings, [shared] * (len(self.values) - shared), 0.0, axis=2)
            by_sensor = np.moveaxis(inputs @ np.swapaxes(direct[objective.kind[drop]], 1, 2), 0, 2)
            readings[..., : len(self.values)] += by_sensor
            for channel, position in objective.sensors.delay_positions:
                readings[:, channel, position] = -np.gradient(self._readings[drop, channel, :samples], edge_order=2)
                readings[:, channel, position] *= objective.decays[drop].rate
            columns = np.empty((channels, samples, readings.shape[2] + 1))
            columns[..., :-1] = np.swapaxes(readings - readings.mean(axis=0), 0, 1)
            columns[..., -1] = self._residuals[drop, :, :samples]
            ends = (objective.decays[drop].rate * _FIRST_WINDOW * 2.0 ** np.arange(_WINDOWS - 1)).astype(np.int64)
            windows = np.split(columns, np.minimum(ends, samples), axis=1)
            products.append([np.swapaxes(window, 1, 2) @ window for window in windows])
        by_window = np.swapaxes(np.array(products), 0, 1) * objective.channel_weights[:, :, None, None]
        return by_window, found.starts, found.transitions

    @cached_property
    def _normal_equations(self) -> tuple[Real, Real]:
        """Information and gradient of parameters and initial states of each drop, the prior of the states included."""
        parameters = len(self.values)
        whole = np.einsum("c,dcij->dij", self.weights, self._products, optimize=True)
        information, gradient = whole[:, :-1, :-1], whole[:, :-1, -1]
        precision = self.objective.prior_std**-2
        information[:, parameters:, parameters:] += np.diag(precision)
        gradient[:, parameters:] -= self.begin * precision
        return information, gradient

    @cached_property
    def _eliminated(self) -> tuple[Real, Real, Real]:
        """Information and gradient of each drop without its initial state, and how that follows the parameters."""
        return eliminate(*self._normal_equations, len(self.values))

    @property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop; shapes (drop, parameter) and (drop, parameter, parameter)."""
        information, gradient, _ = self._eliminated
        return gradient, information

    @cached_property
    def by_window(self) -> tuple[Real, Real]:
        """Gradient and information of each window of time; shapes (window, parameter) and (window, parameter, parameter)."""
        response = self._eliminated[2]
        # What a change of the parameters is in a drop whose initial state follows it.
        change = np.concatenate([np.tile(np.eye(len(self.values)), (len(response), 1, 1)), response], axis=1)
        products = np.einsum("c,wdcij->wdij", self.weights, self._linearised[0], optimize=True)
        gradient = np.einsum("dup,wdu->wp", change, products[..., :-1, -1], optimize=True)
        information = np.einsum("dup,wduv,dvq->wpq", change, products[..., :-1, :-1], change, optimize=True)
        return gradient, information

    @property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""
        return np.asarray(self.by_drop[0].sum(axis=0))

    @property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""
        return np.asarray(self.by_drop[1].sum(axis=0))

    @cached_property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""
        parameters = len(self.values)
        products = self._products[:, :, parameters:-1, parameters:-1]
        inverse = np.linalg.inv(self._normal_equations[0][:, parameters:, parameters:])
        leverage: Real = self.weights * np.einsum("dij,dcji->c", inverse, products, optimize=True)
        return leverage

    @property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop."""
        objective = self.objective
        whole = objective.records - self._residuals
        return tuple(record[:, :samples] for record, samples in zip(whole, objective.samples, strict=True))

    @property
    def states(self) -> Real:
        """{X, Ẋ} and memories of each drop at its first sample, SI, shape (drop, state + memory)."""
        states: Real = self.begin - self.objective.sag(self.values)
        return states

    def motion(self, drop: int, before: int, after: int) -> Real:
        """{X, Ẋ} and memories of a drop, SI, shape (state + memory, time).

        NaN for the samples before its first: friction cannot be followed backward in time.
        """
        chosen = slice(None, self.objective.every * after, self.objective.every)
        memories = self.trajectory.memories[chosen, drop]
        whole = np.hstack([self.trajectory.states[chosen, drop], memories]) - self.objective.sag(self.values)[drop]
        unknown = np.full((whole.shape[1], before), np.nan)
        return np.hstack([unknown, whole.T])
