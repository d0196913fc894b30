"""What the channels read during a drop: how deep they fall, how fast, how hard they land, and how they swing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.preprocess.landing import steepest_rise
from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY

Real = NDArray[np.float64]

BLOW = 0.01
"""s over which readings are averaged, so that a blow, which is shorter, does not pass for a fall."""

_FALL = 0.08
"""s after the first wheel has begun to fall within which every wheel that falls does; later one that stands may jump."""

_LATER = 0.15
"""s more in which the body, slower than wheels, gains its speed."""

IMPACT = 0.5
"""s after the release within which every wheel has met the ground."""

RING, RING_FROM, RING_TO = 0.2, 0.1, 0.8
"""m/s² that the slow swinging of a dropped vehicle exceeds, in at least two channels, and s after the landing."""

_SLOW = 0.1
"""s over which readings are averaged to see the swinging of the body and nothing faster."""

SPEED = 0.2
"""m/s downward that a wheel gains at least: blocks of 0.02 m give 0.3."""

_AT_ONCE, _DEEP = 0.0067, 0.2
"""Parts of what the wheel that fell most has of depth times onset, and of depth, from which another fell too. Over 1650 drops
of 150 vehicles one that stood has 0.005 and 0.153 at most; one let go together with it has 0.009 at least, a later one more
than 0.2 of the depth as a rule."""


@dataclass(frozen=True, eq=False)
class DropFeatures:
    """What the channels read during a drop, shape (channel,) each, NaN where a recording has gaps.

    Attributes
    ----------
    level, noise
        At rest, and the standard deviation of it, m/s².
    onset
        Directly after the release, off the rest and in the channel's own direction, m/s².
    depth
        How far below rest during the fall, m/s².
    speed
        Gained downward, m/s.
    peak
        The largest off the rest within half a second of the release, m/s².
    swing
        The largest of the slow swinging that follows, m/s².
    """

    level: Real
    noise: Real
    onset: Real
    depth: Real
    speed: Real
    peak: Real
    swing: Real

    def at(self, channels: Sequence[int | None]) -> DropFeatures:
        """Give the readings of other channels, or in another order.

        Parameters
        ----------
        channels
            Index of each in these readings; None for one that they do not have.
        """
        index = np.array([-1 if channel is None else channel for channel in channels], dtype=int)
        columns = {field.name: np.append(getattr(self, field.name), np.nan)[index] for field in fields(self)}
        return DropFeatures(**columns)

    def beside(self, other: DropFeatures) -> DropFeatures:
        """Give these readings and after them those of other channels."""
        both = {field.name: np.append(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)}
        return DropFeatures(**both)


def read_fall(values: Real, rate: float, release: Release, wheels: NDArray[np.bool_]) -> DropFeatures:
    """Read what the channels do after a release that is known.

    Parameters
    ----------
    values
        Shape (channel, time), m/s²; NaN in channels that are left out.
    rate
        Samples per second.
    release
        The release.
    wheels
        Which channels are on wheels, shape (channel,).
    """
    noise = np.where(np.isnan(release.rest.level), np.nan, release.rest.noise.std(axis=1))
    end = release.sample + int((IMPACT + RING_TO + 0.1) * rate)
    return look_at(values[:, :end], rate, release.sample, release.rest.level, noise, wheels)[0]


def look_at(
    values: Real, rate: float, release: int, level: Real, noise: Real, wheels: NDArray[np.bool_] | None
) -> tuple[DropFeatures, int, Real, Real, Real]:
    """Look at a fall.

    Parameters
    ----------
    values
        Shape (channel, time), m/s².
    rate
        Samples per second.
    release
        Sample of the release.
    level, noise
        What the channels read before it, and the standard deviation of that, m/s², shape (channel,).
    wheels
        Which channels are known to be on wheels, shape (channel,); None where nobody knows.

    Returns
    -------
    tuple
        What the channels read, the sample of the landing, their readings off the rest and the slow part of these, m/s², shape
        (channel, time), and what they gain downward in the end, m/s.
    """
    moved = values - level[:, None]
    fall = moved[:, release : release + int(IMPACT * rate)]
    # What an AC-coupled sensor calls up is not known: a wheel's first large reading after the release is downward.
    onset = fall[:, : max(int(2 * BLOW * rate), 1)].mean(axis=1)
    over = (np.abs(level) < STANDARD_GRAVITY / 2) & (onset > STANDARD_GRAVITY)
    fall = np.where(over[:, None], -fall, fall)
    smooth = np.nan_to_num(uniform_filter1d(fall, max(round(BLOW * rate), 1), axis=1, mode="nearest"))
    early = _falls(smooth, rate)
    depth = np.maximum(-smooth[:, :early].min(axis=1), 0.0)
    gained = np.maximum.accumulate(-np.cumsum(fall[:, : early + int(_LATER * rate)], axis=1) / rate, axis=1)
    speed = np.maximum(gained[:, early - 1], 0.0)
    peak = np.abs(fall).max(axis=1)
    falling = _falling(depth, wheels)
    landing = release + max((steepest_rise(fall[i], 0) for i in np.flatnonzero(falling)), default=0)
    width = max(round(_SLOW * rate), 1)
    slow = uniform_filter1d(moved, width, axis=1, mode="nearest")
    ringing = slow[:, landing + int(RING_FROM * rate) : landing + int(RING_TO * rate)]
    swing = np.maximum(np.abs(ringing).max(axis=1, initial=0.0) - 4 * noise / np.sqrt(width), 0.0)
    return DropFeatures(level, noise, onset, depth, speed, peak, swing), landing, moved, slow, gained[:, -1]


def _falls(smooth: Real, rate: float) -> int:
    """Give how many samples after the release belong to the fall: what moves at first may be a hand at the blocks."""
    deepest = int(np.argmin(smooth.min(axis=1)))
    begun = int(np.argmax(smooth[deepest] <= 0.25 * smooth[deepest].min()))
    return int(min(begun + max(int(_FALL * rate), 1), smooth.shape[1]))


def _falling(depth: Real, wheels: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    """Say which channels show a wheel that falls, or where none does the body."""
    among = np.nan_to_num(depth if wheels is None else np.where(wheels, depth, 0.0))
    if among.max(initial=0.0) < STANDARD_GRAVITY:
        among = np.nan_to_num(depth)
    return np.asarray(among >= 0.5 * max(float(among.max(initial=0.0)), 1e-12))


def detect_dropped_channels(seen: DropFeatures, sit: NDArray[np.bool_]) -> tuple[int, ...]:
    """Say which channels show the fall of a wheel; none where no wheel with a sensor fell.

    Parameters
    ----------
    seen
        What the channels read during the drop.
    sit
        Which of them sit on wheels, shape (channel,).
    """
    depth, speed = (np.where(sit, np.nan_to_num(each), 0.0) for each in (seen.depth, seen.speed))
    over = np.abs(np.nan_to_num(seen.level)) < STANDARD_GRAVITY / 2  # an AC-coupled sensor may point down
    over &= np.nan_to_num(seen.onset) > 0
    at_once = depth * np.maximum(np.nan_to_num(np.where(over, seen.onset, -seen.onset)), 0.0)
    falls = (depth > _DEEP * depth.max()) | (at_once > _AT_ONCE * at_once.max())
    any_fell = bool(((depth > STANDARD_GRAVITY) & (speed > SPEED)).any())
    return tuple(np.flatnonzero(falls & sit).tolist()) if any_fell else ()
