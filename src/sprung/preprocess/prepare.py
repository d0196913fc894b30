"""From recordings to free decays: each recording is corrected step by step, then its release and landing are detected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from sprung.campaign import Campaign, DropTest, Recording, unique_drop_names
from sprung.errors import Fault
from sprung.preprocess.alignment import active_channels, align_loggers
from sprung.preprocess.clipping import check_full_scale, detect_clipping
from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.decimation import decimate
from sprung.preprocess.drift import remove_drift
from sprung.preprocess.dropped_wheels import (
    Dropped,
    detect_dropped_wheels,
    dropped_wheels_fault,
    find_contradicted_drops,
    merge_dropped_wheels,
)
from sprung.preprocess.events import DropObservation, mark_samples
from sprung.preprocess.exclusion import exclude_copies, exclude_flat_channels
from sprung.preprocess.extraction import extract_decay, pool_suspension_forces
from sprung.preprocess.gravity import check_gravity
from sprung.preprocess.high_pass import undo_high_pass
from sprung.preprocess.pad_consistency import add_moving_pads, check_pad_sensors
from sprung.preprocess.pad_exchange import exchange_opposite_channels
from sprung.preprocess.pads import exclude_still_pads, extract_forced_response, is_on_pads
from sprung.preprocess.release import detect_release, unknown_release
from sprung.preprocess.rest_only import rest_only_fault
from sprung.preprocess.spikes import remove_spikes
from sprung.preprocess.splice import join_splices
from sprung.preprocess.wheel_displacement import exclude_other_displacements
from sprung.progress import Progress, Step, counted, silent


class Prepared(NamedTuple):
    """A prepared campaign.

    Attributes
    ----------
    decays
        One for each drop that can be used, in the campaign's order.
    left_out
        The other drops, each with its faults.
    observations
        For every drop of the campaign, in its order, what its recording shows.
    """

    decays: tuple[FreeDecay, ...]
    left_out: tuple[tuple[DropTest, tuple[Fault, ...]], ...]
    observations: tuple[DropObservation, ...] = ()


def prepare(campaign: Campaign, progress: Progress = silent, *, full_rate: bool = False) -> Prepared:
    """Correct the recordings of a campaign and extract their :term:`free decays <free decay>`.

    Parameters
    ----------
    campaign
        The campaign.
    progress
        Called with each recording that is begun, in three rounds.
    full_rate
        Whether recordings that were sampled very fast keep all of their samples.

    Returns
    -------
    Prepared
    """
    stage = "looking for spikes in the recordings"
    whole = [recording if full_rate else decimate(recording) for recording in join_splices(campaign.recordings)]
    despiked = [remove_spikes(recording) for recording in counted(progress, stage, tuple(whole))]
    recordings = exclude_copies([align_loggers(recording) for recording, _ in despiked], campaign.drops)
    stated = _with_recordings(campaign.drops, recordings)
    stated = [add_moving_pads(drop, campaign.sensors) for drop in exchange_opposite_channels(stated, campaign.sensors)]
    recordings = [exclude_still_pads(drop.recording, drop, campaign.sensors) for drop in stated]
    recordings = [exclude_flat_channels(recording) for recording in recordings]
    progress(Step("looking for wrong signs, units and saturation in the recordings"))
    recordings = [check_full_scale(recording, campaign.sensors) for recording in recordings]
    releases = [
        None
        if is_on_pads(drop)
        else detect_release(
            recording.values, recording.rate, active=active_channels(recording), is_driven=drop.is_driven
        )
        for drop, recording in zip(campaign.drops, recordings, strict=True)
    ]
    recordings = check_pad_sensors(_with_recordings(stated, recordings), campaign.sensors)
    recordings = exclude_other_displacements(_with_recordings(stated, recordings), campaign.sensors)
    at_rest = [
        None if is_on_pads(drop) else rest_only_fault(drop, release, campaign.sensors)
        for drop, release in zip(_with_recordings(campaign.drops, recordings), releases, strict=True)
    ]
    recordings, releases, sensors = check_gravity(recordings, releases, campaign.sensors)
    # A sensor clips before its drift is removed or its high-pass undone: what it reads then is not within its range.
    clipped = [detect_clipping(recording) for recording in recordings]
    recordings = [
        undo_high_pass(remove_drift(recording, release, sensors), release, sensors)
        for recording, release in zip(
            counted(progress, "removing drift from the recordings", recordings), releases, strict=True
        )
    ]
    dropped: list[Dropped] = [
        {} if drop.is_driven else detect_dropped_wheels(recording, release, sensors)
        for drop, recording, release in zip(campaign.drops, recordings, releases, strict=True)
    ]
    drops = _correct_dropped_wheels(_with_recordings(stated, recordings), dropped)
    corrected = replace(campaign, drops=tuple(drops), sensors=sensors)

    suspension = pool_suspension_forces(corrected, releases)
    decays, left_out, observations = [], [], []
    names = counted(progress, "finding the decays", unique_drop_names(drops))
    for i, name in enumerate(names):
        drop, release = drops[i], releases[i]
        decay: FreeDecay | Fault
        if fault := at_rest[i]:
            decay = fault
        elif is_on_pads(drop):
            decay = extract_forced_response(corrected, drop, name, clipped[i])
        else:
            decay = extract_decay(corrected, drop, name, release, suspension, clipped[i])
        if isinstance(decay, FreeDecay):
            decays.append(decay)
        else:
            left_out.append((drop, tuple(dict.fromkeys((*drop.recording.faults, decay)))))
        observation = DropObservation(
            drop=campaign.drops[i],
            recording=drop.recording,
            rest=unknown_release(len(sensors)) if release is None else release,
            marks=(*mark_samples("clipped", clipped[i]), *mark_samples("spike", despiked[i][1])),
            dropped=dropped[i],
            wheels=drop.wheels,
        )
        observations.append(observation)
    return Prepared(tuple(decays), tuple(left_out), tuple(observations))


def _with_recordings(drops: Sequence[DropTest], recordings: Sequence[Recording]) -> list[DropTest]:
    return [replace(drop, recording=recording) for drop, recording in zip(drops, recordings, strict=True)]


def _correct_dropped_wheels(drops: Sequence[DropTest], dropped: Sequence[Dropped]) -> list[DropTest]:
    """Take the wheels that fell from the release where the campaign states none, or where the release contradicts it."""
    corrected = list(drops)
    contradicted = find_contradicted_drops(drops, dropped)
    for i, (drop, shown) in enumerate(zip(drops, dropped, strict=True)):
        if i in contradicted:
            fault = dropped_wheels_fault(drop, shown, drop.recording.name)
            recording = replace(drop.recording, faults=(*drop.recording.faults, fault))
            corrected[i] = replace(drop, recording=recording, wheels=merge_dropped_wheels(drop, shown))
        elif not drop.wheels:
            corrected[i] = replace(drop, wheels=merge_dropped_wheels(drop, shown))
    return corrected


def exclude_drops(campaign: Campaign, prepared: Prepared, excluded: Mapping[str, Fault]) -> Prepared:
    """Exclude drops from a prepared campaign.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        Its recordings, prepared.
    excluded
        The reasons, by the names of the recordings.

    Returns
    -------
    Prepared
    """
    drops = {drop.recording.name: drop for drop in campaign.drops}
    gone = [decay for decay in prepared.decays if decay.file in excluded]
    return prepared._replace(
        decays=tuple(decay for decay in prepared.decays if decay.file not in excluded),
        left_out=(
            *prepared.left_out,
            *((drops[decay.file], (*decay.faults, excluded[decay.file])) for decay in gone),
        ),
    )
