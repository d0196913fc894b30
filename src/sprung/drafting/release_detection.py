"""Detection of releases in displacements: a vehicle that is held, or stands on blocks, is let go and swings.

A release differs from lifting and lowering by what follows it: only a vehicle that is let go swings to and fro about the level
at which it comes to rest. Averages over some milliseconds show that; only they are kept.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from sprung.drafting.classification import AFTER, BEFORE
from sprung.drafting.detected_release import DetectedRelease
from sprung.drafting.detection import RejectedEvent
from sprung.preprocess import BLOW

Real = NDArray[np.float64]

_REST = 0.08
"""s of rest before a release at least."""

_STILL = 0.015
"""Part of all that a channel moves within which it rests: a body of 1.25 Hz moves by 0.024 about its turning point."""

_NOISE = 6.0
"""Standard deviations of a channel's noise within which it rests."""

_SETTLED = 0.5
"""s of rest by which a vibration has ended."""

_MOVES = 0.2
"""Part of all that a channel moves in a recording by which it moves at least in a release."""

_OVERSHOOT = 0.05
"""Part of the largest distance from the last level by which a vehicle that is let go swings beyond it: no lift does."""

_LAST = 0.3
"""Part of a vibration that does not come to rest whose middle is its last level."""

_FADED = 0.02
"""Part of the largest distance from the last level below which a vibration has faded."""

_ONSET = 0.12
"""s after the release in which a wheel falls off a usual block."""

_BEGUN = 0.1
"""Part of the largest distance from the last level that a channel has moved when the direction of its first motion shows."""

_SPARED = 0.05
"""s that are left out before the next motion."""

_NEXT = 0.1
"""Part of all that a channel moves, off its last level, by which the next motion begins."""


@dataclass(frozen=True, eq=False)
class Averages:
    """Averages over short times of a recording.

    Attributes
    ----------
    values
        Shape (channel, bin).
    step
        Length of a bin, s.
    start
        Time of the first bin's beginning, s.
    """

    values: Real
    step: float
    start: float


def average_pieces(pieces: Iterable[tuple[int, Real]], rate: float, start: float) -> Averages:
    """Average a recording over a few milliseconds, piece by piece.

    Parameters
    ----------
    pieces
        Index of the first sample, and readings of shape (channel, time); NaN where there is nothing.
    rate
        Samples per second.
    start
        Time of the first sample, s.

    Returns
    -------
    Averages
        Gaps are bridged by straight lines.
    """
    width = max(round(BLOW * rate), 1)
    means, rest = [], None
    for _, piece in pieces:
        joined = piece if rest is None else np.concatenate([rest, piece], axis=1)
        bins = joined.shape[1] // width
        means.append(joined[:, : bins * width].reshape(len(joined), bins, width).mean(axis=2))
        rest = joined[:, bins * width :]
    values = np.concatenate(means, axis=1) if means else np.zeros((0, 0))
    for channel in values:
        there = np.flatnonzero(np.isfinite(channel))
        if there.size:
            channel[:] = np.interp(np.arange(channel.size), there, channel[there])
    return Averages(np.nan_to_num(values), width / rate, start)


def detect_releases(
    averages: Averages, channels: tuple[str, ...]
) -> tuple[tuple[DetectedRelease, ...], tuple[RejectedEvent, ...]]:
    """Detect the releases in a recording of displacements.

    Parameters
    ----------
    averages
        Of the recording, m.
    channels
        Their names.

    Returns
    -------
    releases
        In the order of time.
    rejected
        Other motions after a rest, with the reason why they are no releases.
    """
    values, step = averages.values, averages.step
    if values.shape[1] < 2 * _SETTLED / step:
        return (), ()
    noise = noise_of(values)
    width = max(round(_REST / step), 2)
    rests = _rests(values, noise, width)
    begins = np.flatnonzero(rests[:-1] & ~rests[1:]) + 1
    found: list[DetectedRelease] = []
    rejected: list[RejectedEvent] = []
    done = 0
    for first in begins.tolist():
        if first < done:
            continue
        settled, last, why_end = _end_of_motion(values, rests, first, step)
        result = _classify(averages, noise, (_rest_begins(rests, first, width, step), first, settled, last))
        if isinstance(result, str):
            rejected.append(RejectedEvent(averages.start + first * step, result))
        if not isinstance(result, tuple):
            continue
        found.append(DetectedRelease(*result[:4], why_end, channels, *result[4:]))
        done = last
    if not found and not rejected:
        moved = (np.ptp(values, axis=1) > 2 * _NOISE * noise).any()
        if moved:
            rejected.append(RejectedEvent(averages.start, "nothing is at rest before the motion, so no release shows"))
    return tuple(found), tuple(rejected)


def noise_of(values: Real) -> Real:
    """Return the standard deviation of each channel's noise, from second differences; shape (channel, 1)."""
    second = np.abs(np.diff(values, 2, axis=1))
    return np.asarray(np.median(second, axis=1, keepdims=True) / (0.6745 * np.sqrt(6.0)))


def _rests(values: Real, noise: Real, width: int) -> NDArray[np.bool_]:
    """Return in which bins all channels have rested for some time, shape (bin,)."""
    late = (width - 1) // 2
    most = maximum_filter1d(values, width, axis=1, mode="nearest", origin=late)
    span = most - minimum_filter1d(values, width, axis=1, mode="nearest", origin=late)
    still = np.maximum(_STILL * np.ptp(values, axis=1, keepdims=True), _NOISE * noise)
    rests: NDArray[np.bool_] = (span <= still).all(axis=0)
    rests[: width - 1] = False
    return rests


def _rest_begins(rests: NDArray[np.bool_], first: int, width: int, step: float) -> int:
    """Return the bin from which the vehicle has rested, at most as far back as is worth having."""
    before = np.flatnonzero(~rests[:first])
    since = int(before[-1]) + 1 if before.size else 0
    return max(since - width + 1, first - int(BEFORE / step), 0)


def _end_of_motion(values: Real, rests: NDArray[np.bool_], first: int, step: float) -> tuple[int, int, str]:
    """Return the bin in which a motion has ended, the last undisturbed one, and why it is the last."""
    until = min(first + int(AFTER / step), rests.size)
    why = "the recording ends" if until == rests.size else f"{AFTER:g} s after the release every vehicle is at rest"
    long = round(_SETTLED / step)
    settled = np.convolve(rests[first:until], np.ones(long, dtype=int), mode="valid") == long
    if until - first < long or not settled.any():
        return until, until, why
    at_rest = first + int(np.argmax(settled))
    level = np.median(values[:, at_rest : at_rest + long], axis=1, keepdims=True)
    off = np.abs(values[:, at_rest:until] - level) > _NEXT * np.ptp(values, axis=1, keepdims=True)
    if off.any():
        until = at_rest + int(np.argmax(off.any(axis=0))) - round(_SPARED / step)
        why = "the next motion begins"
    return at_rest, until, why


def _classify(
    averages: Averages, noise: Real, at: tuple[int, int, int, int]
) -> tuple[float, float, float, float, Real, Real, Real] | str | None:
    """Return times, falls, swings and onsets of a release, or the reason why a motion is none; None for a slight one."""
    begin, first, settled, last = at
    values, step = averages.values, averages.step
    held = np.median(values[:, begin:first], axis=1, keepdims=True)
    moving = values[:, first:last]
    moved = np.abs(values[:, first : first + round(_SETTLED / step)] - held).max(axis=1)
    enough = (moved > _MOVES * np.ptp(values, axis=1)) & (moved > 2 * _NOISE * noise[:, 0])
    if not enough.any():
        return None
    if moving.shape[1] < _SETTLED / step:
        return "the recording ends, or another motion begins, directly after it"
    resting = values[:, settled:last]
    if resting.shape[1] < _SETTLED / step:
        resting = moving[:, int((1 - _LAST) * moving.shape[1]) :]
    level = (resting.max(axis=1, keepdims=True) + resting.min(axis=1, keepdims=True)) / 2
    size = np.abs(moving - level).max(axis=1)
    fall = (held - level)[:, 0]
    both_ways = np.maximum(np.maximum(moving - level, 0).max(axis=1), 0), np.maximum(level - moving, 0).max(axis=1)
    if not (np.minimum(*both_ways) > _OVERSHOOT * size)[enough].any():
        return "it comes to rest at another level without swinging beyond it: lifted or lowered, not let go"
    away = (np.abs(values[:, first:last] - level) > np.maximum(_FADED * size, _NOISE * noise[:, 0])[:, None]).any(
        axis=0
    )
    faded = first + int(np.flatnonzero(away)[-1]) + 1
    times = [averages.start + each * step for each in (begin, first, min(faded, last), last)]
    early = values[:, first - 1 : first + round(_ONSET / step)] - held
    rates = np.abs(np.diff(early, axis=1)).max(axis=1) / step
    whole = values[:, first - 1 : last] - held
    moves = np.abs(whole) > np.maximum(_BEGUN * size, _NOISE * noise[:, 0])[:, None]
    signs = np.sign(np.take_along_axis(whole, moves.argmax(axis=1)[:, None], axis=1)[:, 0])
    onset = np.where(moves.any(axis=1), signs * rates, 0.0)
    return times[0], times[1], times[2], times[3], fall, size, onset
