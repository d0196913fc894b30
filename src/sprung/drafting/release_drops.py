"""Drops, pushes and rides on pads that displacements show, as sections of a campaign file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from sprung.campaign import Excitation
from sprung.drafting.combination import SHORT, TAKEN_EMPTY
from sprung.drafting.detected_release import DetectedRelease
from sprung.drafting.examination import ExaminedRecording
from sprung.drafting.excitation import classify_excitation, wheels_of_excitation
from sprung.drafting.layout_names import wheels_in_part, wheels_named_anywhere
from sprung.drafting.names import load_named
from sprung.drafting.records import DraftDrop, DraftSensor
from sprung.drafting.vehicle_part import stations_of
from sprung.vehicle import WHEELS, VehicleModel, Wheel


def release_drops(
    recordings: Sequence[ExaminedRecording], sensors: Sequence[DraftSensor], model: VehicleModel
) -> Iterator[DraftDrop]:
    """Yield the releases of recordings in which no accelerometer shows a drop.

    Parameters
    ----------
    recordings
        As examined.
    sensors
        Of the campaign.
    model
        Which part of a vehicle it is.

    Yields
    ------
    DraftDrop
        In the order of the recordings and of time.
    """
    stations = stations_of(sensors, model)
    for recording in recordings:
        if recording.pads:
            yield _on_pads(recording, stations, model)
        if recording.driven:
            yield _by_name(recording, recording.driven, model)
        for release in recording.releases:
            yield _drop(recording, release, sensors, stations, model)


def _on_pads(recording: ExaminedRecording, stations: Mapping[str, Wheel | None], model: VehicleModel) -> DraftDrop:
    over = {stations[channel] for channel in recording.pads if channel in stations}
    wheels = () if None in over else tuple(wheel for wheel in wheels_in_part(WHEELS, model) if wheel in over)
    return _whole_recording(recording, "pads", wheels, f"{', '.join(recording.pads)} move: driven by pads")


def _by_name(recording: ExaminedRecording, excitation: Excitation, model: VehicleModel) -> DraftDrop:
    wheels = wheels_in_part(wheels_named_anywhere(recording.file.name), model)
    return _whole_recording(recording, excitation, wheels, f"a {excitation} by the name of the recording")


def _whole_recording(
    recording: ExaminedRecording, excitation: Excitation, wheels: tuple[Wheel, ...], why: str
) -> DraftDrop:
    """Return a recording of which no part is told from the others."""
    file = recording.file
    whole = DetectedRelease(file.start, file.start, file.end, file.end, "the recording ends", (), *np.zeros((3, 0)))
    load = load_named(file.name)
    notes = (why, *([TAKEN_EMPTY] if load is None else []))
    return DraftDrop((file.name,), None, load or "empty", wheels, whole.as_drop(), notes, excitation=excitation)


def _drop(
    recording: ExaminedRecording,
    release: DetectedRelease,
    sensors: Sequence[DraftSensor],
    stations: Mapping[str, Wheel | None],
    model: VehicleModel,
) -> DraftDrop:
    name = recording.file.name
    found = classify_excitation(release, sensors, name)
    notes = [
        f"at rest for {release.release - release.begin:.2f} s, moves from {release.release:.2f} s on",
        found.why,
        f"usable until {release.end:.2f} s, when {release.why_end}",
    ]
    wheels, how = wheels_of_excitation(found, stations, wheels_named_anywhere(name), model)
    alone = len(recording.releases) == 1
    load = load_named(name)
    if load is None and alone:
        load = "empty"
    notes += [how] if how else []
    notes += [TAKEN_EMPTY] if load_named(name) is None and alone else []
    # The release comes late enough, and the window whole, where the recording is short and holds nothing else.
    whole = alone and recording.file.end - recording.file.start <= SHORT and not _is_disturbed(release)
    window = None if whole else (release.begin, release.end)
    return DraftDrop((name,), window, load, wheels, release.as_drop(), tuple(notes), excitation=found.excitation)


def _is_disturbed(release: DetectedRelease) -> bool:
    return "next motion" in release.why_end
