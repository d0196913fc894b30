"""Placement of labels near their points, without overlapping another label, a point or a leader line.

Dimension lines and outlines are kept free too where that is possible close to the point.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, takewhile

from sprung.report.sketch.shapes import Kind, Point

LETTER = 6.0
"""Width of a letter of a label, units, in the widest of the usual fonts."""

LINE = 12.5
"""Line spacing of labels, units."""

_DISTANCES = (9.0, 14.0, 20.0, 28.0, 38.0, 50.0)
"""Distances from a point to its label, units, in order of preference."""

_DIRECTIONS = (
    (1, 0),
    (-1, 0),
    (0.6, -1),
    (-0.6, -1),
    (0.6, 1),
    (-0.6, 1),
    (0, -1),
    (0, 1),
    (1, -0.5),
    (-1, -0.5),
    (1, 0.5),
    (-1, 0.5),
)
"""Directions from a point to its label, in order of preference."""  # fmt: skip

_CLOSE = 30.0
"""Largest distance of a label that keeps a dimension line or an outline free, units."""

_NEAR = 10.0
"""Largest distance of a label without a leader line, units."""


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle parallel to the frame."""

    left: float
    top: float
    right: float
    bottom: float

    def overlaps(self, other: Box) -> bool:
        """Whether two rectangles have an area in common."""
        return (
            self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom
        )

    def within(self, other: Box) -> bool:
        """Whether another rectangle contains this one."""
        return (
            other.left <= self.left
            and self.right <= other.right
            and other.top <= self.top
            and self.bottom <= other.bottom
        )

    def with_margin(self, by: float) -> Box:
        """Return the rectangle with a margin on all sides."""
        return Box(self.left - by, self.top - by, self.right + by, self.bottom + by)

    def nearest(self, point: Point) -> Point:
        """Return the point of the rectangle that is nearest to another point."""
        return min(max(point[0], self.left), self.right), min(max(point[1], self.top), self.bottom)

    def is_crossed(self, start: Point, end: Point) -> bool:
        """Whether a straight line from one point to another passes through the rectangle."""
        first, last = 0.0, 1.0
        for begin, step, low, high in (
            (start[0], end[0] - start[0], self.left, self.right),
            (start[1], end[1] - start[1], self.top, self.bottom),
        ):
            if step == 0:
                if not low < begin < high:
                    return False
                continue
            enter, leave = sorted(((low - begin) / step, (high - begin) / step))
            first, last = max(first, enter), min(last, leave)
        return first < last


@dataclass(frozen=True, slots=True)
class Label:
    """A text that belongs to a point.

    Attributes
    ----------
    at
        The point.
    lines
        Text.
    kind
        Kind of the marked object.
    """

    at: Point
    lines: tuple[str, ...]
    kind: Kind

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the text, units."""
        return LETTER * max(map(len, self.lines)), LINE * len(self.lines)


@dataclass(frozen=True, slots=True)
class PlacedLabel:
    """A label with its position.

    Attributes
    ----------
    label
        The label.
    box
        Area of its text.
    leader
        End of the leader line from the point to the text; None where none is needed.
    """

    label: Label
    box: Box
    leader: Point | None


def text_box(text: str, at: Point, anchor: str) -> Box:
    """Return the area of one line of text.

    Parameters
    ----------
    text
        Any.
    at
        Position of its baseline.
    anchor
        ``start``, ``middle`` or ``end``.
    """
    width = LETTER * len(text)
    left = at[0] - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
    return Box(left, at[1] - 9.0, left + width, at[1] + 3.0)


def place_labels(
    labels: Sequence[Label], taken: Iterable[Box], frame: Box, lines: Sequence[tuple[Point, Point]] = ()
) -> tuple[PlacedLabel | None, ...]:
    """Return the positions of labels, placed one after the other, each as near to its point as possible.

    Parameters
    ----------
    labels
        In order of importance.
    taken
        Areas that no label may cover.
    frame
        Area that no label may leave.
    lines
        Lines that no label should cover.

    Returns
    -------
    tuple
        One for each label; None where it cannot be placed.
    """
    points = [Box(label.at[0], label.at[1], label.at[0], label.at[1]).with_margin(5.0) for label in labels]
    texts = list(taken)
    leaders: list[tuple[Point, Point]] = []
    placed: list[PlacedLabel | None] = []
    for label in labels:
        possible = (
            place
            for place in chain(_around(label), _anywhere(label, frame))
            if place.box.within(frame)
            and not any(place.box.overlaps(box) for box in (*texts, *points))
            and not any(place.box.with_margin(1.0).is_crossed(*leader) for leader in leaders)
            and (place.leader is None or not any(box.is_crossed(label.at, place.leader) for box in texts))
        )
        best = _best_position(possible, label.at, lines)
        placed.append(best)
        if best is not None:
            texts.append(best.box)
            if best.leader is not None:
                leaders.append((label.at, best.leader))
    return tuple(placed)


def _best_position(
    possible: Iterator[PlacedLabel], point: Point, lines: Sequence[tuple[Point, Point]]
) -> PlacedLabel | None:
    """Return the first of the positions close to a point that covers the fewest lines, or else the first of all."""
    first = next(possible, None)
    if first is None:
        return None
    close = takewhile(lambda place: math.dist(place.box.nearest(point), point) <= _CLOSE, possible)
    return min((first, *close), key=lambda place: sum(place.box.is_crossed(*line) for line in lines))


def _around(label: Label) -> Iterator[PlacedLabel]:
    """Yield positions beside the point in the preferred directions."""
    width, height = label.size
    # Above the centre of gravity nothing else is dimensioned.
    directions = ((0, -1), *_DIRECTIONS) if label.kind == "gravity" else _DIRECTIONS
    for distance in _DISTANCES:
        for x, y in directions:
            # The side of the text that faces the point is at this distance, whatever the size of the text.
            middle = (
                label.at[0] + x * distance + (width / 2 if x > 0.7 else -width / 2 if x < -0.7 else x * width / 2),
                label.at[1] + y * distance + (height / 2) * (1 if y > 0 else -1 if y < 0 else 0),
            )
            yield _at(label, middle)


def _anywhere(label: Label, frame: Box) -> Iterator[PlacedLabel]:
    """Yield positions all over the frame, the nearest first."""
    width, height = label.size
    across, down = int((frame.right - frame.left - width) / LETTER), int((frame.bottom - frame.top - height) / LINE)
    middles = [
        (frame.left + width / 2 + LETTER * i, frame.top + height / 2 + LINE * k)
        for i in range(across + 1)
        for k in range(down + 1)
    ]
    yield from (_at(label, middle) for middle in sorted(middles, key=lambda middle: math.dist(middle, label.at)))


def _at(label: Label, middle: Point) -> PlacedLabel:
    width, height = label.size
    box = Box(middle[0] - width / 2, middle[1] - height / 2, middle[0] + width / 2, middle[1] + height / 2)
    near = box.nearest(label.at)
    return PlacedLabel(label, box, near if math.dist(near, label.at) > _NEAR else None)
