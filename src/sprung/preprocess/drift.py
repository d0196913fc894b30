"""Baseline drift: a level at rest that changes through the record; a linear drift is removed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY, si_symbol
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_END = 1.0
"""s at the end of a recording over which its last level is averaged, at most a third of the motion."""

_SURE = 5.0
"""Standard errors by which the last level has to differ from the first."""

_MATTERS = 1.0
"""Times the noise below which a drift does not matter."""

_MAY_BE = 3.0
"""Standard errors by which the autocorrelation of a short rest may be larger than estimated."""

_AGREES = 4.0
"""Standard errors within which the slopes at rest must equal that of the line between the levels, and beyond which not zero."""

_TURN = 0.035
"""rad by which a vehicle turns that is dropped on one side from 5 cm."""

_LEAST = 1e-3
"""m/s² below which no drift matters."""


def remove_drift(recording: Recording, release: Release | None, sensors: Sequence[Sensor]) -> Recording:
    """Remove the linear drift of DC-coupled sensors, and report any other change of their level.

    Parameters
    ----------
    recording
        As it was read.
    release
        The release in it; without one the level before the motion is not known, and nothing is changed.
    sensors
        One for each channel.

    Returns
    -------
    Recording
        With a fault for each channel whose level at the end is another than before the release.

    Notes
    -----
    Before the release and once the motion has died away the vehicle is at rest, and a sensor reads the same. If its slope,
    before the release and at the end, already is that of the line from one level to the other, it drifts, and the line is
    subtracted. If not, the sensor or the vehicle has settled at another angle, or drifts in some other way: nothing is changed.
    """
    if release is None:
        return recording
    values, rate, noise = recording.values, recording.rate, release.noise
    rest, first = noise.shape[1], release.sample - 1 - noise.shape[1]
    end = min(round(_END * rate), (values.shape[1] - release.sample) // 3)
    if end < rest / 4 or rest < 4:
        return recording
    since = values.shape[1] - end
    std = np.maximum(noise.std(axis=1), np.finfo(float).eps)
    level, slope_at_rest, level_error, slope_error = _level_and_slope(values[:, first : first + rest], rate)
    last_level, last_slope, last_level_error, last_slope_error = _level_and_slope(values[:, since:], rate)
    middle = (first + (rest - 1) / 2) / rate
    drift = last_level - level
    slope = drift / ((since + (end - 1) / 2) / rate - middle)
    # What still moves at the end, a drift apart, hides its level.
    still = values[:, since:] - slope[:, None] * np.arange(end) / rate
    motion = np.sqrt(np.maximum(still.var(axis=1) - std**2, 0.0))
    quantisation = release.step / np.sqrt(6)
    inflation = _variance_inflation_of_means(noise)
    error = np.sqrt(inflation * (level_error**2 + last_level_error**2) * std**2 + motion**2 + quantisation**2)
    # Of a displacement or a force the level depends on where the vehicle stands.
    direct = np.array([one.high_pass is None and one.quantity not in ("displacement", "force") for one in sensors])
    # A tilted sensor shows a part of gravity, which is another one where the vehicle has come to rest at another angle.
    tilts = [sensor.tilt_std if sensor.reads_gravity else 0.0 for sensor in sensors]
    turned = _SURE * np.radians(tilts) * _TURN * STANDARD_GRAVITY
    drifts = direct & (
        np.abs(drift) > np.maximum.reduce([_SURE * error, _MATTERS * std, turned, np.full_like(std, _LEAST)])
    )
    if not drifts.any():
        return recording
    errors = np.array([slope_error * std, last_slope_error * np.hypot(std, np.sqrt(end) * motion)])
    weight = (errors**-2).sum(axis=0)
    own_slope = (np.array([slope_at_rest, last_slope]) * errors**-2).sum(axis=0) / weight
    linear = drifts & ((own_slope - slope) ** 2 * weight < _AGREES**2)
    # What drifts in one recording drifts alike: all its channels together decide between a drift and a new level.
    linear &= float(((own_slope**2 - (own_slope - slope) ** 2) * weight)[linear].sum()) > _AGREES**2
    faults = [
        Fault(
            "drift",
            f"{recording.name}: {recording.channels[channel]}",
            f"baseline drift of {drift[channel]:+.2g} {si_symbol(sensors[channel].quantity)} "
            "from before the release to the end, "
            + (
                "removed as a straight line" if linear[channel] else "which is not a straight line; nothing was changed"
            ),
            "Let the sensor and the logger warm up before the test, and see that nothing strains the sensor's base.",
        )
        for channel in np.flatnonzero(drifts).tolist()
    ]
    time = np.arange(values.shape[1]) / rate - middle
    values = values - np.where(linear, slope, 0.0)[:, None] * time
    return replace(recording, values=values, faults=(*recording.faults, *faults))


def _variance_inflation_of_means(noise: Real) -> Real:
    """Return the largest likely variance of means of noise at rest over that of means of white noise, shape (channel,).

    That is (1 + rho)/(1 - rho) with the correlation rho of neighbouring samples, of which a short rest is a poor estimate: its
    own, or that of all channels together and an allowance for its error, whichever is larger.
    """
    known = ~np.isnan(noise).any(axis=1)
    own = noise[known]
    energy, neighbours = np.sum(own**2, axis=1), np.sum(own[:, 1:] * own[:, :-1], axis=1)
    pooled = float(neighbours.sum() / max(energy.sum(), np.finfo(float).tiny))
    pooled += _MAY_BE * np.sqrt(max(1 - pooled**2, 0.0) / max(own.size, 1))
    rho = np.full(len(noise), pooled)
    rho[known] = np.maximum(neighbours / np.maximum(energy, np.finfo(float).tiny), pooled)
    rho = np.clip(rho, 0.0, 1 - 1 / noise.shape[1])
    inflation: Real = (1 + rho) / (1 - rho)
    return inflation


def _level_and_slope(values: Real, rate: float) -> tuple[Real, Real, float, float]:
    """Return level and slope of a stretch of samples, shape (channel,), and the standard errors that unit noise gives them."""
    count = values.shape[1]
    window = np.hanning(count + 2)[1:-1]
    window /= window.sum()
    time = (np.arange(count) - (count - 1) / 2) / rate
    spread = float(time @ time)
    return values @ window, values @ time / spread, float(np.sqrt(window @ window)), spread**-0.5
