"""Look at the recordings, identify nothing: which part of each drop can be used, why, and what is wrong."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sprung.display import shown
from sprung.errors import Fault
from sprung.pipeline.clocks import ClockReport
from sprung.pipeline.options import CampaignSource, campaign_from
from sprung.pipeline.series import Recorded
from sprung.prepare import Decay, Events, Prepared, Seen, prepare
from sprung.recording import Campaign, Drop, drop_names
from sprung.vehicle import WHEELS, Sensor, Wheel

if TYPE_CHECKING:
    import pandas as pd


@shown
@dataclass(frozen=True)
class ChannelReport:
    """What one channel of one drop shows.

    Attributes
    ----------
    name
        The channel's.
    on
        What its sensor sits on: the body, or a wheel station.
    noise
        At rest on the blocks, m/s² root-mean-square; None where the recording shows no rest.
    peak
        Largest reading from the release on, counted from the reading at rest (without one, from the mean), m/s²; None
        where nothing of the channel can be read.
    used
        Whether it is in the decay.
    faults
        Codes of its own.
    """

    name: str
    on: Literal["body", "fl", "fr", "rl", "rr"]
    noise: float | None
    peak: float | None
    used: bool
    faults: tuple[str, ...]


@shown
@dataclass(frozen=True)
class DropReport:
    """One drop: what happened when, which part of it was used, why, and the codes of its faults.

    Times are in s on the recording's own clock. What results of an older sprung do not have is None or empty.

    Attributes
    ----------
    file
        The recording.
    load
        Name of the load on the vehicle.
    start, end
        Of the decay; None where none was used.
    faults
        Codes.
    kind
        ``bounce``, ``pitch front``, ``pitch rear``, ``roll left``, ``roll right``, or the wheels by name.
    wheels
        Which wheels were dropped, as the campaign says.
    wheels_seen
        Which wheels the release shows to have fallen; as stated where no sensor tells. None without a release.
    release, landing, last_lift_off
        First motion; when the last wheel that fell met the ground; the last moment a tyre may have been off it. None
        where the records do not tell.
    why_start, why_end
        The reason for each limit of the decay, in words.
    rate
        Samples per second.
    channels
        What each channel shows.
    clocks
        For several loggers how their clocks stood, as the fit found it.
    name
        The drop's short name, by which its series are found.
    """

    file: str
    load: str
    start: float | None
    end: float | None
    faults: tuple[str, ...]
    kind: str = ""
    wheels: tuple[Wheel, ...] = ()
    wheels_seen: tuple[Wheel, ...] | None = None
    release: float | None = None
    landing: float | None = None
    last_lift_off: float | None = None
    why_start: str = ""
    why_end: str = ""
    rate: float | None = None
    channels: tuple[ChannelReport, ...] = ()
    clocks: tuple[ClockReport, ...] = ()
    name: str = ""

    @property
    def contradicted(self) -> bool:
        """Whether the records show other wheels to have fallen than the campaign says."""
        return self.wheels_seen is not None and set(self.wheels_seen) != set(self.wheels)


@shown
@dataclass(frozen=True)
class Check:
    """What a look at the recordings shows.

    Attributes
    ----------
    drops
        What happened in each drop, and which part of it can be used.
    faults
        Everything that is wrong, the harmless included.
    recorded
        Each drop's whole recording, to draw.
    """

    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]
    recorded: tuple[Recorded, ...] = field(default=(), repr=False)

    @property
    def usable(self) -> bool:
        """Whether at least one drop can be used."""
        return any(drop.start is not None for drop in self.drops)

    def to_dataframe(self) -> pd.DataFrame:
        """Return what happened in each drop as a table, times in s on the recording's own clock."""
        import pandas as pd  # noqa: PLC0415 (slow to import, and nothing else here needs it)

        columns = ["file", "load", "kind", "release", "landing", "start", "end", "rate", "faults"]
        rows = [[getattr(drop, one) for one in columns[:-1]] + [", ".join(drop.faults)] for drop in self.drops]
        return pd.DataFrame(rows, columns=columns).set_index("file")

    def document(self) -> dict[str, Any]:
        """Give drops and faults as JSON holds them."""
        return {"drops": [asdict(drop) for drop in self.drops], "faults": [asdict(fault) for fault in self.faults]}


def check(campaign: CampaignSource) -> Check:
    """Judge the recordings of a campaign.

    Parameters
    ----------
    campaign
        From `sprung.read`; or the path of a campaign file or of its folder.

    Returns
    -------
    Check

    Raises
    ------
    InputError
        If the campaign cannot be read.
    """
    campaign = campaign_from(campaign)
    return check_prepared(campaign, prepare(campaign))


def check_prepared(campaign: Campaign, prepared: Prepared) -> Check:
    """Judge recordings that have been prepared already."""
    used = {decay.file: decay for decay in prepared.decays}
    left_out = {recording.name: faults for _, recording, faults in prepared.left_out}
    reports = []
    for drop, short, seen in zip(campaign.drops, drop_names(campaign.drops), prepared.seen, strict=True):
        name = seen.recording.name
        decay = used.get(name)
        faults = left_out[name] if decay is None else decay.faults
        reports.append(_report(drop, short, seen, decay, faults, campaign.sensors))
    recorded = tuple(Recorded.of(*pair) for pair in zip(prepared.seen, campaign.recordings, strict=True))
    of_drops = [fault for decay in prepared.decays for fault in decay.faults]
    of_left_out = [fault for _, _, faults in prepared.left_out for fault in faults]
    everything = (*campaign.faults, *of_drops, *of_left_out)
    return Check(tuple(reports), everything, recorded)


def _report(
    drop: Drop, name: str, seen: Seen, decay: Decay | None, faults: Sequence[Fault], sensors: Sequence[Sensor]
) -> DropReport:
    recording = seen.recording
    released = None if seen.release is None else recording.start + seen.release / recording.rate
    events = Events(release=released) if decay is None else decay.events
    return DropReport(
        file=recording.name,
        load=drop.load,
        start=None if decay is None else decay.start,
        end=None if decay is None else decay.end,
        faults=tuple(fault.code for fault in faults),
        kind=drop.kind,
        wheels=drop.wheels,
        wheels_seen=_fallen(drop, seen) if seen.fell else None,
        release=events.release,
        landing=events.landing,
        last_lift_off=events.last_lift_off,
        why_start=events.why_start,
        why_end=events.why_end,
        rate=recording.rate,
        channels=tuple(_channels(seen, decay, faults, sensors)),
        name=name,
    )


def _fallen(drop: Drop, seen: Seen) -> tuple[Wheel, ...]:
    return tuple(wheel for wheel in WHEELS if seen.fell.get(wheel, wheel in drop.wheels))


def _channels(
    seen: Seen, decay: Decay | None, faults: Sequence[Fault], sensors: Sequence[Sensor]
) -> Iterator[ChannelReport]:
    recording, rest = seen.recording, seen.rest
    for channel, (name, sensor) in enumerate(zip(recording.channels, sensors, strict=True)):
        values = recording.values[channel]
        at_rest = seen.release is not None and np.isfinite(rest.level[channel])
        level = rest.level[channel] if at_rest else values.mean()
        peak = np.abs(values[seen.release or 0 :] - level).max(initial=0.0)
        used = decay is not None and bool(decay.usable[channel])
        yield ChannelReport(
            name=name,
            on=sensor.on,
            noise=float(np.sqrt(np.mean(rest.noise[channel] ** 2))) if at_rest else None,
            peak=float(peak) if np.isfinite(peak) else None,
            used=used,
            faults=tuple(fault.code for fault in faults if fault.where == f"{recording.name}: {name}"),
        )
