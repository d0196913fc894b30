"""A drafted campaign: its records, the text of its file, and what is still missing."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from sprung.campaign import CAMPAIGN_FILE, SCHEMA_FILE, schema_text
from sprung.display import shown
from sprung.drafting.records import DraftDrop, DraftFile, DraftSensor
from sprung.errors import Problem
from sprung.files import atomic_write
from sprung.vehicle import VehicleModel


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
    model
        Which part of a vehicle it is.
    copies
        Recordings that were left out as they are identical to another, by name, and that other.
    setting
        What the names of its recordings state of the vehicle itself, where other recordings state another setting.
    output
        Folder of the campaign file; None for that of the recordings.
    """

    folder: Path
    name: str
    sensors: tuple[DraftSensor, ...]
    drops: tuple[DraftDrop, ...]
    files: tuple[DraftFile, ...]
    unreadable: Mapping[str, tuple[Problem, ...]]
    text: str = ""
    missing: tuple[tuple[str, str], ...] = ()
    model: VehicleModel = "full"
    copies: Mapping[str, str] = field(default_factory=dict)
    setting: str | None = None
    output: Path | None = None

    @property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads, without ``empty``, in the order in which they come up."""
        return tuple(dict.fromkeys(drop.load for drop in self.drops if drop.load not in (None, "empty") and drop.load))

    @property
    def path(self) -> Path:
        """Where the campaign file goes."""
        return (self.output or self.folder) / CAMPAIGN_FILE

    def path_to(self, name: str) -> str:
        """Return the path of a recording from the campaign file."""
        if self.output is None or self.output.resolve() == self.folder.resolve():
            return name
        recording = (self.folder / name).resolve()
        try:
            return Path(os.path.relpath(recording, self.output.resolve())).as_posix()
        except ValueError:  # on another drive
            return recording.as_posix()

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
        atomic_write(self.output or self.folder, files, overwrite=overwrite)
        return self.path

    def document(self) -> dict[str, Any]:
        """Return the draft as one JSON document."""
        return {
            "campaign": str(self.path),
            "model": self.model,
            "setting": self.setting,
            "copies": dict(self.copies),
            "sensors": [
                {
                    "channel": sensor.channel,
                    "on": sensor.on,
                    "corner": sensor.corner,
                    "unit": sensor.unit,
                    "direction": sensor.direction,
                    "coupling": sensor.coupling,
                    "full_scale": sensor.full_scale,
                    "quantity": sensor.quantity,
                    "axis": sensor.axis,
                    "is_travel": sensor.is_travel,
                    "relative_to": sensor.relative_to,
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
                    "excitation": drop.excitation,
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
