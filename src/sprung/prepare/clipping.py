"""Clipping: samples at which a sensor could show no more."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.prepare.release import resolution
from sprung.units import acceleration_factor
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_FULL = 0.999
"""Part of the full scale from which a reading is at it."""

_PLATEAU = 3
"""Samples in a row at a channel's extreme which are no chance, once its shoulders are steep."""

_STEEP = 4.0
"""Steps of resolution that a signal has to jump on to a plateau and off it: a peak that is merely flat does not."""


def clipped_samples(values: Real, sensors: Sequence[Sensor]) -> NDArray[np.bool_]:
    """Find the clipped samples.

    Parameters
    ----------
    values
        Shape (channel, time), m/s²; channels that are left out NaN.
    sensors
        One for each channel; the range of one that has it decides, otherwise the channel's own extremes do.

    Returns
    -------
    ndarray
        Shape (channel, time).
    """
    found = np.zeros(values.shape, dtype=bool)
    steps = resolution(np.nan_to_num(values))
    for channel, sensor in enumerate(sensors):
        signal = values[channel]
        if np.isnan(signal).any():
            continue
        if sensor.range is not None and sensor.unit is not None:
            found[channel] = np.abs(signal) >= _FULL * sensor.range * acceleration_factor(sensor.unit)
        else:
            found[channel] = _plateaus(signal, signal.max(), steps[channel])
            found[channel] |= _plateaus(signal, signal.min(), steps[channel])
    return found


def _plateaus(signal: Real, extreme: float, step: float) -> NDArray[np.bool_]:
    at = np.concatenate([[0], (signal == extreme).astype(int), [0]])
    begins, ends = np.flatnonzero(np.diff(at) == 1), np.flatnonzero(np.diff(at) == -1)
    found = np.zeros(signal.size, dtype=bool)
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        last = signal.size - 1
        outside = signal[[begin - 1 if begin else 0, end if end < last else last]]
        if end - begin >= _PLATEAU and np.all(np.abs(outside - extreme) > _STEEP * step):
            found[begin:end] = True
    return found
