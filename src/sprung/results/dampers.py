"""What the accelerometers say of the dampers: force against velocity, sample by sample, beside the force curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.results.excess_force import damper_travel_rows, excess_forces
from sprung.results.motion import ReadDrop, motion_of, read_drop
from sprung.vehicle import STATIONS, Wheel, parameter_name

if TYPE_CHECKING:
    from sprung.results.result import Result

Real = NDArray[np.float64]

_FINER = 8
"""Steps for each sample, where a damper's own travel is integrated behind its rubber mount."""


@shown
@dataclass(frozen=True, eq=False)
class DamperPoints:
    """Velocity and force of one damper in one drop.

    Attributes
    ----------
    drop, wheel
        Names.
    velocity
        Of the damper in the fitted motion, m/s, positive in rebound, shape (time,).
    force
        Of the damper, N, positive in rebound, shape (time,): that of the model at this velocity, and what the measured
        accelerations say beyond the model.
    model
        The former alone, N, shape (time,).
    noise
        Standard deviation of the force by the noise of the accelerometers, N.
    """

    drop: str
    wheel: Wheel
    velocity: Real
    force: Real
    model: Real
    noise: float


def damper_points(result: Result, drop: str) -> tuple[DamperPoints, ...]:
    """Return velocity and force of every damper in a drop, as the accelerometers have them.

    Parameters
    ----------
    result
        With its series.
    drop
        Name of a drop that was fitted.

    Returns
    -------
    tuple of DamperPoints
        One for each wheel station.

    Raises
    ------
    InputError
        If the motion cannot be determined (as for `fitted_motion`), or the accelerometers do not determine a force at each
        damper.

    Notes
    -----
    What the model leaves of the measured accelerations is taken for the effect of forces that the dampers exert beyond the
    model, and that move the vehicle away from the fitted motion: see `excess_forces`. A deviation of a tyre, a spring or a
    sensor from the model thus appears as a force of a damper: the points show by how much, and where, the recordings contradict
    the curve; they are no estimate of it.
    """
    read = read_drop(result, drop)
    motion = motion_of(result, read)
    series = result.series[drop]
    rows = damper_travel_rows(read)
    travel, rate = rows @ motion.motion.displacement, rows @ motion.motion.velocity
    excess = excess_forces(read, np.asarray(series.measured - series.fitted, dtype=float), motion.time)
    found = []
    for i, wheel in enumerate(read.vehicle.layout.wheels):
        curve = _curve(result, wheel)
        fitted = _damper_rate(read, motion.time, wheel, (travel[i], rate[i]), curve)
        moved = (travel[i] + rows[i] @ excess.displacement, rate[i] + rows[i] @ excess.velocity)
        velocity = _damper_rate(read, motion.time, wheel, moved, curve)
        # The linear vehicle already resists the deviation from the fitted motion.
        model = np.interp(fitted, *curve) + _linear_rate(read, wheel) * (velocity - fitted)
        found.append(
            DamperPoints(
                drop,
                wheel,
                velocity,
                model + excess.force[i],
                np.interp(velocity, *curve),
                float(excess.noise[i]),
            )
        )
    return tuple(found)


def _curve(result: Result, wheel: Wheel) -> tuple[Real, Real]:
    """Return velocities, m/s, and forces, N, of the curve of a damper, far beyond what a drop reaches."""
    values = result.vehicle.parameters
    axle, side = STATIONS[wheel].axle, STATIONS[wheel].side
    name = {"f": "damper_front", "r": "damper_rear"}.get(axle, "damper")
    far = 100.0
    if name in result.curves:
        curve = result.curves[name]
        x = np.concatenate([[curve.x[0] - far], curve.x, [curve.x[-1] + far]])
        force = np.asarray(curve.at(x).force)
    else:
        x = np.array([-far, 0.0, far])
        force = values[f"c_s{axle}"] * x
    return x, force + side * values.get(f"d_cs{axle}", 0.0) * x


def _linear_rate(read: ReadDrop, wheel: Wheel) -> float:
    """Return the rate of a damper in the linear equations of motion, N s/m."""
    values, axle = read.vehicle.parameters, STATIONS[wheel].axle
    return float(values[f"c_s{axle}"] + STATIONS[wheel].side * values.get(f"d_cs{axle}", 0.0))


def _damper_rate(
    read: ReadDrop, time: Real, wheel: Wheel, suspension: tuple[Real, Real], curve: tuple[Real, Real]
) -> Real:
    """Return the velocity of a damper, m/s; one behind a rubber mount moves less than the suspension."""
    values, axle = read.vehicle.parameters, STATIONS[wheel].axle
    stiffness = values.get(f"k_d{axle}", np.inf)
    if not np.isfinite(stiffness):
        return suspension[1]
    damping = values.get(parameter_name("c_d", axle), 0.0)
    return damper_rate_behind_mount(time, *suspension, curve, stiffness, damping)


def damper_rate_behind_mount(
    time: Real, travel: Real, rate: Real, curve: tuple[Real, Real], stiffness: float, damping: float
) -> Real:
    """Return the velocity of a damper in series with a rubber mount.

    Parameters
    ----------
    time
        s, shape (time,).
    travel, rate
        Of damper and mount together, m and m/s, shape (time,).
    curve
        Velocities, m/s, ascending, and forces of the damper, N, straight between them.
    stiffness, damping
        Of the mount, N/m and N s/m.

    Returns
    -------
    ndarray
        m/s, shape (time,).

    Notes
    -----
    The force of the damper is that of its mount, F(v) = k (s - x) + c (ṡ - v) with ẋ = v: in backward Euler steps, eight for
    each sample, v is where F(v) + (c + k h) v = k (s - x) + c ṡ.
    """
    fine = np.linspace(time[0], time[-1], _FINER * (len(time) - 1) + 1)
    step = float(fine[1] - fine[0])
    s, ds = np.interp(fine, time, travel), np.interp(fine, time, rate)
    x, force = curve
    resistance = force + (damping + stiffness * step) * x
    own = s[0] - float(np.interp(ds[0], x, force)) / stiffness
    velocity = np.empty_like(fine)
    for i in range(len(fine)):
        velocity[i] = np.interp(stiffness * (s[i] - own) + damping * ds[i], resistance, x)
        own += step * velocity[i]
    return velocity[::_FINER]
