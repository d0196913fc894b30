"""The release: the moment at which the vehicle, until then at rest on the blocks, begins to fall."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_QUIET = 0.04
"""s: no channel stays within its noise for so long once the vehicle has begun to move."""

_SMALL = 0.03
"""Part of a channel's peak that counts as rest however quiet the sensor: wind, somebody at the lever."""

PEAK_OVER_NOISE = 30.0
"""Peak over the standard deviation of the first samples in the clearest channel, below which a recording shows no release."""

_FEW = 20
"""Samples from which the noise is first estimated, at the least."""

_FILLED_IN = 0.01
"""Part of the steps of a channel that may be smaller than its resolution."""

_REST = 0.3
"""s before the release from which rest level and noise are estimated."""

_SLOW = 0.1
"""s before the first motion that shows in which a push may have begun."""

_FEWEST = 4
"""Samples of a rest at the least."""


class Release(NamedTuple):
    """The release in one recording, and what the sensors read before it, while the vehicle stood on the blocks.

    Attributes
    ----------
    sample
        First sample that moves; 0 where the recording shows no rest.
    level
        Mean reading of each channel, m/s², shape (channel,); NaN where the recording shows no rest.
    noise
        Readings less level and linear creep, m/s², shape (channel, time); no samples where the recording shows no rest.
    step
        Resolution of each channel as recorded, m/s², shape (channel,); NaN where the recording shows no rest.
    """

    sample: int
    level: Real
    noise: Real
    step: Real


def unknown_release(channels: int) -> Release:
    """Return what is known of the release in a recording that shows no rest: nothing.

    Parameters
    ----------
    channels
        Number of channels.

    Returns
    -------
    Release
        NaN everywhere, without samples of noise.
    """
    return Release(0, np.full(channels, np.nan), np.empty((channels, 0)), np.full(channels, np.nan))


def detect_release(
    values: Real,
    rate: float,
    peak_over_noise: float = PEAK_OVER_NOISE,
    active: Flags | None = None,
    is_driven: bool = False,
) -> Release | None:
    """Detect the release, or the first motion of a vehicle that is pushed or reaches a bump.

    Parameters
    ----------
    values
        Shape (channel, time), m/s²; a channel with any NaN is left out.
    rate
        Samples per second.
    peak_over_noise
        Peak over the standard deviation of the first samples in the clearest channel, below which there is no release.
    active
        Channels that show the moment of the release, shape (channel,); all of them by default.
    is_driven
        Whether the vehicle was driven until it vibrated freely: the first motion counts, which may begin slowly.

    Returns
    -------
    Release or None
        Baseline NaN in channels that are left out. None where the recording shows no rest before the motion.

    Notes
    -----
    The landing is the largest event of a recording, all channels taken together. Going back from it, the release is where
    the last stretch ends in which every channel stays within its own noise.
    """
    usable = np.logical_not(np.isnan(values).any(axis=1))
    if not usable.any():
        return None
    if usable.all():
        return _detect(values, rate, peak_over_noise, active, is_driven)
    found = _detect(values[usable], rate, peak_over_noise, None if active is None else active[usable], is_driven)
    if found is None:
        return None
    level, step = np.full((2, len(values)), np.nan)
    noise = np.full((len(values), found.noise.shape[1]), np.nan)
    _, level[usable], noise[usable], step[usable] = found
    return Release(found.sample, level, noise, step)


def _detect(values: Real, rate: float, peak_over_noise: float, active: Flags | None, is_driven: bool) -> Release | None:
    width = max(round(_QUIET * rate), 3)
    if values.shape[1] < 4 * width:
        return None
    first = values[:, : max(width, _FEW)]
    level = median_by_channel(first)[:, None]
    # A coarse sensor at rest may show one step, or none at all: its noise is then no less than its resolution's.
    step = resolution(values)
    spread = np.max(
        [1.4826 * median_by_channel(np.abs(first - level)), 0.6 * first.std(axis=1), step / np.sqrt(12)], axis=0
    )[:, None]
    deviation = np.abs(values - level)
    peak = np.maximum(deviation.max(axis=1, keepdims=True), 1e-300)
    clear = peak > peak_over_noise * spread
    if active is not None:
        clear &= active[:, None]
    if not clear.any():
        return None
    # A landing shows in every channel that shows anything, a spike in one.
    landing = int(np.argmax((clear / peak).T @ deviation))
    if landing < width:
        return None
    watched = slice(None) if active is None else active
    moving = (deviation[watched, :landing] > np.maximum(8 * spread, _SMALL * peak)[watched]).any(axis=0)
    events = np.concatenate([[-1], np.flatnonzero(moving), [landing]])
    quiet = np.flatnonzero(np.diff(events) > width)
    if quiet.size == 0 or (is_driven and quiet[0] > 0):
        return None
    sample = int(events[1 if is_driven else quiet[-1] + 1])
    rested = sample - (int(_SLOW * rate) if is_driven else 1)
    rest = values[:, max(0, rested + 1 - int(_REST * rate)) : max(rested, 0)]
    if rest.shape[1] < _FEWEST:
        return None
    # A vehicle on blocks may still creep a little: a straight line is taken off before the noise is read.
    centred = np.arange(rest.shape[1]) - (rest.shape[1] - 1) / 2
    slope = rest @ centred / (centred @ centred)
    mean = rest.mean(axis=1)
    return Release(sample, mean, rest - mean[:, None] - slope[:, None] * centred, step)


def resolution(values: Real) -> Real:
    """Return the resolution of each channel: the smallest step that it usually takes.

    Parameters
    ----------
    values
        Shape (channel, time), any unit; NaN throughout in channels that are left out.

    Returns
    -------
    ndarray
        Unit of the values, shape (channel,); 0 for a channel that never changes. Steps below it are those of a few samples
        that were filled in.
    """
    steps = np.abs(np.diff(values, axis=1))
    taken = np.count_nonzero(steps > 0, axis=1)
    # In the order of size the steps of zero come first.
    rank = steps.shape[1] - taken + (_FILLED_IN * taken).astype(int)
    some = np.flatnonzero(taken)
    smallest = np.zeros(len(values))
    smallest[some] = np.sort(steps[some], axis=1)[np.arange(len(some)), rank[some]]
    return smallest


def median_by_channel(values: Real) -> Real:
    """Return the median of each channel, several times as fast as NumPy selects it: it sorts by vectors.

    Parameters
    ----------
    values
        Shape (channel, time), any unit; NaN throughout in channels that are left out.

    Returns
    -------
    ndarray
        Unit of the values, shape (channel,).
    """
    ordered, middle = np.sort(values, axis=1), values.shape[1] // 2
    median: Real = ordered[:, middle] if values.shape[1] % 2 else (ordered[:, middle - 1] + ordered[:, middle]) / 2
    return median
