"""Technical drawings as data: strokes, discs and text, in units of the frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Point: TypeAlias = tuple[float, float]
"""To the right and down from the upper left corner, units."""

Kind = Literal["outline", "wheel", "dimension", "axis", "sensor", "load", "gravity", "leader", "write"]
"""Meaning of a shape, which determines its colour."""

Anchor = Literal["start", "middle", "end"]
"""Part of a text that is at its position."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """A line through points.

    Attributes
    ----------
    points
        Two or more.
    kind
        Its meaning.
    dashed
        Whether it shows an unknown position or length.
    closed
        Whether it returns to its first point.
    arrows
        Ends with arrowheads.
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
        Its meaning.
    dashed
        Whether it shows an unknown position or length.
    filled
        Whether it is filled with its colour.
    about
        Channel of the sensor that it marks; empty for anything else.
    """

    centre: Point
    radius: float
    kind: Kind
    dashed: bool = False
    filled: bool = False
    about: str = ""


@dataclass(frozen=True, slots=True)
class TextShape:
    """One line of text.

    Attributes
    ----------
    text
        Any.
    at
        Beginning, middle or end of its baseline.
    kind
        Its meaning.
    anchor
        Part of the text that is at that position.
    symbol
        Whether it is a symbol with an index after an underscore, such as ``t_f``.
    """

    text: str
    at: Point
    kind: Kind
    anchor: Anchor = "start"
    symbol: bool = False


Shape: TypeAlias = Stroke | Disc | TextShape
"""Any shape of a drawing."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """A technical drawing.

    Attributes
    ----------
    title
        Above it.
    description
        Content in a sentence, for screen readers.
    width, height
        Of its frame, units.
    shapes
        Drawn in this order.
    scale
        Units per m; 0 for a drawing without a scale.
    origin
        Position of the centre of the front axle, on the ground or on the centreline.
    """

    title: str
    description: str
    width: float
    height: float
    shapes: tuple[Shape, ...]
    scale: float = 0.0
    origin: Point = (0.0, 0.0)
