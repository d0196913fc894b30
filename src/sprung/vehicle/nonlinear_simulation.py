"""Drops and decays of a vehicle with nonlinear forces: stepped so finely that nothing of it shows.

With dry friction, uneven dampers or springs that stiffen there are no exact pieces to put together as in `drop_from_blocks`.
All motions are stepped at once; the ground, which pushes and never pulls, is one more force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.elements import (
    NonlinearElement,
    ground_contact_elements,
    nonlinear_elements,
    seven_degrees_of_freedom,
)
from sprung.vehicle.force_laws import ElementInput
from sprung.vehicle.ground import Ground
from sprung.vehicle.kinematics import WHEELS, WHEELS_AT, Wheel
from sprung.vehicle.load import Load
from sprung.vehicle.nonlinear import NonlinearModel
from sprung.vehicle.response import Motion
from sprung.vehicle.stepping import Stepper
from sprung.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]

_FINEST = 2e-4
"""s of a step at most."""

_SETTLING = 60
"""Newton steps to find how a vehicle rests on its blocks."""


class BlockSupport(NamedTuple):
    """How a vehicle rests before it is dropped.

    Attributes
    ----------
    load
        What is on it.
    wheels
        Which of them have blocks under them.
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
    """Release a vehicle from blocks, several times, and sample what follows.

    Parameters
    ----------
    vehicle
        With forces that no matrix carries.
    blocks
        How it rests each time; friction holds nothing then.
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
        Displacement from where the vehicle rests with its load, velocity and acceleration, each (coordinate, samples).
    """
    names, values = tuple(vehicle.parameters), np.array(list(vehicle.parameters.values()))
    on_ground = ground_contact_elements(vehicle.extras)
    loads = list({block.load.name: block.load for block in blocks}.values())
    models = [_model(vehicle, names, on_ground, load, gravity) for load in loads]
    kind = np.array([[load.name for load in loads].index(block.load.name) for block in blocks])
    n = len(models[0].sag(values))
    begin = np.zeros((len(blocks), 2 * n))
    for state, block, which in zip(begin, blocks, kind, strict=True):
        rest = Ground.under(vehicle, block.load, gravity).rest(_heights(block)) + models[which].sag(values)
        state[:n] = _at_rest(models[which], values, rest, _heights(block))
    return _sampled(models, kind, values, begin, step, samples, start)


def simulate_nonlinear_decays(
    vehicle: Vehicle, loads: Sequence[Load], states: Array, step: float, samples: int
) -> list[Motion]:
    """Let a vehicle vibrate from given states, tyres always on the ground.

    Parameters
    ----------
    vehicle
        With forces that no matrix carries.
    loads
        What is on it each time.
    states
        {X, Ẋ} from where it rests with its load, SI, shape (decay, 2n); friction holds nothing at first.
    step
        Sampling interval, s.
    samples
        How many samples.

    Returns
    -------
    list of Motion
        One for each state.
    """
    names, values = tuple(vehicle.parameters), np.array(list(vehicle.parameters.values()))
    different = list({load.name: load for load in loads}.values())
    models = [_model(vehicle, names, (), load, STANDARD_GRAVITY) for load in different]
    kind = np.array([[load.name for load in different].index(load.name) for load in loads])
    begin, sag = states.copy(), np.array([model.sag(values) for model in models])[kind]
    begin[:, : sag.shape[1]] += sag
    return _sampled(models, kind, values, begin, step, samples, 0.0)


def _model(
    vehicle: Vehicle, names: tuple[str, ...], more: Sequence[NonlinearElement], load: Load, gravity: float
) -> NonlinearModel:
    elements = seven_degrees_of_freedom(vehicle.tracks, vehicle.extras, vehicle.heights)
    forces = [*nonlinear_elements(vehicle.tracks, vehicle.extras), *more]
    return NonlinearModel.of(elements, forces, names, load, vehicle.heights, gravity)


def _heights(block: BlockSupport) -> Array:
    return np.array([block.height if station in block.wheels else 0.0 for station in WHEELS])


def _at_rest(model: NonlinearModel, values: Array, rest: Array, heights: Array) -> Array:
    """Find how a vehicle rests on blocks, X from the empty one at rest on the ground; shape (coordinate,)."""
    forces, K = model.forces, model.linear.matrices(values).K
    G, offsets = forces.rows.at(values), model.offsets(values)[0]
    tyres = np.array([values[model.names.index(f"k_t{station[0]}")] for station in WHEELS])
    pull = -K @ model.sag(values)
    pull[WHEELS_AT] -= tyres * heights
    lifted = np.zeros(forces.number)
    lifted[-4:] = heights
    X = rest
    for _ in range(_SETTLING):
        travel = G @ X - lifted + offsets
        nothing = np.zeros_like(travel)
        answer = forces.answer(values, ElementInput(travel, nothing, nothing, nothing))
        left = K @ X + pull + G.T @ answer.force
        X = X - np.linalg.solve(K + (G.T * answer.by_travel) @ G, left)
        if np.abs(left).max() < 1e-9 * np.abs(pull).max():
            break
    return X


def _sampled(
    models: Sequence[NonlinearModel],
    kind: NDArray[np.int64],
    values: Array,
    begin: Array,
    step: float,
    samples: int,
    start: float,
) -> list[Motion]:
    every = max(math.ceil(step / _FINEST), 1)
    memories = np.zeros((len(begin), len(models[0].forces.remembering)))
    if start > 0:
        first = Stepper.of(models, [start / every] * len(models), kind, values).follow(begin, memories, every)
        begin, memories = first.states[-1], first.memories[-1][:, models[0].forces.remembering]
    stepper = Stepper.of(models, [step / every] * len(models), kind, values)
    path = stepper.follow(begin, memories, every * (samples - 1))
    motions = []
    for drop, which in enumerate(kind.tolist()):
        states, forces = path.states[::every, drop].T, path.forces[::every, drop].T
        rows = models[which].accelerations(values)[0]
        acceleration = rows @ np.vstack([states, forces, np.ones((1, states.shape[1]))])
        sag = models[which].sag(values)[:, None]
        motions.append(Motion(states[: len(sag)] - sag, states[len(sag) :], acceleration))
    return motions
