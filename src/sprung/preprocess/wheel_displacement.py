"""Displacement and acceleration of one wheel, in tests on pads: the second derivative of the one is the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import csd, welch

from sprung.campaign import DropTest, Recording
from sprung.errors import Fault
from sprung.preprocess.pads import is_on_pads
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_BAND = (2.0, 20.0)
"""Hz from above the body's modes to above wheel hop: a wheel and its pad move alike only below wheel hop."""

_PIECE = 2.0
"""s of the records that are averaged: longer than the response of a wheel, and a dozen of them in half a minute."""

_COHERENT = 0.8
"""Part of the acceleration's power that is coherent with the displacement at least, unless noise blurs their relation."""

_ALIKE = 0.5
"""Part of the acceleration's power that any one gain explains at least if both are of one wheel: nearly all that is coherent. A
wheel and its pad differ by half a turn above wheel hop, so that one gain explains little of both sides of it."""


def exclude_other_displacements(drops: Sequence[DropTest], sensors: Sequence[Sensor]) -> list[Recording]:
    """Exclude displacements that are stated on a wheel and are not that of the wheel, as its accelerometer shows.

    Parameters
    ----------
    drops
        With their recordings; those on pads are examined, whose motion lasts.
    sensors
        One for each channel.

    Returns
    -------
    list of Recording
        Without the channel in all drops, and with a fault in the first one on pads. Accelerometers are kept, as gravity
        confirms them.
    """
    on_pads = [n for n, drop in enumerate(drops) if is_on_pads(drop)]
    recordings = [drop.recording for drop in drops]
    accelerometers = {sensor.wheel: n for n, sensor in enumerate(sensors) if sensor.wheel and sensor.reads_gravity}
    for channel, sensor in enumerate(sensors):
        if sensor.quantity != "displacement" or sensor.wheel not in accelerometers:
            continue
        other = accelerometers[sensor.wheel]
        used = [n for n in on_pads if recordings[n].usable[[channel, other]].all()]
        if not used or not _is_other_motion([recordings[n] for n in used], channel, other):
            continue
        what = (
            f"not the displacement of {sensor.wheel}, on which it is stated: {sensors[other].channel} is not its second "
            "derivative at any scale; the channel is left out"
        )
        do = f'State where it is: for the pad under this wheel, on = "pad {sensor.wheel}".'
        recordings = [_without(recording, channel) for recording in recordings]
        faults = (*recordings[used[0]].faults, Fault("unlike-others", sensor.channel, what, do))
        recordings[used[0]] = replace(recordings[used[0]], faults=faults)
    return recordings


def _is_other_motion(recordings: Sequence[Recording], displacement: int, acceleration: int) -> bool:
    """Return whether two channels are coherent, and no one gain explains an acceleration by a displacement."""
    total = coherent = driving = 0.0
    crossed = 0j
    for recording in recordings:
        moved, accelerated = recording.values[[displacement, acceleration]]
        samples = min(round(_PIECE * recording.rate), moved.size)
        frequency, cross = csd(moved, accelerated, recording.rate, nperseg=samples)
        own, others = (welch(each, recording.rate, nperseg=samples)[1] for each in (moved, accelerated))
        band = (frequency > _BAND[0]) & (frequency < _BAND[1])
        omega = -((2 * np.pi * frequency[band]) ** 2)
        total += float(others[band].sum())
        coherent += float((np.abs(cross[band]) ** 2 / np.maximum(own[band], np.finfo(float).tiny)).sum())
        crossed += complex((omega * cross[band]).sum())
        driving += float((omega**2 * own[band]).sum())
    explained = abs(crossed) ** 2 / driving if driving else 0.0
    return coherent > _COHERENT * total and explained < _ALIKE * total


def _without(recording: Recording, channel: int) -> Recording:
    """Return a recording with NaN in one channel."""
    left = np.arange(len(recording.values)) != channel
    return replace(recording, values=np.where(left[:, None], recording.values, np.nan))
