"""Look at the recordings, identify nothing: which part of each drop can be used, and what is wrong."""

from __future__ import annotations

from dataclasses import dataclass

from sprung.errors import Fault
from sprung.prepare import Prepared, prepare
from sprung.recording import Campaign


@dataclass(frozen=True)
class DropReport:
    """One drop: which part of it was used, and the codes of its faults; start and end are None where none was.

    Attributes
    ----------
    file
        The recording.
    load
        Name of the load on the vehicle.
    start, end
        Of the decay, s on the file's own clock.
    faults
        Codes.
    """

    file: str
    load: str
    start: float | None
    end: float | None
    faults: tuple[str, ...]


@dataclass(frozen=True)
class Check:
    """What a look at the recordings shows.

    Attributes
    ----------
    drops
        Which part of each drop can be used.
    faults
        Everything that is wrong, the harmless included.
    """

    drops: tuple[DropReport, ...]
    faults: tuple[Fault, ...]

    @property
    def usable(self) -> bool:
        """Whether at least one drop can be used."""
        return any(drop.start is not None for drop in self.drops)


def check(campaign: Campaign) -> Check:
    """Judge the recordings of a campaign.

    Parameters
    ----------
    campaign
        From `sprung.read`.

    Returns
    -------
    Check
    """
    return check_prepared(campaign, prepare(campaign))


def check_prepared(campaign: Campaign, prepared: Prepared) -> Check:
    """Judge recordings that have been prepared already."""
    used = {decay.file: decay for decay in prepared.decays}
    left_out = {recording.name: faults for _, recording, faults in prepared.left_out}
    reports = []
    for drop, recording in zip(campaign.drops, campaign.recordings, strict=True):
        decay = used.get(recording.name)
        faults = left_out[recording.name] if decay is None else decay.faults
        start, end = (None, None) if decay is None else (decay.start, decay.end)
        reports.append(DropReport(recording.name, drop.load, start, end, tuple(fault.code for fault in faults)))
    of_drops = [fault for decay in prepared.decays for fault in decay.faults]
    of_left_out = [fault for _, _, faults in prepared.left_out for fault in faults]
    return Check(tuple(reports), (*campaign.faults, *of_drops, *of_left_out))
