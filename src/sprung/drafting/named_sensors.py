"""Sensors that no drop shows: those of other quantities, and accelerometers of recordings in which no wheel falls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from sprung.drafting.channel import Channel
from sprung.drafting.examination import ExaminedRecording
from sprung.drafting.layout_names import stations_named
from sprung.drafting.names import parts_named
from sprung.drafting.other_channel import OtherChannel
from sprung.drafting.quantity_names import is_pad_named, is_travel_named, rotation_named
from sprung.drafting.records import DraftSensor

_STILL = 0.02
"""Part of the largest swing of all displacements below which a channel is not moved; one on a wheel by its name may be."""


def name_sensors(recordings: Sequence[ExaminedRecording], placed: Collection[str]) -> tuple[DraftSensor, ...]:
    """Describe the sensors by their names and units.

    Parameters
    ----------
    recordings
        As examined.
    placed
        Channels that are described already, by their motion in drops.

    Returns
    -------
    tuple of DraftSensor
        Their wheel stations are open.
    """
    used = [recording for recording in recordings if recording.shows_excitation]
    channels: list[Channel | OtherChannel] = []
    for recording in used:
        channels += recording.channels
        channels += recording.others
    return _with_falls(tuple(_sensor(channel) for channel in _most_frequent(channels, placed)), used)


def find_still(recordings: Sequence[ExaminedRecording]) -> dict[str, str]:
    """Find the channels of displacement that no release moves, each with the reason."""
    known = {channel.name for recording in recordings for channel in recording.others if channel.unit is not None}
    swings = {name: size for name, size in _largest(recordings, of_fall=False).items() if name in known}
    largest = max(map(abs, swings.values()), default=0.0)
    return {
        name: "no release moves it"
        for name, swing in swings.items()
        if abs(swing) < _STILL * largest and parts_named(name) != {"wheel"} and not is_pad_named(name)
    }


def _most_frequent(
    channels: Sequence[Channel | OtherChannel], placed: Collection[str]
) -> Iterator[Channel | OtherChannel]:
    """Yield each channel as most recordings have it."""
    names = dict.fromkeys(channel.name for channel in channels if channel.name not in placed)
    for name in names:
        own = [channel for channel in channels if channel.name == name]
        usual = Counter((type(channel), channel.unit) for channel in own).most_common(1)[0][0]
        yield next(channel for channel in own if (type(channel), channel.unit) == usual)


def _sensor(channel: Channel | OtherChannel) -> DraftSensor:
    if isinstance(channel, OtherChannel):
        return _other_sensor(channel)
    parts = parts_named(channel.name)
    on: Literal["body", "wheel"] | None = None if len(parts) != 1 else "wheel" if "wheel" in parts else "body"
    return DraftSensor(
        channel=channel.name, on=on, corner=None, unit=channel.unit, stated_unit=channel.stated_unit,
        direction=channel.direction, coupling=channel.coupling, full_scale=None,
        notes=(*channel.notes, *_by_name(on)), logger=channel.logger,
    )  # fmt: skip


def _other_sensor(channel: OtherChannel) -> DraftSensor:
    name, quantity = channel.name, channel.quantity
    parts = parts_named(name)
    travel = quantity in ("displacement", "velocity") and (is_travel_named(name) or len(parts) > 1)
    axis = rotation_named(name) if quantity == "angular-rate" else None
    on: Literal["body", "wheel", "pad"] | None
    if travel or quantity == "angular-rate":
        on = "body"
    elif quantity == "force" or is_pad_named(name):
        on = "pad"
    else:
        on = None if len(parts) != 1 else "wheel" if "wheel" in parts else "body"
    notes = (*channel.notes, *(("travel of a suspension by its name",) if travel else _by_name(on, quantity)))
    return DraftSensor(
        channel=name, on=on, corner=None, unit=channel.unit, stated_unit=channel.unit, direction="up", coupling="DC",
        full_scale=None, notes=notes, quantity=quantity, axis=axis if axis != "yaw" else None, is_travel=travel,
    )  # fmt: skip


def _by_name(on: str | None, quantity: str = "acceleration") -> tuple[str, ...]:
    if quantity in ("angular-rate", "force"):
        return ()
    return ("its name states neither body nor wheel",) if on is None else (f"on {_PLACES[on]} by its name",)


_PLACES: Mapping[str, str] = {"body": "the body", "wheel": "a wheel", "pad": "a pad"}


def _with_falls(sensors: tuple[DraftSensor, ...], recordings: Sequence[ExaminedRecording]) -> tuple[DraftSensor, ...]:
    """Return the sensors with what their readings do in the releases."""
    falls = _largest(recordings, of_fall=True)
    stations = stations_named([sensor.channel for sensor in sensors])
    noted = []
    for sensor in sensors:
        fall, notes = falls.get(sensor.channel, 0.0), list(sensor.notes)
        if fall and sensor.unit is not None:
            moves = "falls" if fall > 0 else "rises"
            notes.append(f"{moves} by up to {1e3 * abs(fall):.3g} mm from the rest before a release to that after it")
        for other in sensors:
            above = {sensor.on, other.on} == {"body", "wheel"} and not (sensor.is_travel or other.is_travel)
            here = stations[sensor.channel] == stations[other.channel]
            if above and here and fall * falls.get(other.channel, 0.0) < 0:
                notes.append(f"moves against '{other.channel}': does one of the two point down?")
        noted.append(replace(sensor, notes=tuple(notes)))
    return tuple(noted)


def _largest(recordings: Sequence[ExaminedRecording], *, of_fall: bool) -> dict[str, float]:
    """Return the largest fall, or swing, of each channel of displacement in any release, m."""
    found: dict[str, float] = {}
    for recording in recordings:
        for release in recording.releases:
            for name, size in zip(release.channels, release.fall if of_fall else release.swing, strict=True):
                if abs(size) >= abs(found.get(name, 0.0)):
                    found[name] = float(np.asarray(size))
    return found
