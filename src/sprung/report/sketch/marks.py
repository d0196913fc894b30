"""Marks of sensors and loads on a drawing, and the labels that belong to them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sprung.report.sketch.labels import Label
from sprung.report.sketch.proportions import Proportions
from sprung.report.sketch.shapes import Disc, Kind, Point, Shape, Stroke
from sprung.vehicle import STATIONS, Wheel

_MARK = 3.6
"""Half-size of the mark of a sensor or a load, units."""

_COINCIDENT = 7.0
"""Distance of marks, units, below which they share one label."""

_STATIONS = tuple(STATIONS)
"""Names of all wheel stations."""

_LONGEST = 26
"""Letters of a name that are shown at most."""


@dataclass(frozen=True)
class Frame:
    """Transformation from lengths to positions on a drawing.

    Attributes
    ----------
    scale
        Units per m.
    origin
        Position of the centre of the front axle, on the ground or on the centreline, units.
    """

    scale: float
    origin: Point

    def at(self, x: float, up: float) -> Point:
        """Return the position of a point: x to the right, y or z upwards."""
        return self.origin[0] + self.scale * x, self.origin[1] - self.scale * up


@dataclass(frozen=True)
class Mark:
    """Mark of a sensor or of an item of a load.

    Attributes
    ----------
    at
        Its position, units.
    text
        Its label.
    kind
        ``sensor`` or ``load``.
    on_body
        Whether it is on the body, and not on a wheel.
    channel
        Of a sensor; empty for a load.
    """

    at: Point
    text: str
    kind: Kind
    on_body: bool = True
    channel: str = ""


Marks: TypeAlias = Callable[[Frame], list[Mark]]
"""Returns the marks for the frame of a drawing."""


def mark_placer(
    drawn: Proportions,
    project: Callable[[tuple[float, float, float]], tuple[float, float]],
    wheel: Callable[[Wheel], tuple[float, float]],
) -> Marks:
    """Return a function that marks the sensors and loads with known positions.

    Parameters
    ----------
    drawn
        The vehicle as it is drawn.
    project
        From x, y and z of a point on the body to its two coordinates on the drawing, m.
    wheel
        From a wheel station to its two coordinates on the drawing, m.
    """
    stations: list[str | None] = ["body", *_STATIONS, None]

    def marks(frame: Frame) -> list[Mark]:
        placed = []
        for sensor in sorted(drawn.geometry.sensors, key=lambda sensor: stations.index(sensor.on)):
            name, channel = shortened(sensor.channel), sensor.channel
            if sensor.position is not None:
                placed.append(Mark(frame.at(*project(sensor.position)), name, "sensor", channel=channel))
            elif sensor.wheel is not None:
                placed.append(Mark(frame.at(*wheel(sensor.wheel)), name, "sensor", False, channel))
        for load in drawn.geometry.loads:
            for item in load.items:
                text = shortened(f"{load.name} {item.mass:.4g} kg")
                if item.position is not None:
                    placed.append(Mark(frame.at(*project(item.position)), text, "load"))
                elif item.on in _STATIONS:
                    placed.append(Mark(frame.at(*wheel(item.on)), text, "load", False))
        return placed

    return marks


def grouped_labels(marks: Sequence[Mark]) -> Iterator[Label]:
    """Yield the labels of marks; coincident marks of one kind share one.

    Parameters
    ----------
    marks
        On one drawing.
    """
    groups: list[list[Mark]] = []
    for mark in marks:
        for group in groups:
            apart = max(abs(mark.at[0] - group[0].at[0]), abs(mark.at[1] - group[0].at[1]))
            if group[0].kind == mark.kind and apart < _COINCIDENT:
                group.append(mark)
                break
        else:
            groups.append([mark])
    for group in groups:
        yield Label(group[0].at, tuple(dict.fromkeys(mark.text for mark in group)), group[0].kind)


def shortened(name: str) -> str:
    """Return a name, shortened for a label.

    Parameters
    ----------
    name
        Any.
    """
    printable = "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in name)
    return printable if len(printable) <= _LONGEST else f"{printable[: _LONGEST - 1]}…"


def mark_shapes(mark: Mark) -> Iterator[Shape]:
    """Draw a mark.

    Parameters
    ----------
    mark
        Any.
    """
    (x, y), r = mark.at, _MARK
    if mark.kind == "sensor":
        yield Disc(mark.at, r, "sensor", filled=mark.on_body, about=mark.channel)
        return
    yield Stroke(((x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)), mark.kind, closed=True)
    yield Stroke(((x - r, y - r), (x + r, y + r)), mark.kind)
    yield Stroke(((x - r, y + r), (x + r, y - r)), mark.kind)
