"""Finite rotation: what sensors read to second order in the angles, beyond the linear equations of motion.

The motion is X₁ + X₂ with X₁ of first order, the linear free vibration, and X₂ of second order. X₂ obeys the linear equations
of motion with the second-order inertia and suspension forces of X₁ as their input, so that it follows without iteration
(regular perturbation: Nayfeh and Mook, Nonlinear Oscillations, 1979, section 2.3). Wheels slide along the body's own vertical
axis and tyres press vertically. Pitch comes first, then roll: a point of the body at (x, y, h) from the centre of gravity is at
the height z - x sin θ + y cos θ sin φ + h cos θ cos φ.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import kinematics
from sprung.vehicle.heights import Heights
from sprung.vehicle.layout import WHEELS, LinearLaw, Tracks, Wheel, half_distances, wheelbase_of
from sprung.vehicle.load import Load
from sprung.vehicle.model import LinearModel, Matrices, Rows, highest_derivatives
from sprung.vehicle.readout import sensor_rows
from sprung.vehicle.sensor import Sensor

Array = NDArray[np.float64]

_PITCH, _ROLL = 1, 2
"""Positions of the angles among the coordinates."""

_VALUE, _RATE, _SECOND = 0, 1, 2
"""Positions of displacements and of their first and second derivatives by time in signals, shape (3, ..., time)."""

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


def second_order_readings(
    model: LinearModel,
    tracks: Tracks,
    heights: Heights,
    load: Load,
    sensors: Sequence[Sensor],
    values: Array,
    motions: Sequence[Array],
    step: float,
) -> list[Array]:
    """Return what accelerometers read to second order beyond the linear equations of motion.

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
    motion, ends = np.hstack(motions), np.cumsum([one.shape[1] for one in motions])[:-1]
    matrices = model.matrices(values)
    n, m = len(matrices.M), model.massive
    A, leading_inverse = matrices.state_and_leading_inverse(m)
    # Where no mass is, the velocity follows from the displacements, and there is no acceleration to be known.
    rates = A @ motion
    signals = np.stack([motion[:n], rates[:n], np.vstack([rates[n:], np.zeros_like(motion[: n - m])])])
    springs, dampers = -_travels(model, tracks, "spring", values), -_travels(model, tracks, "damper", values)
    moved = model.unconstrained_motion(values)
    # Forward displacement of the centre of gravity per pitch angle, and the sideways one per roll angle, m/rad.
    drift = float(moved[0, _PITCH]), float(moved[1, _ROLL])
    half = _half_square(signals)
    forces = [
        _suspension_forces(model, heights, values, matrices, springs, dampers, signals, half),
        _inertia_forces(model, heights, load, values, springs, drift, signals, half),
    ]
    directions = np.hstack([columns for columns, _ in forces])
    inputs = np.zeros((len(A), directions.shape[1]))
    inputs[highest_derivatives(n, m)] = leading_inverse @ directions
    rows = np.zeros((len(sensors), len(A)))
    # The others read a motion, not the rate of a velocity: to them the second order is of no account.
    accelerometers = np.array([sensor.reads_gravity for sensor in sensors])[:, None]
    wheelbase = wheelbase_of(model.names, values.tolist())
    rows[:, n:] = accelerometers * sensor_rows(sensors, model.names, wheelbase).at(values)[:, :m]
    readings = _forced_rates(A, inputs, np.vstack([series for _, series in forces]), rows, step, ends)
    turning = accelerometers * _sensor_rotation(heights, sensors, drift, signals, half)
    return np.split(readings + turning, ends, axis=1)


def _sensor_rotation(
    heights: Heights, sensors: Sequence[Sensor], drift: tuple[float, float], signals: Array, half: Array
) -> Array:
    """Return what sensors read because they turn with the body: specific force along its axis, and centripetal acceleration."""
    pitch, roll = signals[:, _PITCH], signals[:, _ROLL]
    forward, sideways = drift
    arms = [
        (heights.wheel_arms[1], 0.0) if sensor.position is None else (0.0, -_above_centre(heights, sensor.position[2]))
        for sensor in sensors
    ]
    swung = pitch[_VALUE] * pitch[_SECOND], roll[_VALUE] * roll[_SECOND]
    centripetal = pitch[_RATE] ** 2 + roll[_RATE] ** 2
    of_all = forward * swung[0] - sideways * swung[1] - STANDARD_GRAVITY * half[_VALUE]
    readings: Array = of_all + np.array(arms) @ np.vstack([swung[0] + swung[1], centripetal])
    return readings


def _suspension_forces(
    model: LinearModel,
    heights: Heights,
    values: Array,
    matrices: Matrices,
    springs: Array,
    dampers: Array,
    signals: Array,
    half: Array,
) -> tuple[Array, Array]:
    """Return the second-order generalised forces of springs and dampers: directions times series.

    The compression is q = (q₁ + d)(1 + (θ² + φ²)/2) - d to third order, with the linear q₁ and the height d of the wheel's
    centre above the body's centre of gravity.

    Returns
    -------
    directions
        SI, shape (coordinate, direction).
    series
        Shape (direction, time).
    """
    arm = heights.wheel_arms[1]
    rates = _by_axle(model, "k_s", values)
    static = rates * -(springs @ matrices.deflection(matrices.M @ model.heave * STANDARD_GRAVITY))
    by_spring = -(static + rates * arm) @ springs
    by_damper = -arm * _by_axle(model, "c_s", values) @ dampers
    force = by_spring @ signals[_VALUE] + by_damper @ signals[_RATE]
    directions = np.column_stack([by_spring, by_damper, *_angles(model)])
    return directions, np.vstack([half[_VALUE], half[_RATE], force * signals[_VALUE][[_PITCH, _ROLL]]])


def _inertia_forces(
    model: LinearModel,
    heights: Heights,
    load: Load,
    values: Array,
    springs: Array,
    drift: tuple[float, float],
    signals: Array,
    half: Array,
) -> tuple[Array, Array]:
    """Return the second-order generalised inertia forces of wheels and items of the load, as `_suspension_forces` does.

    A mass whose displacement along an axis is u₁ + u₂ acts with -m (ü₁ ∂u₂/∂X + ü₂ ∂u₁/∂X). All wheels together act as their
    first moments do: both wheels of an axle cancel what their half-distance adds.
    """
    by_pitch, by_roll = _angles(model)
    if not heights.has_effect:
        return np.zeros((len(by_pitch), 0)), np.zeros((0, signals.shape[2]))
    pitch, roll = signals[:, _PITCH], signals[:, _ROLL]
    forward, sideways = drift
    own = dict(zip(model.names, values.tolist(), strict=True))
    items = [(one.mass, *one.position) for one in load.items if one.position is not None]
    mass, x, y, z = np.array(items).reshape(-1, 4).T
    x = x + own["a"]
    height = np.array([_above_centre(heights, one) for one in z.tolist()])
    # Wheels: u₁ = arm times the angle along both axes, u₂ with their travel.
    arm, masses = heights.wheel_arms[1], _by_axle(model, "m_u", values)
    of_wheels = masses @ springs
    distances = masses @ np.array([own["a"] if station[0] == "f" else -own["b"] for station in WHEELS])
    q, ahead, aside = of_wheels @ signals, forward + arm, sideways - arm
    # Items: of their weights on the body, and of their places.
    lifted = np.zeros(len(by_pitch))
    lifted[[0, _PITCH, _ROLL]] = (mass * height) @ np.column_stack([np.ones_like(x), -x, y])
    tilting = lifted @ signals[_SECOND]
    along = (mass * x) @ (forward + height) + distances * ahead
    across = (mass * y) @ (sideways - height)

    def by_angle(angle: Array, arm: float, squared: float) -> Array:
        """Return the moment about an axis of what moves along the other one as the body turns."""
        twice = 2 * angle[_SECOND] * angle[_VALUE] + angle[_RATE] ** 2
        moved = angle[_SECOND] * q[_VALUE] + _second_of_product(q, angle)
        moment: Array = tilting * angle[_VALUE] + squared * twice + arm * moved
        return moment

    directions = np.column_stack([lifted, -ahead * of_wheels, aside * of_wheels, by_pitch, by_roll])
    series = [
        half[_SECOND],
        pitch[_SECOND] * pitch[_VALUE],
        roll[_SECOND] * roll[_VALUE],
        by_angle(pitch, -ahead, along),
        by_angle(roll, aside, across),
    ]
    return directions, np.vstack(series)


def _angles(model: LinearModel) -> Array:
    """Return the directions of pitch and roll among the coordinates, shape (2, coordinate)."""
    return np.eye(len(model.heave))[[_PITCH, _ROLL]]


def _second_of_product(one: Array, other: Array) -> Array:
    """Return the second derivative of the product of two signals, by Leibniz's rule."""
    second: Array = one[_SECOND] * other[_VALUE] + 2 * one[_RATE] * other[_RATE] + one[_VALUE] * other[_SECOND]
    return second


def _half_square(signals: Array) -> Array:
    """Return half the sum of both squared angles, and its derivatives by time, shape (3, time)."""
    value, rate, second = signals[:, [_PITCH, _ROLL]]
    half: Array = np.stack([0.5 * (value * value), rate * value, second * value + rate * rate]).sum(axis=1)
    return half


def _above_centre(heights: Heights, height: float) -> float:
    """Return a height above the centre of gravity, m; 0 where that is not known."""
    return height - heights.cg_height if heights.has_effect and heights.cg_height is not None else 0.0


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


def _forced_rates(
    A: Array, inputs: Array, series: Array, rows: Array, step: float, ends: Sequence[int] | Array
) -> Array:
    """Return C Ẏ of Ẏ = A Y + B u from rest, u running linearly between samples, with C the rows and B the inputs.

    Shapes (state, input), (input, time) and (row, state) to (row, time); from rest again behind each of the `ends`.
    """
    poles, vectors = np.linalg.eig(A)
    # A pole and its conjugate add the same real part twice.
    upper = np.imag(poles) >= 0
    weights = np.linalg.inv(vectors)[upper] @ inputs
    modal = weights.real @ series + 1j * (weights.imag @ series)
    poles, output = poles[upper].astype(complex), (rows @ vectors[:, upper]).astype(complex)
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
    output *= poles * np.where(poles.imag > 0, 2.0, 1.0)
    forced: Array = output.real @ states.real - output.imag @ states.imag + rows @ inputs @ series
    return forced
