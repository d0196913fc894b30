"""Clipping: samples at which a sensor, its amplifier or the logger was at its full scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.release import resolution
from sprung.units import si_symbol
from sprung.vehicle import Sensor

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_FULL = 0.999
"""Part of the full scale from which a reading is at it."""

_BEYOND = 1.02
"""Full scales from which a reading is beyond it: then the full scale is another one than stated."""

_PLATEAU = 3
"""Samples in a row at a channel's extreme which are no chance, once its shoulders are steep."""

_STEEP = 4.0
"""Steps of resolution that a signal has to jump on to a plateau and off it: a peak that is merely flat does not."""

_NOISY, _COARSE = 6.0, 0.05
"""Changes from sample to sample that it has to jump likewise, where a step of resolution is no small part of one: then noise
may stay on one step for some samples, and a finer signal never does."""


def check_full_scale(recording: Recording, sensors: Sequence[Sensor]) -> Recording:
    """Take the full scale of each channel from its sensor where no file states it, and drop one that is exceeded.

    Parameters
    ----------
    recording
        As it was read.
    sensors
        One for each channel, with a range in its own unit, or else in m/s².

    Returns
    -------
    Recording
        With a fault for each channel that exceeds its range.
    """
    stated = recording.full_scale or tuple(
        None if sensor.range is None else sensor.range * sensor.si_factor for sensor in sensors
    )
    if not any(stated):
        return replace(recording, full_scale=stated)
    kept, faults = list(stated), []
    for channel, peak in enumerate(np.abs(recording.values).max(axis=1, initial=0.0).tolist()):
        scale, unit = stated[channel], si_symbol(sensors[channel].quantity)
        if scale is None or not peak > _BEYOND * scale:
            continue
        kept[channel] = None
        faults.append(
            Fault(
                "unit",
                f"{recording.name}: {recording.channels[channel]}",
                f"readings reach {peak:.4g} {unit}, beyond the range of {scale:.4g} {unit}; the range was not used",
                "Correct the range or the unit of the sensor in the campaign file.",
            )
        )
    return replace(recording, full_scale=tuple(kept), faults=(*recording.faults, *faults))


def detect_clipping(recording: Recording) -> Flags:
    """Detect the clipped samples.

    Parameters
    ----------
    recording
        With its full scale, where it is known; a plateau at a channel's own extreme shows clipping as well.

    Returns
    -------
    ndarray
        Shape (channel, time).
    """
    values = recording.values
    found = np.zeros(values.shape, dtype=bool)
    if not values.shape[1]:
        return found
    for channel, full_scale in enumerate(recording.full_scale):
        if full_scale is not None and not np.isnan(values[channel]).any():
            found[channel] = np.abs(values[channel]) >= _FULL * full_scale
    # Whatever the sensor can show, its amplifier or the logger may be able to show less.
    for sign, extreme in ((1.0, values.max(axis=1)), (-1.0, values.min(axis=1))):
        at_extreme = values == extreme[:, None]
        for channel in np.flatnonzero(np.count_nonzero(at_extreme, axis=1) >= _PLATEAU).tolist():
            found[channel] |= _detect_plateaus(sign * values[channel])
    return found


def _detect_plateaus(signal: Real) -> Flags:
    """Detect plateaus at the maximum of one channel, shape (time,).

    A coarse signal may stay at its maximum unclipped, but then it does not come on to go beyond.
    """
    step, usual = float(resolution(signal[None])[0]), float(np.median(np.abs(np.diff(signal))))
    coarse = step > _COARSE * usual
    jump = max(_STEEP * step, _NOISY * usual if coarse else 0.0)
    extreme = float(signal.max())
    at = np.concatenate([[0], (signal == extreme).astype(int), [0]])
    begins, ends = np.flatnonzero(np.diff(at) == 1), np.flatnonzero(np.diff(at) == -1)
    found = np.zeros(signal.size, dtype=bool)
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        last = signal.size - 1
        outside = signal[[begin - 1 if begin else 0, end if end < last else last]]
        if end - begin >= _PLATEAU and np.all(extreme - outside > jump):
            found[begin:end] = not coarse or _extrapolate_peak(signal, begin, end) > extreme + jump
    return found


def _extrapolate_peak(signal: Real, begin: int, end: int) -> float:
    """Return what a plateau's middle would read had the signal gone on as it came and as it left (a cubic of Hermite)."""
    if begin < 2 or end > signal.size - 2:
        return np.inf
    came, left = signal[begin - 1] - signal[begin - 2], signal[end] - signal[end + 1]
    return float((signal[begin - 1] + signal[end]) / 2 + (end - begin + 1) / 8 * (came + left))
