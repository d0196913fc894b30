"""The release: the moment at which the vehicle, until then at rest on the blocks, begins to fall."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]

_QUIET = 0.04
"""s: no channel stays within its noise for so long once the vehicle has begun to move."""

_SMALL = 0.03
"""Part of a channel's peak that is taken as rest however quiet the sensor: wind, somebody at the lever."""

STANDS_OUT = 30.0
"""Peak over the spread of the first samples in the clearest channel, below which the recording does not begin at rest."""

_FEW = 20
"""Samples that a first look at the noise needs at least."""

_FILLED_IN = 0.01
"""Part of the steps of a channel that may be smaller than its resolution."""

_REST = 0.3
"""s before the release from which rest level and noise are taken."""


class StaticBaseline(NamedTuple):
    """What the sensors read while the vehicle stood on the blocks.

    Attributes
    ----------
    level
        Mean reading of each channel, m/s², shape (channel,); NaN where the recording shows no rest.
    noise
        Readings less level and creep, m/s², shape (channel, time); no samples where the recording shows no rest.
    step
        The smallest step each channel ever takes as recorded, m/s², shape (channel,); NaN where the recording shows no rest.
    """

    level: Real
    noise: Real
    step: Real


class Release(NamedTuple):
    """The release in one recording.

    Attributes
    ----------
    sample
        First sample that moves.
    rest
        What the sensors read before it.
    """

    sample: int
    rest: StaticBaseline


def unknown_baseline(channels: int) -> StaticBaseline:
    """Give the rest of a recording that shows none.

    Parameters
    ----------
    channels
        How many there are.

    Returns
    -------
    Rest
        NaN everywhere.
    """
    return StaticBaseline(np.full(channels, np.nan), np.empty((channels, 0)), np.full(channels, np.nan))


def detect_release(
    values: Real, rate: float, stands_out: float = STANDS_OUT, watched: NDArray[np.bool_] | None = None
) -> Release | None:
    """Find the release.

    Parameters
    ----------
    values
        Usable channels, shape (channel, time), m/s².
    rate
        Samples per second.
    stands_out
        Peak over the spread of the first samples in the clearest channel, below which there is no release.
    watched
        Which channels tell the moment, shape (channel,); all where it is left out.

    Returns
    -------
    Release or None
        None where the recording shows no rest before the motion.

    Notes
    -----
    The landing is the largest event of a recording, all channels taken together. Going back from it, the release is where
    the last stretch ends in which every channel stays within its own noise.
    """
    width = max(round(_QUIET * rate), 3)
    if values.shape[1] < 4 * width:
        return None
    first = values[:, : max(width, _FEW)]
    level = np.median(first, axis=1, keepdims=True)
    # A coarse sensor at rest may show one step, or none at all: its noise is then no less than its resolution's.
    step = resolution(values)
    spread = np.max(
        [1.4826 * np.median(np.abs(first - level), axis=1), 0.6 * first.std(axis=1), step / np.sqrt(12)],
        axis=0,
    )[:, None]
    deviation = np.abs(values - level)
    peak = np.maximum(deviation.max(axis=1, keepdims=True), 1e-300)
    told = np.ones(len(values), dtype=bool) if watched is None else watched
    moving = (deviation > np.maximum(8 * spread, _SMALL * peak))[told].any(axis=0)
    clear = (peak > stands_out * spread) & told[:, None]
    if not clear.any():
        return None
    # A landing shows in every channel that shows anything, a spike in one.
    landing = int(np.argmax((deviation / peak * clear).sum(axis=0)))
    if landing < width:
        return None
    run = np.convolve(moving[:landing], np.ones(width), mode="valid")
    quiet = np.flatnonzero(run == 0)
    if quiet.size == 0:
        return None
    sample = int(quiet[-1]) + width
    rest = values[:, max(0, sample - int(_REST * rate)) : sample - 1]
    if rest.shape[1] < 4:
        return None
    # A vehicle on blocks may still creep a little: a straight line is taken off before the noise is read.
    centred = np.arange(rest.shape[1]) - (rest.shape[1] - 1) / 2
    slope = rest @ centred / (centred @ centred)
    mean = rest.mean(axis=1)
    return Release(sample, StaticBaseline(mean, rest - mean[:, None] - slope[:, None] * centred, step))


def resolution(values: Real) -> Real:
    """Give the smallest step that each channel usually takes, m/s²: its resolution, if that is coarse; shape (channel,).

    Steps below it are those of a few samples that were filled in.
    """
    smallest = np.zeros(len(values))
    for channel, steps in enumerate(np.abs(np.diff(values, axis=1))):
        taken = steps[steps > 0]
        if taken.size:
            few = int(_FILLED_IN * taken.size)
            smallest[channel] = np.partition(taken, few)[few]
    return smallest
