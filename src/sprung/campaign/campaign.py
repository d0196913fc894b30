"""A campaign: all drops of one vehicle, empty and loaded, and what was measured beforehand."""

from __future__ import annotations

import datetime as dt
import itertools
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Annotated, Literal

from pydantic import Field, model_validator

from sprung.campaign.beforehand import Given, known_quantities
from sprung.campaign.completeness import Missing
from sprung.campaign.recording import Recording
from sprung.campaign.sources import SourceFile
from sprung.display import shown
from sprung.errors import Fault, InputError, Problems, UnknownNameError
from sprung.uncertainty import KnownValue
from sprung.vehicle import EMPTY, WHEELS, Finite, Heights, Load, Positive, Sensor, Wheel, checked_record

KINDS: Mapping[frozenset[Wheel], str] = {
    frozenset(WHEELS): "bounce",
    frozenset(("fl", "fr")): "pitch front",
    frozenset(("rl", "rr")): "pitch rear",
    frozenset(("fl", "rl")): "roll left",
    frozenset(("fr", "rr")): "roll right",
}
"""The usual drops by the wheels that fall."""


def kind_of(wheels: Sequence[Wheel]) -> str:
    """Give what a drop of some wheels is called: ``pitch front``; or just the wheels.

    Parameters
    ----------
    wheels
        Those that fall.

    Returns
    -------
    str
    """
    return KINDS.get(frozenset(wheels), " ".join(wheels))


@checked_record
class Drop:
    """One release off the blocks, as a campaign file describes it."""

    # Where it is not known yet, the load is empty text and there are no wheels.

    file: str | None = None
    """Recording, relative to the campaign file; a vehicle file, which has no recordings, leaves it out."""
    files: Annotated[tuple[str, ...], Field(max_length=64)] = ()
    """Recordings of this drop, where several loggers recorded it, each on its own clock; instead of `file`."""
    name: Annotated[str, Field(min_length=1)] | None = None
    """What to call it everywhere, unlike every other drop's; its recording's name where it is left out."""
    window: tuple[Finite, Finite] | None = None
    """s on the file's clock, of several files the first one's: the part that holds this drop, where they hold more than one."""
    load: str = "empty"
    """Name of the load on the vehicle."""
    wheels: Annotated[tuple[Wheel, ...], Field(json_schema_extra={"minItems": 1})] = ("fl", "fr", "rl", "rr")
    """Which wheels were dropped; the others stood on the ground."""
    height: Positive | None = None
    """Of the blocks, m."""
    start: Finite | None = None
    """s on the file's clock, of several files the first one's: the decay is used from here, as given."""
    end: Finite | None = None
    """s on the file's clock, of several files the first one's: the decay is used up to here, as given."""

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
        if self.name is not None and (not self.name.isprintable() or {"/", "\\"} & set(self.name)):
            raise ValueError("a drop's name is printable text without / and \\")
        if self.window is not None and self.window[1] <= self.window[0]:
            raise ValueError(f"the window must end after {self.window[0]:g} s, where it begins")
        return self

    @property
    def recordings(self) -> tuple[str, ...]:
        """Files that recorded it."""
        return self.files if self.file is None else (self.file,)

    @property
    def recording(self) -> str | None:
        """What to call its recording: the file, with the beginning of its window, or what its files have in common."""
        shared = self.file or next(iter(self.files), None)
        if len(self.files) > 1:
            own = len(self._shared) - 1 - len(PurePath(self.files[0]).suffix)
            shared = self._shared if own > 0 else f"{self.files[0]} and {len(self.files) - 1} more"
        return shared if shared is None or self.window is None else f"{shared} from {self.window[0]:g} s"

    @property
    def label(self) -> str:
        """Short name: its own, the recording's without its folder and ending, or made from the load and the wheels."""
        if self.name is not None:
            return self.name
        if self.file is not None:
            return PurePath(self.file).stem + self._from
        shared = PurePath(self._shared).stem.replace("*", "").strip("_-. ") if self.files else ""
        return (shared or f"{self.load}_{self.kind.replace(' ', '_')}") + self._from

    @property
    def _shared(self) -> str:
        """What the names of its files have in common, a star for the rest."""
        start, end = _shared_beginning(self.files), _shared_beginning([file[::-1] for file in self.files])[::-1]
        return self.files[0] if len(self.files) < 2 else f"{start}*{end}"

    @property
    def _from(self) -> str:
        return "" if self.window is None else f"_{self.window[0]:g}s"

    @property
    def _long_name(self) -> str:
        """Name that says which folder the first of its files is in."""
        path = PurePath(next(iter(self.recordings), self.label))
        return "_".join([*path.parts[:-1], path.stem]) + self._from

    @property
    def kind(self) -> str:
        """What kind of drop it is, by the wheels that were dropped: ``pitch front``; or just the wheels."""
        return kind_of(self.wheels)


def drop_names(drops: Sequence[Drop]) -> tuple[str, ...]:
    """Give every drop of a campaign a name of its own, as short as that allows.

    Parameters
    ----------
    drops
        All of them.

    Returns
    -------
    tuple of str
        In the same order.
    """
    return _told_apart([(drop.label,) if drop.name else (drop.label, drop._long_name) for drop in drops])


def recording_names(drops: Sequence[Drop]) -> tuple[str, ...]:
    """Say what to call every drop's recording, no two alike: the drop's own name, or what its files have in common.

    Parameters
    ----------
    drops
        All of a campaign.

    Returns
    -------
    tuple of str
        In the same order.
    """
    firsts = [(f"{drop.files[0]} and {len(drop.files) - 1} more",) if drop.files[1:] else () for drop in drops]
    return _told_apart(
        [(drop.name or drop.recording or drop.label, *first) for drop, first in zip(drops, firsts, strict=True)]
    )


def _told_apart(names: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Give each of several things the first of its names that no other has, or else its last one, numbered."""
    often = Counter(name for own in names for name in set(own))
    taken: dict[str, None] = {}
    for own in names:
        name = next((name for name in own if often[name] == 1), own[-1])
        numbered = itertools.chain([name], (f"{name} ({count})" for count in itertools.count(2)))
        taken[next(one for one in numbered if one not in taken)] = None
    return tuple(taken)


def _shared_beginning(texts: Sequence[str]) -> str:
    alike = [len(set(letters)) == 1 for letters in zip(*texts, strict=False)]
    return texts[0][: (*alike, False).index(False)]


@checked_record
class ModelChoice:
    """What the user says about the model; what is left out, sprung decides."""

    tracks: Literal["shared", "separate"] | None = None
    """One half-distance per axle, or those of springs and dampers apart."""
    extras: tuple[str, ...] | None = None
    """Exactly these beyond the plain model of seven degrees of freedom."""
    forbid: tuple[str, ...] = ()
    """Never these, whatever else sprung chooses."""
    fall: bool | None = None
    """Whether drops are used from their release on, and not only from when the last tyre is down."""


@checked_record
class TestRecord:
    """``[test]``: when, where and by whom the vehicle was tested; for the record, no number depends on it."""

    date: dt.date | None = None
    """Day of the test: 2026-11-22, without quotes."""
    operator: Annotated[str, Field(min_length=1)] | None = None
    """Who did the test."""
    place: Annotated[str, Field(min_length=1)] | None = None
    """Where it was done."""
    remarks: Annotated[str, Field(min_length=1)] | None = None
    """Whatever else belongs into the record: tyre pressures, fuel, weather."""


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
    files
        What was read: the campaign file and the recordings, with their checksums.
    missing
        What the campaign file does not say yet, of a campaign that was read although it is not complete.
    unread
        Drops whose recordings could not be read, of a campaign that was read although it is not complete; they are not among
        `drops`.
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
    drops: tuple[Drop, ...]
    recordings: tuple[Recording, ...]
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
    missing: tuple[Missing, ...] = ()
    unread: tuple[Drop, ...] = ()
    identification: str | None = None
    test: TestRecord = field(default_factory=TestRecord)

    def __post_init__(self) -> None:
        problems = Problems()
        several: dict[str, Callable[..., object]] = {"sensors": Sensor, "drops": Drop, "loads": Load}
        single: dict[str, Callable[..., object]] = {"model": ModelChoice, "test": TestRecord}
        for name, kind in several.items():
            object.__setattr__(self, name, tuple(_as_record(one, kind, problems) for one in getattr(self, name)))
        for name, kind in single.items():
            object.__setattr__(self, name, _as_record(getattr(self, name), kind, problems))
        given: dict[str, Given] = dict(self.known)
        if self.wheelbase is not None:
            given["wheelbase"] = self.wheelbase
        known = known_quantities(given, f"campaign {self.name}: known", problems)
        problems.raise_if_any()
        object.__setattr__(self, "wheelbase", known.pop("wheelbase", None))
        object.__setattr__(self, "known", known)

    @property
    def heights(self) -> Heights:
        """How high things are, as far as it was measured."""
        return Heights(self.cg_height, self.wheel_height, self.roll_axis_height)

    def require_complete(self) -> None:
        """Refuse a campaign that does not say everything that an identification needs.

        Raises
        ------
        InputError
            With everything that is missing.
        """
        needed = [one.problem for one in self.missing if one.needed]
        if needed:
            raise InputError(needed)

    def load(self, name: str) -> Load:
        """Give the load of that name.

        Raises
        ------
        UnknownNameError
            If there is none; a `KeyError` that says which one was probably meant.
        """
        for load in self.loads:
            if load.name == name:
                return load
        raise UnknownNameError(name, [load.name for load in self.loads])


def _as_record(given: object, kind: Callable[..., object], problems: Problems) -> object:
    """Return a record that was given by its keys, as a campaign file holds them; others as they are."""
    if isinstance(given, Mapping):
        with problems.collecting():
            return kind(**given)
    return given
