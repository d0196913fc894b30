"""Drafting of a campaign: every recording is examined, all of them are combined, the campaign file is written."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from sprung.drafting.combination import TAKEN_EMPTY, combine_recordings
from sprung.drafting.draft_campaign import DraftCampaign
from sprung.drafting.examination import ExaminedRecording
from sprung.drafting.examined_folder import ExaminedFolder, examine_folder, shows_drops
from sprung.drafting.named_sensors import find_still, name_sensors
from sprung.drafting.named_settings import NamedCondition, by_setting
from sprung.drafting.names import load_named
from sprung.drafting.records import DraftDrop, DraftFile, DraftSensor
from sprung.drafting.release_drops import release_drops
from sprung.drafting.single_channel import join_single_channel_loggers
from sprung.drafting.text import campaign_text, missing_in
from sprung.drafting.vehicle_part import find_part, is_on_pad
from sprung.progress import Progress, silent

_NO_PAD_MOVES = "it is on a pad under a tyre, and no pad moves in these recordings"


def draft(folder: str | os.PathLike[str], progress: Progress = silent, *, overwrite: bool = False) -> DraftCampaign:
    """Draft a campaign from the recordings in a folder and its subfolders.

    Parameters
    ----------
    folder
        Where the recordings are; the campaign file goes there.
    progress
        Called with each recording that is begun, and within long ones, with the part that is done.
    overwrite
        Whether a campaign file that is there already is to be replaced: it is drafted anew.

    Returns
    -------
    Draft
        Not written yet.

    Raises
    ------
    InputError
        If there is no such folder, a campaign file in it already, or no drop in any of its recordings; then with the
        reason for each of them.
    """
    folder = Path(folder)
    contents = examine_folder(folder, folder, progress, overwrite=overwrite)
    return _campaign(contents, contents.joined)


def draft_campaigns(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    progress: Progress = silent,
    *,
    settings: bool = True,
    overwrite: bool = False,
) -> tuple[DraftCampaign, ...]:
    """Draft a campaign for each setting of the vehicle that the names of the recordings state.

    Recordings with other dampers, or another pressure, are those of another vehicle: each setting has a campaign of its own.

    Parameters
    ----------
    folder
        Where the recordings are.
    output
        Folder of the campaign file, or of a folder for each setting; by default that of the recordings.
    progress
        Called with each recording that is begun, and within long ones, with the part that is done.
    settings
        Whether each setting has a campaign of its own; otherwise there is one for all recordings.
    overwrite
        Whether campaign files that are there already are to be replaced.

    Returns
    -------
    tuple of DraftCampaign
        One where the names state no settings; none is written yet.

    Raises
    ------
    InputError
        As `draft`.
    """
    folder = Path(folder)
    target = folder if output is None else Path(output)
    contents = examine_folder(folder, target, progress, overwrite=overwrite, settings=settings)
    groups = by_setting({own.file.name: contents.conditions[own.file.name] for own in contents.recordings})
    members = {
        setting: [own for own in contents.recordings if own.file.name in names] for setting, names in groups.items()
    }
    members = {setting: own for setting, own in members.items() if shows_drops(own)}
    if len(members) < 2 or not settings:
        return (_campaign(contents, contents.joined, output=None if output is None else target),)
    campaigns = []
    for setting, own in members.items():
        joined = join_single_channel_loggers(own, folder)
        campaigns.append(_campaign(contents, joined, setting=setting, output=target / str(setting)))
    return tuple(campaigns)


def _campaign(
    contents: ExaminedFolder,
    recordings: Sequence[ExaminedRecording],
    *,
    setting: str | None = None,
    output: Path | None = None,
) -> DraftCampaign:
    """Combine recordings to a campaign."""
    sensors: tuple[DraftSensor, ...] = ()
    drops: tuple[DraftDrop, ...] = ()
    still: dict[str, str] = {}
    if any(recording.drops for recording in recordings):
        sensors, drops, found = combine_recordings(recordings)
        still |= found
    still |= find_still(recordings)
    sensors = (*sensors, *name_sensors(recordings, {*still, *(sensor.channel for sensor in sensors)}))
    model, sensors, drops = find_part(sensors, drops)
    drops = (*drops, *release_drops(recordings, sensors, model))
    if not any(drop.excitation == "pads" for drop in drops):
        still |= {sensor.channel: _NO_PAD_MOVES for sensor in sensors if is_on_pad(sensor)}
        sensors = tuple(sensor for sensor in sensors if not is_on_pad(sensor))
    place = {recording.file.name: i for i, recording in enumerate(recordings)}
    drops = tuple(sorted(drops, key=lambda drop: (place.get(drop.files[0], 0), drop.found.begin)))
    files = tuple(_with_left_out(recording, still) for recording in recordings)
    name = contents.folder.absolute().name or "vehicle"
    made = DraftCampaign(
        folder=contents.folder,
        name=name if setting is None else f"{name}, {setting}",
        sensors=sensors,
        drops=tuple(_with_named_load(drop, contents.conditions) for drop in drops),
        files=files,
        unreadable=contents.unreadable,
        model=model,
        copies={name: original for name, original in contents.copies.items() if original in place},
        setting=setting,
        output=output,
    )
    text = campaign_text(made)
    return replace(made, text=text, missing=missing_in(text))


def _with_left_out(recording: ExaminedRecording, still: Mapping[str, str]) -> DraftFile:
    held = {channel.name for channel in recording.channels} | {channel.name for channel in recording.others}
    left_out = {name: why for name, why in still.items() if name in held}
    return replace(recording.file, left_out={**recording.file.left_out, **left_out})


def _with_named_load(drop: DraftDrop, conditions: Mapping[str, NamedCondition]) -> DraftDrop:
    """Return a drop with the load that a number in its name stands for, where words state none."""
    condition = conditions.get(drop.files[0], NamedCondition())
    if condition.load is None or _states_load(drop):
        return drop
    notes = tuple(note for note in drop.notes if note != TAKEN_EMPTY)
    said = (
        TAKEN_EMPTY
        if condition.load == "empty"
        else f"load by the second number in the name of the file, {condition.load}"
    )
    return replace(drop, load=condition.load, notes=(*notes, said), proposed=False)


def _states_load(drop: DraftDrop) -> bool:
    return any(load_named(name) is not None for name in drop.files)
