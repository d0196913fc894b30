"""Finite rotation: what sensors read to second order in the angles, beyond the linear equations of motion.

The motion is X₁ + X₂ with X₁ of first order, the linear free vibration, and X₂ of second order. X₂ obeys the linear equations
of motion with the second-order inertia and suspension forces of X₁ as their input, so that it follows without iteration
(regular perturbation: Nayfeh and Mook, Nonlinear Oscillations, 1979, section 2.3). Wheels slide along the body's own vertical
axis and tyres press vertically. Pitch comes first, then roll: a point of the body at (x, y, h) from the centre of gravity is at
the height z - x sin θ + y cos θ sin φ + h cos θ cos φ.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

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


_STILL = 1e-6
"""Pole times step below which a mode does not move within a step."""


class _Signal(NamedTuple):
    """A displacement and its first and second derivatives by time, SI, each of shape (..., time)."""

    value: Array
    rate: Array
    second: Array

    def __add__(self, other: _Signal) -> _Signal:  # type: ignore[override]
        return _Signal(*(one + two for one, two in zip(self, other, strict=True)))

    def __mul__(self, other: _Signal | float) -> _Signal:  # type: ignore[override]
        if not isinstance(other, _Signal):
            return _Signal(*(other * one for one in self))
        rate = self.rate * other.value + self.value * other.rate
        second = self.second * other.value + 2 * self.rate * other.rate + self.value * other.second
        return _Signal(self.value * other.value, rate, second)

    def along(self, row: Array) -> _Signal:
        """Return the signal of a displacement with a row, from that of all coordinates."""
        return _Signal(*(row @ one for one in self))


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
    signals = _Signal(motion[:n], rates[:n], np.vstack([rates[n:], np.zeros_like(motion[: n - m])]))
    forces = _suspension_forces(model, tracks, heights, values, signals) + _inertia_forces(
        model, tracks, heights, load, values, signals
    )
    rows = Rows.of([sensor.row for sensor in sensors], model.names).at(values)
    inputs = np.zeros_like(motion)
    inputs[highest_derivatives(n, m)] = np.linalg.solve(matrices.leading, forces)
    readings = rows[:, :m] @ _forced_accelerations(A, inputs, step, ends)[n:]
    return np.split(readings + _sensor_rotation(model, heights, sensors, values, signals), ends, axis=1)


def _sensor_rotation(
    model: LinearModel, heights: Heights, sensors: Sequence[Sensor], values: Array, signals: _Signal
) -> Array:
    """Return what sensors read because they turn with the body: specific force along its axis, and centripetal acceleration."""
    pitch, roll = (_Signal(*(one[angle] for one in signals)) for angle in (_PITCH, _ROLL))
    forward, sideways = _unconstrained_per_angle(model, values)
    tilt = forward * pitch.value * pitch.second - sideways * roll.value * roll.second
    leakage = STANDARD_GRAVITY * 0.5 * (pitch.value**2 + roll.value**2)
    readings = []
    for sensor in sensors:
        if sensor.position is None:
            arm = heights.wheel_arms[1]
            own = arm * (pitch.value * pitch.second + roll.value * roll.second)
        else:
            own = -_above_centre(heights, sensor.position[2]) * (pitch.rate**2 + roll.rate**2)
        readings.append(tilt + own - leakage)
    return np.array(readings)


def _suspension_forces(model: LinearModel, tracks: Tracks, heights: Heights, values: Array, signals: _Signal) -> Array:
    """Return the second-order generalised forces of springs and dampers, SI, shape (coordinate, time).

    The compression is q = (q₁ + d)(1 + (θ² + φ²)/2) - d to third order, with the linear q₁ and the height d of the wheel's
    centre above the body's centre of gravity.
    """
    arm = heights.wheel_arms[1]
    half = _half_square(signals)
    tilt = np.zeros_like(signals.value)
    tilt[[_PITCH, _ROLL]] = signals.value[[_PITCH, _ROLL]]
    springs, dampers = -_travels(model, tracks, "spring", values), -_travels(model, tracks, "damper", values)
    rates, damping = _by_axle(model, "k_s", values), _by_axle(model, "c_s", values)
    matrices = model.matrices(values)
    static = rates * -(springs @ matrices.deflection(matrices.M @ model.heave * STANDARD_GRAVITY))
    forces = np.zeros_like(signals.value)
    for spring, damper, k, c, held in zip(springs, dampers, rates, damping, static, strict=True):
        compression = signals.along(spring).value
        forces -= held * (np.outer(spring, half.value) + compression * tilt)
        forces -= k * arm * (compression * tilt + np.outer(spring, half.value))
        forces -= c * arm * (signals.along(damper).rate * tilt + np.outer(damper, half.rate))
    return forces


def _inertia_forces(
    model: LinearModel, tracks: Tracks, heights: Heights, load: Load, values: Array, signals: _Signal
) -> Array:
    """Return the second-order generalised inertia forces of wheels and items of the load, SI, shape (coordinate, time).

    A mass whose displacement along an axis is u₁ + u₂ acts with -m (ü₁ ∂u₂/∂X + ü₂ ∂u₁/∂X).
    """
    if not heights.has_effect:
        return np.zeros_like(signals.value)
    units = np.eye(len(signals.value))
    pitch, roll = (signals.along(units[angle]) for angle in (_PITCH, _ROLL))
    by_pitch, by_roll = units[_PITCH], units[_ROLL]
    forward, sideways = _unconstrained_per_angle(model, values)
    own = dict(zip(model.names, values.tolist(), strict=True))
    forces = np.zeros_like(signals.value)
    arm = heights.wheel_arms[1]
    masses = _by_axle(model, "m_u", values)
    for station, row, mass in zip(WHEELS, -_travels(model, tracks, "spring", values), masses, strict=True):
        x, q = own["a"] if station[0] == "f" else -own["b"], signals.along(row)
        # Both wheels of an axle cancel what their half-distance adds.
        first, second = (sideways - arm) * by_roll, q * roll * -1.0
        slope = -(np.outer(by_roll, q.value) + np.outer(row, roll.value))
        forces -= mass * ((first @ signals.second) * slope + np.outer(first, second.second))
        first, second = (forward + arm) * by_pitch, q * pitch + pitch * pitch * (-0.5 * x)
        slope = np.outer(by_pitch, q.value - x * pitch.value) + np.outer(row, pitch.value)
        forces -= mass * ((first @ signals.second) * slope + np.outer(first, second.second))
    for item in (one for one in load.items if one.position is not None):
        x, y, z = item.position or (0.0, 0.0, 0.0)
        x, height = x + own["a"], _above_centre(heights, z)
        vertical = units[0] - x * by_pitch + y * by_roll
        parts = [
            (vertical, _half_square(signals) * -height, -height * _tilt(units, signals)),
            ((sideways - height) * by_roll, roll * roll * (-0.5 * y), -y * np.outer(by_roll, roll.value)),
            ((forward + height) * by_pitch, pitch * pitch * (-0.5 * x), -x * np.outer(by_pitch, pitch.value)),
        ]
        for first, second, slope in parts:
            forces -= item.mass * ((first @ signals.second) * slope + np.outer(first, second.second))
    return forces


def _half_square(signals: _Signal) -> _Signal:
    """Return half the sum of both squared angles."""
    pitch, roll = (_Signal(*(one[angle] for one in signals)) for angle in (_PITCH, _ROLL))
    return (pitch * pitch + roll * roll) * 0.5


def _tilt(units: Array, signals: _Signal) -> Array:
    """Return the gradient of half the sum of both squared angles, shape (coordinate, time)."""
    return units[:, [_PITCH, _ROLL]] @ signals.value[[_PITCH, _ROLL]]


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
