"""Finite rotation: what sensors read to second order in the angles, beyond the linear equations of motion.

The motion is X₁ + X₂ with X₁ of first order, the linear free vibration, and X₂ of second order. X₂ obeys the linear equations
of motion with the second-order inertia and suspension forces of X₁ as their input, so that it follows without iteration
(regular perturbation: Nayfeh and Mook, Nonlinear Oscillations, 1979, section 2.3). Wheels slide along the body's own vertical
axis and tyres press vertically. Pitch comes first, then roll: a point of the body at (x, y, h) from the centre of gravity is at
the height z - x sin θ + y cos θ sin φ + h cos θ cos φ.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import kinematics
from sprung.vehicle.elements import LinearLaw, Tracks, half_distances
from sprung.vehicle.heights import Heights
from sprung.vehicle.kinematics import WHEELS, Wheel
from sprung.vehicle.load import Load
from sprung.vehicle.model import LinearModel, Rows, highest_derivatives
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
    n, m, A = len(matrices.M), model.massive, matrices.state
    # Where no mass is, the velocity follows from the displacements, and there is no acceleration to be known.
    rates = A @ motion
    signals = np.stack([motion[:n], rates[:n], np.vstack([rates[n:], np.zeros_like(motion[: n - m])])])
    forces = _suspension_forces(model, tracks, heights, values, signals) + _inertia_forces(
        model, tracks, heights, load, values, signals
    )
    rows = Rows.of([sensor.row for sensor in sensors], model.names).at(values)
    inputs = np.zeros_like(motion)
    inputs[highest_derivatives(n, m)] = np.linalg.solve(matrices.leading, forces)
    readings = rows[:, :m] @ _forced_accelerations(A, inputs, step, ends)[n:]
    return np.split(readings + _sensor_rotation(model, heights, sensors, values, signals), ends, axis=1)


def _sensor_rotation(
    model: LinearModel, heights: Heights, sensors: Sequence[Sensor], values: Array, signals: Array
) -> Array:
    """Return what sensors read because they turn with the body: specific force along its axis, and centripetal acceleration."""
    pitch, roll = signals[:, _PITCH], signals[:, _ROLL]
    forward, sideways = _unconstrained_per_angle(model, values)
    tilt = forward * pitch[_VALUE] * pitch[_SECOND] - sideways * roll[_VALUE] * roll[_SECOND]
    leakage = STANDARD_GRAVITY * 0.5 * (pitch[_VALUE] ** 2 + roll[_VALUE] ** 2)
    readings = []
    for sensor in sensors:
        if sensor.position is None:
            arm = heights.wheel_arms[1]
            own = arm * (pitch[_VALUE] * pitch[_SECOND] + roll[_VALUE] * roll[_SECOND])
        else:
            own = -_above_centre(heights, sensor.position[2]) * (pitch[_RATE] ** 2 + roll[_RATE] ** 2)
        readings.append(tilt + own - leakage)
    return np.array(readings)


def _suspension_forces(model: LinearModel, tracks: Tracks, heights: Heights, values: Array, signals: Array) -> Array:
    """Return the second-order generalised forces of springs and dampers, SI, shape (coordinate, time).

    The compression is q = (q₁ + d)(1 + (θ² + φ²)/2) - d to third order, with the linear q₁ and the height d of the wheel's
    centre above the body's centre of gravity.
    """
    arm = heights.wheel_arms[1]
    half = _half_square(signals)
    tilt = np.zeros_like(signals[_VALUE])
    tilt[[_PITCH, _ROLL]] = signals[_VALUE][[_PITCH, _ROLL]]
    springs, dampers = -_travels(model, tracks, "spring", values), -_travels(model, tracks, "damper", values)
    rates, damping = _by_axle(model, "k_s", values), _by_axle(model, "c_s", values)
    matrices = model.matrices(values)
    static = rates * -(springs @ matrices.deflection(matrices.M @ model.heave * STANDARD_GRAVITY))
    forces: Array = np.zeros_like(signals[_VALUE])
    for spring, damper, k, c, held in zip(springs, dampers, rates, damping, static, strict=True):
        compression = spring @ signals[_VALUE]
        forces -= held * (np.outer(spring, half[_VALUE]) + compression * tilt)
        forces -= k * arm * (compression * tilt + np.outer(spring, half[_VALUE]))
        forces -= c * arm * ((damper @ signals[_RATE]) * tilt + np.outer(damper, half[_RATE]))
    return forces


def _inertia_forces(
    model: LinearModel, tracks: Tracks, heights: Heights, load: Load, values: Array, signals: Array
) -> Array:
    """Return the second-order generalised inertia forces of wheels and items of the load, SI, shape (coordinate, time).

    A mass whose displacement along an axis is u₁ + u₂ acts with -m (ü₁ ∂u₂/∂X + ü₂ ∂u₁/∂X).
    """
    if not heights.has_effect:
        return np.zeros_like(signals[_VALUE])
    units = np.eye(len(signals[_VALUE]))
    pitch, roll = signals[:, _PITCH], signals[:, _ROLL]
    by_pitch, by_roll = units[_PITCH], units[_ROLL]
    forward, sideways = _unconstrained_per_angle(model, values)
    own = dict(zip(model.names, values.tolist(), strict=True))
    forces: Array = np.zeros_like(signals[_VALUE])
    arm = heights.wheel_arms[1]
    masses = _by_axle(model, "m_u", values)
    for station, row, mass in zip(WHEELS, -_travels(model, tracks, "spring", values), masses, strict=True):
        x, q = own["a"] if station[0] == "f" else -own["b"], row @ signals
        # Both wheels of an axle cancel what their half-distance adds.
        first, second = (sideways - arm) * by_roll, -_product(q, roll)
        slope = -(np.outer(by_roll, q[_VALUE]) + np.outer(row, roll[_VALUE]))
        forces -= mass * ((first @ signals[_SECOND]) * slope + np.outer(first, second[_SECOND]))
        first, second = (forward + arm) * by_pitch, _product(q, pitch) - 0.5 * x * _product(pitch, pitch)
        slope = np.outer(by_pitch, q[_VALUE] - x * pitch[_VALUE]) + np.outer(row, pitch[_VALUE])
        forces -= mass * ((first @ signals[_SECOND]) * slope + np.outer(first, second[_SECOND]))
    for item in (one for one in load.items if one.position is not None):
        x, y, z = item.position or (0.0, 0.0, 0.0)
        x, height = x + own["a"], _above_centre(heights, z)
        vertical = units[0] - x * by_pitch + y * by_roll
        parts = [
            (vertical, -height * _half_square(signals), -height * _tilt(units, signals)),
            ((sideways - height) * by_roll, -0.5 * y * _product(roll, roll), -y * np.outer(by_roll, roll[_VALUE])),
            ((forward + height) * by_pitch, -0.5 * x * _product(pitch, pitch), -x * np.outer(by_pitch, pitch[_VALUE])),
        ]
        for first, second, slope in parts:
            forces -= item.mass * ((first @ signals[_SECOND]) * slope + np.outer(first, second[_SECOND]))
    return forces


def _product(one: Array, other: Array) -> Array:
    """Return the product of two signals, by Leibniz's rule."""
    rate = one[_RATE] * other[_VALUE] + one[_VALUE] * other[_RATE]
    second = one[_SECOND] * other[_VALUE] + 2 * one[_RATE] * other[_RATE] + one[_VALUE] * other[_SECOND]
    return np.stack([one[_VALUE] * other[_VALUE], rate, second])


def _half_square(signals: Array) -> Array:
    """Return half the sum of both squared angles."""
    pitch, roll = signals[:, _PITCH], signals[:, _ROLL]
    half: Array = 0.5 * (_product(pitch, pitch) + _product(roll, roll))
    return half


def _tilt(units: Array, signals: Array) -> Array:
    """Return the gradient of half the sum of both squared angles, shape (coordinate, time)."""
    tilt: Array = units[:, [_PITCH, _ROLL]] @ signals[_VALUE][[_PITCH, _ROLL]]
    return tilt


def _unconstrained_per_angle(model: LinearModel, values: Array) -> tuple[float, float]:
    """Return the forward displacement of the centre of gravity per pitch angle and the sideways one per roll angle, m/rad."""
    moved = model.unconstrained_motion(values)
    return float(moved[0, _PITCH]), float(moved[1, _ROLL])


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


def _forced_accelerations(A: Array, inputs: Array, step: float, ends: Sequence[int] | Array) -> Array:
    """Return Ẏ of Ẏ = A Y + u from rest, u running linearly between samples; shapes (state, time).

    From rest again behind each of the `ends`.
    """
    poles, vectors = np.linalg.eig(A)
    modal = np.linalg.solve(vectors, inputs.astype(complex))
    z = poles[:, None] * step
    decay = np.exp(z)
    # Weights of u at the beginning and at the end of a step: integrals of exp(λ (step - t)) times a linear function.
    z = np.where(np.abs(z) < _STILL, _STILL, z)
    before, after = step * (np.exp(z) * (z - 1) + 1) / z**2, step * (np.exp(z) - 1 - z) / z**2
    added = np.zeros_like(modal)
    added[:, 1:] = before * modal[:, :-1] + after * modal[:, 1:]
    added[:, ends] = 0.0
    parts = np.split(added, ends, axis=1)
    rows = np.zeros((len(poles), len(parts), max(part.shape[1] for part in parts)), dtype=complex)
    for number, part in enumerate(parts):
        rows[:, number, : part.shape[1]] = part
    filtered = np.stack(
        [lfilter([1.0], [1.0, -factor], row) for row, factor in zip(rows, decay[:, 0].tolist(), strict=True)]
    )
    states = np.hstack([filtered[:, number, : part.shape[1]] for number, part in enumerate(parts)])
    forced: Array = (vectors @ (poles[:, None] * states)).real + inputs
    return forced
