"""The landing: when the last tyre to lift off has come down for good, and free vibration begins.

A tyre's force can be read off the accelerometers. Per unit of unsprung mass it is the wheel's reading plus the
suspension's force; that force carries the body, so it follows the body's reading above the wheel, and the release itself
shows its size: at that moment the tyre force vanishes while the spring has not yet moved, and the wheel's reading jumps to
minus the static suspension force over the unsprung mass. No mass or rate needs to be known.

Above a corner the body's reading stands for the suspension's force only as far as the body's inertia is spread like a
car's. So the first landing is also taken from what needs no such assumption: a tyre that meets the ground drives the
wheel's reading up, at once and far more steeply than any spring.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS, Sensor, Wheel

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_JUMP = 0.015
"""s after the release within which the wheel's reading has jumped, blocks and filters being what they are."""

_IMPACT = 0.5
"""s after the release within which every wheel has met the ground: a fall from 0.3 m, and the tyre's compression."""

_EARLIER = 0.008
"""s by which the landing may have been before the steepest rise of a wheel's reading."""

_SPIKE = 0.02
"""s: what is shorter counts as a spike, not as a wheel that has left the ground again."""

_LONGEST = 2.0
"""s after the release for which wheels may hop; what looks like it later is something else."""

_ON_THE_GROUND = 0.5
"""Part of the static tyre force above which a tyre is certainly on the ground, for all that is rough in its estimate."""


class Landing(NamedTuple):
    """When free vibration begins.

    Attributes
    ----------
    possible
        First sample after every wheel that fell has landed once: before it nothing is free vibration.
    certain
        First sample from which no tyre can have left the ground again.
    why
        The reason, in words.
    landed
        First sample after the last wheel that fell met the ground; None where no sensor shows it.
    lifted
        Last sample, not before that, at which a tyre may have been off the ground once more; None where none can have been, or
        no sensor shows it.
    """

    possible: int
    certain: int
    why: str
    landed: int | None = None
    lifted: int | None = None


def measure_suspension_force(
    values: Real, rate: float, release: Release, sensors: Sequence[Sensor], dropped: Sequence[Wheel]
) -> dict[Wheel, float]:
    """Measure the static suspension force over the unsprung mass by the jump of the wheels' readings at the release.

    Parameters
    ----------
    values
        Shape (channel, time), m/s².
    rate
        Samples per second.
    release
        The release.
    sensors
        One for each channel.
    dropped
        The wheels that fell.

    Returns
    -------
    dict
        m/s², for each dropped wheel with a sensor; NaN where its channel is left out.
    """
    window = slice(release.sample, release.sample + max(int(np.ceil(_JUMP * rate)), 2))
    forces: dict[Wheel, float] = {}
    for channel, sensor in enumerate(sensors):
        if sensor.wheel is not None and sensor.wheel in dropped and sensor.reads_gravity:
            lowest = float(values[channel, window].min() - release.level[channel])
            forces[sensor.wheel] = max(-lowest - STANDARD_GRAVITY, 0.0)
    return forces


def detect_landing(
    values: Real,
    rate: float,
    release: Release,
    sensors: Sequence[Sensor],
    suspension: Mapping[Wheel, float],
    dropped: Sequence[Wheel],
    wheelbase: float,
) -> Landing | None:
    """Detect when every tyre has come down, and from when on it stays there.

    Parameters
    ----------
    values
        Shape (channel, time), m/s²; channels that are left out NaN.
    rate
        Samples per second.
    release
        The release.
    sensors
        One for each channel.
    suspension
        Static suspension force over unsprung mass, m/s², by wheel, from `measure_suspension_force`.
    dropped
        The wheels that fell.
    wheelbase
        m, however roughly.

    Returns
    -------
    Landing or None
        None where no wheel with a sensor left the ground and came back, or too few body sensors have a position.
    """
    whole = np.logical_not(np.isnan(values).any(axis=1))
    body = [i for i, one in enumerate(sensors) if one.position is not None and one.reads_gravity and whole[i]]
    wheels: list[tuple[int, Wheel]] = [
        (i, sensor.wheel)
        for i, sensor in enumerate(sensors)
        if sensor.wheel is not None and sensor.wheel in suspension and sensor.reads_gravity and whole[i]
    ]
    stations = [STATIONS[wheel] for _, wheel in wheels]
    # Where front and rear, or left and right, are not told apart, the body does not turn so.
    turns = [True, any(station.end for station in stations), any(station.side for station in stations)]
    if len(body) < sum(turns):
        return None
    reading = values[:, release.sample : release.sample + int(_LONGEST * rate)] - release.level[:, None]
    places = np.array([sensors[i].position for i in body], dtype=float)
    plane = np.column_stack([np.ones(len(body)), places[:, :2]])[:, turns]
    half_track = float(np.abs(places[:, 1]).mean())
    corners = np.array(
        [[1.0, -wheelbase if station.end < 0 else 0.0, station.side * half_track] for station in stations]
    ).reshape(-1, 3)[:, turns]
    static = np.array([suspension[station] for _, station in wheels])[:, None]
    above = corners @ np.linalg.pinv(plane) @ (reading[body] + STANDARD_GRAVITY)
    own = reading[[channel for channel, _ in wheels]]
    tyre_force = own + STANDARD_GRAVITY + static * above / STANDARD_GRAVITY
    is_unloaded = _without_short_runs(tyre_force < _ON_THE_GROUND * (STANDARD_GRAVITY + static), int(_SPIKE * rate / 2))
    low = np.flatnonzero(is_unloaded.any(axis=0))
    last = release.sample + int(low[-1]) + 1 if low.size else 0
    falls = [
        release.sample + find_steepest_rise(signal[: int(_IMPACT * rate)])
        for signal, (_, station) in zip(own, wheels, strict=True)
        if station in dropped
    ]
    first = max(falls, default=0)
    if not (first or last):
        return None
    # The rise shows the landing to a few samples; what lies before it costs nothing, for the fit estimates where it was.
    possible = max((first or last) - int(np.ceil(_EARLIER * rate)), release.sample)
    why = (
        "no tyre can be off the ground any more" if last > first else "every wheel that fell has landed and stays down"
    )
    return Landing(possible, max(first, last), why, first or None, last - 1 if last > first else None)


def _without_short_runs(flags: Flags, half: int) -> Flags:
    """Return the running median of flags, shape (channel, time), over twice so many samples and one, reflected at the ends."""
    if flags.shape[1] <= half:
        return flags
    padded = np.concatenate([flags[:, half::-1], flags, flags[:, : -half - 1 : -1]], axis=1)
    count = np.cumsum(padded, axis=1)
    return np.asarray(count[:, 2 * half + 1 :] - count[:, : -2 * half - 1] > half)


def find_steepest_rise(reading: Real) -> int:
    """Return the sample after the steepest rise before the hardest impact.

    Parameters
    ----------
    reading
        Of one sensor on a wheel from the release on, positive up, m/s², shape (time,).

    Returns
    -------
    int
        Position of the sample.
    """
    impact = int(np.argmax(reading))
    return impact if impact < 2 else int(np.argmax(np.diff(reading[: impact + 1]))) + 1
