"""Drops and decays of a vehicle with nonlinear elements, by time steps short enough to leave no visible error.

With dry friction, rebound damping or progressive springs there are no linear segments as in `drop_from_blocks`. All motions
are stepped at once; the ground, which pushes and never pulls, is one more nonlinear element.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.simulation.ground import Ground
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import (
    STATIONS,
    ElementInput,
    Load,
    Motion,
    NonlinearElement,
    NonlinearModel,
    Stepper,
    Vehicle,
    Wheel,
    ground_contact_elements,
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


def simulate_nonlinear_drops(
    vehicle: Vehicle,
    blocks: Sequence[BlockSupport],
    step: float,
    samples: int,
    start: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> list[Motion]:
    """Simulate several drops from blocks of a vehicle with nonlinear elements.

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
    for state, block, which in zip(states, blocks, kind, strict=True):
        heights = np.array([block.height if station in block.wheels else 0.0 for station in vehicle.layout.wheels])
        linear = Ground.under(vehicle, block.load, gravity).rest(heights) + models[which].sag(values)
        state[: len(linear)] = _rest(models[which], values, linear, heights)
    return _sample(models, kind, values, states, step, samples, start)


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
            NonlinearModel.of(elements + further, [*nonlinear, *contact], names, load, vehicle.heights, gravity)
        )
    order = [load.name for load in different]
    return models, np.array([order.index(load.name) for load in loads])


def _rest(model: NonlinearModel, values: Array, start: Array, heights: Array) -> Array:
    """Return the rest position on blocks, X from the empty vehicle at rest on the ground, shape (coordinate,)."""
    forces, matrices = model.forces, model.linear.matrices(values)
    K = matrices.K
    G, directions = forces.rows.at(values), forces.directions(values)
    offsets = model.travel_offsets(values)[0]
    layout = layout_of(model.names)
    tyres = np.array([values[model.names.index(f"k_t{STATIONS[wheel].axle}")] for wheel in layout.wheels])
    load = -K @ model.sag(values)
    load[layout.wheels_at] -= tyres * heights
    raised = np.zeros(forces.number)
    raised[-len(heights) :] = heights
    X = start
    for _ in range(_ITERATIONS):
        travel = G @ X - raised + offsets
        zero = np.zeros_like(travel)
        found = forces.evaluate(forces.parameters(values), ElementInput(travel, zero, zero, np.zeros(forces.memories)))
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
) -> list[Motion]:
    every = max(math.ceil(step / _LONGEST_STEP), 1)
    memories = np.zeros((len(states), models[0].forces.memories))
    if start > 0:
        before = Stepper.of(models, [start / every] * len(models), kind, values).integrate(states, memories, every)
        states, memories = before.states[-1], before.memories[-1]
    stepper = Stepper.of(models, [step / every] * len(models), kind, values)
    trajectory = stepper.integrate(states, memories, every * (samples - 1))
    motions = []
    for drop, which in enumerate(kind.tolist()):
        X, forces = trajectory.states[::every, drop].T, trajectory.forces[::every, drop].T
        highest = models[which].accelerations(values)[0] @ np.vstack([X, forces, np.ones((1, X.shape[1]))])
        sag, m = models[which].sag(values)[:, None], models[which].linear.massive
        # Coordinates without mass have velocities by the equations of motion, and accelerations that nothing measures.
        velocity = np.vstack([X[len(sag) :], highest[m:]])
        acceleration = np.vstack([highest[:m], np.gradient(highest[m:], step, axis=1)])
        motions.append(Motion(X[: len(sag)] - sag, velocity, acceleration))
    return motions
