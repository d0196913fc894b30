"""A technical drawing as SVG text, its colours left to the page's style."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.report.sketch.shapes import Disc, Drawing, Point, Shape, Stroke, Words
from sprung.tables import escaped

_HEAD = 5.0
"""Length of an arrowhead, units."""


def drawing_svg(drawing: Drawing, style: str = "") -> str:
    """Draw a technical drawing.

    Parameters
    ----------
    drawing
        What it shows.
    style
        Rules of style to go with it, for where those of a page do not reach.

    Returns
    -------
    str
        An ``svg`` element; the same for the same drawing.
    """
    return (
        f'<svg class="sketch" viewBox="0 0 {drawing.width:.0f} {drawing.height:.0f}" role="img" '
        f'aria-label="{escaped(drawing.title)}"><title>{escaped(drawing.title)}</title>'
        f"<desc>{escaped(drawing.described)}</desc>{style}{shapes_svg(drawing.shapes)}</svg>"
    )


def shapes_svg(shapes: tuple[Shape, ...]) -> str:
    """Draw shapes, to stand within an ``svg`` element.

    Parameters
    ----------
    shapes
        The hindmost first.
    """
    return "".join(part for shape in shapes for part in _drawn(shape))


def _drawn(shape: Shape) -> Iterator[str]:
    match shape:
        case Stroke():
            path = "L".join(f"{x:.1f} {y:.1f}" for x, y in shape.points)
            yield f'<path class="{_classes(shape)}" d="M{path}{"z" if shape.closed else ""}"/>'
            ends = [(shape.points[-2], shape.points[-1])] if shape.arrows else []
            ends += [(shape.points[1], shape.points[0])] if shape.arrows == "both" else []
            yield from (f'<path class="head {shape.kind}" d="{_head(*end)}"/>' for end in ends)
        case Disc():
            (x, y), filled = shape.centre, " filled" if shape.filled else ""
            yield f'<circle class="{_classes(shape)}{filled}" cx="{x:.1f}" cy="{y:.1f}" r="{shape.radius:.1f}"/>'
        case Words():
            x, y = shape.at
            place = f'x="{x:.1f}" y="{y:.1f}"' + (f' text-anchor="{shape.anchor}"' if shape.anchor != "start" else "")
            yield f'<text class="{shape.kind}" {place}>{_written(shape)}</text>'


def _classes(shape: Stroke | Disc) -> str:
    return f"line {shape.kind}{' dashed' if shape.dashed else ''}"


def _head(start: Point, tip: Point) -> str:
    """Give the path of an arrowhead."""
    x, y = tip[0] - start[0], tip[1] - start[1]
    length = (x**2 + y**2) ** 0.5 or 1.0
    head = min(_HEAD, length / 2)
    x, y = x / length * head, y / length * head
    left = (tip[0] - x - 0.4 * y, tip[1] - y + 0.4 * x)
    right = (tip[0] - x + 0.4 * y, tip[1] - y - 0.4 * x)
    return "M" + "L".join(f"{one[0]:.1f} {one[1]:.1f}" for one in (tip, left, right)) + "z"


def _written(words: Words) -> str:
    letter, _, below = words.text.partition("_")
    if not words.symbol or not below:
        return escaped(words.text)
    return f'<tspan class="symbol">{escaped(letter)}</tspan><tspan class="index" dy="2.5">{escaped(below)}</tspan>'
