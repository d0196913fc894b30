"""The drop from blocks, exact: the vehicle rests with blocks under some wheels, and at the release these are removed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Problems, did_you_mean
from sprung.simulation.contact_motion import DropMotion, follow_motion
from sprung.simulation.ground import Ground
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, Load, Vehicle, Wheel

Array = NDArray[np.float64]


def drop_from_blocks(
    vehicle: Vehicle,
    load: Load = EMPTY,
    wheels: tuple[Wheel, ...] | None = None,
    height: float = 0.05,
    *,
    duration: float = 60.0,
    gravity: float = STANDARD_GRAVITY,
) -> DropMotion:
    """Return the exact motion of a vehicle released from blocks, through every lift-off and landing.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    wheels
        The wheels with blocks under them; the others stand on the ground.
    height
        Of the blocks, m.
    duration
        Of the motion at most, s; once the energy left cannot lift any wheel, the motion is known for all time.
    gravity
        m/s².

    Returns
    -------
    DropMotion

    Raises
    ------
    InputError
        If the vehicle does not stand on its four wheels, or there are no such blocks; all faults at once.
    SprungError
        If its wheels never stop hopping, as those of a vehicle without damping.

    Notes
    -----
    A tyre's force is max(0, W - k_t z_u - c_t ż_u) while it is compressed, with W the static wheel load, and zero while
    it is not. Without tyre damping that is continuous; with it the force jumps at a landing, to c_t times the speed.

    Examples
    --------
    >>> from sprung.vehicle import TABLE_1_CAR
    >>> drop = drop_from_blocks(TABLE_1_CAR, wheels=("fl", "fr"), height=0.05)
    >>> [event.kind for event in drop.events]
    ['lift-off', 'lift-off', 'landing', 'landing']
    """
    wheels = vehicle.layout.wheels if wheels is None else wheels
    ground = Ground.under(vehicle, load, gravity)
    rest = _rest(ground, vehicle, load, wheels, height)
    return follow_motion(ground, rest, duration=duration, what=f"drop of {vehicle.name}")


def _rest(ground: Ground, vehicle: Vehicle, load: Load, wheels: tuple[Wheel, ...], height: float) -> Array:
    """Return the rest position X on the blocks, shape (coordinate,), or raise an error if there is none."""
    problems = Problems()
    where, stations = f"drop of {vehicle.name}, load '{load.name}'", vehicle.layout.wheels
    if not wheels:
        problems.add(where, "no wheels", "at least one wheel on a block", "Name the wheels that are dropped.")
    for wheel in wheels:
        if wheel not in stations:
            problems.add(where, f"wheel '{wheel}'", "a wheel station", did_you_mean(wheel, stations))
    if not (math.isfinite(height) and height > 0):
        problems.add(where, f"blocks of {height} m", "a positive height", "Give the height of the blocks in m.")
    if np.any(ground.wheel_loads <= 0):
        each = ", ".join(f"{wheel} {weight:.0f} N" for wheel, weight in zip(stations, ground.wheel_loads, strict=True))
        problems.add(where, f"static wheel loads {each}", "all wheels pressed to the ground", "Move the load inwards.")
    problems.raise_if_any()
    return ground.rest(np.array([height if wheel in wheels else 0.0 for wheel in stations]))
