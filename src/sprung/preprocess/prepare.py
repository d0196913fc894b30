"""From recordings to decays: release found, landing awaited, what cannot be used left out and named."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, Drop, DropTest, Recording, unique_drop_names
from sprung.errors import Fault
from sprung.preprocess.alignment import active_channels, align_loggers
from sprung.preprocess.clipping import check_full_scale, detect_clipping
from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.drift import remove_drift
from sprung.preprocess.dropped_wheels import (
    detect_dropped_wheels,
    dropped_wheels_fault,
    find_contradicted_drops,
    merge_dropped_wheels,
)
from sprung.preprocess.events import DropObservation, Events, filled_in, marked
from sprung.preprocess.gravity import check_gravity
from sprung.preprocess.high_pass import integrate_from_rest, undo_high_pass
from sprung.preprocess.landing import Landing, detect_landing, weigh_corners
from sprung.preprocess.release import Release, StaticBaseline, detect_release, unknown_baseline
from sprung.preprocess.spikes import remove_spikes
from sprung.progress import Progress, Step, counted, silent
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Wheel

Real = NDArray[np.float64]

SHORTEST = 0.5
"""s: a decay shorter than this holds less than half a period of a body mode, and is left out."""

_TYPICAL_WHEELBASE = 2.7
"""m, where neither tape nor sensors tell."""

_LOW_BLOCKS, _HOPPING = 0.1, 0.25
"""Height of blocks that nobody measured, m; and two periods of the slowest usual wheel hop, s."""

_CLIPPED = 0.6
"""s after the release up to which clipping only delays the decay; a channel that clips for longer is left out."""

_NEAR_END = 2.0
"""Samples before the end of its window at which a recording may end, its clock being made even."""

_ALLOWED_FOR = "a fall and two periods of wheel hop after the release, as no sensor tells when the wheels landed"

_NOT_PLACED = (
    "a fall and two periods of wheel hop after the release, as the landing follows from the positions of the body sensors, "
    "which are not known"
)

_TYPICAL_SUSPENSION = 70.0
"""Static suspension force over unsprung mass, m/s², for a wheel that no release has weighed: between car and bus."""


class Prepared(NamedTuple):
    """What preparing a campaign gives.

    Attributes
    ----------
    decays
        One for each drop that can be used, in the campaign's order.
    left_out
        For the other drops why.
    observations
        For every drop of the campaign, in its order, what its recording shows.
    """

    decays: tuple[FreeDecay, ...]
    left_out: tuple[tuple[DropTest, tuple[Fault, ...]], ...]
    observations: tuple[DropObservation, ...] = ()


def prepare(campaign: Campaign, progress: Progress = silent) -> Prepared:
    """Find the usable part of every drop.

    Parameters
    ----------
    campaign
        The campaign.
    progress
        Called with each recording that is begun, in three rounds.

    Returns
    -------
    Prepared
    """
    stated = campaign.drops
    smooth = [
        remove_spikes(one) for one in counted(progress, "looking for spikes in the recordings", campaign.recordings)
    ]
    spiked = [filled_in(*pair) for pair in zip(campaign.recordings, smooth, strict=True)]
    whole = _alive([align_loggers(recording) for recording in smooth], campaign.drops)
    progress(Step("looking for wrong signs, units and saturation in the recordings"))
    scaled = [check_full_scale(recording, campaign.sensors) for recording in whole]
    righted = check_gravity(scaled, [_release(recording) for recording in scaled], campaign.sensors)
    releases, sensors = righted.releases, righted.sensors
    campaign = replace(campaign, sensors=sensors)
    # A sensor clips before its drift is taken off or its high-pass undone: what it read then is not within its range.
    clipped = [detect_clipping(recording) for recording in righted.recordings]
    recordings = [
        recording if release is None else undo_high_pass(remove_drift(recording, release, sensors), release, sensors)
        for recording, release in zip(
            counted(progress, "removing drift from the recordings", righted.recordings), releases, strict=True
        )
    ]
    fell = [detect_dropped_wheels(one, release, sensors) for one, release in zip(recordings, releases, strict=True)]
    drops = list(campaign.drops)
    for i in find_contradicted_drops(campaign.drops, fell):
        fault = dropped_wheels_fault(campaign.drops[i], fell[i], recordings[i].name)
        recordings[i] = replace(recordings[i], faults=(*recordings[i].faults, fault))
        drops[i] = replace(campaign.drops[i], wheels=merge_dropped_wheels(campaign.drops[i], fell[i]))
    for i, drop in enumerate(drops):
        if not drop.wheels:
            drops[i] = replace(drop, wheels=merge_dropped_wheels(drop, fell[i]))
    campaign = replace(campaign, drops=tuple(drops)).with_recordings(recordings)
    suspension = _weigh_corners(campaign, releases)
    decays, left_out = [], []
    names = unique_drop_names(campaign.drops)
    counted_names = counted(progress, "finding the decays", names)
    for drop, name, release, over in zip(campaign.drops, counted_names, releases, clipped, strict=True):
        decay = _decay(campaign, drop, name, release, suspension, over)
        if isinstance(decay, FreeDecay):
            decays.append(decay)
        else:
            left_out.append((drop, tuple(dict.fromkeys((*drop.recording.faults, decay)))))
    seen = [
        DropObservation(
            drop=as_stated,
            recording=drop.recording,
            release=None if release is None else release.sample,
            rest=unknown_baseline(len(sensors)) if release is None else release.rest,
            marks=(*marked("clipped", over), *marked("spike", off)),
            dropped=told,
            wheels=drop.wheels,
        )
        for as_stated, drop, release, over, off, told in zip(
            stated, campaign.drops, releases, clipped, spiked, fell, strict=True
        )
    ]
    return Prepared(tuple(decays), tuple(left_out), tuple(seen))


def _alive(recordings: Sequence[Recording], drops: Sequence[Drop]) -> tuple[Recording, ...]:
    """Leave out channels that never move, and recordings that are copies of an earlier one."""
    seen: dict[tuple[bytes, float | None, float | None], str] = {}
    alive = []
    for recording, drop in zip(recordings, drops, strict=True):
        flat = recording.usable & (np.ptp(recording.values, axis=1) == 0)
        original = seen.setdefault((recording.values.tobytes(), drop.start, drop.end), recording.name)
        faults = [
            Fault(
                "flat",
                f"{recording.name}: {recording.channels[channel]}",
                "the channel shows one value throughout; it is left out of this drop",
                "Check the sensor and its cable.",
            )
            for channel in np.flatnonzero(flat)
        ]
        if original != recording.name and recording.usable.any():
            flat = np.ones_like(flat)
            faults = [
                Fault(
                    "copy",
                    recording.name,
                    f"the same samples as {original}; the drop is left out",
                    "Name the right file for this drop, or remove it from the campaign.",
                )
            ]
        values = np.where(flat[:, None], np.nan, recording.values)
        alive.append(replace(recording, values=values, faults=(*recording.faults, *faults)))
    return tuple(alive)


def _release(recording: Recording) -> Release | None:
    if not recording.usable.any():
        return None
    watched = active_channels(recording)[recording.usable]
    found = detect_release(recording.values[recording.usable], recording.rate, watched=watched)
    if found is None:
        return None
    level = np.full(len(recording.channels), np.nan)
    noise = np.full((len(recording.channels), found.rest.noise.shape[1]), np.nan)
    step = np.full(len(recording.channels), np.nan)
    level[recording.usable], noise[recording.usable], step[recording.usable] = found.rest
    return Release(found.sample, StaticBaseline(level, noise, step))


def _weigh_corners(campaign: Campaign, releases: list[Release | None]) -> dict[Wheel, float]:
    """Pool what all releases say about the corners; a wheel that never fell is taken to be like its neighbour."""
    jumps: defaultdict[Wheel, list[float]] = defaultdict(list)
    for drop, release in zip(campaign.drops, releases, strict=True):
        if release is not None:
            recording = drop.recording
            found = weigh_corners(recording.values, recording.rate, release, campaign.sensors, drop.wheels)
            for station, jump in found.items():
                if np.isfinite(jump):
                    jumps[station].append(jump)
    weighed: dict[Wheel, float] = {station: float(np.median(found)) for station, found in jumps.items()}
    across: dict[Wheel, Wheel] = {"fl": "fr", "fr": "fl", "rl": "rr", "rr": "rl"}
    return {station: weighed.get(station, weighed.get(across[station], _TYPICAL_SUSPENSION)) for station in across}


def _decay(
    campaign: Campaign,
    drop: DropTest,
    name: str,
    release: Release | None,
    suspension: dict[Wheel, float],
    clipped: NDArray[np.bool_],
) -> FreeDecay | Fault:
    recording = drop.recording
    where = recording.name
    if not recording.usable.any():
        for fault in recording.faults:
            if fault.code == "copy":  # which says already why nothing is left
                return fault
        return Fault("missing", where, "no channel of this drop can be used; it is left out", "Record the drop again.")
    faults = list(recording.faults)
    landing = _landing(campaign, drop, recording, release, suspension, clipped, faults)
    first = landing.certain
    recording = _without_clipped(recording, clipped, landing.possible, faults)
    last = recording.values.shape[1] - 1
    why_end = "its window ends" if _ends_with_window(drop, recording) else "the recording ends"
    if drop.end is not None:
        last, why_end = min(last, int(np.floor((drop.end - recording.start) * recording.rate + 1e-6))), "given as end"
    length = (last - first) / recording.rate
    if length < SHORTEST:
        return Fault(
            "no-decay",
            where,
            f"{max(length, 0.0):.2f} s of free vibration, at least {SHORTEST} s are needed; the drop is left out",
            "Record for at least three seconds after the release.",
        )
    high_pass = tuple((release and sensor.high_pass) or 0.0 for sensor in campaign.sensors)
    return FreeDecay(
        name=name,
        file=recording.name,
        load=drop.load,
        values=recording.values[:, first : last + 1],
        earlier=recording.values[:, landing.possible : first],
        rate=recording.rate,
        start=recording.start + first / recording.rate,
        rest=unknown_baseline(len(recording.channels)) if release is None else release.rest,
        faults=tuple(faults),
        clocks=recording.clocks,
        rate_ratios=recording.rate_ratios,
        high_pass=high_pass,
        initial_velocity=integrate_from_rest(recording, release, high_pass, landing.possible),
        events=_events(recording, release, landing, first, why_end),
    )


def _ends_with_window(drop: Drop, recording: Recording) -> bool:
    """Say whether the file goes on where the recording ends."""
    return drop.window is not None and drop.window[1] - float(recording.time[-1]) < _NEAR_END / recording.rate


def _events(recording: Recording, release: Release | None, landing: Landing, first: int, why_end: str) -> Events:
    def when(sample: int | None) -> float | None:
        return None if sample is None else recording.start + sample / recording.rate

    released = None if release is None else release.sample
    moments = when(released), when(landing.landed), when(landing.lifted), when(first)
    return Events(*moments, why_start=landing.why, why_end=why_end)


def _without_clipped(recording: Recording, clipped: NDArray[np.bool_], start: int, faults: list[Fault]) -> Recording:
    """Leave out the channels that clip within the decay, and tell of those that clipped before it."""
    spoilt = np.asarray(clipped[:, start:].any(axis=1))
    for channel in np.flatnonzero(np.asarray(clipped.any(axis=1))):
        consequence = "it is left out of this drop" if spoilt[channel] else "the decay is used from after them"
        faults.append(
            Fault(
                "clipped",
                f"{recording.name}: {recording.channels[channel]}",
                f"{int(clipped[channel].sum())} samples are at the sensor's full scale; {consequence}",
                "Use a sensor with more range, or lower blocks.",
            )
        )
    return replace(recording, values=np.where(spoilt[:, None], np.nan, recording.values)) if spoilt.any() else recording


def _landing(
    campaign: Campaign,
    drop: Drop,
    recording: Recording,
    release: Release | None,
    suspension: dict[Wheel, float],
    clipped: NDArray[np.bool_],
    faults: list[Fault],
) -> Landing:
    if drop.start is not None:
        given = max(0, int(np.ceil((drop.start - recording.start) * recording.rate - 1e-6)))
        return Landing(given, given, "given as start")
    if release is None:
        faults.append(
            Fault(
                "no-release",
                recording.name,
                "no rest before the motion was found; the recording is used from its first sample on",
                "Give start = ... for this drop, or let the recording begin before the release.",
            )
        )
        return Landing(0, 0, "no release was found, so the first sample")
    fall = np.sqrt(2 * (drop.height or _LOW_BLOCKS) / STANDARD_GRAVITY)
    possible = release.sample + int(fall * recording.rate)
    guessed = release.sample + int((fall + _HOPPING) * recording.rate)
    wheelbase = _wheelbase(campaign)
    found = detect_landing(
        recording.values, recording.rate, release, campaign.sensors, suspension, drop.wheels, wheelbase
    )
    if found is None:
        placed = all(sensor.position is not None for sensor in campaign.sensors if sensor.on == "body")
        found = Landing(possible, guessed, _ALLOWED_FOR if placed else _NOT_PLACED)
    judged = {sensor.on for sensor, used in zip(campaign.sensors, recording.usable, strict=True) if used}
    if not judged.issuperset(drop.wheels):  # a wheel fell that nobody watched
        later = guessed > found.certain
        found = found._replace(possible=max(found.possible, possible), certain=max(found.certain, guessed))
        found = found._replace(why=_ALLOWED_FOR) if later else found
    at_landing = np.asarray(clipped[:, : release.sample + int(_CLIPPED * recording.rate)].any(axis=0))
    after = int(np.flatnonzero(at_landing)[-1]) + 1 if at_landing.any() else 0
    if after > found.certain:
        over = [name for name, samples in zip(recording.channels, clipped, strict=True) if samples[after - 1]]
        found = found._replace(why=f"until then {', '.join(over)} clipped")
    return found._replace(possible=max(found.possible, after), certain=max(found.certain, after))


def _wheelbase(campaign: Campaign) -> float:
    if campaign.wheelbase is not None:
        return campaign.wheelbase.value
    x = [sensor.position[0] for sensor in campaign.sensors if sensor.position is not None]
    return max(x) - min(x) if x else _TYPICAL_WHEELBASE
