"""Clipping: samples at which a sensor could show no more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.release import resolution
from sprung.units import acceleration_factor
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_FULL = 0.999
"""Part of the full scale from which a reading is at it."""

_BEYOND = 1.02
"""Full scales from which a reading is beyond it: then it is another one than stated."""

_PLATEAU = 3
"""Samples in a row at a channel's extreme which are no chance, once its shoulders are steep."""

_STEEP = 4.0
"""Steps of resolution that a signal has to jump on to a plateau and off it: a peak that is merely flat does not."""

_NOISY, _COARSE = 6.0, 0.05
"""Changes from sample to sample that it has to jump likewise, where a step of resolution is no small part of one: then noise
may stay on one step for some samples, and a finer signal never does."""


def check_full_scale(recording: Recording, sensors: Sequence[Sensor]) -> Recording:
    """Give a recording that no file was read for the full scale of its channels, and take back one that cannot be.

    Parameters
    ----------
    recording
        As it was read.
    sensors
        One for each channel, with a range in its own unit, or else in m/s².

    Returns
    -------
    Recording
        With a fault for each channel that reads more than its range.
    """
    stated = recording.full_scale or tuple(
        None if sensor.range is None else sensor.range * acceleration_factor(sensor.unit or "m/s^2")
        for sensor in sensors
    )
    peaks = np.abs(recording.values).max(axis=1, initial=0.0).tolist()
    kept = tuple(
        None if scale is None or peak > _BEYOND * scale else scale for peak, scale in zip(peaks, stated, strict=True)
    )
    faults = [
        Fault(
            "unit",
            f"{recording.name}: {channel}",
            f"it reads up to {peak:.4g} m/s², beyond its range of {scale:.4g} m/s²; the range was not used",
            "Correct the range or the unit of the sensor in the campaign file.",
        )
        for channel, peak, scale, now in zip(recording.channels, peaks, stated, kept, strict=True)
        if scale is not None and now is None
    ]
    return replace(recording, full_scale=kept, faults=(*recording.faults, *faults))


def detect_clipping(recording: Recording) -> NDArray[np.bool_]:
    """Find the clipped samples.

    Parameters
    ----------
    recording
        With its full scale, where it is known; a channel's own extremes tell as well.

    Returns
    -------
    ndarray
        Shape (channel, time).
    """
    values = recording.values
    found = np.zeros(values.shape, dtype=bool)
    steps = resolution(np.nan_to_num(values))
    for channel, full_scale in enumerate(recording.full_scale or [None] * len(values)):
        signal = values[channel]
        if np.isnan(signal).any() or not signal.size:
            continue
        if full_scale is not None:
            found[channel] = np.abs(signal) >= _FULL * full_scale
        # Whatever the sensor can show, its amplifier or the logger may be able to show less.
        step, usual = float(steps[channel]), float(np.median(np.abs(np.diff(signal))))
        coarse = step > _COARSE * usual
        jump = max(_STEEP * step, _NOISY * usual if coarse else 0.0)
        for way in (1.0, -1.0):
            found[channel] |= _plateaus(way * signal, jump, coarse)
    return found


def _plateaus(signal: Real, jump: float, coarse: bool) -> NDArray[np.bool_]:
    """Find plateaus at the top; what is coarse may stay there unclipped, but then it does not come on to go beyond."""
    extreme = float(signal.max())
    at = np.concatenate([[0], (signal == extreme).astype(int), [0]])
    begins, ends = np.flatnonzero(np.diff(at) == 1), np.flatnonzero(np.diff(at) == -1)
    found = np.zeros(signal.size, dtype=bool)
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        last = signal.size - 1
        outside = signal[[begin - 1 if begin else 0, end if end < last else last]]
        if end - begin >= _PLATEAU and np.all(extreme - outside > jump):
            found[begin:end] = not coarse or _beyond(signal, begin, end) > extreme + jump
    return found


def _beyond(signal: Real, begin: int, end: int) -> float:
    """Give where a plateau's middle would be had the signal gone on as it came and as it left (a cubic of Hermite)."""
    if begin < 2 or end > signal.size - 2:
        return np.inf
    came, left = signal[begin - 1] - signal[begin - 2], signal[end] - signal[end + 1]
    return float((signal[begin - 1] + signal[end]) / 2 + (end - begin + 1) / 8 * (came + left))
