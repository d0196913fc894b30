"""A campaign: all drops of one vehicle, empty and loaded, and what was measured beforehand."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from sprung.campaign.completeness import MissingEntry
from sprung.campaign.drop import Drop, DropTest
from sprung.campaign.known_values import KnownValueLike, parse_known_values, parse_motion_ratios
from sprung.campaign.recording import Recording
from sprung.campaign.source_file import SourceFile
from sprung.display import shown
from sprung.errors import Fault, InputError, Problems, UnknownNameError
from sprung.uncertainty import KnownValue
from sprung.vehicle import EMPTY, LAYOUTS, Heights, Layout, Load, Sensor, VehicleModel, checked_record


@checked_record
class ModelChoice:
    """What the user states of the model; what is left out is selected."""

    tracks: Literal["shared", "separate"] | None = None
    """One half-distance per axle (shared), or separate ones of springs and dampers."""
    extras: tuple[str, ...] | None = None
    """Exactly these model terms beyond the linear model of seven degrees of freedom."""
    forbid: tuple[str, ...] = ()
    """Never these, whatever else is selected."""
    fall: bool | None = None
    """Whether drops are used from their release on, and not only from the last landing on."""


@checked_record
class TestRecord:
    """``[test]``: when, where and by whom the vehicle was tested; for the record, no number depends on it."""

    date: dt.date | None = None
    """Day of the test: 2026-11-22, without quotes."""
    operator: Annotated[str, Field(min_length=1)] | None = None
    """Name of the operator."""
    place: Annotated[str, Field(min_length=1)] | None = None
    """Place of the test."""
    remarks: Annotated[str, Field(min_length=1)] | None = None
    """Other data for the record: tyre pressures, fuel, weather."""


@shown
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
        Quantities measured beforehand: parameters, ``total_mass``, ``front_axle_mass``, ``rear_axle_mass``. Numbers, which are
        exact, and mappings {value, std} become records.
    motion_ratio
        Travel of springs and dampers per travel of their wheels, dimensionless, by the names of `sprung.vehicle.MOTION_RATIOS`;
        numbers and mappings {value, std} become records.
    model
        What the user says about the model.
    sensors, loads
        The sensors in the order of every recording's channels; the loads, ``empty`` among them.
    drops
        What is stated of each drop, and its recording.
    faults
        What was wrong with the files.
    path
        Where the campaign file is; None for a campaign made in memory.
    files
        What was read: the campaign file and the recordings, with their checksums.
    missing
        What the campaign file does not say yet, of a campaign that was read although it is not complete.
    unread
        Drops whose recordings could not be read, of a campaign that was read although it is not complete; they are not among
        `drops`.
    vehicle_model
        Which part of a vehicle is tested.
    identification
        Of the vehicle: chassis, registration or test number; None where nobody gave it.
    test
        When, where and by whom the vehicle was tested, as far as the campaign file says it.

    Raises
    ------
    InputError
        If a known quantity has no such name or cannot have such a value, or the keys of a sensor, load, drop or the model that
        are given as a mapping are wrong; all faults at once.
    """

    name: str
    sensors: tuple[Sensor, ...]
    drops: tuple[DropTest, ...]
    loads: tuple[Load, ...] = (EMPTY,)
    wheelbase: KnownValue | None = None
    cg_height: float | None = None
    wheel_height: float | None = None
    roll_axis_height: float | None = None
    known: Mapping[str, KnownValue] = field(default_factory=dict)
    model: ModelChoice = field(default_factory=ModelChoice)
    faults: tuple[Fault, ...] = ()
    path: Path | None = None
    files: tuple[SourceFile, ...] = ()
    missing: tuple[MissingEntry, ...] = ()
    unread: tuple[Drop, ...] = ()
    vehicle_model: VehicleModel = "full"
    identification: str | None = None
    test: TestRecord = field(default_factory=TestRecord)
    motion_ratio: Mapping[str, KnownValue] = field(default_factory=dict)

    def __post_init__(self) -> None:
        problems = Problems()
        several: dict[str, Callable[..., object]] = {"sensors": Sensor, "drops": DropTest, "loads": Load}
        single: dict[str, Callable[..., object]] = {"model": ModelChoice, "test": TestRecord}
        for name, kind in several.items():
            object.__setattr__(self, name, tuple(_as_record(given, kind, problems) for given in getattr(self, name)))
        for name, kind in single.items():
            object.__setattr__(self, name, _as_record(getattr(self, name), kind, problems))
        stated: dict[str, KnownValueLike] = dict(self.known)
        if self.wheelbase is not None:
            stated["wheelbase"] = self.wheelbase
        known = parse_known_values(stated, f"campaign {self.name}: known", problems)
        ratios = parse_motion_ratios(self.motion_ratio, f"campaign {self.name}: motion_ratio", problems)
        for drop in self.drops:
            if not isinstance(drop, DropTest):
                do = "Give Drop(...).with_recording(recording), or DropTest(..., recording=recording)."
                problems.add(
                    f"campaign {self.name}: drop {drop.label}", "no recording", "a drop with its recording", do
                )
        problems.raise_if_any()
        object.__setattr__(self, "drops", tuple(drop.on_wheels_of(self.layout) for drop in self.drops))
        object.__setattr__(self, "wheelbase", known.pop("wheelbase", None))
        object.__setattr__(self, "known", known)
        object.__setattr__(self, "motion_ratio", ratios)

    @property
    def layout(self) -> Layout:
        """Coordinates and wheel stations of the vehicle."""
        return LAYOUTS[self.vehicle_model]

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """Recordings of the drops, in their order."""
        return tuple(drop.recording for drop in self.drops)

    def with_recordings(self, recordings: Iterable[Recording]) -> Campaign:
        """Return the campaign with other recordings of its drops.

        Parameters
        ----------
        recordings
            One for each drop, in the same order.

        Returns
        -------
        Campaign

        Raises
        ------
        ValueError
            If there are more or fewer of them than drops.
        """
        pairs = zip(self.drops, recordings, strict=True)
        return replace(self, drops=tuple(replace(drop, recording=recording) for drop, recording in pairs))

    @property
    def heights(self) -> Heights:
        """How high things are, as far as it was measured."""
        return Heights(self.cg_height, self.wheel_height, self.roll_axis_height)

    def require_complete(self) -> None:
        """Check that a campaign states everything that an identification needs.

        Raises
        ------
        InputError
            With everything that is missing.
        """
        needed = [entry.problem for entry in self.missing if entry.needed]
        if needed:
            raise InputError(needed)

    def load(self, name: str) -> Load:
        """Return the load of that name.

        Raises
        ------
        UnknownNameError
            If there is none; a `KeyError` with the most similar name.
        """
        for load in self.loads:
            if load.name == name:
                return load
        raise UnknownNameError(name, [load.name for load in self.loads])

    @property
    def with_used_loads(self) -> Campaign:
        """The same without loads that no drop has, where there are drops: recordings tell nothing of them."""
        used = {EMPTY.name, *(drop.load for drop in self.drops)}
        return replace(self, loads=tuple(load for load in self.loads if load.name in used)) if self.drops else self


def _as_record(given: object, kind: Callable[..., object], problems: Problems) -> object:
    """Return a record that was given by its keys, as a campaign file holds them; others as they are."""
    if isinstance(given, Mapping):
        with problems.collect():
            return kind(**given)
    return given
