"""AC-coupled sensors: what a first-order high-pass took away is put back, and what a corner otherwise would change is told.

A first-order high-pass with the corner ω turns x into y with ẏ + ω y = ẋ, so x is y + ω ∫ y dt from a rest on. By ω that
changes by the integral of y: of what was put back that is an integral too, one that forgets at the rate ω.
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

SILENT = 0.5
"""m/s² at rest below which a sensor does not feel gravity, whatever its unit."""


def undo_high_pass(recording: Recording, release: Release, sensors: Sequence[Sensor]) -> Recording:
    """Give the recording as sensors without a high-pass would have made it.

    Parameters
    ----------
    recording
        As it was read.
    release
        The release in it: at rest before it, the filter had settled.
    sensors
        One for each channel; those with a `high_pass` are undone.

    Returns
    -------
    Recording
    """
    values = recording.values
    history = []
    for channel, sensor in enumerate(sensors):
        if sensor.high_pass is not None and recording.usable[channel]:
            left = values[channel] - release.rest.level[channel]
            lost = 2 * np.pi * sensor.high_pass * cumulative_trapezoid(left, dx=1 / recording.rate, initial=0)
            values = np.vstack([values[:channel], values[channel] + lost, values[channel + 1 :]])
            history.append(f"{sensor.channel}: high-pass of {sensor.high_pass:g} Hz undone")
    return replace(recording, values=values, history=(*recording.history, *history)) if history else recording


def integrate_from_rest(recording: Recording, release: Release | None, high_pass: Sequence[float], sample: int) -> Real:
    """Integrate what each sensor read from rest up to a sample, forgetting as the high-pass does that was undone.

    Parameters
    ----------
    recording
        With every high-pass undone.
    release
        The release in it; without one nothing is integrated.
    high_pass
        Corner of the high-pass that was undone in each channel, Hz, 0 where none was.
    sample
        Up to which.

    Returns
    -------
    ndarray
        m/s, shape (channel,).
    """
    if release is None:
        return np.zeros(len(recording.values))
    moved = recording.values[:, : sample + 1] - release.rest.level[:, None]
    return _integrated(moved, recording.rate, high_pass, np.zeros(len(moved)))[:, -1]


def differentiate_by_cutoff(decay: FreeDecay) -> Real:
    """Give by how much a decay's samples change with the corner of their high-pass.

    Parameters
    ----------
    decay
        With the high-pass undone as far as one is known of.

    Returns
    -------
    ndarray
        m/s² per rad/s, shape (channel, time); 0 in channels that are left out or feel gravity, which no high-pass lets through.
    """
    through = is_ac_coupled(decay)
    if not through.any():
        return np.zeros_like(decay.values)
    level = np.where(through, decay.rest.level, np.nan)
    whole = np.concatenate([decay.earlier, decay.values], axis=1) - level[:, None]
    changes = _integrated(
        np.nan_to_num(whole), decay.rate, decay.high_pass or np.zeros(len(whole)), decay.initial_velocity
    )
    return np.where(np.isnan(whole).any(axis=1)[:, None], 0.0, changes)[:, decay.earlier.shape[1] :]


def is_ac_coupled(decay: FreeDecay) -> NDArray[np.bool_]:
    """Say of which channels the rest admits that they are AC-coupled.

    Parameters
    ----------
    decay
        With what its recording shows at rest.

    Returns
    -------
    ndarray
        Truth values, shape (channel,).
    """
    return np.asarray(decay.usable & (np.abs(np.nan_to_num(decay.rest.level, nan=np.inf)) < SILENT))


def _integrated(values: Real, rate: float, corners: Sequence[float] | Real, before: Real) -> Real:
    """Integrate by the trapezoidal rule, forgetting at the rates of the corners, Hz, from what there was before."""
    found = []
    for one, corner, first in zip(values, corners, before.tolist(), strict=True):
        kept = np.exp(-2 * np.pi * corner / rate)
        steps = np.concatenate([[first], (kept * one[:-1] + one[1:]) / (2 * rate)])
        found.append(lfilter([1.0], [1.0, -kept], steps))
    integrated: Real = np.array(found)
    return integrated
