"""Plan view and side view to scale, with axes, dimensions, sensors, loads and centre of gravity."""

from __future__ import annotations

from sprung.report.sketch.composition import WIDTH, compose
from sprung.report.sketch.dimensions import (
    centre_of_gravity,
    coordinate_axes,
    half_distances,
    lengths_along,
    scale_bar,
    wheels_from_above,
)
from sprung.report.sketch.geometry import Geometry
from sprung.report.sketch.labels import Label
from sprung.report.sketch.marks import Frame, mark_placer
from sprung.report.sketch.proportions import Proportions, proportions_of
from sprung.report.sketch.shapes import Disc, Drawing, Shape, Stroke
from sprung.vehicle import STATIONS, Wheel

SIDE = 62.0
"""Margin for dimensions left and right of the vehicle, units."""


def plan_view(geometry: Geometry) -> Drawing:
    """Return the plan view of a vehicle.

    Parameters
    ----------
    geometry
        Its dimensions.

    Returns
    -------
    Drawing
    """
    drawn = proportions_of(geometry)
    front, rear, half = drawn.outline

    def shapes(top: float) -> tuple[Frame, list[Shape], list[Label], float]:
        frame = _frame(drawn, top, half)
        corners = [(front, half), (front, -half), (rear, -half), (rear, half)]
        parts: list[Shape] = [Stroke(tuple(frame.at(*corner) for corner in corners), "outline", closed=True)]
        parts.append(Stroke((frame.at(front, 0.0), frame.at(rear, 0.0)), "outline", dashed=True))
        parts += wheels_from_above(drawn, frame)
        parts += half_distances(drawn, frame)
        bottom = frame.at(0.0, -half)[1]
        if geometry.layout.pitches:
            parts += lengths_along(drawn, frame, bottom + 14.0, (("a", geometry.a), ("b", geometry.b)))
        parts += coordinate_axes(frame, "y")
        parts += scale_bar(drawn, frame.scale, bottom + 46.0)
        x, _ = drawn.centre_of_gravity
        labels = [Label(frame.at(x, 0.0), ("centre of gravity",), "gravity")]
        parts += centre_of_gravity(frame.at(x, 0.0), _cg_unknown(geometry))
        return frame, parts, labels, bottom

    marks = mark_placer(drawn, lambda position: (position[0], position[1]), drawn.wheel)
    return compose("Plan view", _description(geometry), shapes, marks)


def side_view(geometry: Geometry) -> Drawing:
    """Return the side view of a vehicle, from its right.

    Parameters
    ----------
    geometry
        Its dimensions.

    Returns
    -------
    Drawing
    """
    drawn = proportions_of(geometry)
    front, rear, _ = drawn.outline
    low, high = drawn.heights

    def shapes(top: float) -> tuple[Frame, list[Shape], list[Label], float]:
        frame = _frame(drawn, top, high)
        corners = [(front, low), (front, 0.6 * high), (0.55 * front, high), (rear, high), (rear, low)]
        parts: list[Shape] = [Stroke(tuple(frame.at(*corner) for corner in corners), "outline", closed=True)]
        ground = frame.at(0.0, 0.0)[1]
        parts.append(Stroke(((SIDE - 30.0, ground), (WIDTH - SIDE + 30.0, ground)), "outline"))
        labels = []
        for x in drawn.axles:
            dashed = geometry.wheel_height.value is None or (x != 0.0 and not drawn.has_length)
            hub = frame.at(x, drawn.wheel_radius)
            parts.append(Disc(hub, frame.scale * drawn.wheel_radius, "wheel", dashed=dashed))
            parts.append(Disc(hub, 1.6, "wheel", filled=True))
        if geometry.wheel_height.value is not None:
            labels.append(
                Label(frame.at(0.0, drawn.wheel_radius), ("wheel centre", f"z {geometry.wheel_height.text}"), "wheel")
            )
        if (roll := geometry.roll_axis_height.value) is not None:
            y = frame.at(0.0, roll)[1]
            parts.append(Stroke(((SIDE - 10.0, y), (WIDTH - SIDE + 10.0, y)), "gravity", dashed=True))
            labels.append(Label((SIDE - 10.0, y), ("roll axis", f"z {geometry.roll_axis_height.text}"), "gravity"))
        x, z = drawn.centre_of_gravity
        unknown = _cg_unknown(geometry) or geometry.cg_height.value is None
        parts += centre_of_gravity(frame.at(x, z), unknown)
        labels.append(Label(frame.at(x, z), ("centre of gravity", f"z {geometry.cg_height.text}"), "gravity"))
        if geometry.layout.pitches:
            parts += lengths_along(drawn, frame, ground + 16.0, (("wheelbase", geometry.wheelbase),))
        parts += coordinate_axes(frame, "z")
        return frame, parts, labels, ground

    def wheel(station: Wheel) -> tuple[float, float]:
        return drawn.wheel(station)[0], drawn.wheel_radius

    marks = mark_placer(drawn, lambda position: (position[0], position[2]), wheel)
    return compose("Side view", _description(geometry), shapes, marks)


def _frame(drawn: Proportions, top: float, height: float) -> Frame:
    """Return the frame of a view below an upper margin, its origin a height in m below the top of the outline."""
    front, rear, _ = drawn.outline
    scale = (WIDTH - 2 * SIDE) / (front - rear)
    return Frame(scale, (SIDE - scale * rear, top + scale * height))


def _cg_unknown(geometry: Geometry) -> bool:
    """Whether the centre of gravity has a position along the vehicle, and it is not known."""
    return geometry.layout.pitches and geometry.a.value is None


def _description(geometry: Geometry) -> str:
    lengths = (
        (("wheelbase", geometry.wheelbase), ("a", geometry.a), ("b", geometry.b)) if geometry.layout.pitches else ()
    )
    known = ", ".join(f"{name} {length.text}" for name, length in lengths)
    placed = sum(sensor.position is not None or sensor.on in STATIONS for sensor in geometry.sensors)
    sensors = f"{placed} of {len(geometry.sensors)} sensors at known positions"
    return "; ".join(part for part in (known, sensors, f"{len(geometry.loads)} loads") if part) + "."
