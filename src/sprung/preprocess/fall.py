"""The fall of a drop: how far the readings of its channels go down, how fast, and which of them show a wheel that falls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.units import STANDARD_GRAVITY

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

BLOW = 0.01
"""s over which readings are averaged, so that a blow, which is shorter, does not pass for a fall."""

_FALL = 0.08
"""s after the first wheel has begun to fall within which every wheel that falls does; later one that stands may jump."""

_LATER = 0.15
"""s more in which the body, slower than wheels, gains its speed."""

IMPACT = 0.5
"""s after the release within which every wheel has met the ground."""

WHEEL_SPEED = 0.2
"""m/s downward that a wheel gains at least: blocks of 0.02 m give 0.3."""

_AT_ONCE, _DEEP = 0.0067, 0.2
"""Parts of what the wheel that fell most has of depth times onset, and of depth, from which another fell too. Over 1650 drops
of 150 vehicles one that stood has 0.005 and 0.153 at most; one let go together with it has 0.009 at least, a later one more
than 0.2 of the depth as a rule."""


def measure_fall(moved: Real, rate: float, release: int, level: Real) -> tuple[Real, Real, Real, Real, Real]:
    """Measure how the readings fall after a release.

    Parameters
    ----------
    moved
        Readings less their level at rest, m/s², shape (channel, time); NaN in channels that are left out.
    rate
        Samples per second.
    release
        Sample of the release.
    level
        What the channels read at rest, m/s², shape (channel,).

    Returns
    -------
    onset : ndarray
        Reading directly after the release, off the rest and in the channel's own direction, m/s², shape (channel,).
    depth : ndarray
        Farthest below rest during the fall, m/s², shape (channel,).
    speed : ndarray
        Gained downward, m/s, shape (channel,).
    gained : ndarray
        Speed downward that is gained in the end, m/s, shape (channel,).
    fall : ndarray
        The half second after the release, positive up, m/s², shape (channel, time).
    """
    fall = moved[:, release : release + int(IMPACT * rate)]
    # Which way an AC-coupled sensor points is not known: a wheel's first large reading after the release is downward.
    onset = fall[:, : max(int(2 * BLOW * rate), 1)].mean(axis=1)
    over = (np.abs(level) < STANDARD_GRAVITY / 2) & (onset > STANDARD_GRAVITY)
    fall = np.where(over[:, None], -fall, fall)
    smooth = uniform_filter1d(fall, max(round(BLOW * rate), 1), axis=1, mode="nearest")
    smooth[np.isnan(smooth)] = 0.0
    # What moves at first may be a hand at the blocks.
    deepest = smooth[int(np.argmin(smooth.min(axis=1)))]
    begin = int(np.argmax(deepest <= 0.25 * deepest.min()))
    end = min(begin + max(int(_FALL * rate), 1), smooth.shape[1])
    depth = np.maximum(-smooth[:, :end].min(axis=1), 0.0)
    gained = np.maximum.accumulate(-np.cumsum(fall[:, : end + int(_LATER * rate)], axis=1) / rate, axis=1)
    return onset, depth, np.maximum(gained[:, end - 1], 0.0), gained[:, -1], fall


def detect_dropped_channels(level: Real, onset: Real, depth: Real, speed: Real, wheels: Flags) -> tuple[int, ...]:
    """Detect which channels show the fall of a wheel.

    Parameters
    ----------
    level
        At rest, m/s², shape (channel,).
    onset, depth
        From `measure_fall`, m/s², shape (channel,).
    speed
        From `measure_fall`, m/s, shape (channel,).
    wheels
        Which channels are on wheels, shape (channel,).

    Returns
    -------
    tuple of int
        Positions of the channels; none where no wheel with a sensor fell.
    """
    depth, speed, onset = np.where(wheels & ~np.isnan(onset), (depth, speed, onset), 0.0)
    over = ~(np.abs(level) >= STANDARD_GRAVITY / 2) & (onset > 0)  # an AC-coupled sensor may point down
    at_once = depth * np.maximum(np.where(over, onset, -onset), 0.0)
    falls = (depth > _DEEP * depth.max()) | (at_once > _AT_ONCE * at_once.max())
    any_fell = bool(((depth > STANDARD_GRAVITY) & (speed > WHEEL_SPEED)).any())
    return tuple(np.flatnonzero(falls & wheels).tolist()) if any_fell else ()
