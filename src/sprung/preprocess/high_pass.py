"""AC-coupled sensors: the first-order high-pass is undone, and what another cut-off would change is known.

A first-order high-pass with the cut-off ω turns x into y with ẏ + ω y = ẋ, so x is y + ω ∫ y dt from a rest on. The derivative
of x by ω is the integral of y; that is itself an integral of x, with an exponential memory of 1/ω.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.signal import lfilter

from sprung.campaign import Recording
from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.release import Release
from sprung.vehicle import Sensor

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

AC_LEVEL = 0.5
"""m/s² at rest below which a sensor does not read gravity, whatever its unit."""


def undo_high_pass(recording: Recording, release: Release | None, sensors: Sequence[Sensor]) -> Recording:
    """Undo the high-pass of AC-coupled sensors.

    Parameters
    ----------
    recording
        As it was read.
    release
        The release in it: at rest before it, the filter had settled. Without one nothing is changed.
    sensors
        One for each channel; those with a `high_pass` are undone.

    Returns
    -------
    Recording
        As DC-coupled sensors would have made it.
    """
    filtered = [
        channel for channel, sensor in enumerate(sensors) if sensor.high_pass is not None and recording.usable[channel]
    ]
    if release is None or not filtered:
        return recording
    cutoffs = 2 * np.pi * np.array([sensors[channel].high_pass for channel in filtered], dtype=float)
    moved = recording.values[filtered] - release.level[filtered, None]
    values = recording.values.copy()
    values[filtered] += cutoffs[:, None] * cumulative_trapezoid(moved, dx=1 / recording.rate, axis=1, initial=0)
    history = [
        f"{sensors[channel].channel}: high-pass of {sensors[channel].high_pass:g} Hz undone" for channel in filtered
    ]
    return replace(recording, values=values, history=(*recording.history, *history))


def integrate_from_rest(
    values: Real, rate: float, release: Release | None, high_pass: Sequence[float], sample: int
) -> Real:
    """Integrate the reading of each sensor above its rest up to a sample, with the memory of the high-pass that was undone.

    Parameters
    ----------
    values
        With every high-pass undone, m/s², shape (channel, time).
    rate
        Samples per second.
    release
        The release in them; without one the integral is zero.
    high_pass
        Cut-off of the high-pass that was undone in each channel, Hz, 0 where none was.
    sample
        Last sample of the integral.

    Returns
    -------
    ndarray
        m/s, shape (channel,).
    """
    if release is None:
        return np.zeros(len(values))
    # By the trapezoidal rule: of each sample what is remembered at the last one.
    weights = np.ones(sample + 1)
    weights[[0, -1]] /= 2
    if not sample:
        weights[:] = 0.0
    if any(high_pass):
        age = np.arange(sample, -1, -1) / rate
        weights = weights * np.exp(-2 * np.pi * np.array(high_pass)[:, None] * age)
    moved = values[:, : sample + 1] - release.level[:, None]
    integral: Real = (moved * weights).sum(axis=1) / rate
    return integral


def differentiate_by_cutoff(decay: FreeDecay, channels: Sequence[int] | None = None) -> Real:
    """Differentiate a decay's samples by the cut-off of their high-pass.

    Parameters
    ----------
    decay
        With the stated high-pass undone.
    channels
        Of these channels; without it, of all that do not read gravity, which no high-pass lets through.

    Returns
    -------
    ndarray
        m/s² per rad/s, shape (channel, time); 0 in other channels and in those that are left out.
    """
    changes = np.zeros_like(decay.values)
    high_pass = decay.high_pass or (0.0,) * len(changes)
    for channel in np.flatnonzero(is_ac_coupled(decay)).tolist() if channels is None else channels:
        moved = np.concatenate([decay.earlier[channel], decay.values[channel]]) - decay.rest.level[channel]
        if np.isnan(moved).any():
            continue
        kept = np.exp(-2 * np.pi * high_pass[channel] / decay.rate)
        steps = np.concatenate([[decay.initial_velocity[channel]], (kept * moved[:-1] + moved[1:]) / (2 * decay.rate)])
        changes[channel] = lfilter([1.0], [1.0, -kept], steps)[decay.earlier.shape[1] :]
    return changes


def is_ac_coupled(decay: FreeDecay) -> Flags:
    """Return which channels may be AC-coupled: at rest they do not read gravity.

    Parameters
    ----------
    decay
        With what its recording shows at rest.

    Returns
    -------
    ndarray
        Shape (channel,).
    """
    return np.asarray(decay.usable & (np.abs(np.nan_to_num(decay.rest.level, nan=np.inf)) < AC_LEVEL))
