"""Composition of a drawing: what is drawn of the vehicle, then sensors and loads, then labels where there is room for them."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple, TypeAlias

from sprung.report.sketch.labels import LINE, Box, Label, Placed, place_labels, text_box
from sprung.report.sketch.marks import Frame, Mark, Marks, grouped_labels, mark_shapes
from sprung.report.sketch.shapes import Drawing, Shape, Stroke, Words

WIDTH = 360.0
"""Units across a drawing: its words can be read on a telephone, and two stand beside each other on a desk."""

_LABELS, _BELOW = 22.0, 56.0
"""Margins above the vehicle for labels, and below it for dimensions, units."""

_MORE, _TRIES = 4 * LINE, 6
"""By how much the upper margin grows while labels have no place, and how often."""


Shapes: TypeAlias = Callable[[float], tuple[Frame, list[Shape], list[Label], float]]
"""Draws everything but sensors and loads below an upper margin: with its frame, further labels, and where it ends."""


class _Attempt(NamedTuple):
    """A drawing with one upper margin."""

    parts: list[Shape]
    marks: list[Mark]
    labels: list[Label]
    placed: tuple[Placed | None, ...]
    height: float

    @property
    def missed(self) -> int:
        """Labels without a place."""
        return self.placed.count(None)


def _attempt(drawn: tuple[Frame, list[Shape], list[Label], float], marks: Marks) -> _Attempt:
    frame, parts, labels, bottom = drawn
    marked = marks(frame)
    wanted = [*grouped_labels(marked), *labels]
    taken = [_box(part) for part in parts if isinstance(part, Words)]
    height = bottom + _BELOW
    dimensions = [part for part in parts if isinstance(part, Stroke) and part.kind == "dimension"]
    lines = [line for part in dimensions for line in pairwise(part.points)]
    placed = place_labels(wanted, taken, Box(2.0, 2.0, WIDTH - 2.0, height - 2.0), lines)
    return _Attempt(parts, marked, wanted, placed, height)


def compose(title: str, described: str, shapes: Shapes, marks: Marks) -> Drawing:
    """Add sensors, loads and labels, with so much margin above that every label has its place.

    Parameters
    ----------
    title, described
        Of the drawing.
    shapes
        Draws everything but sensors and loads.
    marks
        Places sensors and loads.
    """
    best: _Attempt | None = None
    for step in range(_TRIES):
        attempt = _attempt(shapes(_LABELS + step * _MORE), marks)
        if best is None or attempt.missed < best.missed:
            best = attempt
        if not best.missed:
            break
    assert best is not None  # noqa: S101 (the first attempt; for the type checker)
    parts, marked, wanted, placed, height = best
    for label, one in zip(wanted, placed, strict=True):
        if one is None:  # so crowded that no line leads to it: below the drawing it is named at least
            parts += [
                Words(line, (4.0, height + LINE * (i + 1) - 4.0), label.kind) for i, line in enumerate(label.lines)
            ]
            height += LINE * len(label.lines)
            continue
        if one.leader is not None:
            parts.append(Stroke((one.label.at, one.leader), "leader"))
        parts += [
            Words(line, (one.box.left, one.box.top + LINE * (i + 1) - 3.2), one.label.kind)
            for i, line in enumerate(one.label.lines)
        ]
    for mark in marked:
        parts += mark_shapes(mark)
    return Drawing(title, described, WIDTH, height, tuple(parts))


def _box(words: Words) -> Box:
    return text_box(words.text, words.at, words.anchor)
