"""Known loads: the elements that they add to the mass matrix."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from sprung.errors import InputError, Problem
from sprung.uncertainty import KnownValue
from sprung.vehicle import kinematics
from sprung.vehicle.checked_record import checked_record
from sprung.vehicle.elements import Element
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.layout import FULL, STATIONS, Layout, Wheel
from sprung.vehicle.nuisances import LOAD_MASS

_NOTHING = 1e-3
"""kg in practice none: a coordinate needs some mass."""

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
"""A positive number in a campaign file."""

NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
"""A number in a campaign file that is not negative."""

Finite = Annotated[float, Field(allow_inf_nan=False)]
"""A number in a campaign file: neither infinite nor NaN."""


def _split_mass(given: Any) -> Any:
    """Split a mass that is written as { value = ..., std = ... } into value and standard uncertainty."""
    keys = getattr(given, "kwargs", given)
    if not isinstance(keys, Mapping):
        return given
    # From here on the values are Python's, and strict validation accepts no list as a tuple.
    plain = {name: tuple(value) if isinstance(value, list) else value for name, value in keys.items()}
    mass = plain.get("mass")
    if isinstance(mass, Mapping) and {"value"} <= mass.keys() <= {"value", "std"}:
        std = mass.get("std", 0.0)
        if isinstance(std, bool) or not isinstance(std, int | float) or not 0 <= std < float("inf"):
            raise ValueError("the std of a mass must be a number, 0 or more, in kg")
        plain |= {"mass": mass["value"], "mass_std": float(std)}
    return plain


@checked_record
class Item:
    """One item of a load: a mass at a place."""

    mass: Positive
    """kg; in a campaign file also { value = ..., std = ... }."""
    mass_std: NotNegative = 0.0
    """Standard uncertainty of the mass, kg; 0 means exact."""
    position: tuple[Finite, Finite, Finite] | None = None
    """x forward of the front axle, y left of the centreline, z above the ground, m; for items on the body."""
    inertia: tuple[NotNegative, NotNegative] = (0.0, 0.0)
    """Its own [I_xx, I_yy] about its centre, kg m²."""
    on: Wheel | Literal["floor", "seat"] | None = None
    """Wheel station, for items on a wheel; for items on the body ``floor``, which is meant where nothing is said, or ``seat``:
    the item then moves on a cushion, with a frequency and a damping that the drops have to tell."""

    @model_validator(mode="before")
    @classmethod
    def _measured(cls, given: Any) -> Any:
        return _split_mass(given)

    @model_validator(mode="after")
    def _somewhere(self) -> Item:
        if self.position is None and self.on is None:
            raise ValueError('an item needs its position = [x, y, z] on the body, or the wheel it sits on (on = "fl")')
        if self.position is None and self.on not in STATIONS:
            raise ValueError(f'an item with on = "{self.on}" needs its position = [x, y, z] too')
        if self.position is not None and self.on in STATIONS:
            raise ValueError(
                f'an item with on = "{self.on}" sits on that wheel and has no position: leave one of them out'
            )
        return self

    @property
    def is_soft(self) -> bool:
        """Whether it lies on a seat."""
        return self.on == "seat"

    def elements(
        self,
        heights: Heights,
        mass: str | float | None = None,
        seat: int | None = None,
        names: Collection[str] = (),
        wheelbase: float = 0.0,
    ) -> Iterator[Element]:
        """Yield the elements of the item.

        Parameters
        ----------
        heights
            Of the empty vehicle; without them the item is level with the centre of gravity.
        mass
            Name of the parameter that is its mass, or kg; its own mass unless given.
        seat
            Number of the seat on which it moves; as if on the floor unless given.
        names, wheelbase
            Parameters of the vehicle, and its wheelbase, m, where its body twists unevenly.
        """
        mass = self.mass if mass is None else mass
        if self.position is None:
            yield from (Element("mass", mass, kinematics.wheel(wheel)) for wheel in STATIONS if wheel == self.on)
        else:
            x, y, z = self.position
            floor = kinematics.body_point(x, y, names, wheelbase)
            if seat is None:
                yield Element("mass", mass, floor)
            else:
                yield Element("mass", mass, kinematics.on_seat(seat))
                yield from _cushion(self.mass, floor - kinematics.on_seat(seat))
            # How far its own inertia follows a floor that bends or twists under it, nobody knows: it turns with the body.
            arms, rows = heights.item_arms(z), (kinematics.roll(), kinematics.pitch())
            for row, own, arm in zip(rows, self.inertia, arms, strict=True):
                yield Element("mass", own, row)
                if not heights.is_free:
                    yield Element("mass", mass, row, arm**2)
                if heights.has_effect:
                    yield Element("spring", mass, row, -heights.gravity_stiffness(z))
            if heights.is_free:
                yield Element("mass", mass, kinematics.forward(y, arms[1]))
                yield Element("mass", mass, kinematics.sideways(x, arms[0]))


def _cushion(mass: float, travel: kinematics.Row) -> Iterator[Element]:
    """Yield the elements of a cushion under a mass, kg, by its travel."""
    yield Element("spring", "w_l", travel, mass)
    yield Element("damper", "c_l", travel, mass)


def _empty_seat(seat: int) -> Iterator[Element]:
    """Yield what holds the coordinate of a seat on which nothing lies: it weighs nothing, and moves by itself."""
    yield Element("mass", _NOTHING, kinematics.on_seat(seat))
    yield from _cushion(_NOTHING, kinematics.on_seat(seat))


@checked_record
class Added:
    """A load of which only totals are known, taken as centred on the body's centre of gravity (the paper's bus)."""

    mass: NotNegative
    """kg, on the body; in a campaign file also { value = ..., std = ... }."""
    mass_std: NotNegative = 0.0
    """Standard uncertainty of the mass, kg; 0 means exact."""
    I_yy: NotNegative = 0.0
    """kg m², pitch."""
    I_xx: NotNegative = 0.0
    """kg m², roll."""
    m_uf: NotNegative = 0.0
    """kg on each front wheel: the paper's simulation adds about 10 % to every mass (its lost eq. (20))."""
    m_ur: NotNegative = 0.0
    """kg on each rear wheel."""
    m_u: NotNegative = 0.0
    """kg on each wheel of a vehicle with one axle."""

    @model_validator(mode="before")
    @classmethod
    def _measured(cls, given: Any) -> Any:
        return _split_mass(given)

    @model_validator(mode="after")
    def _some_mass(self) -> Added:
        if self.mass_std > 0 and self.mass == 0:
            raise ValueError("a mass of 0 kg has no uncertainty; give the load's mass")
        return self

    def elements(self, mass: str | float | None = None) -> Iterator[Element]:
        """Yield the elements of the load.

        Parameters
        ----------
        mass
            Name of the parameter that is its mass on the body, or kg; its own unless given.
        """
        yield Element("mass", self.mass if mass is None else mass, kinematics.bounce())
        yield Element("mass", self.I_yy, kinematics.pitch())
        yield Element("mass", self.I_xx, kinematics.roll())
        at_wheel = {"f": self.m_uf, "r": self.m_ur, "": self.m_u}
        for wheel, station in STATIONS.items():
            yield Element("mass", at_wheel[station.axle], kinematics.wheel(wheel))


@checked_record
class Load:
    """A known load: a list of items, or totals. The load named ``empty`` has neither and always exists."""

    name: Annotated[str, Field(min_length=1)]
    """Name by which drops refer to it."""
    items: tuple[Item, ...] = ()
    """Its items, each a mass at a position."""
    added: Added | None = None
    """Its totals, if only these are known."""

    @model_validator(mode="after")
    def _one_description(self) -> Load:
        if sum(item.is_soft for item in self.items) > len(kinematics.SEAT_LOADS):
            raise ValueError(f"at most {len(kinematics.SEAT_LOADS)} items of a load may lie on seats")
        if self.items and self.added is not None:
            raise ValueError("give either items or added totals, not both")
        if self.name == "empty" and (self.items or self.added is not None):
            raise ValueError("the load named 'empty' is the vehicle as it is; give this load another name")
        return self

    @property
    def is_described(self) -> bool:
        """Whether its masses are known; its drops identify nothing without them."""
        return self.name == "empty" or bool(self.items) or self.added is not None

    @property
    def is_soft(self) -> bool:
        """Whether an item lies on a seat."""
        return any(item.is_soft for item in self.items)

    def total_mass(self, layout: Layout = FULL) -> float:
        """Return the mass on a vehicle of a layout, kg."""
        if self.added is None:
            return sum(item.mass for item in self.items)
        at_wheel = {"f": self.added.m_uf, "r": self.added.m_ur, "": self.added.m_u}
        return self.added.mass + sum(at_wheel[STATIONS[wheel].axle] for wheel in layout.wheels)

    def mass_at_wheels(self, wheelbase: float, layout: Layout = FULL) -> dict[str, float]:
        """Return what each wheel of an axle carries of what is on the body, kg; totals are shared equally.

        Parameters
        ----------
        wheelbase
            m.
        layout
            Of the vehicle.

        Returns
        -------
        dict
            By the index of the axle.
        """
        placed = [(item.mass, item.position[0]) for item in self.items if item.position is not None]
        body = sum(mass for mass, _ in placed) if self.added is None else self.added.mass
        if len(layout.axles) == 1 or self.added is not None:
            return dict.fromkeys(layout.axles, body / len(layout.wheels))
        rear = sum(-mass * x / wheelbase for mass, x in placed)
        return {"f": (body - rear) / len(layout.wheels_of("f")), "r": rear / len(layout.wheels_of("r"))}

    @property
    def uncertain_masses(self) -> dict[str, KnownValue]:
        """Masses that are known with an uncertainty, kg, by the names under which they are parameters of a fit."""
        if self.added is not None:
            parts: dict[str, Item | Added] = {f"{LOAD_MASS}{self.name}": self.added}
        else:
            several = len(self.items) > 1
            parts = {self._name_of(i, several): item for i, item in enumerate(self.items)}
        return {name: KnownValue(part.mass, part.mass_std) for name, part in parts.items() if part.mass_std > 0}

    def _name_of(self, item: int, several: bool) -> str:
        return f"{LOAD_MASS}{self.name}, item {item + 1}" if several else f"{LOAD_MASS}{self.name}"

    def elements(
        self, heights: Heights = LEVEL, unknown: Collection[str] = (), wheelbase: float = 0.0
    ) -> tuple[Element, ...]:
        """Return the elements of the load; ΔM is the sum of the masses, full where the items are off centre.

        Parameters
        ----------
        heights
            Of the empty vehicle; without them every item is level with the centre of gravity. With them a load reduces the
            stiffness of roll and pitch by its height above the lateral support.
        unknown
            Names of parameters; masses of `uncertain_masses` among them are parameters instead of numbers, and items on seats
            move by themselves if w_l is among them.
        wheelbase
            Of a body that twists unevenly, with u_w among the names, m.

        Raises
        ------
        InputError
            If its masses are not known.
        """
        if not self.is_described:
            expected, do = "items = [...] or added = {...}", "State the items of the load, or its totals."
            raise InputError([Problem(f"load '{self.name}'", "neither items nor added", expected, do)])
        soft = [i for i, item in enumerate(self.items) if item.is_soft]
        seats = dict(zip(soft, range(len(soft)), strict=True)) if "w_l" in unknown else {}
        elements = [
            element
            for seat in range(len(seats), len(kinematics.SEAT_LOADS) if "w_l" in unknown else 0)
            for element in _empty_seat(seat)
        ]
        if self.added is not None:
            name = self._name_of(0, several=False)
            return (*elements, *self.added.elements(name if name in unknown else None))
        for i, item in enumerate(self.items):
            name = self._name_of(i, len(self.items) > 1)
            elements += item.elements(heights, name if name in unknown else None, seats.get(i), unknown, wheelbase)
        return tuple(elements)


EMPTY = Load(name="empty")
"""The vehicle as it is."""
