"""Finite rotation: what sensors read beyond the linear equations of motion, as the body turns by finite angles.

The motion is X₁ + X₂, where X₁ is the linear free vibration. X₂ obeys the linear equations of motion with the forces as their
input that these leave out (`TurnedBody`). Those depend on the whole motion: for X₁ alone they leave out the third order in the
angles, for X₁ + X₂ the fourth (Picard's iteration). Angles are those from level: a load tilts the body as far as
a drop does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import cast

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import kinematics
from sprung.vehicle.heights import Heights
from sprung.vehicle.layout import STATIONS, WHEELS, LinearLaw, Tracks, Wheel, half_distances, wheelbase_of
from sprung.vehicle.load import Load
from sprung.vehicle.model import LinearModel, Rows, highest_derivatives
from sprung.vehicle.readout import sensor_rows
from sprung.vehicle.sensor import Sensor
from sprung.vehicle.turned_body import BODY, MOVING, Points, Struts, TurnedBody

Array = NDArray[np.float64]

_PASSES = 2
"""Evaluations of the forces: a third would change readings by the fourth order, 1e-6 of the first at 0.03 rad."""

_PROBE = 1e-3
"""m, rad and their rates, of central differences: what they leave out is of the third order, 1e-6."""

_PITCH, _ROLL = 1, 2
"""Positions of the angles among the coordinates."""

_STILL = 1e-6
"""Pole times step below which a mode does not move within a step."""


def body_sinking(empty: LinearModel, loaded: LinearModel, tracks: Tracks, values: Array) -> float:
    """Return how much lower the body rests on its wheels under a load, m.

    Parameters
    ----------
    empty, loaded
        Equations of motion without and with the load.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    values
        Parameters, SI, shape (parameter,).

    Returns
    -------
    float
        Mean of the wheels, each with the force of its spring: with that, the moment of gravity changes.
    """
    with_load = loaded.matrices(values)
    masses = np.array([with_load.M, with_load.M - empty.matrices(values).M])
    weights = STANDARD_GRAVITY * masses @ loaded.heave
    compressions = _travels(loaded, tracks, "spring", values) @ with_load.deflection(weights.T)
    force = _by_axle(loaded, "k_s", values) * compressions[:, 0]
    return float(force @ compressions[:, 1] / force.sum())


def finite_rotation_readings(
    model: LinearModel,
    tracks: Tracks,
    heights: Heights,
    load: Load,
    sensors: Sequence[Sensor],
    values: Array,
    motions: Sequence[Array],
    step: float,
) -> list[Array]:
    """Return what accelerometers read beyond the linear equations of motion.

    Parameters
    ----------
    model
        Linear equations of motion with the load.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    heights
        With the effect of the load.
    load
        What is on the vehicle.
    sensors
        The accelerometers.
    values
        Parameters, SI, shape (parameter,).
    motions
        {X, Ẋ} of the linear vehicle in each drop with the load, SI, shape (state, time) each.
    step
        Sampling interval, s.

    Returns
    -------
    list of ndarray
        m/s², shape (sensor, time), one for each drop.
    """
    free, ends = np.hstack(motions), np.cumsum([one.shape[1] for one in motions])[:-1]
    matrices = model.matrices(values)
    n, m = len(matrices.M), model.massive
    A, leading_inverse = matrices.state_and_leading_inverse(m)
    inputs = np.zeros((len(A), MOVING))
    inputs[highest_derivatives(n, m)] = -leading_inverse[:, :MOVING]
    body = turned_body(model, tracks, heights, load, values)
    on_body = [sensor for sensor in sensors if sensor.reads_gravity and sensor.position is not None]
    points = _points(
        [(0.0, *sensor.position) for sensor in on_body if sensor.position is not None], heights, values, model
    )
    level = replace(body, tilt=(0.0, 0.0))
    linear_forces, linear_readings = _linear_part(level.forces), _linear_part(lambda one: level.readings(one, points))

    def signals(forced: Array, rates: Array) -> Array:
        return np.stack([(free + forced)[:MOVING], rates[:MOVING], rates[n : n + MOVING]])

    forced, rates = np.zeros_like(free), A @ free
    for _ in range(_PASSES):
        motion = signals(forced, rates)
        forces = body.forces(motion) - np.tensordot(linear_forces, motion, axes=2)
        forced = _forced_motion(A, inputs, forces, step, ends)
        added = A @ forced + inputs @ forces
        rates = A @ free + added
    motion = signals(forced, rates)
    turning = body.readings(motion, points) - np.tensordot(linear_readings, motion, axes=2)
    # Sensors of other kinds read a motion, not the rate of a velocity: to them finite rotation is of no account.
    accelerometers = np.array([sensor.reads_gravity for sensor in sensors])[:, None]
    places = [
        on_body.index(sensor) if sensor in on_body else len(on_body) + WHEELS.index(cast(Wheel, sensor.on))
        for sensor in sensors
        if sensor.reads_gravity
    ]
    rows = sensor_rows(sensors, model.names, wheelbase_of(model.names, values.tolist())).at(values)[:, :m]
    readings = np.where(accelerometers, rows @ added[n:], 0.0)
    readings[accelerometers[:, 0]] += turning[places]
    return np.split(readings, ends, axis=1)


def turned_body(model: LinearModel, tracks: Tracks, heights: Heights, load: Load, values: Array) -> TurnedBody:
    """Return a vehicle with its load, as it stands, in all that finite rotation changes; arguments as for its readings."""
    own, matrices = dict(zip(model.names, values.tolist(), strict=True)), model.matrices(values)
    items = _points(
        [(one.mass, *one.position) for one in load.items if one.position is not None], heights, values, model
    )
    weights = np.zeros(len(model.heave))
    weights[:BODY] = -STANDARD_GRAVITY * items.mass @ np.column_stack([np.ones_like(items.x), -items.x, items.y])
    tilt = matrices.deflection(weights)[[_PITCH, _ROLL]]
    distances = half_distances(tracks)
    sides = np.array([STATIONS[station].side for station in WHEELS])
    y = {law: sides * [own[distances[station[0], law]] for station in WHEELS] for law in ("spring", "damper")}
    x = np.array([own["a"] if station[0] == "f" else -own["b"] for station in WHEELS])
    bars = np.array([own.get(f"k_a{station[0]}", 0.0) for station in WHEELS])
    on_one_axle = np.equal.outer(x, x) * np.outer(sides, sides)
    springs = np.diag(_by_axle(model, "k_s", values)) + bars * on_one_axle
    deflection = matrices.deflection(matrices.M @ model.heave * STANDARD_GRAVITY)
    unsprung = _by_axle(model, "m_u", values)
    return TurnedBody(
        mass=own["m_s"] + float(unsprung.sum() + items.mass.sum()),
        tilt=(float(tilt[0]), float(tilt[1])),
        wheels=Points(x, y["spring"], np.full(len(x), heights.wheel_arms[1]), unsprung),
        springs=Struts(y["spring"], springs),
        dampers=Struts(y["damper"], np.diag(_by_axle(model, "c_s", values))),
        preload=springs @ _travels(model, tracks, "spring", values) @ deflection,
        items=items,
    )


def _points(
    places: Sequence[tuple[float, float, float, float]], heights: Heights, values: Array, model: LinearModel
) -> Points:
    """Return points by their masses and their places in a campaign file."""
    mass, x, y, z = np.array(places).reshape(-1, 4).T
    level = heights.cg_height if heights.has_effect else None
    return Points(x + values[model.names.index("a")], y, np.zeros_like(z) if level is None else z - level, mass)


def _linear_part(function: Callable[[Array], Array]) -> Array:
    """Return the derivatives at rest of a function of a motion, shape (result, 3, coordinate): central differences."""
    probes = _PROBE * np.eye(3 * MOVING).reshape(3, MOVING, -1)
    there, back = np.split(function(np.concatenate([probes, -probes], axis=2)), 2, axis=1)
    slopes: Array = (there - back) / (2 * _PROBE)
    return slopes.reshape(-1, 3, MOVING)


def _travels(model: LinearModel, tracks: Tracks, law: LinearLaw, values: Array) -> Array:
    """Return the rows of the suspension travel at each wheel, shape (wheel, coordinate)."""
    distances = half_distances(tracks)
    rows = [kinematics.travel(station, distances[station[0], law]) for station in WHEELS]
    return Rows.of(rows, model.names).at(values)


def _by_axle(model: LinearModel, letter: str, values: Array) -> Array:
    """Return a parameter of the axles at each wheel, shape (wheel,)."""

    def at(station: Wheel) -> int:
        return model.names.index(f"{letter}{station[0]}")

    return values[[at(station) for station in WHEELS]]


def _forced_motion(A: Array, inputs: Array, series: Array, step: float, ends: Sequence[int] | Array) -> Array:
    """Return Y of Ẏ = A Y + B u from rest, u running linearly between samples, with B the inputs.

    Shapes (state, input) and (input, time) to (state, time); from rest again behind each of the `ends`.
    """
    poles, vectors = np.linalg.eig(A)
    # A pole and its conjugate add the same real part twice.
    upper = np.imag(poles) >= 0
    weights = np.linalg.inv(vectors)[upper] @ inputs
    modal = weights.real @ series + 1j * (weights.imag @ series)
    poles, output = poles[upper].astype(complex), vectors[:, upper].astype(complex)
    z = poles[:, None] * step
    turn = np.exp(z)[:, :, None]
    # Weights of u at the beginning and at the end of a step: integrals of exp(λ (step - t)) times a linear function.
    z = np.where(np.abs(z) < _STILL, _STILL, z)
    before, after = step * (np.exp(z) * (z - 1) + 1) / z**2, step * (np.exp(z) - 1 - z) / z**2
    bounds = list(pairwise([0, *ends, modal.shape[1]]))
    longest = max(end - begin for begin, end in bounds)
    apart = np.zeros((len(poles), len(bounds), longest), dtype=np.complex128)
    for drop, (begin, end) in enumerate(bounds):
        apart[:, drop, 1 : end - begin] = before * modal[:, begin : end - 1] + after * modal[:, begin + 1 : end]
    # What is left of each step, over twice as many of them each time.
    reach = 1
    while reach < longest:
        apart[..., reach:] += turn * apart[..., :-reach]
        turn, reach = turn * turn, 2 * reach
    states = np.hstack([apart[:, drop, : end - begin] for drop, (begin, end) in enumerate(bounds)])
    output *= np.where(poles.imag > 0, 2.0, 1.0)
    forced: Array = output.real @ states.real - output.imag @ states.imag
    return forced
