"""What a technical drawing consists of: strokes, discs and words, in units of its frame, apart from how they are drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Point: TypeAlias = tuple[float, float]
"""To the right and down from the upper left corner, units."""

Kind = Literal["outline", "wheel", "dimension", "axis", "sensor", "load", "gravity", "leader", "write"]
"""What a shape stands for; its colour follows."""


Anchor = Literal["start", "middle", "end"]
"""Which part of a text is at its point."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """A line through points.

    Attributes
    ----------
    points
        At least two.
    kind
        What it stands for.
    dashed
        Whether it shows something that is not known.
    closed
        Whether it returns to its first point.
    arrows
        At which ends it has arrowheads.
    """

    points: tuple[Point, ...]
    kind: Kind
    dashed: bool = False
    closed: bool = False
    arrows: Literal["", "end", "both"] = ""


@dataclass(frozen=True, slots=True)
class Disc:
    """A circle.

    Attributes
    ----------
    centre
        Its centre.
    radius
        Units.
    kind
        What it stands for.
    dashed
        Whether it shows something that is not known.
    filled
        Whether it is filled with its colour.
    """

    centre: Point
    radius: float
    kind: Kind
    dashed: bool = False
    filled: bool = False


@dataclass(frozen=True, slots=True)
class Words:
    """One line of text.

    Attributes
    ----------
    text
        The text.
    at
        Where its baseline begins, is centred or ends.
    kind
        What it belongs to.
    anchor
        Which part of the text is at that point.
    symbol
        Whether it is a symbol with an index after an underscore, such as ``t_f``.
    """

    text: str
    at: Point
    kind: Kind
    anchor: Anchor = "start"
    symbol: bool = False


Shape: TypeAlias = Stroke | Disc | Words
"""Anything in a drawing."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """A technical drawing.

    Attributes
    ----------
    title
        What it shows.
    described
        The same in a sentence, for readers who cannot see it.
    width, height
        Of its frame, units.
    shapes
        The hindmost first.
    """

    title: str
    described: str
    width: float
    height: float
    shapes: tuple[Shape, ...]
