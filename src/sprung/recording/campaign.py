"""A campaign: all drops of one vehicle, empty and loaded, and what was measured beforehand."""

from __future__ import annotations

from collections.abc import Mapping
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

    model_config = ConfigDict(frozen=True, extra="forbid")

    file: str | None = None
    """Recording, relative to the campaign file; a vehicle file, which has no recordings, leaves it out."""
    load: str = "empty"
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
        return self

    @property
    def name(self) -> str:
        """Short name: the recording's file name without its ending, or made from the load and the wheels."""
        if self.file is not None:
            return PurePath(self.file).stem
        kinds = {
            frozenset(("fl", "fr", "rl", "rr")): "bounce",
            frozenset(("fl", "fr")): "pitch_front",
            frozenset(("rl", "rr")): "pitch_rear",
            frozenset(("fl", "rl")): "roll_left",
            frozenset(("fr", "rr")): "roll_right",
        }
        return f"{self.load}_{kinds.get(frozenset(self.wheels), '_'.join(self.wheels))}"


class ModelChoice(BaseModel):
    """What the user says about the model; what is left out, sprung decides."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    tracks: Literal["shared", "separate"] | None = None
    extras: tuple[str, ...] | None = None
    forbid: tuple[str, ...] = ()


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
