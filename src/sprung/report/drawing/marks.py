"""Curves, points, lines and bands of one panel as SVG elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Band, Curve, Mark, Points, Rule
from sprung.report.pictures.lanes import thin_out

Real = NDArray[np.float64]

BINS = 400
"""Intervals of a curve across a panel, of which the lowest and the highest sample are drawn."""

FINE = 10
"""Resolution of curves, steps per unit."""

_EDGE = 1.0
"""Distance beyond the edges of a panel up to which curves and points are drawn, units: the width of a line."""


@dataclass(frozen=True)
class Box:
    """Position and axes of a panel.

    Attributes
    ----------
    left, top, width, height
        In units of the picture.
    x, y
        Its axes.
    """

    left: float
    top: float
    width: float
    height: float
    x: Axis
    y: Axis

    def across(self, values: Real) -> Real:
        """Return the horizontal position of values, units."""
        return self.left + self.width * self.x.at(values)

    def down(self, values: Real) -> Real:
        """Return the vertical position of values, units."""
        return self.top + self.height * (1 - self.y.at(values))

    @property
    def bottom(self) -> float:
        """Lower edge, units."""
        return self.top + self.height


def mark_elements(mark: Mark, box: Box, number: int | None = None) -> Iterator[str]:
    """Draw one mark.

    Parameters
    ----------
    mark
        Curve, points, line or band.
    box
        The panel.
    number
        Index among the curves and points of its panel, where a script may draw them again; None otherwise.

    Yields
    ------
    str
        SVG elements.
    """
    zoomable = number is not None
    match mark:
        case Curve():
            yield from _curve(mark, box, f' data-curve="{number}"' if zoomable else "")
        case Points():
            yield from _points(mark, box, f' data-curve="{number}"' if zoomable else "")
        case Rule(horizontal=True):
            y = float(box.down(np.array(mark.at)))
            if box.top - 1 <= y <= box.bottom + 1:
                dashes = " dashed" if mark.dashed else ""
                yield f'<path class="rule {mark.role}{dashes}" d="M{box.left:.1f} {y:.1f}h{box.width:.1f}"/>'
        case Rule():
            if 0 <= (part := float(box.x.at(np.array(mark.at)))) <= 1:
                dashes, key = " dashed" if mark.dashed else "", f' data-x="{mark.at:.9g}"' if zoomable else ""
                x = box.left + box.width * part
                yield f'<path class="rule {mark.role}{dashes}"{key} d="M{x:.1f} {box.top:.1f}v{box.height:.1f}"/>'
        case Band():
            ends = np.sort(np.clip(box.x.at(np.array([mark.low, mark.high])), 0, 1))
            low, high = (box.left + box.width * ends).tolist()
            key = f' data-low="{mark.low:.9g}" data-high="{mark.high:.9g}"' if zoomable else ""
            place = f'x="{low:.1f}" y="{box.top:.1f}" width="{high - low:.1f}" height="{box.height:.1f}"'
            yield f'<rect class="band"{key} {place}/>'


def _segments(curve: Curve) -> Iterator[tuple[Real, Real]]:
    """Yield the parts of a curve between its gaps, thinned to the resolution of the drawing."""
    finite = np.isfinite(curve.x) & np.isfinite(curve.y)
    for part in np.split(np.arange(finite.size), np.flatnonzero(np.diff(finite)) + 1):
        if part.size > 1 and finite[part[0]]:
            kept = part[thin_out(curve.y[part], BINS)]
            yield curve.x[kept], curve.y[kept]


def _inside(across: Real, down: Real, box: Box) -> Iterator[tuple[Real, Real]]:
    """Yield the parts of a polyline between the upper and the lower edge of its panel."""
    edges = box.top - _EDGE, box.bottom + _EDGE
    for edge in edges:
        outside = down - edge
        leaves = np.flatnonzero(outside[:-1] * outside[1:] < 0)
        reached = outside[leaves] / (outside[leaves] - outside[leaves + 1])
        across = np.insert(across, leaves + 1, across[leaves] + reached * np.diff(across)[leaves])
        down = np.insert(down, leaves + 1, edge)
    inside = (down >= edges[0]) & (down <= edges[1])
    for part in np.split(np.arange(inside.size), np.flatnonzero(np.diff(inside)) + 1):
        if part.size > 1 and inside[part[0]]:
            yield across[part], down[part]


def _path(across: Real, down: Real) -> str:
    """Return a polyline as relative steps in fractions of a unit."""
    places = np.stack([FINE * across, FINE * down]).round().astype(int)
    steps = np.diff(places, axis=1)
    steps = steps[:, (steps != 0).any(axis=0)]
    numbers = " ".join(map(str, steps.T.ravel().tolist())).replace(" -", "-")
    return f"M{places[0, 0]} {places[1, 0]}" + (f"l{numbers}" if numbers else "h0")


def _curve(curve: Curve, box: Box, key: str) -> Iterator[str]:
    if curve.band is not None:
        yield f'<path class="area {curve.role}" d="{_area(curve, curve.band, box)}"/>'
    parts = ((box.across(x), np.clip(box.down(y), -1e4, 1e4)) for x, y in _segments(curve))
    steps = "".join(_path(*inside) for part in parts for inside in _inside(*part, box))
    if steps:
        look = f'stroke-width="{FINE * curve.width:g}"'
        if curve.dashed:
            look += f' stroke-dasharray="{4 * FINE} {2.5 * FINE:g}"'
        yield f'<path class="curve {curve.role}"{key} {look} transform="scale({1 / FINE})" d="{steps}"/>'


def _area(curve: Curve, half: Real, box: Box) -> str:
    """Return the outline of the band about a curve."""
    edges = [np.clip(box.down(curve.y + sign * half), box.top, box.bottom) for sign in (1, -1)]
    across = box.across(curve.x)
    corners = [*zip(across, edges[0], strict=True), *zip(across[::-1], edges[1][::-1], strict=True)]
    return f"M{'L'.join(f'{x:.1f} {y:.1f}' for x, y in corners)}Z"


def _points(points: Points, box: Box, key: str) -> Iterator[str]:
    across, down = box.across(points.x), box.down(points.y)
    inside = np.isfinite(across) & np.isfinite(down) & (down > box.top - 1) & (down < box.bottom + 1)
    if points.bars is not None:
        ends = [np.clip(box.down(points.y + sign * points.bars), box.top, box.bottom) for sign in (1, -1)]
        bars = "".join(
            f"M{x:.1f} {low:.1f}V{high:.1f}"
            for x, low, high in zip(across[inside], *(end[inside] for end in ends), strict=True)
        )
        yield f'<path class="bars {points.role}" d="{bars}"/>'
    # A line of length zero with round ends is a dot, in a tenth of the characters of a circle.
    dots = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in zip(across[inside], down[inside], strict=True))
    if dots:
        yield f'<path class="points {points.role}"{key} stroke-width="{4.4 * points.size:.2g}" d="{dots}"/>'
        if points.hollow:
            yield f'<path class="points paper"{key} stroke-width="{2.4 * points.size:.2g}" d="{dots}"/>'
