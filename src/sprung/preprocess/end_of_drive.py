"""The end of a push or of a bump: from when on nothing drives the vehicle, as roughly as its recording alone shows.

A body that is pushed, and a wheel on a bump, move most while they are driven or just after it. A motion that is free dies away.
So in every channel the last time at which its power is a part of the largest is after the last force; a fit then shows how
long before it the motion was free.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.preprocess.landing import Landing
from sprung.preprocess.release import Release

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_PERIOD = 0.7
"""s after a moment over which power is averaged: a period of a body mode."""

_REMAINING = 0.25
"""Part of the largest power that remains where a motion begins to die away: of a mode that loses half its amplitude in a
quarter of a second a third remains, of one that is damped less, more."""

_CLEAR = 4.0
"""Largest over least power, which is noise, of a channel that shows the motion at all."""

_LEVEL = 0.25
"""Part of the recording at its end over which a channel's level is averaged."""

DIES_AWAY = "the motion has begun to die away"
"""Why a decay after a push or a bump begins where the recording alone shows it."""


def detect_end_of_drive(values: Real, rate: float, release: Release | None, clipped: Flags) -> Landing:
    """Detect from when on a motion dies away.

    Parameters
    ----------
    values
        Shape (channel, time), SI; NaN in channels that are left out.
    rate
        Samples per second.
    release
        The first motion; None where the recording shows no rest before it.
    clipped
        Samples at full scale, shape (channel, time).

    Returns
    -------
    Landing
        Free vibration is possible from the first motion on, and after the last sample that clips.
    """
    samples = values.shape[1]
    first = 0 if release is None else release.sample
    possible = max(first, int(np.flatnonzero(clipped.any(axis=0))[-1]) + 1 if clipped.any() else 0)
    used = values[np.logical_not(np.isnan(values).any(axis=1))]
    moved = used - np.median(used[:, samples - max(int(_LEVEL * samples), 1) :], axis=1)[:, None]
    width = max(round(_PERIOD * rate), 1)
    power = uniform_filter1d(moved**2, width, axis=1, mode="constant", origin=-(width // 2))
    largest, least = power.max(axis=1), power[:, : max(samples - width, 1)].min(axis=1)
    clear = largest > _CLEAR * np.maximum(least, 0.0)
    driven = (power - least[:, None])[clear] > _REMAINING * (largest - least)[clear, None]
    last = int(np.flatnonzero(driven.any(axis=0))[-1]) + 1 if driven.any() else first
    return Landing(min(possible, samples), min(max(possible, last), samples), DIES_AWAY)
