"""The end of a push or of a bump: from when on nothing drives the vehicle, as roughly as its recording alone shows.

A body that is pushed, and a wheel on a bump, move most while they are driven or just after it. A motion that is free dies away.
So in every channel the last time at which its power is a part of the largest is after the last force; a fit then shows how
long before it the motion was free.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.campaign import DropTest
from sprung.errors import Fault
from sprung.preprocess.landing import Landing
from sprung.preprocess.release import Release

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_PERIOD = 0.7
"""s after a moment over which power is averaged: a period of a body mode."""

_REMAINING = 0.15
"""Part of the largest power that remains when a motion has certainly begun to die away: of a mode with a damping ratio of
0.6 and a natural frequency of 1.3 Hz so much remains at once, of one that is damped less, later."""

_CLEAR = 4.0
"""Largest over least power, which is noise, of a channel that shows the motion at all."""

_LEVEL = 0.25
"""Part of the recording at its end over which a channel's level is averaged."""

_GOES_ON, _CHANGED = 0.01, 0.6
"""Part of the largest power that the last period of a recording has, and of the power of the period before, from which
something still drives the vehicle: a mode with a damping ratio of 0.05 keeps half its power over a period."""

_AT_ONCE, _JUMP = 0.02, 0.7
"""s about its first motion within which a body that is let go is accelerated most, and the part of the largest reading at
least; who pushes by hand begins slowly."""

_ABOVE_NOISE = 10.0
"""Largest motion over the noise from which a channel shows how it began."""

LET_GO = "the body was let go"
"""Why a decay after a pull with a rope, or after a lift, begins with the first motion."""

DIES_AWAY = "the motion has begun to die away"
"""Why a decay after a push or a bump begins where the recording alone shows it."""


def detect_end_of_drive(drop: DropTest, release: Release | None, clipped: Flags, last: int) -> Landing | Fault:
    """Detect from when on the motion after a push or a bump dies away.

    Parameters
    ----------
    drop
        With its recording, corrected.
    release
        The first motion; None where the recording shows no rest before it.
    clipped
        Samples at full scale, shape (channel, time).
    last
        Last sample that is to be used.

    Returns
    -------
    Landing or Fault
        Free vibration is possible from the first motion on, and after the last sample that clips. A fault where no motion
        dies away.
    """
    recording, samples = drop.recording, last + 1
    used, rate = recording.values[recording.usable, :samples], recording.rate
    moved = used - np.median(used[:, samples - max(int(_LEVEL * samples), 1) :], axis=1)[:, None]
    width = min(max(round(_PERIOD * rate), 1), samples)
    power = uniform_filter1d(moved**2, width, axis=1, mode="constant", origin=-(width // 2))
    whole = power[:, : max(samples - width, 1)]
    largest, least = power.max(axis=1), np.maximum(whole.min(axis=1), 0.0)
    clear = largest > _CLEAR * least
    power, largest, least = (part[clear] for part in (power - least[:, None], largest - least, least))
    if not clear.any():
        what = "no motion in it dies away: it is as large at the end as at any time; the drop is left out"
        return Fault("no-decay", recording.name, what, _REMEDIES[drop.excitation])
    is_driven = (power > _REMAINING * largest[:, None]).any(axis=0)
    free = int(np.flatnonzero(is_driven)[-1]) + 1
    if int(np.median(power.argmax(axis=1))) + 3 * width < samples:
        at_end, before = power[:, samples - width - 1], power[:, samples - 2 * width - 1]
        part = float(np.median(at_end / largest))
        if part > _GOES_ON and np.median(at_end - _CHANGED * before) > 0 and np.median(at_end - least) > 0:
            what = (
                f"something still moves the vehicle at the end of the recording: the last {_PERIOD:g} s have "
                f"{100 * part**0.5:.0f} % of the largest motion, and it does not die away; the drop is left out"
            )
            return Fault("no-decay", recording.name, what, _REMEDIES[drop.excitation])
    first = 0 if release is None else release.sample
    noise = np.sqrt(least).tolist()
    if (
        drop.excitation == "push"
        and first
        and any(_is_let_go(own, first, rate, std) for own, std in zip(moved[clear], noise, strict=True))
    ):
        return Landing(first, first, LET_GO)
    possible = max(first, int(np.flatnonzero(clipped.any(axis=0))[-1]) + 1 if clipped.any() else 0)
    return Landing(min(possible, samples), min(max(possible, free), samples), DIES_AWAY)


def _is_let_go(moved: Real, first: int, rate: float, noise: float) -> bool:
    """Whether a channel, shape (time,), begins at a sample about as far from its level at the end as it ever is.

    A displacement has been there while the body was held; an acceleration jumps there. What rises slowly was pushed by hand,
    and noise may be as large at any time as at another.
    """
    half = max(round(_AT_ONCE * rate / 2), 1)
    smooth = np.abs(uniform_filter1d(moved, half, mode="nearest"))
    largest, before = float(smooth[first:].max()), float(smooth[max(first - half, 0)])
    after = float(smooth[first : first + half + 1].max())
    is_held, jumps = before > _JUMP * largest, after - before > _JUMP * largest
    return (is_held or jumps) and largest > _ABOVE_NOISE * noise / half**0.5


def too_short(drop: DropTest, length: float, least: float) -> Fault:
    """Return the fault that too little free vibration is recorded behind a bump or after a push.

    Parameters
    ----------
    drop
        With its recording.
    length, least
        Of free vibration, and how much is needed, s.
    """
    behind = "behind the bump" if drop.excitation == "pass" else "after the push"
    what = f"{max(length, 0.0):.2f} s of free vibration {behind}, at least {least:g} s are needed; the drop is left out"
    return Fault("no-decay", drop.recording.name, what, _REMEDIES[drop.excitation])


_REMEDIES: Mapping[str, str] = {
    "pass": "Record three seconds of flat, smooth road behind the bump, and neither brake nor steer there; or state end = ...",
    "push": "Let go of the body and leave the vehicle alone for three seconds while it is recorded; or state end = ...",
}
