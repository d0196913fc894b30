"""Judge the recordings, identify nothing: which part of each drop can be used, why, what is wrong, and what is missing."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sprung.campaign import (
    CAMPAIGN_FILE,
    Campaign,
    Drop,
    MissingEntry,
    drop_kind,
    read,
    read_document,
    require_plausible,
    unique_drop_names,
)
from sprung.checking.clock import ClockReport
from sprung.checking.recorded import PlottedRecording
from sprung.dataframes import require_pandas
from sprung.display import shown
from sprung.drafting import DraftCampaign, draft
from sprung.errors import Fault, InputError
from sprung.faults import examine
from sprung.preprocess import DropObservation, Events, FreeDecay, Prepared, exclude_drops, prepare
from sprung.progress import Progress, silent
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
        What its sensor sits on: the body, or a wheel station; None for a wheel station that is not known.
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
    on: Literal["body", "fl", "fr", "rl", "rr"] | None
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
        Of the decay, as the recording shows it, the same from `check` and in a result; None where none was used.
    faults
        Codes.
    kind
        ``bounce``, ``pitch front``, ``pitch rear``, ``roll left``, ``roll right``, or the wheels by name.
    wheels
        Which wheels were dropped, as the campaign says; empty where it does not say it.
    wheels_seen
        Which wheels the release shows to have fallen; as stated where no sensor tells. None without a release.
    release, landing, last_lift_off
        First motion; when the last wheel that fell met the ground; the last moment, not before the landing, at which a tyre may
        have been off the ground once more. They follow each other in this order, and ``start`` follows them. None where the
        records do not tell, the last also where no tyre can have been off the ground again.
    why_start, why_end
        The reason for each limit of the decay, in words.
    fit_start, why_fit
        From where a fit uses the drop, and why, where that is not ``start``: it knows to the sample when the last tyre of the
        fitted vehicle is down, or uses the fall too. None and empty from `check`.
    rate
        Samples per second.
    channels
        What each channel shows.
    clocks
        For several loggers how their clocks stood, as the fit found it.
    name
        The drop's short name, by which its series are found.
    title
        The name that the campaign gives it; empty where it gives none.
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
    fit_start: float | None = None
    why_fit: str = ""
    rate: float | None = None
    channels: tuple[ChannelReport, ...] = ()
    clocks: tuple[ClockReport, ...] = ()
    name: str = ""
    title: str = ""

    @property
    def used_from(self) -> float | None:
        """Where the fit begins to use the drop, s on the recording's own clock; without a fit where its decay begins."""
        return self.start if self.fit_start is None else self.fit_start

    @property
    def label(self) -> str:
        """What to call it: the name that the campaign gives it, or else its recording."""
        return self.title or self.file

    @property
    def contradicted(self) -> bool:
        """Whether the records show other wheels to have fallen than the campaign says."""
        return bool(self.wheels) and self.wheels_seen is not None and set(self.wheels_seen) != set(self.wheels)


@shown
@dataclass(frozen=True)
class Check:
    """What the recordings of a campaign show, and what the campaign does not say yet.

    Attributes
    ----------
    drops
        What happened in each drop, and which part of it can be used.
    faults
        Everything that is wrong, the harmless included.
    recorded
        Whole recordings, to draw: of the drops in their order, without the last ones, which could not be read.
    campaign
        What was judged; None where only its reports are at hand.
    missing
        What an identification would need besides the recordings, or profit from.
    """

    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]
    recorded: tuple[PlottedRecording, ...] = field(default=(), repr=False)
    campaign: Campaign | None = field(default=None, repr=False)
    missing: tuple[MissingEntry, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether at least one drop can be used."""
        return any(drop.start is not None for drop in self.drops)

    def to_dataframe(self) -> pd.DataFrame:
        """Return what happened in each drop as a table, times in s on the recording's own clock."""
        require_pandas()
        import pandas as pd  # noqa: PLC0415 (optional, and nothing else here needs it)

        columns = ["file", "load", "kind", "release", "landing", "start", "end", "rate", "faults"]
        rows = [[getattr(drop, one) for one in columns[:-1]] + [", ".join(drop.faults)] for drop in self.drops]
        return pd.DataFrame(rows, columns=columns).set_index("file")

    @property
    def summary(self) -> str:
        """How many drops can be used, and what is missing: ``10 of 10 drops usable; missing: wheelbase``."""
        usable = sum(drop.start is not None for drop in self.drops)
        items = ", ".join(dict.fromkeys(one.item for one in self.missing))
        counted = f"{usable} of {len(self.drops)} drop{'s' * (len(self.drops) != 1)} usable"
        return f"{counted}; missing: {items}" if items else counted

    def faults_of(self, drop: DropReport) -> tuple[Fault, ...]:
        """Return what is wrong with one drop.

        Parameters
        ----------
        drop
            One of `drops`.
        """
        return tuple(fault for fault in self.faults if fault.where == drop.file or _is_within(fault.where, drop.file))

    @property
    def common_faults(self) -> tuple[Fault, ...]:
        """What is wrong with the campaign or with a channel in all drops."""
        of_drops = {fault for drop in self.drops for fault in self.faults_of(drop)}
        return tuple(fault for fault in self.faults if fault not in of_drops)

    def document(self) -> dict[str, Any]:
        """Return drops, faults and what is missing, as JSON holds them."""
        return {
            "drops": [asdict(drop) for drop in self.drops],
            "faults": [asdict(fault) for fault in self.faults],
            "missing": [one.document() for one in self.missing],
        }


def _is_within(place: str, file: str) -> bool:
    return place.startswith(f"{file}: ")


def check(campaign: Campaign | str | os.PathLike[str], *, progress: Progress = silent) -> Check:
    """Judge the recordings of a campaign; no geometry is needed for that.

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
        If a path is given and there is nothing that can be judged, or the campaign states what cannot be.
    """
    if not isinstance(campaign, Campaign):
        campaign = _campaign_at(Path(campaign), progress)
    else:
        require_plausible(campaign)
    try:
        campaign, prepared, undeclared = examine(campaign, progress)
    except InputError as error:  # what makes identifying impossible is one more thing to be told of here
        found = tuple(Fault("mirrored", one.where, one.found, one.do) for one in error.problems)
        return check_prepared(replace(campaign, faults=(*campaign.faults, *found)), prepare(campaign, progress))
    return check_prepared(campaign, exclude_drops(campaign, prepared, undeclared))


def _campaign_at(path: Path, progress: Progress) -> Campaign:
    """Read a campaign as far as it is written down, or draft one from recordings alone."""
    if not path.is_dir() or any(path.glob("*.toml")):
        return read(path, complete=False, progress=progress)
    drafted = draft(path, progress=progress)
    campaign = read_document(tomllib.loads(drafted.text), path / CAMPAIGN_FILE, complete=False, progress=progress)
    return replace(campaign, faults=(*campaign.faults, *_without_drop(drafted)))


def _without_drop(drafted: DraftCampaign) -> Iterator[Fault]:
    """Name the recordings in which no drop was found."""
    for file in drafted.files:
        if not file.drops:
            why = file.rejected[0].why if file.rejected else "nothing in it moves"
            do = "Look whether it is the right recording, and name its unit if it has another."
            yield Fault("no-drop", file.name, f"no drop was found: {why}", do)
    for name, problems in drafted.unreadable.items():
        yield Fault("unreadable", name, f"found {problems[0].found}; the recording is left out", problems[0].do)


def check_prepared(campaign: Campaign, prepared: Prepared) -> Check:
    """Judge recordings that have been prepared already."""
    used = {decay.file: decay for decay in prepared.decays}
    left_out = {drop.recording.name: faults for drop, faults in prepared.left_out}
    reports = []
    for short, seen in zip(unique_drop_names(campaign.drops), prepared.observations, strict=True):
        name = seen.recording.name
        decay = used.get(name)
        faults = left_out[name] if decay is None else decay.faults
        reports.append(_report(short, seen, decay, faults, campaign.sensors))
    recorded = tuple(PlottedRecording.of(seen) for seen in prepared.observations)
    of_drops = [fault for decay in prepared.decays for fault in decay.faults]
    of_left_out = [fault for _, faults in prepared.left_out for fault in faults]
    everything = tuple(dict.fromkeys((*campaign.faults, *of_drops, *of_left_out)))  # one may be that of several drops
    reports += [_unread(drop, everything) for drop in campaign.unread]
    return Check(tuple(reports), everything, recorded, campaign, campaign.missing)


def _unread(drop: Drop, faults: Sequence[Fault]) -> DropReport:
    """Report a drop whose recording could not be read."""
    file = drop.recording_name or drop.label
    codes = tuple(fault.code for fault in faults if fault.where == file or _is_within(fault.where, file))
    kind, title = drop_kind(drop.wheels), drop.name or ""
    return DropReport(file, drop.load, None, None, codes, kind=kind, wheels=drop.wheels, name=drop.label, title=title)


def _report(
    name: str,
    seen: DropObservation,
    decay: FreeDecay | None,
    faults: Sequence[Fault],
    sensors: Sequence[Sensor],
) -> DropReport:
    drop, recording = seen.drop, seen.recording
    released = None if seen.release is None else recording.start + seen.release / recording.rate
    events = Events(release=released) if decay is None else decay.events
    return DropReport(
        file=recording.name if drop.name is None else drop.recording_name or recording.name,
        load=drop.load,
        start=None if decay is None else decay.events.start,
        end=None if decay is None else decay.end,
        faults=tuple(fault.code for fault in faults),
        kind=drop_kind(drop.wheels or seen.wheels),
        wheels=drop.wheels,
        wheels_seen=_fallen(drop, seen) if seen.dropped else None,
        release=events.release,
        landing=events.landing,
        last_lift_off=events.last_lift_off,
        why_start=events.why_start,
        why_end=events.why_end,
        fit_start=decay.start if decay is not None and events.why_fit else None,
        why_fit=events.why_fit,
        rate=recording.rate,
        channels=tuple(_channels(seen, decay, faults, sensors)),
        name=name,
        title=drop.name or "",
    )


def _fallen(drop: Drop, seen: DropObservation) -> tuple[Wheel, ...]:
    return tuple(wheel for wheel in WHEELS if seen.dropped.get(wheel, wheel in drop.wheels))


def _channels(
    seen: DropObservation, decay: FreeDecay | None, faults: Sequence[Fault], sensors: Sequence[Sensor]
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
