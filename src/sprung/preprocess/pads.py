"""Records of a vehicle on pads that move: no release and no landing, all samples are used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, DropTest, Recording
from sprung.errors import Fault
from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.events import Events
from sprung.preprocess.extraction import clipping_faults, find_end, find_stated_start
from sprung.preprocess.release import unknown_release
from sprung.vehicle import Sensor, Wheel

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_PART = 0.02
"""Part of the largest motion of any displacement in a recording by which a pad moves at least."""

_LEAST = 2e-4
"""m by which a pad moves at least."""

_NOISE = 12.0
"""Standard deviations of its noise by which a pad moves at least."""

_SHORTEST = 4.0
"""s: a shorter record has hardly a line below the frequencies of a body."""


def is_on_pads(drop: DropTest) -> bool:
    """Return whether pads drove the vehicle."""
    return drop.excitation == "pads"


def find_moving_pads(displacements: Real) -> Flags:
    """Find the pads that move.

    Parameters
    ----------
    displacements
        All of a recording, m, shape (channel, time).

    Returns
    -------
    ndarray
        Shape (channel,).
    """
    if displacements.shape[1] < 3:
        return np.zeros(len(displacements), dtype=np.bool_)
    sizes = np.ptp(displacements, axis=1)
    # Second differences of white noise have six times its variance.
    second = np.median(np.abs(np.diff(displacements, 2, axis=1)), axis=1)
    noise = second / (0.6745 * np.sqrt(6.0))
    return np.asarray(sizes > np.maximum(max(_LEAST, _PART * float(sizes.max(initial=0.0))), _NOISE * noise))


def exclude_still_pads(recording: Recording, drop: DropTest, sensors: Sequence[Sensor]) -> Recording:
    """Exclude the channels of pads that tell nothing: all of them where no pad moved, or displacements of those that did not.

    Parameters
    ----------
    recording
        As it was read.
    drop
        As it is stated.
    sensors
        One for each channel.

    Returns
    -------
    Recording
        With NaN in such channels.
    """
    still = [
        one.pad is not None
        and (not is_on_pads(drop) or (one.quantity == "displacement" and one.pad not in drop.wheels))
        for one in sensors
    ]
    if not any(still):
        return recording
    return replace(recording, values=np.where(np.array(still)[:, None], np.nan, recording.values))


def extract_forced_response(campaign: Campaign, drop: DropTest, name: str, clipped: Flags) -> FreeDecay | Fault:
    """Extract the record of one test on pads.

    Parameters
    ----------
    campaign
        Its sensors.
    drop
        With its recording, corrected.
    name
        Short name of the drop.
    clipped
        Samples at full scale, shape (channel, time).

    Returns
    -------
    FreeDecay or Fault
        A fault where nothing can be used.
    """
    recording = drop.recording
    first, (last, why_end) = find_stated_start(drop), find_end(drop)
    part = slice(first, last + 1)
    clips = np.asarray(clipped[:, part].any(axis=1))
    faults = [*recording.faults, *clipping_faults(recording, clipped, clips), *_clock_faults(recording)]
    other = [channel for clock in recording.clocks for channel in clock.channels]
    values = np.where(clips[:, None], np.nan, recording.values)
    values[other] = np.nan
    unknown = _unmeasured(campaign.sensors, drop.wheels, np.logical_not(np.isnan(values).any(axis=1)))
    if unknown:
        what = f"neither displacement nor force is known of the pads under {', '.join(unknown)}; the drop is left out"
        return Fault("missing", recording.name, what, "Record one of the two for every pad that moves.")
    length = (last + 1 - first) / recording.rate
    if length < _SHORTEST:
        what = f"{max(length, 0.0):.2f} s on pads, at least {_SHORTEST:g} s are needed; the drop is left out"
        return Fault("no-decay", recording.name, what, "Record for half a minute.")
    start = recording.start + first / recording.rate
    why_start = "given as start" if drop.start is not None else "the recording begins"
    return FreeDecay(
        name=name,
        file=recording.name,
        load=drop.load,
        values=values[:, part],
        earlier=values[:, :0],
        rate=recording.rate,
        start=start,
        rest=unknown_release(len(recording.channels)),
        faults=tuple(faults),
        high_pass=tuple(sensor.high_pass or 0.0 for sensor in campaign.sensors),
        events=Events(start=start, why_start=why_start, why_end=why_end),
        pads=drop.wheels,
    )


def _unmeasured(sensors: Sequence[Sensor], wheels: Sequence[Wheel], usable: Flags) -> list[Wheel]:
    """Return the wheels whose pads have no usable sensor."""
    measured = {one.pad for one, used in zip(sensors, usable.tolist(), strict=True) if used}
    return [wheel for wheel in wheels if wheel not in measured]


def _clock_faults(recording: Recording) -> Iterator[Fault]:
    """Yield a fault for the channels of further loggers: nothing in a record on pads sets their clocks."""
    for clock in recording.clocks:
        channels = ", ".join(recording.channels[channel] for channel in clock.channels)
        what = f"the clock of {clock.name} cannot be set on pads; {channels} are left out of this drop"
        yield Fault("clock", recording.name, what, "Record all channels with one logger, or with synchronised ones.")
