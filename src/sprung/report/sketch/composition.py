"""Composition of a drawing: vehicle, sensors and loads, then labels where there is room for them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple, TypeAlias

from sprung.report.sketch.labels import LINE, Box, Label, PlacedLabel, place_labels, text_box
from sprung.report.sketch.marks import Frame, Mark, Marks, grouped_labels, mark_shapes
from sprung.report.sketch.shapes import Disc, Drawing, Point, Shape, Stroke, TextShape

WIDTH = 360.0
"""Width of a drawing, units: small enough for a telephone, and for two beside each other on a wide screen."""

_LABELS, _BELOW = 22.0, 56.0
"""Margins above the vehicle for labels, and below it for dimensions, units."""

_MORE, _TRIES = 4 * LINE, 6
"""Increment of the upper margin while labels cannot be placed, units, and largest number of increments."""


_FREE, _SIDES = frozenset(("dimension", "wheel", "outline")), 16
"""Kinds of lines that labels leave free, and number of lines that stand for a circle."""


Shapes: TypeAlias = Callable[[float], tuple[Frame, list[Shape], list[Label], float]]
"""Draws everything but sensors and loads below an upper margin; returns frame, shapes, further labels and lower end."""


class _Attempt(NamedTuple):
    """A drawing with a certain upper margin."""

    frame: Frame
    parts: list[Shape]
    marks: list[Mark]
    labels: list[Label]
    placed: tuple[PlacedLabel | None, ...]
    height: float

    @property
    def unplaced(self) -> int:
        """Number of labels that could not be placed."""
        return self.placed.count(None)


def _attempt(drawn: tuple[Frame, list[Shape], list[Label], float], marks: Marks) -> _Attempt:
    frame, parts, labels, bottom = drawn
    marked = marks(frame)
    wanted = [*grouped_labels(marked), *labels]
    taken = [_box(part) for part in parts if isinstance(part, TextShape)]
    height = bottom + _BELOW
    lines = [line for part in parts for line in _lines(part)]
    free = Box(2.0, 2.0, WIDTH - 2.0, height - 2.0)
    # A label on an outline is better than none.
    placed = min((place_labels(wanted, taken, free, kept) for kept in (lines, ())), key=lambda found: found.count(None))
    return _Attempt(frame, parts, marked, wanted, placed, height)


def compose(title: str, description: str, shapes: Shapes, marks: Marks) -> Drawing:
    """Return a drawing with sensors, loads and labels, with enough margin above for every label.

    Parameters
    ----------
    title, description
        Of the drawing.
    shapes
        Draws everything but sensors and loads.
    marks
        Places sensors and loads.
    """
    best: _Attempt | None = None
    for step in range(_TRIES):
        attempt = _attempt(shapes(_LABELS + step * _MORE), marks)
        if best is None or attempt.unplaced < best.unplaced:
            best = attempt
        if not best.unplaced:
            break
    assert best is not None  # noqa: S101 (the first attempt; for the type checker)
    frame, parts, marked, wanted, placed, height = best
    for label, position in zip(wanted, placed, strict=True):
        if position is None:  # too crowded for a leader line: listed below the drawing
            parts += [
                TextShape(line, (4.0, height + LINE * (i + 1) - 4.0), label.kind) for i, line in enumerate(label.lines)
            ]
            height += LINE * len(label.lines)
            continue
        if position.leader is not None:
            parts.append(Stroke((label.at, position.leader), "leader"))
        parts += [
            TextShape(line, (position.box.left, position.box.top + LINE * (i + 1) - 3.2), label.kind)
            for i, line in enumerate(label.lines)
        ]
    for mark in marked:
        parts += mark_shapes(mark)
    return Drawing(title, description, WIDTH, height, tuple(parts), frame.scale, frame.origin)


def _lines(part: Shape) -> Iterator[tuple[Point, Point]]:
    """Yield the lines of a dimension, of a wheel or of the outline, which labels leave free where there is room."""
    if isinstance(part, Stroke) and part.kind in _FREE:
        yield from pairwise((*part.points, part.points[0]) if part.closed else part.points)
    if isinstance(part, Disc) and part.kind in _FREE:
        angles = [math.tau * i / _SIDES for i in range(_SIDES + 1)]
        (x, y), r = part.centre, part.radius
        yield from pairwise((x + r * math.cos(angle), y + r * math.sin(angle)) for angle in angles)


def _box(text: TextShape) -> Box:
    return text_box(text.text, text.at, text.anchor)
