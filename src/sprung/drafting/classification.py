"""Classification of one event of a long recording: whether a vehicle was dropped, and how long it vibrates freely.

A drop differs from a knock by its physics, not by a pattern. Before the release the sensors rest. At the release the force
under a wheel vanishes while its spring has not yet moved, so the wheel goes down faster than gravity could take it,
beyond -1 g; nothing else at a standing vehicle does that for longer than a blow lasts. The body follows towards free
fall, since its springs slacken. Then comes the impact, and a body that swings on its springs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from sprung.drafting.drop_features import DropFeatures
from sprung.preprocess import IMPACT, WHEEL_SPEED, detect_release, find_steepest_rise, measure_fall
from sprung.units import STANDARD_GRAVITY

Real = NDArray[np.float64]

BEFORE = 1.0
"""s before the release that are kept: rest level and noise."""

AHEAD = 0.35
"""s before an event from which it is classified."""

AFTER = 12.0
"""s after the release beyond which no vehicle vibrates."""

_SWING_LEAST, _SWING_FROM, _SWING_TO = 0.2, 0.1, 0.8
"""m/s² that the slow swinging of a dropped vehicle exceeds, in at least two channels, and s after the landing."""

_SLOW = 0.1
"""s over which readings are averaged to see the swinging of the body and nothing faster."""

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
class DropEvent:
    """An event that is a drop; samples count within the values that were classified.

    Attributes
    ----------
    first, release, landing, faded, last
        Samples: from when the vehicle rests, the first that moves, the first after the last wheel to fall has met the
        ground, the first at which nothing rises above the noise any more, and the last that is undisturbed.
    features
        What the channels read.
    why_end
        The reason why it ends there, in words.
    """

    first: int
    release: int
    landing: int
    faded: int
    last: int
    features: DropFeatures
    why_end: str


def classify_event(values: Real, rate: float, event: int, wheels: NDArray[np.bool_] | None) -> DropEvent | str:
    """Classify an event as a drop or not.

    Parameters
    ----------
    values
        Shape (channel, time), m/s², around the event; from where the last disturbance has ended.
    rate
        Samples per second.
    event
        Sample at which something begins to move.
    wheels
        Which channels are known to be on wheels, shape (channel,); None where that is not known.

    Returns
    -------
    DropEvent or str
        If it is none, the reason in words.
    """
    begin = max(0, event - int(AHEAD * rate))
    end = min(values.shape[1], event + int((IMPACT + _SWING_TO + 0.1) * rate))
    missing = np.isnan(values[:, begin:end]).mean(axis=1)
    whole = missing <= _MISSING
    if not whole.any():
        return "every channel has gaps here"
    values = _bridge_gaps(values, whole & (missing > 0))
    looked_at = np.where(whole[:, None], values[:, begin:end], np.nan)
    detected = detect_release(looked_at, rate)
    if detected is None or begin + detected.sample > event + int(IMPACT * rate):
        return "nothing is at rest before it, so it is no release"
    release, level = begin + detected.sample, detected.level
    noise, moved = detected.noise.std(axis=1), values - level[:, None]
    onset, depth, speed, gained, fall = measure_fall(moved, rate, release, level)
    falling = _falling_channels(depth, wheels)
    landing = release + max((find_steepest_rise(fall[i]) for i in np.flatnonzero(falling)), default=0)
    width = max(round(_SLOW * rate), 1)
    slow = uniform_filter1d(moved, width, axis=1, mode="nearest")
    swinging = slow[:, landing + int(_SWING_FROM * rate) : landing + int(_SWING_TO * rate)]
    swing = np.maximum(np.abs(swinging).max(axis=1, initial=0.0) - 4 * noise / np.sqrt(width), 0.0)
    features = DropFeatures(level, noise, onset, depth, speed, np.abs(fall).max(axis=1), swing)
    reason = _reject(features, gained, wheels)
    if reason is not None:
        return reason
    first = _rest_begins(moved, noise, release, features.peak, rate)
    faded, last, why_end = _find_end(moved, slow, noise, release, landing, rate)
    return DropEvent(first, release, landing, faded, last, features, why_end)


def _falling_channels(depth: Real, wheels: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    """Return which channels show a wheel that falls, or where none does the body."""
    among = np.nan_to_num(depth if wheels is None else np.where(wheels, depth, 0.0))
    if among.max(initial=0.0) < STANDARD_GRAVITY:
        among = np.nan_to_num(depth)
    return np.asarray(among >= 0.5 * max(float(among.max(initial=0.0)), 1e-12))


def _bridge_gaps(values: Real, gapped: NDArray[np.bool_]) -> Real:
    """Bridge the gaps of some channels by straight lines: enough to see a drop, if not to identify from."""
    if not gapped.any():
        return values
    values, sample = values.copy(), np.arange(values.shape[1])
    for channel in np.flatnonzero(gapped):
        there = np.isfinite(values[channel])
        values[channel] = np.interp(sample, sample[there], values[channel, there])
    return values


def _reject(features: DropFeatures, gained: Real, wheels: NDArray[np.bool_] | None) -> str | None:
    """Return the reason why an event is no drop; None where it is one."""
    noise, depth, speed, swing = features.noise, features.depth, features.speed, features.swing
    candidates = np.ones(depth.size, dtype=bool) if wheels is None else wheels
    wheel = candidates & (depth > STANDARD_GRAVITY) & (speed > WHEEL_SPEED)
    body = (depth > _BODY_DEPTH) & (gained > _BODY_SPEED) & (gained > _BODY_LASTS * depth)
    if not wheel.any() and (body.sum() < 2 or (wheels is not None and wheels.any())):
        deepest = np.nan_to_num(np.where(candidates, depth, 0.0))
        channel = int(np.argmax(deepest))
        reached, fast = deepest[channel] / STANDARD_GRAVITY, float(np.nan_to_num(speed[channel]))
        return (
            f"nothing falls: the lowest reading is {reached:.2g} g below rest and gains {fast:.2g} m/s downward; a released "
            f"wheel exceeds 1 g and gains {WHEEL_SPEED:g} m/s or more"
        )
    falls = wheel if wheel.any() else body
    rest = noise / np.maximum(depth, 1e-9)
    if (np.nan_to_num(rest[falls]) > _RESTLESS).all():
        return f"nothing is at rest before it: what falls moves by {rest[falls].min():.0%} of the fall already"
    second = float(np.sort(np.nan_to_num(swing))[-2:].min(initial=np.inf))
    if second < _SWING_LEAST:
        return (
            f"no body swings after it: {second:.2g} m/s² in the second-largest channel; a dropped vehicle exceeds "
            f"{_SWING_LEAST:g} m/s²"
        )
    return None


def _rest_begins(moved: Real, noise: Real, release: int, peak: Real, rate: float) -> int:
    """Go back from the release as far as every channel rests, at most as far as is worth having."""
    first = max(0, release - int(BEFORE * rate))
    quiet = np.fmax(_STANDS_OUT * noise, 0.03 * peak)[:, None]
    moves = (np.abs(moved[:, first : max(release - 1, first)]) > quiet).any(axis=0)
    return first + int(np.flatnonzero(moves)[-1]) + 1 if moves.any() else first


def _find_end(moved: Real, slow: Real, noise: Real, release: int, landing: int, rate: float) -> tuple[int, int, str]:
    """Return when the vibration has faded, the last undisturbed sample, and why it is the last."""
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
    is_event = (near.sum(axis=0) >= 2) | (
        uniform_filter1d(disturbed.astype(float), 3, axis=1, mode="constant") > 0.9
    ).any(axis=0)
    events = np.flatnonzero(is_event)
    last = release + int(AFTER * rate)
    why_end = f"{AFTER:g} s after the release every vehicle is at rest"
    if events.size:
        event = release + max(int(events[0] * width - _SPARED * rate), 0)
        faded = min(faded, event)
        if event <= last:
            last, why_end = event, "the next disturbance begins"
    if moved.shape[1] - 1 < last:
        last, why_end = moved.shape[1] - 1, "the recording ends"
    shown = max(faded + int(rate), release + int(_SHOWN * rate))
    if shown < last:
        last, why_end = shown, "the vibration has faded into the noise"
    return min(faded, last), last, why_end


def _first_quiet(moving: NDArray[np.int64], samples: int, length: int) -> int:
    """Return where the first stretch without movement begins that lasts so long, or goes on to the end."""
    edges = np.concatenate([[-1], moving, [samples + length]])
    return int(edges[int(np.argmax(np.diff(edges) > length))]) + 1


def _exceeds(envelope: Real, noise: Real, memory: float, spared: float) -> NDArray[np.bool_]:
    """Return where an envelope exceeds what it was within the memory before, which free vibration does not; all in bins.

    The last few bins are spared, so that a disturbance stands out for as long as it takes to rise.
    """
    bins, late = max(int(memory), 1), min(max(round(spared), 1), envelope.shape[1])
    before = np.concatenate([np.repeat(envelope[:, :1], late, axis=1), envelope[:, :-late]], axis=1)
    most = maximum_filter1d(before, bins, axis=1, origin=(bins - 1) // 2, mode="nearest")
    return np.asarray(envelope > _MORE * most + noise[:, None])
