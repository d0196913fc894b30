"""Check of recordings: which part of each drop can be used and why, the faults, and what is missing."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sprung.campaign import (
    CAMPAIGN_FILE,
    Campaign,
    Drop,
    drop_kind,
    read,
    read_document,
    require_plausible,
    unique_drop_names,
)
from sprung.checking.recorded import PlottedRecording
from sprung.checking.reports import ChannelReport, Check, DropReport, is_within
from sprung.errors import Fault, InputError
from sprung.faults import examine
from sprung.preprocess import DropObservation, Events, FreeDecay, Prepared, exclude_drops, merge_dropped_wheels, prepare
from sprung.progress import Progress, silent
from sprung.vehicle import Sensor

if TYPE_CHECKING:
    from sprung.drafting import DraftCampaign


def check(campaign: Campaign | str | os.PathLike[str], *, progress: Progress = silent) -> Check:
    """Check the recordings of a campaign; no geometry is needed.

    Parameters
    ----------
    campaign
        From `sprung.read`; or a campaign file, which need not be complete, or its folder; or a folder with nothing but
        recordings, for which a campaign is drafted as `sprung.draft` does.
    progress
        Called with each step that begins.

    Returns
    -------
    Check

    Raises
    ------
    InputError
        If a path is given and nothing there can be checked, or the campaign states what is impossible.
    """
    if not isinstance(campaign, Campaign):
        campaign = _campaign_at(Path(campaign), progress)
    else:
        require_plausible(campaign)
    try:
        campaign, prepared, undeclared = examine(campaign, progress)
    except InputError as error:  # what makes an identification impossible is one more fault here
        found = tuple(Fault("mirrored", one.where, one.found, one.do) for one in error.problems)
        return check_prepared(replace(campaign, faults=(*campaign.faults, *found)), prepare(campaign, progress))
    return check_prepared(campaign, exclude_drops(campaign, prepared, undeclared))


def _campaign_at(path: Path, progress: Progress) -> Campaign:
    """Read a campaign as far as it is written down, or draft one from recordings alone."""
    if not path.is_dir() or any(path.glob("*.toml")):
        return read(path, complete=False, progress=progress)
    from sprung.drafting import draft  # noqa: PLC0415 (only a folder without a campaign file needs it)

    drafted = draft(path, progress=progress)
    campaign = read_document(tomllib.loads(drafted.text), path / CAMPAIGN_FILE, complete=False, progress=progress)
    return replace(campaign, faults=(*campaign.faults, *_without_drop(drafted)))


def _without_drop(drafted: DraftCampaign) -> Iterator[Fault]:
    """Yield a fault for each recording without a drop, or that cannot be read."""
    for file in drafted.files:
        if not file.drops:
            why = file.rejected[0].why if file.rejected else "it shows no motion"
            do = "Check that it is the right recording, and state its unit if it has another."
            yield Fault("no-drop", file.name, f"no drop was found: {why}", do)
    for name, problems in drafted.unreadable.items():
        yield Fault("unreadable", name, f"found {problems[0].found}; the recording is left out", problems[0].do)


def check_prepared(campaign: Campaign, prepared: Prepared) -> Check:
    """Check recordings that are prepared already.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        Its recordings, prepared.

    Returns
    -------
    Check
    """
    used = {decay.file: decay for decay in prepared.decays}
    left_out = {drop.recording.name: faults for drop, faults in prepared.left_out}
    reports = []
    for short, observation in zip(unique_drop_names(campaign.drops), prepared.observations, strict=True):
        name = observation.recording.name
        decay = used.get(name)
        faults = left_out[name] if decay is None else decay.faults
        reports.append(_report(short, observation, decay, faults, campaign.sensors))
    recorded = tuple(PlottedRecording.of(observation) for observation in prepared.observations)
    of_drops = [fault for decay in prepared.decays for fault in decay.faults]
    of_left_out = [fault for _, faults in prepared.left_out for fault in faults]
    everything = tuple(dict.fromkeys((*campaign.faults, *of_drops, *of_left_out)))  # one may be that of several drops
    reports += [_unread(drop, everything) for drop in campaign.unread]
    return Check(tuple(reports), everything, recorded, campaign, campaign.missing)


def _unread(drop: Drop, faults: Sequence[Fault]) -> DropReport:
    """Report a drop whose recording could not be read."""
    file = drop.recording_name or drop.label
    codes = tuple(dict.fromkeys(fault.code for fault in faults if fault.where == file or is_within(fault.where, file)))
    kind, title = drop.kind, drop.name or ""
    return DropReport(file, drop.load, None, None, codes, kind=kind, wheels=drop.wheels, name=drop.label, title=title)


def _report(
    name: str,
    observation: DropObservation,
    decay: FreeDecay | None,
    faults: Sequence[Fault],
    sensors: Sequence[Sensor],
) -> DropReport:
    drop, recording = observation.drop, observation.recording
    released = None if observation.release is None else recording.start + observation.release / recording.rate
    events = Events(release=released) if decay is None else decay.events
    return DropReport(
        file=recording.name if drop.name is None else drop.recording_name or recording.name,
        load=drop.load,
        start=None if decay is None else decay.events.start,
        end=None if decay is None else decay.end,
        faults=tuple(dict.fromkeys(fault.code for fault in faults)),
        kind=drop_kind(drop.wheels or observation.wheels, drop.excitation),
        wheels=drop.wheels,
        wheels_seen=merge_dropped_wheels(drop, observation.dropped) if observation.dropped else None,
        release=events.release,
        landing=events.landing,
        last_lift_off=events.last_lift_off,
        why_start=events.why_start,
        why_end=events.why_end,
        fit_start=decay.start if decay is not None and events.why_fit else None,
        why_fit=events.why_fit,
        rate=recording.rate,
        channels=tuple(_channels(observation, decay, faults, sensors)),
        name=name,
        title=drop.name or "",
    )


def _channels(
    observation: DropObservation, decay: FreeDecay | None, faults: Sequence[Fault], sensors: Sequence[Sensor]
) -> Iterator[ChannelReport]:
    recording, rest = observation.recording, observation.rest
    if observation.release is None:
        at_rest = np.zeros(len(recording.channels), dtype=bool)
        level, noise = recording.values.mean(axis=1), np.zeros(len(at_rest))
    else:
        at_rest = np.isfinite(rest.level)
        level = np.where(at_rest, rest.level, recording.values.mean(axis=1))
        noise = np.sqrt(np.mean(rest.noise**2, axis=1))
    peak = np.abs(recording.values[:, observation.release or 0 :] - level[:, None]).max(axis=1, initial=0.0)
    used = np.zeros(len(at_rest), dtype=bool) if decay is None else decay.usable
    for channel, (name, sensor) in enumerate(zip(recording.channels, sensors, strict=True)):
        where = f"{recording.name}: {name}"
        yield ChannelReport(
            name=name,
            on=sensor.on,
            noise=float(noise[channel]) if at_rest[channel] else None,
            peak=float(peak[channel]) if np.isfinite(peak[channel]) else None,
            used=bool(used[channel]),
            faults=tuple(fault.code for fault in faults if fault.where == where),
            quantity=sensor.quantity,
        )
