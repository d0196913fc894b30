"""Extraction of the free decay of one drop: from the landing on, without the channels that clip in it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, DropTest, Recording
from sprung.errors import Fault
from sprung.preprocess.decay import FreeDecay
from sprung.preprocess.end_of_drive import detect_end_of_drive, too_short
from sprung.preprocess.events import Events
from sprung.preprocess.high_pass import integrate_from_rest
from sprung.preprocess.landing import Landing, detect_landing, measure_suspension_force
from sprung.preprocess.passage import check_speed
from sprung.preprocess.release import Release, unknown_release
from sprung.preprocess.wheel_height import detect_contact
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS, Wheel

Flags = NDArray[np.bool_]

_SHORTEST = 0.5
"""s: a decay shorter than this holds less than half a period of a body mode, and is left out."""

_TYPICAL_WHEELBASE = 2.7
"""m, where neither the campaign nor the sensors' positions give it."""

_LOWEST_BLOCKS, _HIGHEST_BLOCKS, _HOPPING = 0.02, 0.1, 0.25
"""Heights of blocks that are not stated, m; and two periods of the slowest usual wheel hop, s."""

_FASTEST_FALL = 160.0
"""Acceleration of a wheel that falls, m/s², gravity and its spring together: of a light wheel under a heavy body."""

_CLIPPED = 0.6
"""s after the release up to which clipping only delays the decay; a channel that clips for longer is left out."""

_NEAR_END = 2.0
"""Samples before the end of its window at which a recording may end, its clock having been regularised."""

_ALLOWED_FOR = (
    "a fall and two periods of wheel hop after the release, as the sensors do not tell when every wheel has landed"
)

_BY_HEIGHTS = "every wheel is as low as only one that has landed is"

_NOT_PLACED = (
    "a fall and two periods of wheel hop after the release, as the landing follows from the positions of the body sensors, "
    "which are not known"
)

_TYPICAL_SUSPENSION = 70.0
"""Static suspension force over unsprung mass, m/s², for a wheel whose fall was never recorded: between car and bus."""


def pool_suspension_forces(campaign: Campaign, releases: Sequence[Release | None]) -> dict[Wheel, float]:
    """Pool the static suspension forces over all releases; a wheel that never fell is taken to be like its neighbour.

    Parameters
    ----------
    campaign
        Its recordings corrected.
    releases
        One for each drop.

    Returns
    -------
    dict
        Static suspension force over unsprung mass, m/s², of every wheel.
    """
    measured: defaultdict[Wheel, list[float]] = defaultdict(list)
    for drop, release in zip(campaign.drops, releases, strict=True):
        if release is not None and not drop.is_driven:
            recording = drop.recording
            forces = measure_suspension_force(recording.values, recording.rate, release, campaign.sensors, drop.wheels)
            for wheel, force in forces.items():
                if np.isfinite(force):
                    measured[wheel].append(force)
    pooled: dict[Wheel, float] = {wheel: float(np.median(forces)) for wheel, forces in measured.items()}
    layout = campaign.layout
    of_axle = {
        axle: next((pooled[wheel] for wheel in layout.wheels_of(axle) if wheel in pooled), _TYPICAL_SUSPENSION)
        for axle in layout.axles
    }
    return {wheel: pooled.get(wheel, of_axle[STATIONS[wheel].axle]) for wheel in layout.wheels}


def extract_decay(
    campaign: Campaign,
    drop: DropTest,
    name: str,
    release: Release | None,
    suspension: Mapping[Wheel, float],
    clipped: Flags,
) -> FreeDecay | Fault:
    """Extract the free decay of one drop.

    Parameters
    ----------
    campaign
        Its sensors and wheelbase.
    drop
        With its recording, corrected.
    name
        Short name of the drop.
    release
        Its release; without one the recording is used from its first sample on.
    suspension
        From `pool_suspension_forces`.
    clipped
        Samples at full scale, shape (channel, time).

    Returns
    -------
    FreeDecay or Fault
        A fault where no free vibration is left.
    """
    recording = drop.recording
    if not recording.usable.any():
        missing = "no channel of this drop can be used; it is left out"
        # A copy has its own fault already, which says why nothing is left.
        return next(
            (fault for fault in recording.faults if fault.code == "copy"),
            Fault("missing", recording.name, missing, "Record the drop again."),
        )
    faults = list(recording.faults)
    is_driven = drop.is_driven and drop.start is None
    if drop.start is None and release is None and not is_driven:
        what = "no rest before the motion; the recording is used from its first sample on"
        do = "Give start = ... for this drop, or let the recording begin before the release."
        faults.append(Fault("no-release", recording.name, what, do))
    last, why_end = find_end(drop)
    if is_driven:
        found = detect_end_of_drive(drop, release, clipped, last)
        if isinstance(found, Fault):
            return found
        landing = found
        faults += check_speed(campaign, drop)
    else:
        landing = _find_start(campaign, drop, release, suspension, clipped)
    clips_in_decay = np.asarray(clipped[:, landing.possible :].any(axis=1))
    faults += clipping_faults(recording, clipped, clips_in_decay)
    values = np.where(clips_in_decay[:, None], np.nan, recording.values) if clips_in_decay.any() else recording.values
    first = landing.certain
    length = (last - first) / recording.rate
    if length < _SHORTEST and is_driven:
        return too_short(drop, length, _SHORTEST)
    if length < _SHORTEST:
        what = f"{max(length, 0.0):.2f} s of free vibration, at least {_SHORTEST} s are needed; the drop is left out"
        return Fault("no-decay", recording.name, what, "Record for at least three seconds after the release.")
    high_pass = tuple((release and sensor.high_pass) or 0.0 for sensor in campaign.sensors)
    return FreeDecay(
        name=name,
        file=recording.name,
        load=drop.load,
        values=values[:, first : last + 1],
        earlier=values[:, landing.possible : first],
        rate=recording.rate,
        start=recording.start + first / recording.rate,
        rest=unknown_release(len(recording.channels)) if release is None else release,
        faults=tuple(faults),
        clocks=recording.clocks,
        rate_ratios=recording.rate_ratios,
        high_pass=high_pass,
        initial_velocity=integrate_from_rest(values, recording.rate, release, high_pass, landing.possible),
        events=_events(recording, release, landing, why_end),
        is_driven=is_driven,
    )


def _find_start(
    campaign: Campaign, drop: DropTest, release: Release | None, suspension: Mapping[Wheel, float], clipped: Flags
) -> Landing:
    """Find where the decay begins: after the landing, and after the last sample that clips in the landing."""
    recording = drop.recording
    if drop.start is not None:
        given = find_stated_start(drop)
        return Landing(given, given, "given as start")
    if release is None:
        return Landing(0, 0, "no release was found, so the first sample")
    fall = np.sqrt(2 * (drop.height or _HIGHEST_BLOCKS) / STANDARD_GRAVITY)
    fastest = np.sqrt(2 * (drop.height or _LOWEST_BLOCKS) / _FASTEST_FALL)
    possible, usual = (release.sample + int(time * recording.rate) for time in (fastest, fall))
    typical = release.sample + int((fall + _HOPPING) * recording.rate)
    wheelbase = _wheelbase(campaign)
    landing = detect_landing(
        recording.values, recording.rate, release, campaign.sensors, suspension, drop.wheels, wheelbase
    )
    watched = {
        sensor.wheel
        for sensor, used in zip(campaign.sensors, recording.usable, strict=True)
        if used and sensor.reads_gravity
    }
    if landing is None or not watched.issuperset(drop.wheels):  # a wheel without a usable sensor fell too
        certain, why = typical, _ALLOWED_FOR
        if landing is None and not all(one.position is not None for one in campaign.sensors if one.needs_position):
            why = _NOT_PLACED
        contact = detect_contact(
            recording.values, recording.rate, release, campaign.sensors, drop.wheels, drop.height, typical
        )
        if contact is not None:
            certain, why = contact, _BY_HEIGHTS
        landing = _later_of(landing, Landing(min(possible, certain), certain, why), usual)
    at_landing = np.flatnonzero(clipped[:, : release.sample + int(_CLIPPED * recording.rate)].any(axis=0))
    after = int(at_landing[-1]) + 1 if at_landing.size else 0
    if after > landing.certain:
        over = [name for name, samples in zip(recording.channels, clipped, strict=True) if samples[after - 1]]
        landing = landing._replace(why=f"until then {', '.join(over)} clipped")
    return landing._replace(possible=max(landing.possible, after), certain=max(landing.certain, after))


def _later_of(landing: Landing | None, allowed: Landing, usual: int) -> Landing:
    """Return a landing of some wheels, no earlier than what is allowed for the others; these land by the usual fall, too."""
    if landing is None:
        return allowed
    possible = allowed.possible if landing.landed is None else min(usual, allowed.certain)
    return landing._replace(
        possible=max(landing.possible, possible),
        certain=max(landing.certain, allowed.certain),
        why=allowed.why if allowed.certain > landing.certain else landing.why,
    )


def find_stated_start(drop: DropTest) -> int:
    """Return the first sample that is to be used as the drop states it; 0 where it does not."""
    if drop.start is None:
        return 0
    recording = drop.recording
    return max(0, int(np.ceil((drop.start - recording.start) * recording.rate - 1e-6)))


def find_end(drop: DropTest) -> tuple[int, str]:
    """Find the last sample of the decay, and the reason in words."""
    recording = drop.recording
    last = recording.values.shape[1] - 1
    if drop.end is not None:
        return min(last, int(np.floor((drop.end - recording.start) * recording.rate + 1e-6))), "given as end"
    ends_with_window = (
        drop.window is not None and drop.window[1] - float(recording.time[-1]) < _NEAR_END / recording.rate
    )
    return last, "its window ends" if ends_with_window else "the recording ends"


def clipping_faults(recording: Recording, clipped: Flags, in_decay: Flags) -> Iterator[Fault]:
    """Yield a fault for every channel that clips.

    Parameters
    ----------
    recording
        The recording.
    clipped
        Samples at full scale, shape (channel, time).
    in_decay
        Which channels clip in the part that is used, so that they are left out, shape (channel,).

    Yields
    ------
    Fault
    """
    for channel in np.flatnonzero(clipped.any(axis=1)).tolist():
        consequence = "it is left out of this drop" if in_decay[channel] else "the decay is used from after them"
        yield Fault(
            "clipped",
            f"{recording.name}: {recording.channels[channel]}",
            f"{int(clipped[channel].sum())} samples are at the sensor's full scale; {consequence}",
            "Use a sensor with more range, or lower blocks.",
        )


def _events(recording: Recording, release: Release | None, landing: Landing, why_end: str) -> Events:
    def when(sample: int | None) -> float | None:
        return None if sample is None else recording.start + sample / recording.rate

    return Events(
        release=when(None if release is None else release.sample),
        landing=when(landing.landed),
        last_lift_off=when(landing.lifted),
        start=when(landing.certain),
        why_start=landing.why,
        why_end=why_end,
    )


def _wheelbase(campaign: Campaign) -> float:
    if campaign.wheelbase is not None:
        return campaign.wheelbase.value
    x = [sensor.position[0] for sensor in campaign.sensors if sensor.position is not None]
    return max(x) - min(x) if x else _TYPICAL_WHEELBASE
