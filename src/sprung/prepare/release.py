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

_STANDS_OUT = 30.0
"""Peak over the spread of the first samples in the clearest channel, below which the recording does not begin at rest."""

_REST = 0.3
"""s before the release from which rest level and noise are taken."""


class Rest(NamedTuple):
    """What the sensors read while the vehicle stood on the blocks.

    Attributes
    ----------
    level
        Mean reading of each channel, m/s², shape (channel,); NaN where the recording shows no rest.
    noise
        Readings less level and creep, m/s², shape (channel, time); no samples where the recording shows no rest.
    """

    level: Real
    noise: Real


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
    rest: Rest


def no_rest(channels: int) -> Rest:
    """Give the rest of a recording that shows none."""
    return Rest(np.full(channels, np.nan), np.empty((channels, 0)))


def find_release(values: Real, rate: float) -> Release | None:
    """Find the release.

    Parameters
    ----------
    values
        Usable channels, shape (channel, time), m/s².
    rate
        Samples per second.

    Returns
    -------
    Release or None
        None where the recording shows no rest before the motion.

    Notes
    -----
    The landing is the largest event of a recording. Going back from it, the release is where the last stretch ends in
    which every channel stays within its own noise.
    """
    width = max(round(_QUIET * rate), 3)
    if values.shape[1] < 4 * width:
        return None
    level = np.median(values[:, :width], axis=1, keepdims=True)
    spread = 1.4826 * np.median(np.abs(values[:, :width] - level), axis=1, keepdims=True)
    deviation = np.abs(values - level)
    peak = deviation.max(axis=1, keepdims=True)
    moving = (deviation > np.maximum(8 * spread, _SMALL * peak)).any(axis=0)
    if np.max(peak / np.maximum(spread, 1e-300)) < _STANDS_OUT:
        return None
    landing = int(np.argmax((deviation / np.maximum(peak.max(), 1e-300)).max(axis=0)))
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
    return Release(sample, Rest(mean, rest - mean[:, None] - slope[:, None] * centred))
