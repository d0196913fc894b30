"""Pushes and passes, exact: a body that is pushed and let go, a vehicle that drives over a bump onto flat road."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Bump, Push
from sprung.errors import Problems, did_you_mean
from sprung.simulation.contact_motion import DropMotion, follow_motion
from sprung.simulation.excitation import Drive, bump_arcs, push_arcs
from sprung.simulation.ground import Ground
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, STATIONS, Load, Matrices, Rows, Vehicle, Wheel, body_point, parameter_name

Array = NDArray[np.float64]

DEFAULT_SPEED = 5.0
"""Of a pass where a drop does not say, m/s."""

_BY_HAND, _BY_ROPE = 0.05, 0.1
"""Force of a push by hand, and of a pull, as parts of the vehicle's weight."""


def push_body(
    vehicle: Vehicle,
    load: Load = EMPTY,
    wheels: tuple[Wheel, ...] | None = None,
    push: Push | None = None,
    *,
    duration: float = 60.0,
    gravity: float = STANDARD_GRAVITY,
) -> DropMotion:
    """Return the exact motion of a vehicle whose body is pushed or pulled and let go.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    wheels
        Between which the force acts on the body, unless the push has a position.
    push
        How it is pushed; by hand unless given.
    duration
        Of the motion at most, s.
    gravity
        m/s².

    Returns
    -------
    DropMotion
        From the first push on, or from when the body is let go.

    Raises
    ------
    InputError
        If there are no such wheels.
    SprungError
        If the vehicle's wheels never stop hopping.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> motion = push_body(TABLE_1_CAR, wheels=("fl", "fr"), push=Push(shape="rope"))
    >>> motion.decay_start, motion.events
    (0.0, ())
    """
    push = push or Push()
    wheels = _checked_wheels(vehicle, wheels)
    drive, held = push_drive(vehicle, load, wheels, push, gravity)
    ground = Ground.under(vehicle, load, gravity, drive)
    return follow_motion(ground, ground.matrices.deflection(held), duration=duration, what=f"push of {vehicle.name}")


def push_drive(
    vehicle: Vehicle, load: Load, wheels: tuple[Wheel, ...], push: Push, gravity: float
) -> tuple[Drive, Array]:
    """Return what pushes a vehicle, and the force on its coordinates before that, N, shape (coordinate,)."""
    matrices, values = vehicle.matrices(load), vehicle.parameters
    place = push.position or _middle(vehicle, wheels)
    point = body_point(*place, tuple(values), vehicle.wheelbase)
    row = Rows.of([point], tuple(values)).at(list(values.values()))[0]
    heave = vehicle.linear_model(load).heave
    weight = float(heave @ matrices.M @ heave) * gravity
    force = push.force or (_BY_HAND if push.shape == "hand" else _BY_ROPE) * weight
    signal = push_arcs(push, force, push.frequency or _natural_frequency(matrices, row))
    upward = {"hand": 0.0, "rope": -1.0, "lift": 1.0}[push.shape] * force
    return Drive((signal,), row[:, None], np.zeros((len(vehicle.layout.wheels), 1))), upward * row


def drive_over_bump(
    vehicle: Vehicle,
    load: Load = EMPTY,
    wheels: tuple[Wheel, ...] | None = None,
    speed: float = DEFAULT_SPEED,
    bump: Bump | None = None,
    *,
    duration: float = 60.0,
    gravity: float = STANDARD_GRAVITY,
) -> DropMotion:
    """Return the exact motion of a vehicle that drives over a bump onto flat road, from when the first wheel reaches it.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    wheels
        That run over the bump: those of the front axle first, those of the rear axle a wheelbase later; all unless given.
    speed
        m/s.
    bump
        What it drives over; a half sine unless given.
    duration
        Of the motion at most, s.
    gravity
        m/s².

    Returns
    -------
    DropMotion

    Raises
    ------
    InputError
        If there are no such wheels.
    SprungError
        If the vehicle's wheels never stop hopping.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> motion = drive_over_bump(TABLE_1_CAR, speed=2.0, bump=Bump(height=0.02, length=1.0))
    >>> motion.decay_start == (TABLE_1_CAR.wheelbase + 1.0) / 2.0, motion.events
    (True, ())
    """
    wheels = _checked_wheels(vehicle, wheels)
    ground = Ground.under(vehicle, load, gravity, bump_drive(vehicle, wheels, speed, bump or Bump()))
    start = np.zeros(len(ground.matrices.M))
    return follow_motion(ground, start, duration=duration, what=f"pass of {vehicle.name} over a bump")


def bump_drive(vehicle: Vehicle, wheels: tuple[Wheel, ...], speed: float, bump: Bump) -> Drive:
    """Return the ground under the wheels of a vehicle that drives over a bump at a speed, m/s."""
    stations = vehicle.layout.wheels
    axles = dict.fromkeys(STATIONS[wheel].axle for wheel in stations if wheel in wheels)
    first = next(iter(axles), "")
    signals = [bump_arcs(bump, speed, 0.0 if axle == first else vehicle.wheelbase / speed) for axle in axles]
    heights = [[float(wheel in wheels and STATIONS[wheel].axle == axle) for axle in axles] for wheel in stations]
    return Drive(tuple(signals), np.zeros((vehicle.linear_model().size, len(axles))), np.array(heights))


def _checked_wheels(vehicle: Vehicle, wheels: tuple[Wheel, ...] | None) -> tuple[Wheel, ...]:
    stations = vehicle.layout.wheels
    if wheels is None:
        return stations
    problems = Problems()
    if not wheels:
        problems.add(vehicle.name, "no wheels", "at least one wheel", "Name the wheels.")
    for wheel in wheels:
        if wheel not in stations:
            problems.add(vehicle.name, f"wheel '{wheel}'", "a wheel station", did_you_mean(wheel, stations))
    problems.raise_if_any()
    return wheels


def _middle(vehicle: Vehicle, wheels: tuple[Wheel, ...]) -> tuple[float, float]:
    """Return the place in the middle between wheels: forward of the front axle and left of the centreline, m."""
    x, y = [], []
    for wheel in wheels:
        _, axle, side, end = STATIONS[wheel]
        x.append(-vehicle.wheelbase if end < 0 else 0.0)
        y.append(side * getattr(vehicle, parameter_name("t", axle, "2")) if side else 0.0)
    return float(np.mean(x)), float(np.mean(y))


def _natural_frequency(matrices: Matrices, row: Array) -> float:
    """Return about the natural frequency of the motion of a place by a force there, Hz."""
    m = matrices.massive
    mobility = row[:m] @ np.linalg.solve(matrices.M[:m, :m], row[:m])
    return math.sqrt(mobility / (row @ matrices.deflection(row))) / (2 * math.pi)
