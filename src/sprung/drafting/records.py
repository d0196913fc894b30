"""Records of a drafted campaign."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sprung.campaign import CAMPAIGN_FILE, SCHEMA_FILE, drop_kind, schema_text
from sprung.display import shown
from sprung.drafting.detected_drop import DetectedDrop
from sprung.drafting.detection import RejectedEvent
from sprung.errors import Problem
from sprung.files import atomic_write
from sprung.vehicle import SensorPlace, Wheel


@dataclass(frozen=True)
class DraftSensor:
    """A sensor, as far as its readings and its name show.

    Attributes
    ----------
    channel
        Its name.
    on
        The body, a wheel station, or "wheel" where the station is not known.
    corner
        Corner of the body at which it sits.
    unit
        Its unit; None where it is not known.
    stated_unit
        Unit that the files state.
    direction
        Direction of a positive reading.
    coupling
        DC where it reads gravity at rest, AC where it reads zero.
    full_scale
        A reading at which it stays for some samples, in its unit.
    notes
        Findings and conclusions, in words.
    logger
        The part of its recordings' names that states its logger, where several loggers' channels have one name; the channel
        then begins with it.
    """

    channel: str
    on: SensorPlace
    corner: Wheel | None
    unit: str | None
    stated_unit: str | None
    direction: Literal["up", "down"]
    coupling: Literal["DC", "AC"]
    full_scale: float | None
    notes: tuple[str, ...]
    logger: str | None = None


@dataclass(frozen=True, eq=False)
class DraftDrop:
    """A drop.

    Attributes
    ----------
    files
        The recording, or the recordings of several loggers.
    window
        s on the file's clock, where the recording holds more than this drop.
    load
        Name of the load; None where it is not known.
    wheels
        Which wheels fell; none where it is not known.
    found
        The drop as detected.
    notes
        Findings and conclusions, in words.
    proposed
        Whether its load follows from the periods of the body, not from a name.
    """

    files: tuple[str, ...]
    window: tuple[float, float] | None
    load: str | None
    wheels: tuple[Wheel, ...]
    found: DetectedDrop
    notes: tuple[str, ...]
    proposed: bool = False

    @property
    def kind(self) -> str | None:
        """What such a drop is called."""
        return drop_kind(self.wheels) if self.wheels else None


@dataclass(frozen=True, eq=False)
class DraftFile:
    """A recording that was read.

    Attributes
    ----------
    name
        Relative to the folder.
    rate
        Samples per second.
    start, end
        s on its clock.
    drops
        Number of drops in it.
    rejected
        The largest of the other events, and why they are no drops.
    events
        How many other events there were.
    left_out
        Channels that are no vertical accelerations, each with the reason.
    """

    name: str
    rate: float
    start: float
    end: float
    drops: int
    rejected: tuple[RejectedEvent, ...]
    events: int
    left_out: Mapping[str, str]


@shown
@dataclass(frozen=True, eq=False)
class DraftCampaign:
    """A drafted campaign.

    Attributes
    ----------
    folder
        Where its recordings are.
    name
        Of the vehicle, after the folder.
    sensors, drops
        Of all recordings.
    files
        The recordings that were read.
    unreadable
        Those that could not be read, each with the reason.
    text
        The campaign file.
    missing
        Places to be completed, and what to write there.
    """

    folder: Path
    name: str
    sensors: tuple[DraftSensor, ...]
    drops: tuple[DraftDrop, ...]
    files: tuple[DraftFile, ...]
    unreadable: Mapping[str, tuple[Problem, ...]]
    text: str = ""
    missing: tuple[tuple[str, str], ...] = ()

    @property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads, without ``empty``, in the order in which they come up."""
        return tuple(dict.fromkeys(drop.load for drop in self.drops if drop.load not in (None, "empty") and drop.load))

    @property
    def path(self) -> Path:
        """Where the campaign file goes."""
        return self.folder / CAMPAIGN_FILE

    def write(self, *, overwrite: bool = False) -> Path:
        """Write the campaign file and, for editors, its JSON Schema beside it; whole or not at all.

        Parameters
        ----------
        overwrite
            Whether files of these names that sprung did not write, or that were changed since, are replaced.

        Returns
        -------
        Path
            The campaign file.

        Raises
        ------
        InputError
            If such files would be overwritten, with their list, or the folder cannot be written to.
        """
        files = {SCHEMA_FILE: schema_text().encode(), CAMPAIGN_FILE: self.text.encode()}
        atomic_write(self.folder, files, overwrite=overwrite)
        return self.path

    def document(self) -> dict[str, Any]:
        """Return the draft as one JSON document."""
        return {
            "campaign": str(self.path),
            "sensors": [
                {
                    "channel": sensor.channel,
                    "on": sensor.on,
                    "corner": sensor.corner,
                    "unit": sensor.unit,
                    "direction": sensor.direction,
                    "coupling": sensor.coupling,
                    "full_scale": sensor.full_scale,
                    "notes": list(sensor.notes),
                }
                for sensor in self.sensors
            ],
            "loads": list(self.loads),
            "drops": [
                {
                    "files": list(drop.files),
                    "release": _rounded(drop.found.release),
                    "landing": _rounded(drop.found.landing),
                    "faded": _rounded(drop.found.faded),
                    "begin": _rounded(drop.found.begin),
                    "end": _rounded(drop.found.end),
                    "window": None if drop.window is None else [_rounded(time) for time in drop.window],
                    "load": drop.load,
                    "wheels": list(drop.wheels),
                    "kind": drop.kind,
                    "notes": list(drop.notes),
                }
                for drop in self.drops
            ],
            "files": [
                {
                    "file": file.name,
                    "rate": _rounded(file.rate),
                    "start": _rounded(file.start),
                    "end": _rounded(file.end),
                    "drops": file.drops,
                    "events": file.events,
                    "refused": [{"time": _rounded(event.time), "why": event.why} for event in file.rejected],
                    "left_out": dict(file.left_out),
                }
                for file in self.files
            ],
            "unreadable": {name: [str(problem) for problem in problems] for name, problems in self.unreadable.items()},
            "missing": [{"where": where, "what": what} for where, what in self.missing],
            "next": ["sprung", "check", str(self.path)],
        }


def _rounded(number: float) -> float | None:
    return round(float(number), 6) if np.isfinite(number) else None
