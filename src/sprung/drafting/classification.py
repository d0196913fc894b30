"""The exact look at one event of a long recording: whether a vehicle was dropped, and how long it vibrates freely.

What tells a drop from a knock is physics, not a pattern. Before the release the sensors rest. At the release the force
under a wheel vanishes while its spring has not yet moved, so the wheel goes down faster than gravity could take it,
beyond -1 g; nothing else at a standing vehicle does that for longer than a blow lasts. The body follows towards free
fall, since its springs slacken. Then comes the impact, and a body that swings on its springs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from sprung.preprocess import IMPACT, RING, RING_TO, SPEED, DropFeatures, Release, detect_release, look_at
from sprung.units import STANDARD_GRAVITY

Real = NDArray[np.float64]

BEFORE = 1.0
"""s before the release that are worth having: rest level and noise."""

AHEAD = 0.35
"""s before an event with which the exact look begins."""

AFTER = 12.0
"""s after the release beyond which no vehicle vibrates."""

_BODY_SPEED = 0.15
"""m/s downward that the body gains at least, where no sensor is on a wheel."""

_BODY_DEPTH = 3.0
"""m/s² below rest that the body reaches at least, where no sensor is on a wheel."""

_BODY_LASTS = 0.02
"""s that the fall of a body lasts at least, speed over depth: a knock is over sooner, or swings back."""

_RESTLESS = 0.15
"""Part of the depth of a fall that may be movement at rest, root-mean-square: an engine may idle, nobody may rock the body."""

_BIN = 0.005
"""s: step of the envelopes in which disturbances are looked for."""

_HOPPING = 1.0
"""s after the landing in which wheels may hop: a jerk within it is no disturbance."""

_SWING, _HOP = 1.25, 0.3
"""s: a period of the slowest body mode and of wheel hop; free vibration never exceeds what it did that long before."""

_RISE = 0.02
"""s that a disturbance may take to rise."""

_MORE = 3.0
"""By how much more than free vibration a disturbance has to move a channel."""

_STANDS_OUT = 10.0
"""Standard deviations of the rest beyond which a single reading is none of its noise."""

_MISSING = 0.05
"""Part of a channel's samples around an event that may be missing."""

_QUIET = 1.0
"""s in which nothing rises above the noise once the vibration has faded: a body crosses zero more often."""

_SPARED = 0.05
"""s before a disturbance at which the use ends."""

_SHOWN = 3.0
"""s after the release that are kept at least, and 1 s after the vibration has faded, where nothing disturbs them."""


@dataclass(frozen=True, eq=False)
class Fall:
    """What the exact look at a drop gives; samples count within the values looked at.

    Attributes
    ----------
    first, release, landing, faded, last
        Samples: from when the vehicle rests, the first that moves, the first after the last wheel to fall has met the
        ground, the first at which nothing rises above the noise any more, and the last that is undisturbed.
    seen
        What the channels read.
    ended
        Why it ends there, in words.
    """

    first: int
    release: int
    landing: int
    faded: int
    last: int
    seen: DropFeatures
    ended: str


def classify_event(values: Real, rate: float, event: int, wheels: NDArray[np.bool_] | None) -> Fall | str:
    """Say whether an event is a drop.

    Parameters
    ----------
    values
        Shape (channel, time), m/s², around the event; from where the last disturbance has ended.
    rate
        Samples per second.
    event
        Sample at which something begins to move.
    wheels
        Which channels are known to be on wheels, shape (channel,); None where nobody knows.

    Returns
    -------
    Fall or str
        If it is none, the reason in words.
    """
    begin = max(0, event - int(AHEAD * rate))
    end = min(values.shape[1], event + int((IMPACT + RING_TO + 0.1) * rate))
    missing = np.isnan(values[:, begin:end]).mean(axis=1)
    whole = missing <= _MISSING
    if not whole.any():
        return "every channel has gaps here"
    values = _bridged(values, whole & (missing > 0))
    found = detect_release(values[whole, begin:end], rate)
    if found is None or begin + found.sample > event + int(IMPACT * rate):
        return "nothing rests before it, so it is no release"
    release = begin + found.sample
    level, noise = _of_all(found, whole)
    seen, landing, moved, slow, gained = look_at(values, rate, release, level, noise, wheels)
    refused = _refused(seen, gained, wheels)
    if refused is not None:
        return refused
    first = _rest_begins(moved, noise, release, seen.peak, rate)
    faded, last, ended = _until(moved, slow, noise, release, landing, rate)
    return Fall(first, release, landing, faded, last, seen, ended)


def _bridged(values: Real, gapped: NDArray[np.bool_]) -> Real:
    """Bridge the gaps of some channels by straight lines: enough to see a drop, if not to identify from."""
    if not gapped.any():
        return values
    values, sample = values.copy(), np.arange(values.shape[1])
    for channel in np.flatnonzero(gapped):
        there = np.isfinite(values[channel])
        values[channel] = np.interp(sample, sample[there], values[channel, there])
    return values


def _of_all(found: Release, whole: NDArray[np.bool_]) -> tuple[Real, Real]:
    level, noise = np.full(whole.size, np.nan), np.full(whole.size, np.nan)
    level[whole], noise[whole] = found.rest.level, found.rest.noise.std(axis=1)
    return level, noise


def _refused(seen: DropFeatures, gained: Real, wheels: NDArray[np.bool_] | None) -> str | None:
    """Give the reason why this is no drop; None where it is one."""
    noise, depth, speed, swing = seen.noise, seen.depth, seen.speed, seen.swing
    candidates = np.ones(depth.size, dtype=bool) if wheels is None else wheels
    wheel = candidates & (depth > STANDARD_GRAVITY) & (speed > SPEED)
    body = (depth > _BODY_DEPTH) & (gained > _BODY_SPEED) & (gained > _BODY_LASTS * depth)
    if not wheel.any() and (body.sum() < 2 or (wheels is not None and wheels.any())):
        deepest = np.nan_to_num(np.where(candidates, depth, 0.0))
        channel = int(np.argmax(deepest))
        reached, fast = deepest[channel] / STANDARD_GRAVITY, float(np.nan_to_num(speed[channel]))
        return (
            f"nothing falls: the deepest reading is {reached:.2g} g below rest and gains {fast:.2g} m/s downward, where a "
            f"wheel let go goes beyond 1 g and gains {SPEED:g} m/s or more"
        )
    falls = wheel if wheel.any() else body
    rest = noise / np.maximum(depth, 1e-9)
    if (np.nan_to_num(rest[falls]) > _RESTLESS).all():
        return f"nothing rests before it: what falls moves by {rest[falls].min():.0%} of the fall already"
    second = float(np.sort(np.nan_to_num(swing))[-2:].min(initial=np.inf))
    if second < RING:
        return (
            f"no body swings after it: {second:.2g} m/s² in the second-largest channel, where a dropped vehicle exceeds "
            f"{RING:g} m/s²"
        )
    return None


def _rest_begins(moved: Real, noise: Real, release: int, peak: Real, rate: float) -> int:
    """Go back from the release as far as every channel rests, at most as far as is worth having."""
    first = max(0, release - int(BEFORE * rate))
    quiet = np.fmax(_STANDS_OUT * noise, 0.03 * peak)[:, None]
    moves = (np.abs(moved[:, first : max(release - 1, first)]) > quiet).any(axis=0)
    return first + int(np.flatnonzero(moves)[-1]) + 1 if moves.any() else first


def _until(moved: Real, slow: Real, noise: Real, release: int, landing: int, rate: float) -> tuple[int, int, str]:
    """Give when the vibration has faded, the last undisturbed sample, and why it is the last."""
    width = max(round(_BIN * rate), 1)
    bins = (moved.shape[1] - release) // width
    bin_, whole = width / rate, slice(release, release + bins * width)
    jerk = np.abs(np.diff(moved, axis=1, prepend=moved[:, :1]))
    quiet_jerk = jerk[:, max(0, release - int(AHEAD * rate)) : max(release - 1, 1)]
    size, jerks = (
        np.nan_to_num(each[:, whole]).reshape(len(moved), bins, width).max(axis=2) for each in (np.abs(moved), jerk)
    )
    above = np.abs(np.nan_to_num(slow[:, whole])) > 3 * np.nan_to_num(noise)[:, None] + 0.01
    faded = release + _first_quiet(np.flatnonzero(above.any(axis=0)), above.shape[1], int(_QUIET * rate))

    disturbed = _exceeds(size, _STANDS_OUT * np.nan_to_num(noise), _SWING / bin_, _RISE / bin_)
    disturbed |= _exceeds(jerks, _STANDS_OUT * np.nan_to_num(quiet_jerk.std(axis=1)), _HOP / bin_, _RISE / bin_)
    disturbed[:, : int((landing - release) / width + _HOPPING / bin_)] = False
    # Free vibration ends where at least two channels are disturbed at about the same time, or one is for longer than a spike.
    near = maximum_filter1d(disturbed.astype(np.int8), 9, axis=1, mode="constant")
    together = (near.sum(axis=0) >= 2) | (
        uniform_filter1d(disturbed.astype(float), 3, axis=1, mode="constant") > 0.9
    ).any(axis=0)
    events = np.flatnonzero(together)
    last = release + int(AFTER * rate)
    ended = f"{AFTER:g} s after the release nothing is expected any more"
    if events.size:
        event = release + max(int(events[0] * width - _SPARED * rate), 0)
        faded = min(faded, event)
        if event <= last:
            last, ended = event, "the next disturbance begins"
    if moved.shape[1] - 1 < last:
        last, ended = moved.shape[1] - 1, "the recording ends"
    shown = max(faded + int(rate), release + int(_SHOWN * rate))
    if shown < last:
        last, ended = shown, "the vibration has faded into the noise"
    return min(faded, last), last, ended


def _first_quiet(moving: NDArray[np.int64], samples: int, length: int) -> int:
    """Give where the first stretch without movement begins that lasts so long, or goes on to the end."""
    edges = np.concatenate([[-1], moving, [samples + length]])
    return int(edges[int(np.argmax(np.diff(edges) > length))]) + 1


def _exceeds(envelope: Real, noise: Real, memory: float, spared: float) -> NDArray[np.bool_]:
    """Say where an envelope exceeds what it was within the memory before, which free vibration does not; all in bins.

    The last few bins are spared, so that a disturbance stands out for as long as it takes to rise.
    """
    bins, late = max(int(memory), 1), min(max(round(spared), 1), envelope.shape[1])
    before = np.concatenate([np.repeat(envelope[:, :1], late, axis=1), envelope[:, :-late]], axis=1)
    most = maximum_filter1d(before, bins, axis=1, origin=(bins - 1) // 2, mode="nearest")
    return np.asarray(envelope > _MORE * most + noise[:, None])
