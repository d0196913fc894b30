"""Drift: a level at rest that walks through the record, and is taken off where it is seen to walk evenly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.release import Release, resolution
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_END = 1.0
"""s at the end of a recording that its last level is taken from, if they are no more than a third of the motion."""

_SURE = 5.0
"""Standard errors by which the last level has to differ from the first."""

_MATTERS = 1.0
"""Times the noise below which a drift does not matter."""

_MAY_BE = 3.0
"""Standard errors by which the colour of a short rest may be another one than it seems."""

_AGREES = 4.0
"""Standard errors within which the slopes at rest have to be that of the straight line between the levels, and not none."""

_LEAST = 1e-3
"""m/s² below which no drift matters."""


class _Stretch(NamedTuple):
    """A stretch of samples at rest, or nearly so: its level and slope, shape (channel,), and by what noise gets into them."""

    level: Real
    slope: Real
    time: float
    """s, of its middle."""
    to_level: float
    to_slope: float


def remove_drift(recording: Recording, release: Release | None, sensors: Sequence[Sensor]) -> Recording:
    """Take off the drift of sensors that feel gravity, and name what is none but looks like it.

    Parameters
    ----------
    recording
        As it was read.
    release
        The release in it; without one the level before the motion is not known.
    sensors
        One for each channel.

    Returns
    -------
    Recording
        With a fault for each channel whose level at the end is another than before the release.

    Notes
    -----
    Before the release and once it has died away the vehicle is at rest, and a sensor reads the same. If its level walks,
    before the release and at the end already at the rate that leads from one level to the other, it drifts, and the
    straight line is taken off. If it does not, the sensor or the vehicle has settled at another angle, or drifts in some
    other way: nothing is changed.
    """
    if release is None:
        return recording
    rest, first = release.rest.noise.shape[1], release.sample - 1 - release.rest.noise.shape[1]
    end = min(round(_END * recording.rate), (recording.values.shape[1] - release.sample) // 3)
    if end < rest / 4 or rest < 4:
        return recording
    noise = np.maximum(release.rest.noise.std(axis=1), np.finfo(float).eps)
    since = recording.values.shape[1] - end
    before = _stretch(recording.values[:, first : first + rest], first, recording.rate)
    after = _stretch(recording.values[:, since:], since, recording.rate)
    walked = after.level - before.level
    slope = walked / (after.time - before.time)
    # What still moves at the end, a drift apart, hides its level.
    still = recording.values[:, since:] - slope[:, None] * np.arange(end) / recording.rate
    moves = np.sqrt(np.maximum(still.var(axis=1) - noise**2, 0.0))
    coarse = resolution(recording.values) / np.sqrt(6)
    colour = _of_means(release.rest.noise)
    error = np.sqrt(colour * (before.to_level**2 + after.to_level**2) * noise**2 + moves**2 + coarse**2)
    direct = np.array([sensor.high_pass is None for sensor in sensors])
    seen = direct & (np.abs(walked) > np.maximum(_SURE * error, np.maximum(_MATTERS * noise, _LEAST)))
    errors = np.array([before.to_slope * noise, after.to_slope * np.hypot(noise, np.sqrt(end) * moves)])
    weight = (errors**-2).sum(axis=0)
    walks = (np.array([before.slope, after.slope]) * errors**-2).sum(axis=0) / weight
    even = seen & ((walks - slope) ** 2 * weight < _AGREES**2)
    # Walking or settled: what drifts in one recording drifts alike, and all its channels tell together.
    even &= float(((walks**2 - (walks - slope) ** 2) * weight)[even].sum()) > _AGREES**2
    faults = [
        Fault(
            "drift",
            f"{recording.name}: {recording.channels[channel]}",
            f"baseline drift of {walked[channel]:+.2g} m/s² from before the release to the end"
            + (
                ", removed as a straight line"
                if even[channel]
                else ", which is not a straight line; nothing was changed"
            ),
            "Let the sensor and the logger warm up before the test, and see that nothing strains the sensor's base.",
        )
        for channel in np.flatnonzero(seen).tolist()
    ]
    if not faults:
        return recording
    time = np.arange(recording.values.shape[1]) / recording.rate - before.time
    values = recording.values - np.where(even, slope, 0.0)[:, None] * time
    return replace(recording, values=values, faults=(*recording.faults, *faults))


def _of_means(noise: Real) -> Real:
    """Give by how much the variance of means of noise at rest exceeds that of white noise at most, shape (channel,).

    That is (1 + rho)/(1 - rho) with the correlation rho of neighbours, which a short rest tells badly: its own, or that of
    all channels together and what that may be beyond.
    """
    known = noise[~np.isnan(noise).any(axis=1)]
    energy, neighbours = np.sum(known**2, axis=1), np.sum(known[:, 1:] * known[:, :-1], axis=1)
    together = float(neighbours.sum() / max(energy.sum(), np.finfo(float).tiny))
    together += _MAY_BE * np.sqrt(max(1 - together**2, 0.0) / max(known.size, 1))
    colours = np.full(len(noise), together)
    own = neighbours / np.maximum(energy, np.finfo(float).tiny)
    colours[~np.isnan(noise).any(axis=1)] = np.maximum(own, together)
    rho = np.clip(colours, 0.0, 1 - 1 / noise.shape[1])
    of_means: Real = (1 + rho) / (1 - rho)
    return of_means


def _stretch(values: Real, first: int, rate: float) -> _Stretch:
    count = values.shape[1]
    window = np.hanning(count + 2)[1:-1]
    window /= window.sum()
    time = (np.arange(count) - (count - 1) / 2) / rate
    spread = float(time @ time)
    middle = (first + (count - 1) / 2) / rate
    return _Stretch(values @ window, values @ time / spread, middle, float(np.sqrt(window @ window)), spread**-0.5)
