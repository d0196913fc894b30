"""Known loads: what they add to the mass matrix, as elements like any other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field, model_validator

from sprung.errors import InputError, Problem
from sprung.vehicle import rows
from sprung.vehicle.elements import Element
from sprung.vehicle.heights import LEVEL, Heights
from sprung.vehicle.record import record
from sprung.vehicle.rows import Wheel

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
"""One above 0."""

NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
"""One that is not below 0."""

Finite = Annotated[float, Field(allow_inf_nan=False)]
"""A number in a campaign file: neither infinite nor NaN."""


@record
class Item:
    """One piece of a load: a mass at a place."""

    mass: Positive
    """kg."""
    position: tuple[Finite, Finite, Finite] | None = None
    """x forward of the front axle, y left of the centreline, z above the ground, m; for items on the body."""
    inertia: tuple[NotNegative, NotNegative] = (0.0, 0.0)
    """Its own [I_xx, I_yy] about its centre, kg m²."""
    on: Wheel | None = None
    """The wheel it sits on, for items not on the body."""

    @model_validator(mode="after")
    def _somewhere(self) -> Item:
        if (self.position is None) == (self.on is None):
            raise ValueError('an item needs either a position on the body or the wheel it sits on (on = "fl")')
        return self

    def elements(self, heights: Heights) -> Iterator[Element]:
        """Give what the item adds to the vehicle.

        Parameters
        ----------
        heights
            Of the empty vehicle; without them the item counts as level with the centre of gravity.
        """
        if self.on is not None:
            yield Element("mass", self.mass, rows.wheel(self.on))
        elif self.position is not None:
            x, y, z = self.position
            yield Element("mass", self.mass, rows.body_point(x, y))
            for row, own, arm in zip((rows.roll(), rows.pitch()), self.inertia, heights.item_arms(z), strict=True):
                yield Element("mass", own + self.mass * arm**2, row)
                if heights.known:
                    yield Element("spring", -self.mass * heights.tipping(z), row)


@record
class Added:
    """A load of which only totals are known, taken as centred on the body's centre of gravity (the paper's bus)."""

    mass: NotNegative
    """kg, on the body."""
    I_yy: NotNegative = 0.0
    """kg m², pitch."""
    I_xx: NotNegative = 0.0
    """kg m², roll."""
    m_uf: NotNegative = 0.0
    """kg on each front wheel: the paper's simulation adds about 10 % to every mass (its lost eq. (20))."""
    m_ur: NotNegative = 0.0
    """kg on each rear wheel."""

    def elements(self) -> Iterator[Element]:
        """Give what the load adds to the vehicle."""
        yield Element("mass", self.mass, rows.bounce())
        yield Element("mass", self.I_yy, rows.pitch())
        yield Element("mass", self.I_xx, rows.roll())
        yield Element("mass", self.m_uf, rows.wheel("fl"))
        yield Element("mass", self.m_uf, rows.wheel("fr"))
        yield Element("mass", self.m_ur, rows.wheel("rl"))
        yield Element("mass", self.m_ur, rows.wheel("rr"))


@record
class Load:
    """A known load: a list of items, or totals. The load named ``empty`` has neither and always exists."""

    name: Annotated[str, Field(min_length=1)]
    """What the drops call it."""
    items: tuple[Item, ...] = ()
    """Its pieces, each a mass at a place."""
    added: Added | None = None
    """What it adds in all, where only totals are known."""

    @model_validator(mode="after")
    def _one_description(self) -> Load:
        if self.items and self.added is not None:
            raise ValueError("give either items or added totals, not both")
        if self.name == "empty" and (self.items or self.added is not None):
            raise ValueError("the load named 'empty' is the vehicle as it is; give this load another name")
        return self

    @property
    def described(self) -> bool:
        """Whether it is known what the load adds; without that nothing can be identified from its drops."""
        return self.name == "empty" or bool(self.items) or self.added is not None

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        if self.added is not None:
            return self.added.mass + 2 * (self.added.m_uf + self.added.m_ur)
        return sum(item.mass for item in self.items)

    def elements(self, heights: Heights = LEVEL) -> tuple[Element, ...]:
        """Give the elements that the load adds; ΔM is the sum of the masses, full where the items are off centre.

        Parameters
        ----------
        heights
            Of the empty vehicle; without them every item counts as level with the centre of gravity. Where they tell what
            carries the body, a load tips it the more the higher it stands.

        Raises
        ------
        InputError
            If it is not known what the load adds.
        """
        if not self.described:
            expected, do = "items = [...] or added = {...}", "Write what the load consists of."
            raise InputError([Problem(f"load '{self.name}'", "neither items nor added", expected, do)])
        if self.added is not None:
            return tuple(self.added.elements())
        return tuple(element for item in self.items for element in item.elements(heights))


EMPTY = Load(name="empty")
"""The vehicle as it is."""
