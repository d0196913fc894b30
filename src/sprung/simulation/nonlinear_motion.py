"""Drops and decays of a vehicle with nonlinear elements, by time steps short enough to leave no visible error.

With dry friction, rebound damping or progressive springs there are no linear segments as in `drop_from_blocks`. All motions
are stepped at once; the ground, which pushes and never pulls, is one more nonlinear element. What drives a vehicle runs
linearly over each step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.simulation.excitation import Drive
from sprung.simulation.ground import Ground
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import (
    STATIONS,
    ElementInput,
    Layout,
    Load,
    Motion,
    NonlinearElement,
    NonlinearModel,
    StepDrive,
    Stepper,
    Vehicle,
    Wheel,
    ground_contact_elements,
    highest_derivatives,
    layout_of,
    linear_elements,
    nonlinear_elements,
    stiffened_air_springs,
)

Array = NDArray[np.float64]

_LONGEST_STEP = 2e-4
"""s."""

_ITERATIONS = 60
"""Newton steps at most to find the rest position on blocks."""


class BlockSupport(NamedTuple):
    """How a vehicle rests before it is dropped.

    Attributes
    ----------
    load
        What is on it.
    wheels
        The wheels with blocks under them.
    height
        Of the blocks, m.
    """

    load: Load
    wheels: tuple[Wheel, ...]
    height: float


class DrivenStart(NamedTuple):
    """How a vehicle rests before it is pushed or reaches a bump, and what drives it then.

    Attributes
    ----------
    load
        What is on it.
    drive
        From the beginning of the motion on.
    held
        Force on its coordinates before that, N, shape (coordinate,); None for none.
    """

    load: Load
    drive: Drive
    held: Array | None


def simulate_nonlinear_drops(
    vehicle: Vehicle,
    blocks: Sequence[BlockSupport | DrivenStart],
    step: float,
    samples: int,
    start: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> list[Motion]:
    """Simulate several drops from blocks, pushes or passes over a bump of a vehicle with nonlinear elements.

    Parameters
    ----------
    vehicle
        With nonlinear elements.
    blocks
        How it rests before each drop, without friction forces.
    step
        Sampling interval, s.
    samples
        How many samples.
    start
        Time of the first one, s after the release, less than `step`.
    gravity
        m/s².

    Returns
    -------
    list of Motion
        Displacement from static equilibrium with the load, velocity and acceleration, each (coordinate, samples).
    """
    values = np.array(list(vehicle.parameters.values()))
    contact = ground_contact_elements(vehicle.extras, vehicle.layout)
    models, kind = _models(vehicle, [block.load for block in blocks], contact, gravity)
    states = np.zeros((len(blocks), models[0].state_size))
    stations, n = vehicle.layout.wheels, len(models[0].linear.heave)
    for state, block, which in zip(states, blocks, kind, strict=True):
        heights, ground, held = np.zeros(len(stations)), Ground.under(vehicle, block.load, gravity), np.zeros(n)
        if isinstance(block, BlockSupport):
            heights = np.array([block.height if station in block.wheels else 0.0 for station in stations])
            linear = ground.rest(heights)
        else:
            held = held if block.held is None else block.held
            linear = ground.matrices.deflection(held)
        state[:n] = _rest(models[which], values, linear + models[which].sag(values), heights, held)
    drives = [block.drive if isinstance(block, DrivenStart) else None for block in blocks]
    return _sample(models, kind, values, states, step, samples, start, drives if any(drives) else ())


def simulate_nonlinear_decays(
    vehicle: Vehicle, loads: Sequence[Load], states: Array, step: float, samples: int
) -> list[Motion]:
    """Simulate free decays of a vehicle with nonlinear elements from given states, its tyres always on the ground.

    Parameters
    ----------
    vehicle
        With nonlinear elements.
    loads
        What is on it in each decay.
    states
        {X, Ẋ} from static equilibrium with the load, SI, shape (decay, 2n), without friction forces.
    step
        Sampling interval, s.
    samples
        How many samples.

    Returns
    -------
    list of Motion
        One for each state.
    """
    values = np.array(list(vehicle.parameters.values()))
    models, kind = _models(vehicle, loads, (), STANDARD_GRAVITY)
    initial, sag = states.copy(), np.array([model.sag(values) for model in models])[kind]
    initial[:, : sag.shape[1]] += sag
    return _sample(models, kind, values, initial, step, samples, 0.0)


def _models(
    vehicle: Vehicle, loads: Sequence[Load], contact: Sequence[NonlinearElement], gravity: float
) -> tuple[list[NonlinearModel], NDArray[np.int64]]:
    """Return a model for each different load, and which of them each of the loads has."""
    tracks, extras, wheelbase, layout = vehicle.tracks, vehicle.extras, vehicle.wheelbase, vehicle.layout
    elements = linear_elements(tracks, extras, vehicle.heights, wheelbase, layout)
    names, different = tuple(vehicle.parameters), list({load.name: load for load in loads}.values())
    models = []
    for load in different:
        at_wheels = load.mass_at_wheels(wheelbase, layout)
        further = stiffened_air_springs(at_wheels, tracks, extras, wheelbase, layout)
        nonlinear = nonlinear_elements(tracks, extras, wheelbase, at_wheels, layout)
        models.append(
            NonlinearModel.of(
                elements + further, [*nonlinear, *contact], names, load, vehicle.heights, gravity, wheelbase
            )
        )
    order = [load.name for load in different]
    return models, np.array([order.index(load.name) for load in loads])


def _tyre_rate(values: Mapping[str, float], wheel: Wheel) -> float:
    """Return the rate of one tyre, N/m."""
    _, axle, side, _ = STATIONS[wheel]
    return values[f"k_t{axle}"] + side * values.get(f"d_kt{axle}", 0.0)


def _rest(model: NonlinearModel, values: Array, start: Array, heights: Array, held: Array) -> Array:
    """Return the rest position on blocks under a force, X from the empty vehicle at rest on the ground, shape (coordinate,)."""
    forces, matrices = model.forces, model.linear.matrices(values)
    K = matrices.K
    G, directions = forces.rows.at(values), forces.directions(values)
    offsets = model.travel_offsets(values)[0]
    layout = layout_of(model.names)
    given = dict(zip(model.names, values.tolist(), strict=True))
    tyres = np.array([_tyre_rate(given, wheel) for wheel in layout.wheels])
    load = -K @ model.sag(values) - held
    load[layout.wheels_at] -= tyres * heights
    # Travels of tyres count from where they touch the ground: here, the blocks.
    raised = forces.weightless * (G[:, layout.wheels_at] @ heights)
    X = start
    for _ in range(_ITERATIONS):
        travel = G @ X - raised + offsets
        zero = np.zeros_like(travel)
        found = forces.at(values).evaluate(ElementInput(travel, zero, zero, np.zeros(forces.memories)))
        residual = K @ X + load + directions.T @ found.force
        X = X - matrices._replace(K=K + (directions.T * found.by_travel) @ G).deflection(residual)
        if np.abs(residual).max() < 1e-9 * np.abs(load).max():
            break
    return X


def _sample(
    models: Sequence[NonlinearModel],
    kind: NDArray[np.int64],
    values: Array,
    states: Array,
    step: float,
    samples: int,
    start: float,
    drives: Sequence[Drive | None] = (),
) -> list[Motion]:
    every = max(math.ceil(step / _LONGEST_STEP), 1)
    memories = np.zeros((len(states), models[0].forces.memories))
    driven = [_Driven(models[which], values, one) for which, one in zip(kind.tolist(), drives, strict=False)]
    if start > 0:
        before = Stepper.of(models, [start / every] * len(models), kind, values).integrate(
            states, memories, every, _step_drive(driven, start / every, every)
        )
        states, memories = before.states[-1], before.memories[-1]
    stepper = Stepper.of(models, [step / every] * len(models), kind, values)
    steps = every * (samples - 1)
    trajectory = stepper.integrate(states, memories, steps, _step_drive(driven, step / every, steps, start))
    motions = []
    for drop, which in enumerate(kind.tolist()):
        X, forces = trajectory.states[::every, drop].T, trajectory.forces[::every, drop].T
        highest = models[which].accelerations(values)[0] @ np.vstack([X, forces, np.ones((1, X.shape[1]))])
        if driven:
            times: Array = np.asarray(start + step * np.arange(samples))
            leading = models[which].linear.matrices(values).leading
            highest += np.linalg.solve(leading, np.asarray(driven[drop].forces(times)))
        sag, m = models[which].sag(values)[:, None], models[which].linear.massive
        # Coordinates without mass have velocities by the equations of motion, and accelerations that nothing measures.
        velocity = np.vstack([X[len(sag) :], highest[m:]])
        acceleration = np.vstack([highest[:m], np.gradient(highest[m:], step, axis=1)])
        motions.append(Motion(X[: len(sag)] - sag, velocity, acceleration))
    return motions


@dataclass(frozen=True, eq=False)
class _Driven:
    """A model with parameter values, and what drives it: nothing where that is None."""

    model: NonlinearModel
    values: Array
    drive: Drive | None

    @property
    def _layout(self) -> Layout:
        return layout_of(self.model.names)

    def forces(self, times: Array) -> Array:
        """Return the force on each coordinate at times, s: the signals, and what linear tyres add on a bump; N."""
        n = len(self.model.linear.heave)
        if self.drive is None:
            return np.zeros((n, len(times)))
        value, rate = self.drive.values(times)
        found: Array = self.drive.forces @ value
        parameters = dict(zip(self.model.names, self.values.tolist(), strict=True))
        for place, wheel in enumerate(self._layout.wheels):
            damping = parameters.get(f"c_t{STATIONS[wheel].axle}", 0.0)
            raised = _tyre_rate(parameters, wheel) * value + damping * rate
            found[self._layout.wheels_at.start + place] += self.drive.heights[place] @ raised
        return found

    def increments(self, step: float, times: Array) -> Array:
        """Return what it adds to the state over each step between times, the forces running linearly, (step, state)."""
        A = self.model.linear.matrices(self.values).state
        n, state, forces = len(self.model.linear.heave), len(A), self.forces(times)
        leading = self.model.linear.matrices(self.values).leading
        B = np.zeros((state, n))
        B[highest_derivatives(n, self.model.linear.massive)] = np.linalg.inv(leading)
        generator = np.zeros((state + 2 * n, state + 2 * n))
        generator[:state, :state], generator[:state, state : state + n] = A * step, B * step
        generator[state : state + n, state + n :] = np.eye(n)
        exponential = expm(generator)
        held, ramp = exponential[:state, state : state + n], exponential[:state, state + n :]
        found: Array = (held @ forces[:, :-1] + ramp @ np.diff(forces, axis=1)).T
        return found

    def inputs(self, times: Array) -> Array:
        """Return what it adds to travels and rates of the elements between wheel and ground, shape (time, 2 row)."""
        rows, at = self.model.forces.rows.at(self.values), self._layout.wheels_at
        if self.drive is None:
            return np.zeros((len(times), 2 * len(rows)))
        # The rows of tyres are those of a wheel and nothing else.
        others = np.abs(np.delete(rows, np.arange(at.start, at.stop), axis=1)).sum(axis=1)
        of_tyre = np.where(others[:, None] > 0, 0.0, rows[:, at])
        lifted = -of_tyre @ self.drive.heights
        value, rate = self.drive.values(times)
        return np.vstack([lifted @ value, lifted @ rate]).T


def _step_drive(driven: Sequence[_Driven], step: float, steps: int, start: float = 0.0) -> StepDrive | None:
    if not driven:
        return None
    times: Array = np.asarray(start + step * np.arange(steps + 1))
    increments = np.stack([one.increments(step, times) for one in driven], axis=1)
    return StepDrive(increments, np.stack([one.inputs(times) for one in driven], axis=1))
