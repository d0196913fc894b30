"""Spikes: a few samples far off in one channel, from a radio dropout or a knocked cable, between neighbours that are smooth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import MAX_MISSING, Recording, fill_short_gaps
from sprung.errors import Fault
from sprung.preprocess.release import median_by_channel, resolution

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]
Places = NDArray[np.intp]

_LONGEST = 0.01
"""s between the samples beside a spike at the most; what lasts longer may be a wheel that meets the ground."""

_AROUND = 0.012
"""s before and after a spike that have to be smooth."""

_FEWEST = 6
"""Steps before and after it at the least."""

HEIGHT = 5.0
"""Times the largest step around it by which a spike exceeds the samples on both its sides."""

_LEVEL = 3.0
"""Times the difference between its two sides by which it does: a release is steep down from one level to another."""

_RELAXES = 0.002
"""s: time constant with which a light, strongly damped wheel comes back from its release: each step is a part of the last."""

_USUAL, _COARSE = 2.0, 1.2
"""Usual steps of the channel, and steps of its resolution, that count as the largest step at the least."""

_ROUNDS = 4
"""Passes: the second of two spikes is exposed once the first is filled in."""


def remove_spikes(recording: Recording) -> tuple[Recording, Flags]:
    """Replace the spikes of a recording by interpolation.

    Parameters
    ----------
    recording
        As it was read.

    Returns
    -------
    recording : Recording
        With a fault for each channel that had spikes; a channel with too many is left out. The same where there are none.
    replaced : ndarray
        Samples that were replaced, shape (channel, time); none of those of several loggers.
    """
    none: Flags = np.zeros(recording.values.shape, dtype=bool)
    if recording.parts:
        parts = tuple(remove_spikes(part)[0] for part in recording.parts)
        new = [
            fault for part, old in zip(parts, recording.parts, strict=True) for fault in part.faults[len(old.faults) :]
        ]
        return (replace(recording, parts=parts, faults=(*recording.faults, *new)) if new else recording), none
    values, found = recording.values, none
    for _ in range(_ROUNDS):
        more = detect_spikes(values, recording.rate)
        if not more.any():
            break
        found = found | more
        values = values.copy()
        for channel in np.flatnonzero(found.any(axis=1)).tolist():
            values[channel] = fill_short_gaps(
                np.where(found[channel], np.nan, recording.values[channel]), recording.rate
            )
    faults = []
    for channel in np.flatnonzero(found.any(axis=1)).tolist():
        lost = found[channel].mean() > MAX_MISSING or np.isnan(values[channel]).any()
        faults.append(_spike_fault(recording, channel, found[channel], lost))
        if lost:
            values[channel] = np.nan
    if not faults:
        return recording, none
    return replace(recording, values=values, faults=(*recording.faults, *faults)), found & ~np.isnan(values)


def _spike_fault(recording: Recording, channel: int, found: Flags, lost: bool) -> Fault:
    begins = np.flatnonzero(np.diff(found.astype(int), prepend=0) == 1)
    spikes, samples = (
        f"{n} {noun}{'s' if n > 1 else ''}" for n, noun in ((begins.size, "spike"), (found.sum(), "sample"))
    )
    first = f"{recording.start + begins[0] / recording.rate:.6g} s"
    done = "the channel is left out of this drop" if lost else "replaced by interpolation"
    what = f"{spikes} ({samples}), the first at {first}; {done}"
    do = "Check the sensor's cable, its fastening and its radio link."
    return Fault("spike", f"{recording.name}: {recording.channels[channel]}", what, do)


def detect_spikes(values: Real, rate: float, height: float = HEIGHT) -> Flags:
    """Detect spikes.

    Parameters
    ----------
    values
        Shape (channel, time), any unit; a channel that is left out NaN.
    rate
        Samples per second; below 200 a single sample may be a wheel that meets the ground, and no spike is found.
    height
        Times the largest step around it by which a spike exceeds its neighbours.

    Returns
    -------
    ndarray
        Shape (channel, time).

    Notes
    -----
    A spike exceeds both its sides by several times any step nearby. A landing does not: it is steep on one side only,
    or its own flanks are nearly as steep. Nor does noise, whose steps are all alike.
    """
    found = np.zeros(values.shape, dtype=bool)
    longest = min(int(_LONGEST * rate * (1 + 1e-9)) - 1, values.shape[1] - 2)
    if longest < 1:
        return found
    steps = np.diff(values, axis=1)
    sizes = np.abs(steps)
    least = height * _USUAL * median_by_channel(sizes)
    channel, before, width = _opposite_steps(steps, sizes > least[:, None], longest)
    if not channel.size:
        return found
    inside = values[channel[:, None], before[:, None] + np.minimum(np.arange(1, longest + 1), width[:, None])]
    left, right = values[channel, before], values[channel, before + width + 1]
    exceeds = np.maximum(inside.min(axis=1) - np.maximum(left, right), np.minimum(left, right) - inside.max(axis=1))
    # Beyond the ends nothing is smooth. The flanks are the run's own.
    beside = max(round(_AROUND * rate), _FEWEST)
    padded = np.full((len(sizes), sizes.shape[1] + 2 * beside), np.inf)
    padded[:, beside:-beside] = sizes
    flank = before[:, None] + np.arange(beside)
    around = padded[channel[:, None], np.concatenate([flank, flank + beside + width[:, None] + 1], axis=1)]
    allowed = [
        least[channel],
        height
        * np.partition(around, -3, axis=1)[:, -3],  # two may be the flanks of another spike, but not the next ones
        max(height, 1.5 * np.exp(1 / (_RELAXES * rate))) * around[:, beside - 1 : beside + 1].max(axis=1),
        _LEVEL * np.abs(left - right),
    ]
    clear = exceeds > np.max(allowed, axis=0)
    if clear.any():
        clear &= exceeds > height * _COARSE * resolution(values)[channel]
    for run in np.flatnonzero(clear).tolist():
        found[channel[run], before[run] + 1 : before[run] + width[run] + 1] = True
    return found


def _opposite_steps(steps: Real, high: Flags, longest: int) -> tuple[Places, Places, Places]:
    """Return channel, position and distance of the high steps that an opposite one follows within so many samples."""
    length = steps.shape[1]
    first = np.flatnonzero(high)
    first, width = (
        array.ravel() for array in np.broadcast_arrays(first[:, None], np.arange(1, longest + 1, dtype=first.dtype))
    )
    inside = first % length + width < length
    first, width = first[inside], width[inside]
    high, steps = high.ravel(), steps.ravel()
    follows = high[first + width] & (steps[first] * steps[first + width] < 0)
    channel, before = np.divmod(first[follows], length)
    return channel, before, width[follows]
