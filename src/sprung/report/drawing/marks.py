"""Curves, points, lines and shades of one panel as SVG elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Band, Curve, Mark, Points, Rule
from sprung.report.pictures.lanes import thinned

Real = NDArray[np.float64]

BINS = 400
"""Stretches into which a curve is parted across a panel: nobody sees more."""

FINE = 10
"""Steps of a unit in which curves are drawn."""


@dataclass(frozen=True)
class Box:
    """Where a panel is.

    Attributes
    ----------
    left, top, width, height
        Units of the picture.
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
        """Place values of the horizontal axis, units."""
        return self.left + self.width * self.x.at(values)

    def down(self, values: Real) -> Real:
        """Place values of the vertical axis, units."""
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
        What is drawn.
    box
        The panel.
    number
        Place of the curve or points among those of its panel, where a script may draw them again; None where none does.

    Yields
    ------
    str
        SVG elements.
    """
    again = number is not None
    match mark:
        case Curve():
            steps = "".join(_path(part, box) for part in _stretches(mark))
            if steps:
                look = f'stroke-width="{FINE * mark.width:g}"'
                if mark.dashed:
                    look += f' stroke-dasharray="{4 * FINE} {2.5 * FINE:g}"'
                key = f' data-curve="{number}"' if again else ""
                yield f'<path class="curve {mark.role}"{key} {look} transform="scale({1 / FINE})" d="{steps}"/>'
        case Points():
            yield from _points(mark, box, f' data-curve="{number}"' if again else "")
        case Rule(lying=True):
            y = float(box.down(np.array(mark.at)))
            if box.top - 1 <= y <= box.bottom + 1:
                dashes = " dashed" if mark.dashed else ""
                yield f'<path class="rule {mark.role}{dashes}" d="M{box.left:.1f} {y:.1f}h{box.width:.1f}"/>'
        case Rule():
            if 0 <= (part := float(box.x.at(np.array(mark.at)))) <= 1:
                dashes, key = " dashed" if mark.dashed else "", f' data-x="{mark.at:.9g}"' if again else ""
                x = box.left + box.width * part
                yield f'<path class="rule {mark.role}{dashes}"{key} d="M{x:.1f} {box.top:.1f}v{box.height:.1f}"/>'
        case Band():
            ends = np.sort(np.clip(box.x.at(np.array([mark.low, mark.high])), 0, 1))
            low, high = (box.left + box.width * ends).tolist()
            key = f' data-low="{mark.low:.9g}" data-high="{mark.high:.9g}"' if again else ""
            place = f'x="{low:.1f}" y="{box.top:.1f}" width="{high - low:.1f}" height="{box.height:.1f}"'
            yield f'<rect class="band"{key} {place}/>'


def _stretches(curve: Curve) -> Iterator[tuple[Real, Real]]:
    """Give the parts of a curve between its gaps, each thinned to what can be seen."""
    there = np.isfinite(curve.x) & np.isfinite(curve.y)
    for part in np.split(np.arange(there.size), np.flatnonzero(np.diff(there)) + 1):
        if part.size > 1 and there[part[0]]:
            shown = part[thinned(curve.y[part], BINS)]
            yield curve.x[shown], curve.y[shown]


def _path(part: tuple[Real, Real], box: Box) -> str:
    """Write a polyline in steps of a fraction of a unit, each from the one before."""
    across, down = (FINE * box.across(part[0])).round(), (FINE * np.clip(box.down(part[1]), -1e4, 1e4)).round()
    places = np.stack([across, down]).astype(int)
    steps = np.diff(places, axis=1)
    steps = steps[:, (steps != 0).any(axis=0)]
    numbers = " ".join(map(str, steps.T.ravel().tolist())).replace(" -", "-")
    return f"M{places[0, 0]} {places[1, 0]}" + (f"l{numbers}" if numbers else "h0")


def _points(points: Points, box: Box, key: str) -> Iterator[str]:
    across, down = box.across(points.x), box.down(points.y)
    inside = np.isfinite(across) & np.isfinite(down) & (down > box.top - 1) & (down < box.bottom + 1)
    if points.bars is not None:
        ends = [np.clip(box.down(points.y + way * points.bars), box.top, box.bottom) for way in (1, -1)]
        bars = "".join(
            f"M{x:.1f} {low:.1f}V{high:.1f}"
            for x, low, high in zip(across[inside], *(end[inside] for end in ends), strict=True)
        )
        yield f'<path class="bars {points.role}" d="{bars}"/>'
    # A line of no length with round ends is a point, and a tenth of what a circle takes.
    dots = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in zip(across[inside], down[inside], strict=True))
    if dots:
        yield f'<path class="points {points.role}"{key} stroke-width="{4.4 * points.size:.2g}" d="{dots}"/>'
        if points.hollow:
            yield f'<path class="points paper"{key} stroke-width="{2.4 * points.size:.2g}" d="{dots}"/>'
