"""The sketch as an SVG file, and a blank sketch to print and fill in at the vehicle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sprung.report.drawing.elements import svg_file
from sprung.report.drawing.palette import LIGHT
from sprung.report.sketch.composition import WIDTH
from sprung.report.sketch.geometry import Geometry, Length
from sprung.report.sketch.shapes import Drawing, Shape, Stroke, TextShape
from sprung.report.sketch.sketch import VehicleSketch
from sprung.report.sketch.svg import shapes_svg
from sprung.report.sketch.views import plan_view, side_view
from sprung.tables import escaped

_EDGE, _GAP, _TITLE = 16.0, 24.0, 20.0
"""Units: margin of the sheet, gap between drawings, height of a title."""

_LARGER = 1.5
"""Magnification of the drawings on the blank sheet, for room to write."""

_PAGE = (720.0, 1018.0)
"""Width and height of the blank sheet, units: an A4 page without margins."""

_ROW = 21.0
"""Height of a line to write on, units."""

_WRITE = "________ m"
"""In place of a length to be filled in."""


def sketch_sheet(sketch: VehicleSketch) -> str:
    """Return the two drawings of a sketch beside each other, as an SVG file.

    Parameters
    ----------
    sketch
        From `vehicle_sketch`.

    Returns
    -------
    str
        Content of the file; identical for identical sketches.
    """
    plan, side = sketch.drawings
    width = 2 * _EDGE + 2 * WIDTH + _GAP
    height = 2 * _EDGE + _TITLE + max(plan.height, side.height)
    parts = [_placed(plan, _EDGE, _EDGE), _placed(side, _EDGE + WIDTH + _GAP, _EDGE)]
    return _file(f"{sketch.geometry.name}: sketch of the vehicle", "".join(parts), width, height)


def blank_sketch() -> str:
    """Return a sketch without numbers on a page of A4, with lines to write dimensions, sensors and loads on.

    Returns
    -------
    str
        Content of an SVG file; always the same.
    """
    usual = Geometry(
        name="",
        wheelbase=Length(2.7, written=_WRITE),
        a=Length(1.3, written=_WRITE),
        b=Length(1.4, written=_WRITE),
        springs=(Length(0.6, written="_____ m"), Length(0.6, written="_____ m")),
        cg_height=Length(0.55, written=_WRITE),
        wheel_height=Length(0.31, written=_WRITE),
        blank=True,
    )
    plan, side = plan_view(usual), side_view(usual)
    x = (_PAGE[0] - _LARGER * WIDTH) / 2
    shapes: list[Shape] = []
    y = 20.0
    for labels in (("Vehicle", "Date"), ("Place", "Operator"), ("Tyre pressures", "Fuel, luggage")):
        shapes += _lines(labels, y)
        y += _ROW
    parts = [_placed(plan, x, y, _LARGER)]
    y += _TITLE + _LARGER * plan.height
    parts.append(_placed(side, x, y, _LARGER))
    y += _TITLE + _LARGER * side.height + 6.0
    shapes += _table(("sensor (channel)", "on", "x, m", "y, m", "z, m", "range", "logger"), 8, y)
    y += 9 * _ROW + 12.0
    shapes += _table(("piece of the load", "mass, kg", "x, m", "y, m", "z, m", "load"), 3, y)
    return _file("Sketch of the vehicle, blank", "".join([*parts, shapes_svg(tuple(shapes))]), *_PAGE)


def _placed(drawing: Drawing, x: float, y: float, scale: float = 1.0) -> str:
    title = f'<text class="title" x="{x:.0f}" y="{y + 12:.0f}">{escaped(drawing.title)}</text>'
    place = f"translate({x:.1f} {y + _TITLE:.1f}) scale({scale:g})"
    return f'{title}<g transform="{place}"><desc>{escaped(drawing.description)}</desc>{shapes_svg(drawing.shapes)}</g>'


def _lines(labels: Sequence[str], y: float) -> Iterator[Shape]:
    """Yield labels side by side, each with a line to write on."""
    width = _PAGE[0] / len(labels)
    for column, label in enumerate(labels):
        yield TextShape(label, (column * width, y), "write")
        yield Stroke(((column * width + 84.0, y + 2.0), ((column + 1) * width - 12.0, y + 2.0)), "write")


def _table(headers: Sequence[str], rows: int, y: float) -> Iterator[Shape]:
    """Yield an empty table, its first column twice as wide as the others."""
    width = _PAGE[0] / (len(headers) + 1)
    starts = [0.0, *(width * (column + 2) for column in range(len(headers) - 1)), _PAGE[0]]
    for start, header in zip(starts, headers, strict=False):
        yield TextShape(header, (start + 4.0, y + 14.0), "write")
    for row in range(rows + 2):
        line = y + _ROW * row
        yield Stroke(((0.0, line), (_PAGE[0], line)), "write")
    for start in starts:
        yield Stroke(((start, y), (start, y + _ROW * (rows + 1))), "write")


def _file(title: str, content: str, width: float, height: float) -> str:
    rules = f".sketch .title {{ font-size: 13px; font-weight: 600; fill: {LIGHT['text']}; }}"
    return svg_file(title, (width, height), rules, content, "sketch", margin=1)
