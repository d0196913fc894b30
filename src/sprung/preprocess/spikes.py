"""Spikes: a few samples far off in one channel, from a radio dropout or a knocked cable, between neighbours that are smooth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from sprung.campaign import MAX_MISSING, Recording, fill_short_gaps
from sprung.errors import Fault
from sprung.preprocess.release import resolution

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_LONGEST = 0.01
"""s between the samples beside a spike at the most; what lasts longer may be a wheel that meets the ground."""

_AROUND = 0.012
"""s before and after a spike that have to be smooth."""

_FEWEST = 6
"""Steps before and after it at the least."""

STANDS_OFF = 5.0
"""Times the largest step around it by which a spike stands off the samples on both its sides."""

_LEVEL = 3.0
"""Times the difference between its two sides by which it does: a release is steep down from one level to another."""

_RELAXES = 0.002
"""s: time constant with which a light, strongly damped wheel comes back from its release: each step is a part of the last."""

_USUAL, _COARSE = 2.0, 1.2
"""Usual steps of the channel, and steps of its resolution, that count as the largest step at the least."""

_ROUNDS = 4
"""How often it is looked again: the second of two spikes stands off once the first is filled in."""


def remove_spikes(recording: Recording) -> Recording:
    """Fill in the spikes of a recording.

    Parameters
    ----------
    recording
        As it was read.

    Returns
    -------
    Recording
        With a fault for each channel that had spikes; one that had too many is left out.
    """
    if recording.parts:
        parts = tuple(remove_spikes(part) for part in recording.parts)
        new = [
            fault for part, old in zip(parts, recording.parts, strict=True) for fault in part.faults[len(old.faults) :]
        ]
        return replace(recording, parts=parts, faults=(*recording.faults, *new)) if new else recording
    values, found = recording.values, np.zeros(recording.values.shape, dtype=bool)
    for _ in range(_ROUNDS):
        more = spikes(values, recording.rate)
        if not more.any():
            break
        found |= more
        values = values.copy()
        for channel in np.flatnonzero(found.any(axis=1)).tolist():
            values[channel] = fill_short_gaps(
                np.where(found[channel], np.nan, recording.values[channel]), recording.rate
            )
    if not found.any():
        return recording
    faults = []
    for channel in np.flatnonzero(found.any(axis=1)).tolist():
        begins = np.flatnonzero(np.diff(found[channel].astype(int), prepend=0) == 1)
        lost = found[channel].mean() > MAX_MISSING or np.isnan(values[channel]).any()
        done = "the channel is left out of this drop" if lost else "they were filled in from the samples around"
        many = f"{begins.size} spike{'s' if begins.size > 1 else ''}, {found[channel].sum()} samples far off the others"
        what = f"{many}, the first at {recording.start + begins[0] / recording.rate:.6g} s; {done}"
        do = "Check the sensor's cable, its fastening and its radio link."
        faults.append(Fault("spike", f"{recording.name}: {recording.channels[channel]}", what, do))
        if lost:
            values[channel] = np.nan
    return replace(recording, values=values, faults=(*recording.faults, *faults))


def spikes(values: Real, rate: float, stands_off: float = STANDS_OFF) -> Flags:
    """Find the spikes.

    Parameters
    ----------
    values
        Shape (channel, time), any unit; a channel that is left out NaN.
    rate
        Samples per second; below 200 a single sample may be a wheel that meets the ground, and no spike is found.
    stands_off
        Times the largest step around it by which a spike stands off.

    Returns
    -------
    ndarray
        Shape (channel, time).

    Notes
    -----
    A spike stands off both its sides by several times any step nearby. A landing does not: it is steep on one side only,
    or its own flanks are nearly as steep. Nor does noise, whose steps are all alike.
    """
    found = np.zeros(values.shape, dtype=bool)
    longest = min(int(_LONGEST * rate * (1 + 1e-9)) - 1, values.shape[1] - 2)
    beside = max(round(_AROUND * rate), _FEWEST)
    steps = np.abs(np.diff(values, axis=1))
    coarse = _COARSE * resolution(np.nan_to_num(values))[:, None]
    least = np.maximum(_USUAL * np.median(steps, axis=1, keepdims=True), coarse)
    relaxing = max(stands_off, 1.5 * np.exp(1 / (_RELAXES * rate)))
    # Beyond the ends nothing is smooth.
    steps = np.pad(steps, ((0, 0), (beside, beside)), constant_values=np.inf)
    for width in range(1, longest + 1):
        count = values.shape[1] - width - 1
        low, high = (
            extreme(values, width, axis=1, origin=-(width // 2))[:, 1 : 1 + count]
            for extreme in (minimum_filter1d, maximum_filter1d)
        )
        left, right = values[:, :count], values[:, width + 1 :]
        height = np.maximum(low - np.maximum(left, right), np.minimum(left, right) - high)
        channel, before = np.nonzero(height > stands_off * least)
        # The flanks are the run's own. Of the steps around it two may be the flanks of another spike, but not the next ones.
        offsets = np.concatenate([np.arange(beside), np.arange(beside) + beside + width + 1])
        around = steps[channel[:, None], before[:, None] + offsets]
        allowed = [
            stands_off * np.sort(around, axis=1)[:, -3],
            relaxing * around[:, beside - 1 : beside + 1].max(axis=1),
            _LEVEL * np.abs(left - right)[channel, before],
        ]
        clear = height[channel, before] > np.max(allowed, axis=0)
        for sample in range(1, width + 1):
            found[channel[clear], before[clear] + sample] = True
    return found
