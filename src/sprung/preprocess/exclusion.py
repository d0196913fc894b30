"""Exclusion of what holds nothing new: channels that never change, and recordings that are copies of another one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sprung.campaign import Drop, Recording
from sprung.errors import Fault


def exclude_flat_channels(recording: Recording) -> Recording:
    """Exclude the channels that never change.

    Parameters
    ----------
    recording
        As it was read.

    Returns
    -------
    Recording
        With NaN in such channels, and a fault for each.
    """
    values = recording.values
    flat = np.logical_and.reduce(values == values[:, :1], axis=1) if values.shape[1] else np.zeros(len(values), bool)
    if not flat.any():
        return recording
    faults = [
        Fault(
            "flat",
            f"{recording.name}: {recording.channels[channel]}",
            "all samples have one value; the channel is left out of this drop",
            "Check the sensor and its cable.",
        )
        for channel in np.flatnonzero(flat)
    ]
    return replace(recording, values=np.where(flat[:, None], np.nan, values), faults=(*recording.faults, *faults))


def exclude_copies(recordings: Sequence[Recording], drops: Sequence[Drop]) -> list[Recording]:
    """Exclude recordings with the samples of an earlier one.

    Parameters
    ----------
    recordings
        One for each drop.
    drops
        As the campaign states them; two drops may use different parts of one recording.

    Returns
    -------
    list of Recording
        With NaN in all channels of a copy, and a fault.
    """
    kept: list[Recording] = []
    for i, (recording, drop) in enumerate(zip(recordings, drops, strict=True)):
        original = next(
            (
                earlier.name
                for earlier, other in zip(recordings[:i], drops[:i], strict=True)
                if (other.start, other.end) == (drop.start, drop.end) and _has_same_samples(earlier, recording)
            ),
            recording.name,
        )
        if original == recording.name or not recording.usable.any():
            kept.append(recording)
            continue
        fault = Fault(
            "copy",
            recording.name,
            f"same samples as {original}; the drop is left out",
            "Name the right file for this drop, or remove it from the campaign.",
        )
        nothing = np.full_like(recording.values, np.nan)
        kept.append(replace(recording, values=nothing, faults=(*recording.faults, fault)))
    return kept


def _has_same_samples(first: Recording, second: Recording) -> bool:
    if first.values.shape != second.values.shape:
        return False
    # A look at the last samples is enough for almost all pairs.
    if first.values[:, -1:].tobytes() != second.values[:, -1:].tobytes():
        return False
    return np.array_equal(first.values, second.values, equal_nan=True)
