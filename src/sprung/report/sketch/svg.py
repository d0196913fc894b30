"""Technical drawings as SVG text; colours come from the style of the page."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.report.drawing.elements import svg_element
from sprung.report.sketch.shapes import Disc, Drawing, Point, Shape, Stroke, TextShape
from sprung.tables import escaped

_HEAD = 5.0
"""Length of an arrowhead, units."""


def sketch_svg(drawing: Drawing, style: str = "", movable: bool = False) -> str:
    """Return a technical drawing as an SVG element.

    Parameters
    ----------
    drawing
        Any.
    style
        Style element to include, where the style of a page does not apply.
    movable
        Whether a script of the page moves the sensors: their marks then have their channels (``data-channel``), and the drawing
        begins with its scale (``data-scale``, units per m, and ``data-origin``).

    Returns
    -------
    str
        An ``svg`` element; identical for identical drawings.
    """
    content = style + shapes_svg(drawing.shapes, movable)
    if movable:
        (x, y), name = drawing.origin, escaped(drawing.title)
        frame = f'data-view="{name}" data-scale="{drawing.scale:.6g}" data-origin="{x:.6g} {y:.6g}"'
        content = f'<g class="frame" {frame}/>{content}'
    return svg_element("sketch", (drawing.width, drawing.height), drawing.title, drawing.description, content)


def shapes_svg(shapes: tuple[Shape, ...], movable: bool = False) -> str:
    """Return shapes as the content of an ``svg`` element.

    Parameters
    ----------
    shapes
        Drawn in this order.
    movable
        As for `sketch_svg`.
    """
    return "".join(part for shape in shapes for part in _elements(shape, movable))


def _elements(shape: Shape, movable: bool) -> Iterator[str]:
    match shape:
        case Stroke():
            path = "L".join(f"{x:.1f} {y:.1f}" for x, y in shape.points)
            yield f'<path class="{_classes(shape)}" d="M{path}{"z" if shape.closed else ""}"/>'
            ends = [(shape.points[-2], shape.points[-1])] if shape.arrows else []
            ends += [(shape.points[1], shape.points[0])] if shape.arrows == "both" else []
            yield from (f'<path class="head {shape.kind}" d="{_head(*end)}"/>' for end in ends)
        case Disc():
            (x, y), filled = shape.centre, " filled" if shape.filled else ""
            about = f' data-channel="{escaped(shape.about)}"' if movable and shape.about else ""
            yield f'<circle class="{_classes(shape)}{filled}"{about} cx="{x:.1f}" cy="{y:.1f}" r="{shape.radius:.1f}"/>'
        case TextShape():
            x, y = shape.at
            place = f'x="{x:.1f}" y="{y:.1f}"' + (f' text-anchor="{shape.anchor}"' if shape.anchor != "start" else "")
            yield f'<text class="{shape.kind}" {place}>{_text_content(shape)}</text>'


def _classes(shape: Stroke | Disc) -> str:
    return f"line {shape.kind}{' dashed' if shape.dashed else ''}"


def _head(start: Point, tip: Point) -> str:
    """Return the path of an arrowhead."""
    x, y = tip[0] - start[0], tip[1] - start[1]
    length = (x**2 + y**2) ** 0.5 or 1.0
    head = min(_HEAD, length / 2)
    x, y = x / length * head, y / length * head
    left = (tip[0] - x - 0.4 * y, tip[1] - y + 0.4 * x)
    right = (tip[0] - x + 0.4 * y, tip[1] - y - 0.4 * x)
    return "M" + "L".join(f"{corner[0]:.1f} {corner[1]:.1f}" for corner in (tip, left, right)) + "z"


def _text_content(shape: TextShape) -> str:
    letter, _, index = shape.text.partition("_")
    if not shape.symbol or not index:
        return escaped(shape.text)
    return f'<tspan class="symbol">{escaped(letter)}</tspan><tspan class="index" dy="2.5">{escaped(index)}</tspan>'
