"""A campaign: all drops of one vehicle, empty and loaded, and what was measured beforehand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from sprung.errors import Fault
from sprung.estimate import Known
from sprung.recording.recording import Recording
from sprung.vehicle import EMPTY, Finite, Load, Positive, Sensor, Wheel


class Drop(BaseModel):
    """One release off the blocks, as a campaign file describes it."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    file: str | None = None
    """Recording, relative to the campaign file; a vehicle file, which has no recordings, leaves it out."""
    files: tuple[str, ...] = Field(default=(), max_length=64)
    """Recordings of this drop, where several loggers recorded it, each on its own clock; instead of `file`."""
    window: tuple[Finite, Finite] | None = None
    """s on the file's clock: the part of the recording that holds this drop, where it holds more than one."""
    load: str = "empty"
    """Name of the load on the vehicle."""
    wheels: tuple[Wheel, ...] = Field(default=("fl", "fr", "rl", "rr"), min_length=1)
    """Which wheels were dropped; the others stood on the ground."""
    height: Positive | None = None
    """Of the blocks, m."""
    start: Finite | None = None
    """s on the file's clock: the decay is used from here, as given."""
    end: Finite | None = None
    """s on the file's clock: the decay is used up to here, as given."""

    @model_validator(mode="after")
    def _consistent(self) -> Drop:
        if len(set(self.wheels)) != len(self.wheels):
            raise ValueError("name each wheel once")
        if self.start is not None and self.end is not None and self.end <= self.start:
            raise ValueError(f"the end, {self.end:g} s, must come after the start, {self.start:g} s")
        if self.file is not None and self.files:
            raise ValueError("name either the file or, where several loggers recorded it, the files")
        if len(set(self.files)) != len(self.files):
            raise ValueError("name each file once")
        if self.window is not None and self.window[1] <= self.window[0]:
            raise ValueError(f"the window must end after {self.window[0]:g} s, where it begins")
        if self.window is not None and self.files:
            raise ValueError("the clocks of several files have no window in common: cut the files")
        return self

    @property
    def recordings(self) -> tuple[str, ...]:
        """Files that recorded it."""
        return self.files if self.file is None else (self.file,)

    @property
    def recording(self) -> str | None:
        """What to call its recording: the file, with the beginning of its window, or what its files have in common."""
        if self.window is not None:
            return f"{self.file} from {self.window[0]:g} s"
        if len(self.files) < 2:
            return self.file or next(iter(self.files), None)
        start, end = _shared_beginning(self.files), _shared_beginning([file[::-1] for file in self.files])[::-1]
        shared = f"{start}*{end}"
        own = len(start) + len(end) - len(PurePath(self.files[0]).suffix)
        return shared if own > 0 else f"{self.files[0]} and {len(self.files) - 1} more"

    @property
    def name(self) -> str:
        """Short name: the recording's file name without its ending, or made from the load and the wheels."""
        if self.file is not None:
            return PurePath(self.file).stem + ("" if self.window is None else f"_{self.window[0]:g}s")
        return f"{self.load}_{self.kind.replace(' ', '_')}"

    @property
    def kind(self) -> str:
        """What kind of drop it is, by the wheels that were dropped: ``pitch front``; or just the wheels."""
        kinds = {
            frozenset(("fl", "fr", "rl", "rr")): "bounce",
            frozenset(("fl", "fr")): "pitch front",
            frozenset(("rl", "rr")): "pitch rear",
            frozenset(("fl", "rl")): "roll left",
            frozenset(("fr", "rr")): "roll right",
        }
        return kinds.get(frozenset(self.wheels), " ".join(self.wheels))


def _shared_beginning(texts: Sequence[str]) -> str:
    alike = [len(set(letters)) == 1 for letters in zip(*texts, strict=False)]
    return texts[0][: (*alike, False).index(False)]


class ModelChoice(BaseModel):
    """What the user says about the model; what is left out, sprung decides."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    tracks: Literal["shared", "separate"] | None = None
    """One half-distance per axle, or those of springs and dampers apart."""
    extras: tuple[str, ...] | None = None
    """Exactly these beyond the plain model of seven degrees of freedom."""
    forbid: tuple[str, ...] = ()
    """Never these, whatever else sprung chooses."""


@dataclass(frozen=True, eq=False)
class Campaign:
    """All drops of one vehicle, and what was measured beforehand.

    Attributes
    ----------
    name
        The vehicle's.
    wheelbase
        Front axle to rear axle, m; None where nobody measured it.
    cg_height, wheel_height, roll_axis_height
        Heights above the ground, m, of the sprung mass's centre of gravity, the wheel centres and the roll axis.
    known
        Quantities measured beforehand: parameters, ``total_mass``, ``front_axle_mass``, ``rear_axle_mass``.
    model
        What the user says about the model.
    sensors, loads
        The sensors in the order of every recording's channels; the loads, ``empty`` among them.
    drops, recordings
        One recording for each drop, in the same order.
    faults
        What was wrong with the files.
    path
        Where the campaign file is; None for a campaign made in memory.
    """

    name: str
    sensors: tuple[Sensor, ...]
    drops: tuple[Drop, ...]
    recordings: tuple[Recording, ...]
    loads: tuple[Load, ...] = (EMPTY,)
    wheelbase: Known | None = None
    cg_height: float | None = None
    wheel_height: float | None = None
    roll_axis_height: float | None = None
    known: Mapping[str, Known] = field(default_factory=dict)
    model: ModelChoice = field(default_factory=ModelChoice)
    faults: tuple[Fault, ...] = ()
    path: Path | None = None

    def load(self, name: str) -> Load:
        """Give the load of that name.

        Raises
        ------
        KeyError
            If there is none.
        """
        for load in self.loads:
            if load.name == name:
                return load
        raise KeyError(name)
