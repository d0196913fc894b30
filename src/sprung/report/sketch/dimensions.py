"""Elements of a drawing besides the outline: wheels, springs and dampers, dimension lines, axes, scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sprung.report.sketch.geometry import Length
from sprung.report.sketch.labels import LINE, Box, text_box
from sprung.report.sketch.marks import Frame
from sprung.report.sketch.proportions import Proportions
from sprung.report.sketch.shapes import Anchor, Disc, Point, Shape, Stroke, TextShape


def wheels_from_above(drawn: Proportions, frame: Frame) -> Iterator[Shape]:
    """Draw wheels and axles.

    Parameters
    ----------
    drawn
        The vehicle as it is drawn.
    frame
        Of the drawing.
    """
    long, wide = drawn.wheel_radius, drawn.wheel_width / 2
    layout = drawn.geometry.layout
    for axle in layout.axles:
        wheels = [drawn.wheel(wheel) for wheel in layout.wheels_of(axle)]
        dashed = wheels[0][0] != 0.0 and not drawn.has_length
        if len(wheels) > 1:
            yield Stroke((frame.at(*wheels[0]), frame.at(*wheels[-1])), "wheel", dashed)
        for x, y in wheels:
            corners = [(x - long, y - wide), (x + long, y - wide), (x + long, y + wide), (x - long, y + wide)]
            yield Stroke(tuple(frame.at(*corner) for corner in corners), "wheel", dashed, closed=True)


def half_distances(drawn: Proportions, frame: Frame) -> Iterator[Shape]:
    """Draw springs, dampers with half-distances of their own, and their distance from the centreline.

    Parameters
    ----------
    drawn
        The vehicle as it is drawn.
    frame
        Of the drawing.
    """
    front, rear, _ = drawn.outline
    for name, springs, axle, length in sorted(drawn.geometry.half_distances, key=lambda one: one[2]):
        x, end, sign = drawn.axles[axle], (front, rear)[axle], (1, -1)[axle]
        y = drawn.half_distance(springs, axle) * (1 if springs else -1)
        dashed = length.value is None
        yield from _seats(frame, x, abs(y), springs, dashed)
        line = frame.at(end, 0.0)[0] + 12.0 * sign
        low, high = frame.at(0.0, 0.0)[1], frame.at(0.0, y)[1]
        yield Stroke((frame.at(x, y), (line + 4.0 * sign, high)), "dimension", dashed)
        yield Stroke(((line, low), (line, high)), "dimension", dashed, arrows="both")
        anchor: Anchor = "start" if sign > 0 else "end"
        middle, beside = (low + high) / 2, line + 5.0 * sign
        # Springs above the centreline, dampers below it, however short the dimension line is.
        upper = min(middle - 2.0, low - LINE - 3.5) if springs else max(middle - 2.0, low + 10.5)
        yield TextShape(name, (beside, upper), "dimension", anchor, symbol=True)
        yield TextShape(length.text, (beside, upper + LINE), "dimension", anchor)


def _seats(frame: Frame, x: float, y: float, springs: bool, dashed: bool) -> Iterator[Shape]:
    for side in (y, -y):
        centre = frame.at(x, side)
        if springs:
            yield Disc(centre, 3.0, "dimension", dashed=dashed)
        else:
            at, r = centre, 2.6
            corners = ((at[0] - r, at[1]), (at[0], at[1] - r), (at[0] + r, at[1]), (at[0], at[1] + r))
            yield Stroke(corners, "dimension", dashed, closed=True)


def lengths_along(drawn: Proportions, frame: Frame, y: float, lengths: Sequence[tuple[str, Length]]) -> Iterator[Shape]:
    """Draw dimension lines along the vehicle, one after the other from the front axle.

    Parameters
    ----------
    drawn
        The vehicle as it is drawn.
    frame
        Of the drawing.
    y
        Of the lines, units.
    lengths
        Names and lengths: a and b, or the wheelbase alone.
    """
    cg, _ = drawn.centre_of_gravity
    ends = (0.0, cg, -drawn.wheelbase) if len(lengths) > 1 else (0.0, -drawn.wheelbase)
    texts: list[Box] = []
    for (name, length), front, rear in zip(lengths, ends, ends[1:], strict=False):
        right, left = frame.at(front, 0.0)[0], frame.at(rear, 0.0)[0]
        dashed = length.value is None
        yield Stroke(((left, y), (right, y)), "dimension", dashed, arrows="both")
        for x in (left, right):
            yield Stroke(((x, y - 9.0), (x, y + 3.0)), "dimension", dashed)
        text = f"{name} {length.text}"
        at = ((left + right) / 2, y + 11.5)
        if any(text_box(text, at, "middle").overlaps(box) for box in texts):
            at = (at[0], at[1] + LINE)
        texts.append(text_box(text, at, "middle"))
        yield TextShape(text, at, "dimension", "middle")


def coordinate_axes(frame: Frame, up: str) -> Iterator[Shape]:
    """Draw the origin on the front axle, the x axis and a second one.

    Parameters
    ----------
    frame
        Of the drawing.
    up
        Name of the axis that points upwards on the drawing.
    """
    origin, long = frame.at(0.0, 0.0), 24.0
    yield Disc(origin, 2.0, "axis", filled=True)
    yield Stroke((origin, (origin[0] + long, origin[1])), "axis", arrows="end")
    yield Stroke((origin, (origin[0], origin[1] - long)), "axis", arrows="end")
    yield TextShape("x", (origin[0] + long + 2.0, origin[1] + 3.5), "axis")
    yield TextShape(up, (origin[0] + 4.0, origin[1] - long + 3.0), "axis")


def centre_of_gravity(centre: Point, dashed: bool) -> Iterator[Shape]:
    """Draw the mark of the centre of gravity.

    Parameters
    ----------
    centre
        Its position, units.
    dashed
        Whether its position is unknown.
    """
    r = 5.0
    yield Disc(centre, r, "gravity", dashed=dashed)
    yield Stroke(((centre[0] - r, centre[1]), (centre[0] + r, centre[1])), "gravity", dashed)
    yield Stroke(((centre[0], centre[1] - r), (centre[0], centre[1] + r)), "gravity", dashed)


def scale_bar(drawn: Proportions, scale: float, y: float) -> Iterator[Shape]:
    """Draw a bar of 1 m, or the note that the drawing is not to scale.

    Parameters
    ----------
    drawn
        The vehicle as it is drawn.
    scale
        Units per m.
    y
        Of the bar, units.
    """
    if not drawn.to_scale:
        why = "" if drawn.geometry.blank else ": no length is known"
        yield TextShape(f"not to scale{why}", (4.0, y + 3.5), "dimension")
        return
    yield Stroke(((4.0, y), (4.0 + scale, y)), "dimension")
    for x in (4.0, 4.0 + scale):
        yield Stroke(((x, y - 3.0), (x, y + 3.0)), "dimension")
    yield TextShape("1 m", (8.0 + scale, y + 3.5), "dimension")
