"""Places for labels beside their points: no label covers another, a point or a line that belongs to a label.

Dimension lines are left free too where there is a place close to the point.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, takewhile

from sprung.report.sketch.shapes import Kind, Point

LETTER = 6.0
"""Width of a letter, units: of the widest usual font at the size of labels."""

LINE = 12.5
"""From line to line of a label, units."""

_DISTANCES = (9.0, 14.0, 20.0, 28.0, 38.0, 50.0)
"""From a point to its label, units, the preferred one first."""

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
"""From a point to its label, the preferred one first."""  # fmt: skip

_CLOSE = 20.0
"""Distance up to which a label goes to keep a dimension line free, units."""

_NEAR = 10.0
"""Distance up to which a label needs no line to its point, units."""


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle with its sides parallel to the frame's."""

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

    def grown(self, by: float) -> Box:
        """Add a margin on all sides."""
        return Box(self.left - by, self.top - by, self.right + by, self.bottom + by)

    def nearest(self, point: Point) -> Point:
        """Point of the rectangle that is nearest to another point."""
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
        The text.
    kind
        What it belongs to.
    """

    at: Point
    lines: tuple[str, ...]
    kind: Kind

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the text, units."""
        return LETTER * max(map(len, self.lines)), LINE * len(self.lines)


@dataclass(frozen=True, slots=True)
class Placed:
    """A label with its place.

    Attributes
    ----------
    label
        The label.
    box
        What its text covers.
    leader
        End of the line from the point to the text; None where the text is so near that it needs none.
    """

    label: Label
    box: Box
    leader: Point | None


def text_box(text: str, at: Point, anchor: str) -> Box:
    """Return what one line of text covers.

    Parameters
    ----------
    text
        The text.
    at
        Of its baseline.
    anchor
        ``start``, ``middle`` or ``end``.
    """
    width = LETTER * len(text)
    left = at[0] - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
    return Box(left, at[1] - 9.0, left + width, at[1] + 3.0)


def place_labels(
    labels: Sequence[Label], taken: Iterable[Box], frame: Box, lines: Sequence[tuple[Point, Point]] = ()
) -> tuple[Placed | None, ...]:
    """Place labels one after the other, each as near to its point as it can be.

    Parameters
    ----------
    labels
        In the order of their importance.
    taken
        What no label may cover.
    frame
        What no label may leave.
    lines
        What no label should cover.

    Returns
    -------
    tuple
        One for each label; None where there is no place for it.
    """
    points = [Box(label.at[0], label.at[1], label.at[0], label.at[1]).grown(5.0) for label in labels]
    texts = list(taken)
    leaders: list[tuple[Point, Point]] = []
    placed: list[Placed | None] = []
    for label in labels:
        possible = (
            place
            for place in chain(_around(label), _anywhere(label, frame))
            if place.box.within(frame)
            and not any(place.box.overlaps(box) for box in (*texts, *points))
            and not any(place.box.grown(1.0).is_crossed(*leader) for leader in leaders)
            and (place.leader is None or not any(box.is_crossed(label.at, place.leader) for box in texts))
        )
        found = _freest(possible, label.at, lines)
        placed.append(found)
        if found is not None:
            texts.append(found.box)
            if found.leader is not None:
                leaders.append((label.at, found.leader))
    return tuple(placed)


def _freest(possible: Iterator[Placed], point: Point, lines: Sequence[tuple[Point, Point]]) -> Placed | None:
    """Take the first of the places close to a point that covers the fewest lines, or else the first of all."""
    first = next(possible, None)
    if first is None:
        return None
    close = takewhile(lambda place: math.dist(place.box.nearest(point), point) <= _CLOSE, possible)
    return min((first, *close), key=lambda place: sum(place.box.is_crossed(*line) for line in lines))


def _around(label: Label) -> Iterator[Placed]:
    """Give places beside the point in the preferred directions."""
    width, height = label.size
    # Above the centre of gravity nothing else is dimensioned.
    directions = ((0, -1), *_DIRECTIONS) if label.kind == "gravity" else _DIRECTIONS
    for distance in _DISTANCES:
        for x, y in directions:
            # The side of the text that faces the point stays at the distance, whatever the text's size.
            middle = (
                label.at[0] + x * distance + (width / 2 if x > 0.7 else -width / 2 if x < -0.7 else x * width / 2),
                label.at[1] + y * distance + (height / 2) * (1 if y > 0 else -1 if y < 0 else 0),
            )
            yield _at(label, middle)


def _anywhere(label: Label, frame: Box) -> Iterator[Placed]:
    """Give places all over the frame, the nearest first."""
    width, height = label.size
    across, down = int((frame.right - frame.left - width) / LETTER), int((frame.bottom - frame.top - height) / LINE)
    middles = [
        (frame.left + width / 2 + LETTER * i, frame.top + height / 2 + LINE * k)
        for i in range(across + 1)
        for k in range(down + 1)
    ]
    yield from (_at(label, middle) for middle in sorted(middles, key=lambda one: math.dist(one, label.at)))


def _at(label: Label, middle: Point) -> Placed:
    width, height = label.size
    box = Box(middle[0] - width / 2, middle[1] - height / 2, middle[0] + width / 2, middle[1] + height / 2)
    near = box.nearest(label.at)
    return Placed(label, box, near if math.dist(near, label.at) > _NEAR else None)
