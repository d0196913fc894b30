"""The vehicle from above and from the side, to scale, with axes, dimensions, sensors, loads and centre of gravity."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sprung.report.sketch.geometry import Geometry, Length
from sprung.report.sketch.labels import LINE, Box, Label, Placed, place_labels, text_box
from sprung.report.sketch.proportions import Proportions, proportions_of
from sprung.report.sketch.shapes import Anchor, Disc, Drawing, Kind, Point, Shape, Stroke, Words
from sprung.vehicle import WHEELS, Wheel

WIDTH = 360.0
"""Units across a drawing: its words can be read on a telephone, and two stand beside each other on a desk."""

_SIDE = 62.0
"""Margin for dimensions left and right of the vehicle, units."""

_LABELS, _BELOW = 22.0, 56.0
"""Margins above the vehicle for labels, and below it for dimensions, units."""

_MORE, _TRIES = 4 * LINE, 6
"""By how much the upper margin grows while labels have no place, and how often."""

_MARK = 3.6
"""Half-size of the mark of a sensor or a load, units."""

_SAME = 7.0
"""Marks less than this apart, units, share one label."""

_LONGEST = 26
"""Letters of a name that are written."""


@dataclass(frozen=True)
class Frame:
    """How lengths are placed on a drawing.

    Attributes
    ----------
    scale
        Units per m.
    origin
        Of the front axle's centre on the ground or on the centreline.
    """

    scale: float
    origin: Point

    def at(self, x: float, up: float) -> Point:
        """Place a point: x to the right, y or z upwards."""
        return self.origin[0] + self.scale * x, self.origin[1] - self.scale * up


@dataclass(frozen=True)
class Mark:
    """A sensor or a piece of a load.

    Attributes
    ----------
    at
        Where it is, units.
    text
        Its label.
    kind
        What it is.
    on_body
        Whether it is on the body, and not on a wheel.
    """

    at: Point
    text: str
    kind: Kind
    on_body: bool = True


def plan_view(geometry: Geometry) -> Drawing:
    """Draw the vehicle from above.

    Parameters
    ----------
    geometry
        What is known of it.

    Returns
    -------
    Drawing
    """
    drawn = proportions_of(geometry)
    front, rear, half = drawn.outline
    scale = (WIDTH - 2 * _SIDE) / (front - rear)

    def shapes(top: float) -> tuple[Frame, list[Shape], list[Label], float]:
        frame = Frame(scale, (_SIDE - scale * rear, top + scale * half))
        corners = [(front, half), (front, -half), (rear, -half), (rear, half)]
        parts: list[Shape] = [Stroke(tuple(frame.at(*one) for one in corners), "outline", closed=True)]
        parts.append(Stroke((frame.at(front, 0.0), frame.at(rear, 0.0)), "outline", dashed=True))
        parts += _wheels_from_above(drawn, frame)
        parts += _half_distances(drawn, frame)
        bottom = frame.at(0.0, -half)[1]
        parts += _along(drawn, frame, bottom + 14.0, (("a", geometry.a), ("b", geometry.b)))
        parts += _axes(frame, "y")
        parts += _scale_bar(drawn, scale, bottom + 46.0)
        x, _ = drawn.centre_of_gravity
        labels = [Label(frame.at(x, 0.0), ("centre of gravity",), "gravity")]
        parts += _gravity(frame.at(x, 0.0), geometry.a.value is None)
        return frame, parts, labels, bottom

    marks = _marks(drawn, lambda place: (place[0], place[1]), drawn.wheel)
    return _finished("Plan view", _described(geometry), shapes, marks)


def side_view(geometry: Geometry) -> Drawing:
    """Draw the vehicle from its right side.

    Parameters
    ----------
    geometry
        What is known of it.

    Returns
    -------
    Drawing
    """
    drawn = proportions_of(geometry)
    front, rear, _ = drawn.outline
    low, high = drawn.heights
    scale = (WIDTH - 2 * _SIDE) / (front - rear)

    def shapes(top: float) -> tuple[Frame, list[Shape], list[Label], float]:
        frame = Frame(scale, (_SIDE - scale * rear, top + scale * high))
        corners = [(front, low), (front, 0.6 * high), (0.55 * front, high), (rear, high), (rear, low)]
        parts: list[Shape] = [Stroke(tuple(frame.at(*one) for one in corners), "outline", closed=True)]
        ground = frame.at(0.0, 0.0)[1]
        parts.append(Stroke(((_SIDE - 30.0, ground), (WIDTH - _SIDE + 30.0, ground)), "outline"))
        labels = []
        for x in (0.0, -drawn.wheelbase):
            dashed = geometry.wheel_height.value is None or (x != 0.0 and geometry.wheelbase.value is None)
            hub = frame.at(x, drawn.wheel_radius)
            parts.append(Disc(hub, scale * drawn.wheel_radius, "wheel", dashed=dashed))
            parts.append(Disc(hub, 1.6, "wheel", filled=True))
        if geometry.wheel_height.value is not None:
            labels.append(
                Label(frame.at(0.0, drawn.wheel_radius), ("wheel centre", f"z {geometry.wheel_height.text}"), "wheel")
            )
        if (roll := geometry.roll_axis_height.value) is not None:
            y = frame.at(0.0, roll)[1]
            parts.append(Stroke(((_SIDE - 10.0, y), (WIDTH - _SIDE + 10.0, y)), "gravity", dashed=True))
            labels.append(Label((_SIDE - 10.0, y), ("roll axis", f"z {geometry.roll_axis_height.text}"), "gravity"))
        x, z = drawn.centre_of_gravity
        unknown = geometry.a.value is None or geometry.cg_height.value is None
        parts += _gravity(frame.at(x, z), unknown)
        labels.append(Label(frame.at(x, z), ("centre of gravity", f"z {geometry.cg_height.text}"), "gravity"))
        parts += _along(drawn, frame, ground + 16.0, (("wheelbase", geometry.wheelbase),))
        parts += _axes(frame, "z")
        return frame, parts, labels, ground

    def wheel(station: Wheel) -> tuple[float, float]:
        return drawn.wheel(station)[0], drawn.wheel_radius

    marks = _marks(drawn, lambda place: (place[0], place[2]), wheel)
    return _finished("Side view", _described(geometry), shapes, marks)


_Shapes = Callable[[float], tuple[Frame, list[Shape], list[Label], float]]
"""Draws everything but sensors and loads below an upper margin: with its frame, further labels, and where it ends."""

_Marks = Callable[[Frame], list[Mark]]


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


def _attempt(drawn: tuple[Frame, list[Shape], list[Label], float], marks: _Marks) -> _Attempt:
    frame, parts, labels, bottom = drawn
    marked = marks(frame)
    wanted = [*_grouped(marked), *labels]
    taken = [_box(part) for part in parts if isinstance(part, Words)]
    height = bottom + _BELOW
    placed = place_labels(wanted, taken, Box(2.0, 2.0, WIDTH - 2.0, height - 2.0))
    return _Attempt(parts, marked, wanted, placed, height)


def _finished(title: str, described: str, shapes: _Shapes, marks: _Marks) -> Drawing:
    """Add sensors, loads and labels, with so much margin above that every label has its place."""
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
        parts += _drawn_mark(mark)
    return Drawing(title, described, WIDTH, height, tuple(parts))


def _box(words: Words) -> Box:
    return text_box(words.text, words.at, words.anchor)


def _grouped(marks: Sequence[Mark]) -> Iterator[Label]:
    """Give marks of one kind that lie on one point a label together."""
    groups: list[list[Mark]] = []
    for mark in marks:
        for group in groups:
            apart = max(abs(mark.at[0] - group[0].at[0]), abs(mark.at[1] - group[0].at[1]))
            if group[0].kind == mark.kind and apart < _SAME:
                group.append(mark)
                break
        else:
            groups.append([mark])
    for group in groups:
        yield Label(group[0].at, tuple(dict.fromkeys(mark.text for mark in group)), group[0].kind)


def _marks(
    drawn: Proportions,
    project: Callable[[tuple[float, float, float]], tuple[float, float]],
    wheel: Callable[[Wheel], tuple[float, float]],
) -> _Marks:
    """Place sensors and loads that have a known place."""
    stations: list[str | None] = ["body", *WHEELS, None]

    def marks(frame: Frame) -> list[Mark]:
        found = []
        for sensor in sorted(drawn.geometry.sensors, key=lambda one: stations.index(one.on)):
            if sensor.position is not None:
                found.append(Mark(frame.at(*project(sensor.position)), shortened(sensor.channel), "sensor"))
            elif sensor.on is not None and sensor.on != "body":
                found.append(Mark(frame.at(*wheel(sensor.on)), shortened(sensor.channel), "sensor", False))
        for load in drawn.geometry.loads:
            for item in load.items:
                text = shortened(f"{load.name} {item.mass:.4g} kg")
                if item.position is not None:
                    found.append(Mark(frame.at(*project(item.position)), text, "load"))
                elif item.on is not None:
                    found.append(Mark(frame.at(*wheel(item.on)), text, "load", False))
        return found

    return marks


def shortened(name: str) -> str:
    """Shorten a name that is too long for a label.

    Parameters
    ----------
    name
        Any.
    """
    printable = "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in name)
    return printable if len(printable) <= _LONGEST else f"{printable[: _LONGEST - 1]}…"


def _drawn_mark(mark: Mark) -> Iterator[Shape]:
    (x, y), r = mark.at, _MARK
    if mark.kind == "sensor":
        yield Disc(mark.at, r, "sensor", filled=mark.on_body)
        return
    yield Stroke(((x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)), mark.kind, closed=True)
    yield Stroke(((x - r, y - r), (x + r, y + r)), mark.kind)
    yield Stroke(((x - r, y + r), (x + r, y - r)), mark.kind)


def _wheels_from_above(drawn: Proportions, frame: Frame) -> Iterator[Shape]:
    long, wide = drawn.wheel_radius, drawn.wheel_width / 2
    for x in (0.0, -drawn.wheelbase):
        dashed = x != 0.0 and drawn.geometry.wheelbase.value is None
        yield Stroke((frame.at(x, drawn.half_track), frame.at(x, -drawn.half_track)), "wheel", dashed)
        for y in (drawn.half_track, -drawn.half_track):
            corners = [(x - long, y - wide), (x + long, y - wide), (x + long, y + wide), (x - long, y + wide)]
            yield Stroke(tuple(frame.at(*one) for one in corners), "wheel", dashed, closed=True)


def _half_distances(drawn: Proportions, frame: Frame) -> Iterator[Shape]:
    """Show springs, and dampers where they have half-distances of their own, with their distance from the centreline."""
    front, rear, _ = drawn.outline
    geometry = drawn.geometry
    for axle, (x, end, way) in enumerate(((0.0, front, 1), (-drawn.wheelbase, rear, -1))):
        letter = "fr"[axle]
        names = (f"t_{letter}2", f"t_{letter}1") if geometry.separate else (f"t_{letter}",)
        for springs, name in zip((True, False), names, strict=False):
            length = (geometry.springs if springs else geometry.dampers)[axle]
            y = drawn.half_distance(springs, axle) * (1 if springs else -1)
            dashed = length.value is None
            yield from _seats(frame, x, abs(y), springs, dashed)
            line = frame.at(end, 0.0)[0] + 12.0 * way
            low, high = frame.at(0.0, 0.0)[1], frame.at(0.0, y)[1]
            yield Stroke((frame.at(x, y), (line + 4.0 * way, high)), "dimension", dashed)
            yield Stroke(((line, low), (line, high)), "dimension", dashed, arrows="both")
            anchor: Anchor = "start" if way > 0 else "end"
            middle, beside = (low + high) / 2, line + 5.0 * way
            yield Words(name, (beside, middle - 2.0), "dimension", anchor, symbol=True)
            yield Words(length.text, (beside, middle + LINE - 1.5), "dimension", anchor)


def _seats(frame: Frame, x: float, y: float, springs: bool, dashed: bool) -> Iterator[Shape]:
    for side in (y, -y):
        centre = frame.at(x, side)
        if springs:
            yield Disc(centre, 3.0, "dimension", dashed=dashed)
        else:
            at, r = centre, 2.6
            corners = ((at[0] - r, at[1]), (at[0], at[1] - r), (at[0] + r, at[1]), (at[0], at[1] + r))
            yield Stroke(corners, "dimension", dashed, closed=True)


def _along(drawn: Proportions, frame: Frame, y: float, lengths: Sequence[tuple[str, Length]]) -> Iterator[Shape]:
    """Show lengths along the vehicle, one after the other from the front axle on."""
    cg, _ = drawn.centre_of_gravity
    ends = (0.0, cg, -drawn.wheelbase) if len(lengths) > 1 else (0.0, -drawn.wheelbase)
    written: list[Box] = []
    for (name, length), front, rear in zip(lengths, ends, ends[1:], strict=False):
        right, left = frame.at(front, 0.0)[0], frame.at(rear, 0.0)[0]
        dashed = length.value is None
        yield Stroke(((left, y), (right, y)), "dimension", dashed, arrows="both")
        for x in (left, right):
            yield Stroke(((x, y - 9.0), (x, y + 3.0)), "dimension", dashed)
        text = f"{name} {length.text}"
        at = ((left + right) / 2, y + 11.5)
        if any(text_box(text, at, "middle").overlaps(box) for box in written):
            at = (at[0], at[1] + LINE)
        written.append(text_box(text, at, "middle"))
        yield Words(text, at, "dimension", "middle")


def _axes(frame: Frame, up: str) -> Iterator[Shape]:
    origin, long = frame.at(0.0, 0.0), 24.0
    yield Disc(origin, 2.0, "axis", filled=True)
    yield Stroke((origin, (origin[0] + long, origin[1])), "axis", arrows="end")
    yield Stroke((origin, (origin[0], origin[1] - long)), "axis", arrows="end")
    yield Words("x", (origin[0] + long + 2.0, origin[1] + 3.5), "axis")
    yield Words(up, (origin[0] + 4.0, origin[1] - long + 3.0), "axis")


def _gravity(centre: Point, dashed: bool) -> Iterator[Shape]:
    r = 5.0
    yield Disc(centre, r, "gravity", dashed=dashed)
    yield Stroke(((centre[0] - r, centre[1]), (centre[0] + r, centre[1])), "gravity", dashed)
    yield Stroke(((centre[0], centre[1] - r), (centre[0], centre[1] + r)), "gravity", dashed)


def _scale_bar(drawn: Proportions, scale: float, y: float) -> Iterator[Shape]:
    if not drawn.to_scale:
        yield Words("not to scale: no length is known", (4.0, y + 3.5), "dimension")
        return
    yield Stroke(((4.0, y), (4.0 + scale, y)), "dimension")
    for x in (4.0, 4.0 + scale):
        yield Stroke(((x, y - 3.0), (x, y + 3.0)), "dimension")
    yield Words("1 m", (8.0 + scale, y + 3.5), "dimension")


def _described(geometry: Geometry) -> str:
    known = [f"wheelbase {geometry.wheelbase.text}", f"a {geometry.a.text}", f"b {geometry.b.text}"]
    placed = sum(sensor.position is not None or sensor.on in WHEELS for sensor in geometry.sensors)
    return f"{', '.join(known)}; {placed} of {len(geometry.sensors)} sensors with a known place; {len(geometry.loads)} loads."
