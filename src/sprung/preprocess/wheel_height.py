"""Heights of wheels: how far each is above where it stands in the end, and from when on none can be off the ground.

A tyre that touches the ground is compressed by at least a part of what the standing vehicle compresses it by, so that its
wheel is hardly higher than in the end. A displacement sensor on the wheel shows that; so does its accelerometer, integrated
twice from the release on, where the height of the blocks is stated. Nothing needs to be known of the body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from sprung.preprocess.release import Release
from sprung.vehicle import Sensor, Wheel

Real = NDArray[np.float64]

_STANDING = 0.005
"""m by which every standing tyre is compressed at the least: those of cars and buses are by 15 to 40 mm."""

_LAST = 0.5
"""s at the end of a recording in which the vehicle stands."""


def detect_contact(
    values: Real,
    rate: float,
    release: Release,
    sensors: Sequence[Sensor],
    dropped: Sequence[Wheel],
    height: float | None,
    latest: int,
) -> int | None:
    """Detect from when on no tyre can be off the ground, by the heights of the wheels.

    Parameters
    ----------
    values
        Shape (channel, time), SI; channels that are left out NaN.
    rate
        Samples per second.
    release
        The release.
    sensors
        One for each channel.
    dropped
        The wheels that fell.
    height
        Of the blocks under them, m; None where it is not stated.
    latest
        Sample from which every tyre is on the ground in any case.

    Returns
    -------
    int or None
        First sample, `latest` at the most. None where the height of a wheel that fell is not known.
    """
    last, shown = release.sample, set()
    for wheel in {sensor.wheel for sensor in sensors if sensor.wheel is not None}:
        above = _height_of(wheel, values, rate, release, sensors, height if wheel in dropped else 0.0, latest)
        if above is None:
            continue
        shown.add(wheel)
        high = np.flatnonzero(above[: max(latest - release.sample, 0)] > _STANDING)
        last = max(last, release.sample + int(high[-1]) + 1 if high.size else 0)
    return last if shown.issuperset(dropped) else None


def _height_of(
    wheel: Wheel,
    values: Real,
    rate: float,
    release: Release,
    sensors: Sequence[Sensor],
    height: float | None,
    latest: int,
) -> Real | None:
    """Return how far a wheel is above where it stands in the end, from the release on, m; None where no sensor shows it."""
    own = [
        (sensor.quantity, values[channel], float(release.level[channel]))
        for channel, sensor in enumerate(sensors)
        if sensor.wheel == wheel and not np.isnan(values[channel]).any()
    ]
    for quantity, reading, _ in own:
        if quantity == "displacement":
            above: Real = reading[release.sample :] - reading[-max(int(_LAST * rate), 1) :].mean()
            return above
    for quantity, reading, level in own:
        if quantity == "acceleration" and height is not None:
            return height + _integrated_twice(reading[release.sample :] - level, rate, height, latest - release.sample)
    return None


def _integrated_twice(acceleration: Real, rate: float, height: float, late: int) -> Real:
    """Integrate the acceleration of a wheel twice, m, so that it stands lower by a height, m, from a late sample on.

    When between two samples it was let go, and what its sensor reads at rest to the last digit, is not known: both follow.
    """
    time = np.arange(acceleration.size) / rate
    moved = cumulative_trapezoid(cumulative_trapezoid(acceleration, dx=1 / rate, initial=0), dx=1 / rate, initial=0)
    unknown = np.column_stack([time, time**2])
    missing = np.linalg.lstsq(unknown[late:], -height - moved[late:])[0]
    integrated: Real = moved + unknown @ missing
    return integrated
