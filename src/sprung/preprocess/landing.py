"""The landing: when the last tyre to lift off has come down for good, and free vibration begins.

A tyre's force can be read off the accelerometers. Per unit of unsprung mass it is the wheel's reading plus the
suspension's force; that force carries the body, so it follows the body's reading above the wheel, and its size is
weighed by the release itself: at that moment the tyre force vanishes while the spring has not yet moved, and the wheel's
reading jumps to minus the static suspension force over the unsprung mass. No mass or rate needs to be known.

Above a corner the body's reading stands for the suspension's force only as far as the body's inertia is spread like a
car's. So the first landing is also taken from what no such assumption touches: a tyre that meets the ground drives the
wheel's reading up, at once and far more steeply than any spring.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, Sensor, Wheel

Real = NDArray[np.float64]

_JUMP = 0.015
"""s after the release within which the wheel's reading has jumped, blocks and filters being what they are."""

_IMPACT = 0.5
"""s after the release within which every wheel has met the ground: a fall from 0.3 m, and the tyre's compression."""

_EARLIER = 0.008
"""s by which the landing may have been before the steepest rise of a wheel's reading."""

_SPIKE = 0.02
"""s: what is shorter is taken for a spike, not for a wheel that has left the ground again."""

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
        What that is known from, in words.
    landed
        First sample after the last wheel that fell met the ground; None where no sensor tells.
    lifted
        Last sample, not before that, at which a tyre may have been off the ground once more; None where none can have been, or
        no sensor tells.
    """

    possible: int
    certain: int
    why: str
    landed: int | None = None
    lifted: int | None = None


def weigh_corners(
    values: Real, rate: float, release: Release, sensors: Sequence[Sensor], dropped: Sequence[Wheel]
) -> dict[Wheel, float]:
    """Weigh the corners by the release.

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
        For each dropped wheel with a sensor the static suspension force over the unsprung mass, m/s².
    """
    window = slice(release.sample, release.sample + max(int(np.ceil(_JUMP * rate)), 2))
    jumps: dict[Wheel, float] = {}
    for channel, sensor in enumerate(sensors):
        if sensor.on is not None and sensor.on != "body" and sensor.on in dropped:
            lowest = float(values[channel, window].min() - release.rest.level[channel])
            jumps[sensor.on] = max(-lowest - STANDARD_GRAVITY, 0.0)
    return jumps


def detect_landing(
    values: Real,
    rate: float,
    release: Release,
    sensors: Sequence[Sensor],
    suspension: Mapping[Wheel, float],
    dropped: Sequence[Wheel],
    wheelbase: float,
) -> Landing | None:
    """Find when every tyre has come down, and from when on it stays there.

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
        Static suspension force over unsprung mass, m/s², by wheel, as `weigh_corners` weighs it.
    dropped
        The wheels that fell.
    wheelbase
        m, however roughly.

    Returns
    -------
    Landing or None
        None where no wheel that can be judged ever left the ground and came back.
    """
    reading = values - release.rest.level[:, None] + STANDARD_GRAVITY
    body = [i for i, s in enumerate(sensors) if s.position is not None and not np.isnan(values[i]).any()]
    if len(body) < 3:
        return None
    places = np.array([sensors[i].position for i in body], dtype=float)
    plane = np.column_stack([np.ones(len(body)), places[:, :2]])
    half_track = float(np.abs(places[:, 1]).mean())
    first = last = 0
    longest, impact, spike = int(_LONGEST * rate), int(_IMPACT * rate), 2 * int(_SPIKE * rate / 2) + 1
    for channel, sensor in enumerate(sensors):
        if sensor.on is None or sensor.on == "body" or sensor.on not in suspension or np.isnan(values[channel]).any():
            continue
        x = 0.0 if sensor.on in WHEELS[:2] else -wheelbase
        y = half_track if sensor.on in ("fl", "rl") else -half_track
        above = np.array([1.0, x, y]) @ np.linalg.pinv(plane) @ reading[body]
        force = reading[channel] + suspension[sensor.on] * above / STANDARD_GRAVITY
        static = STANDARD_GRAVITY + suspension[sensor.on]
        force = median_filter(force[release.sample : release.sample + longest], size=spike)
        low = np.flatnonzero(force < _ON_THE_GROUND * static)
        if low.size:
            last = max(last, release.sample + int(low[-1]) + 1)
        if sensor.on in dropped:
            first = max(first, steepest_rise(reading[channel, : release.sample + impact], release.sample))
    if not (first or last):
        return None
    # The rise tells the landing to a few samples; what lies before it costs nothing, for the fit will say where it was.
    possible = max((first or last) - int(np.ceil(_EARLIER * rate)), release.sample)
    why = (
        "no tyre can be off the ground any more" if last > first else "every wheel that fell has landed and stays down"
    )
    return Landing(possible, max(first, last), why, first or None, last - 1 if last > first else None)


def steepest_rise(reading: Real, release: int) -> int:
    """Give the sample after the steepest rise between the release and the wheel's hardest impact.

    Parameters
    ----------
    reading
        Of one sensor on a wheel, positive up, shape (time,).
    release
        Sample of the release.
    """
    impact = release + int(np.argmax(reading[release:]))
    return impact if impact - release < 2 else release + int(np.argmax(np.diff(reading[release : impact + 1]))) + 1
