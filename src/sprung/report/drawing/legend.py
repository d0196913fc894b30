"""Legend of a picture and labels of its vertical lines, above the first panel."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.marks import Box
from sprung.report.drawing.picture import Curve, Picture, Points, Rule
from sprung.tables import escaped

WIDTH = 440
"""Width of a picture, units: small enough for a telephone, and for two beside each other on a wide screen."""

RIGHT = 8.0
"""Margin right of the panels, units."""

LINE = 13.0
"""Line spacing of labels, units."""

LETTER = 5.6
"""Mean width of a letter of a label, units."""


def legend_rows(picture: Picture, left: float) -> Iterator[list[tuple[float, Curve | Points]]]:
    """Yield the rows of the legend, each entry with its distance from the left, units."""
    row: list[tuple[float, Curve | Points]] = []
    x = left
    for mark in picture.legend:
        width = 24 + LETTER * len(mark.label) + 10
        if row and x + width > WIDTH:
            yield row
            row, x = [], left
        row.append((x, mark))
        x += width
    if row:
        yield row


def draw_legend(rows: list[list[tuple[float, Curve | Points]]]) -> Iterator[str]:
    """Draw the rows of a legend."""
    for line, row in enumerate(rows):
        y = 10 + LINE * line
        for x, mark in row:
            if isinstance(mark, Curve):
                dashes = " dashed" if mark.dashed else ""
                yield f'<path class="curve {mark.role}{dashes}" stroke-width="{mark.width:g}" d="M{x:.0f} {y - 3:.0f}h18"/>'
            else:
                dot = f'd="M{x + 9:.0f} {y - 3:.0f}h0"'
                yield f'<path class="points {mark.role}" stroke-width="{4.4 * mark.size:.2g}" {dot}/>'
                if mark.hollow:
                    yield f'<path class="points paper" stroke-width="{2.4 * mark.size:.2g}" {dot}/>'
            yield f'<text class="tick" x="{x + 23:.0f}" y="{y:.0f}">{escaped(mark.label)}</text>'


def label_levels(labels: list[Rule], axis: Axis, width: float) -> list[int]:
    """Return the line above the panels for each label, 0 for the lowest, such that no labels overlap."""
    order = sorted(range(len(labels)), key=lambda i: float(axis.at(np.array(labels[i].at))))
    ends: list[float] = []
    levels = [0] * len(labels)
    for i in order:
        half = LETTER * len(labels[i].label) / 2 + 2
        middle = _kept_inside(float(axis.at(np.array(labels[i].at))) * width, half, width)
        level = next((level for level, end in enumerate(ends) if middle - half > end), len(ends))
        ends[level : level + 1] = [middle + half]
        levels[i] = level
    return levels


def stack_labels(labels: list[Rule], axis: Axis, width: float) -> Iterator[tuple[Rule, float, int]]:
    """Yield every label with its place above the panels, such that none overlap.

    Parameters
    ----------
    labels
        Vertical lines, each with a label.
    axis
        The horizontal axis.
    width
        Of the panels, units of `LETTER`.

    Yields
    ------
    mark : Rule
        The line with its label.
    middle : float
        Of the label along the axis, dimensionless, 0 to 1.
    level : int
        Its line above the panels, 0 for the lowest.
    """
    for mark, level in zip(labels, label_levels(labels, axis, width), strict=True):
        place = float(axis.at(np.array(mark.at)))
        if 0 <= place <= 1:
            yield mark, _kept_inside(place * width, LETTER * len(mark.label) / 2, width) / width, level


def _kept_inside(middle: float, half: float, width: float) -> float:
    """Return the middle of a label, moved so far that the label is within the picture."""
    return min(max(middle, half), width + RIGHT - half)


def draw_rule_labels(labels: list[Rule], levels: list[int], box: Box, zoomable: bool = False) -> Iterator[str]:
    """Draw the labels above the first panel; the lines of the upper ones are behind the lower ones."""
    texts = []
    for mark, level in zip(labels, levels, strict=True):
        place = float(box.x.at(np.array(mark.at))) * box.width
        if not 0 <= place <= box.width:
            continue
        half, key = LETTER * len(mark.label) / 2, f' data-x="{mark.at:.9g}"' if zoomable else ""
        x, y = box.left + _kept_inside(place, half, box.width), box.top - 5 - LINE * level
        if level:
            yield f'<path class="rule {mark.role}"{key} d="M{box.left + place:.1f} {box.top:.1f}V{y + 3:.1f}"/>'
        texts.append(
            f'<text class="tick {mark.role}"{key} x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{escaped(mark.label)}</text>'
        )
    yield from texts
