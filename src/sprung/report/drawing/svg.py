"""Pictures as SVG text; colours come from the style of the page."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.elements import svg_element
from sprung.report.drawing.legend import (
    LETTER,
    LINE,
    RIGHT,
    WIDTH,
    draw_legend,
    draw_rule_labels,
    label_levels,
    legend_rows,
)
from sprung.report.drawing.marks import Box, mark_elements
from sprung.report.drawing.picture import Curve, Panel, Picture, Points, Rule
from sprung.tables import escaped

_HEIGHT = 96.0
"""Height of a panel of relative height 1, units."""

_LEFT, _BELOW, _GAP = 58.0, 34.0, 9.0
"""Margins left of the panels and below the last one, and gap between panels, units."""

_MOST, _LEAST = 280.0, 0.5
"""Largest height of a picture on paper, units, and smallest part of their height that its panels keep."""

_NAME = 18
"""Letters of a name that are shown at most."""

_NUMBER = 9.0
"""Height of a number beside an axis, units."""

_NARROW = 5.0
"""Mean width of a letter of a note, or of the label beside a low panel, units."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions of the parts of a picture, in a frame `WIDTH` units wide.

    Attributes
    ----------
    rows
        Rows of the legend: entries with their positions.
    labels, levels
        Vertical lines with a label above the first panel, and the text line of each label.
    boxes
        Of the panels, from the top.
    """

    rows: list[list[tuple[float, Curve | Points]]]
    labels: list[Rule]
    levels: list[int]
    boxes: tuple[Box, ...]

    @property
    def height(self) -> float:
        """Height of the frame, units."""
        return self.boxes[-1].bottom + _BELOW


def layout_of(picture: Picture) -> Layout:
    """Return the layout of a picture.

    Parameters
    ----------
    picture
        Any.
    """
    longest = max((len(panel.name[:_NAME]) for panel in picture.panels), default=0)
    left = max(_LEFT, 34 + longest * LETTER) if longest else _LEFT
    rows = list(legend_rows(picture, left))
    labels = [mark for mark in picture.panels[0].marks if isinstance(mark, Rule) and mark.label and not mark.horizontal]
    width = WIDTH - left - RIGHT
    levels = label_levels(labels, picture.x, width)
    top = 4 + LINE * len(rows) + LINE * (max(levels, default=-1) + 1) + (4 if rows or labels else 2)
    boxes = []
    for panel in picture.panels:
        boxes.append(Box(left, top, width, _HEIGHT * panel.height, picture.x, panel.y))
        top += _HEIGHT * panel.height + (_GAP if not panel.name else 0)
    return Layout(rows, labels, levels, tuple(boxes))


def reduce_height(picture: Picture) -> Picture:
    """Return a picture with panels so low that three pictures fit on a page.

    Parameters
    ----------
    picture
        Any.
    """
    excess = layout_of(picture).height - _MOST
    panels = sum(panel.height for panel in picture.panels) * _HEIGHT
    factor = max(1 - excess / panels, _LEAST) if excess > 0 else 1.0
    return replace(picture, panels=tuple(replace(panel, height=factor * panel.height) for panel in picture.panels))


def picture_svg(picture: Picture, style: str = "") -> str:
    """Return a picture as an SVG element.

    Parameters
    ----------
    picture
        Any.
    style
        Style element to include, where the style of a page does not apply.

    Returns
    -------
    str
        An ``svg`` element; identical for identical pictures.
    """
    content, height = draw_content(picture)
    return svg_element("picture", (WIDTH, height), picture.title, picture.description, style + content)


def picture_frame(picture: Picture) -> dict[str, float]:
    """Return where the panels of a picture and its horizontal axis lie, for a script that adds marks to its SVG element.

    Parameters
    ----------
    picture
        Any.

    Returns
    -------
    dict
        ``left``, ``width``, ``top`` and ``bottom`` of the panels in units of the drawing; ``low`` and ``high``, the limits of
        the axis in its own unit.
    """
    boxes, axis = layout_of(picture).boxes, picture.x
    first = boxes[0]
    return {
        "left": first.left,
        "width": first.width,
        "top": first.top,
        "bottom": boxes[-1].bottom,
        "low": axis.low,
        "high": axis.high,
    }


def draw_content(picture: Picture) -> tuple[str, float]:
    """Return the content of a picture as SVG elements.

    Parameters
    ----------
    picture
        Any.

    Returns
    -------
    parts
        SVG elements in a frame `WIDTH` units wide.
    height
        Of the frame, units.
    """
    layout = layout_of(picture)
    parts = [*draw_legend(layout.rows)]
    for panel, box in zip(picture.panels, layout.boxes, strict=True):
        inside = "".join(_panel(panel, box, picture.zoomable))
        parts.append(f'<g class="panel">{inside}</g>' if picture.zoomable else inside)
    parts += draw_rule_labels(layout.labels, layout.levels, layout.boxes[0], picture.zoomable)
    across = "".join(_across(picture.x, layout.boxes[-1]))
    parts.append(f'<g class="across">{across}</g>' if picture.zoomable else across)
    return "".join(parts), layout.height


def _panel(panel: Panel, box: Box, zoomable: bool) -> Iterator[str]:
    ticks = "".join(_ticks(panel, box))
    yield f'<g class="ticks">{ticks}</g>' if zoomable else ticks
    number = 0
    for mark in panel.marks:
        yield from mark_elements(mark, box, number if zoomable else None)
        number += isinstance(mark, Curve | Points)
    yield f'<path class="frame" d="M{box.left:.0f} {box.top:.1f}v{box.height:.1f}"/>'
    yield from _label(panel, box)
    notes = [(text, kind) for text, kind in ((panel.note, "note"), (panel.warning, "note wrong")) if text]
    for line, (text, kind) in enumerate(notes):
        right, base, width = WIDTH - RIGHT - 2, box.top + 10 + 11 * line, _NARROW * len(text) + 3
        ground = f'x="{right - width + 1:.0f}" y="{base - 9:.1f}" width="{width:.0f}" height="12"'
        yield f'<rect class="ground" {ground}/>'
        place = f'x="{right:.0f}" y="{base:.1f}" text-anchor="end"'
        yield f'<text class="{kind}" {place}>{escaped(text)}</text>'


def _ticks(panel: Panel, box: Box) -> Iterator[str]:
    # Labels must not overlap each other, nor those of the next panel where panels touch.
    inside = 4.5 if panel.name else -1.0
    last = np.inf
    for value, text in panel.y.all_ticks:
        y = float(box.down(np.array(value)))
        yield f'<path class="grid" d="M{box.left:.0f} {y:.1f}h{box.width:.0f}"/>'
        if not box.top + inside <= y <= box.bottom - inside or abs(last - y) < _NUMBER:
            continue
        last = y
        yield f'<text class="tick" x="{box.left - 4:.0f}" y="{y + 3:.1f}" text-anchor="end">{escaped(text)}</text>'


def _label(panel: Panel, box: Box) -> Iterator[str]:
    """Draw the name and unit left of a panel, or the label of its axis, rotated."""
    middle = box.top + box.height / 2
    if panel.name:
        name = panel.name if len(panel.name) <= _NAME else f"{panel.name[: _NAME - 1]}…"
        yield f'<text class="name" x="2" y="{middle + (-1 if panel.y.label else 3):.1f}">{escaped(name)}</text>'
        if panel.y.label:
            yield f'<text class="tick" x="2" y="{middle + 10:.1f}">{escaped(panel.y.label)}</text>'
    elif panel.y.label:
        # Beside a low panel quantity and unit are on two lines, so that neither extends into the next panel.
        whole = len(panel.y.label) * _NARROW <= box.height + _GAP
        lines = [panel.y.label] if whole else panel.y.label.split(", ", 1)
        for place, line in zip((10, 21), lines, strict=False):
            rotated = f'transform="translate({place} {middle:.1f}) rotate(-90)" text-anchor="middle"'
            yield f'<text class="label" {rotated}>{escaped(line)}</text>'


def _across(axis: Axis, last: Box) -> Iterator[str]:
    yield f'<path class="frame" d="M{last.left:.0f} {last.bottom:.1f}h{last.width:.0f}"/>'
    for value, text in axis.all_ticks:
        x = float(last.across(np.array(value)))
        yield f'<path class="frame" d="M{x:.1f} {last.bottom:.1f}v3"/>'
        yield f'<text class="tick" x="{x:.1f}" y="{last.bottom + 13:.1f}" text-anchor="middle">{escaped(text)}</text>'
    place = f'x="{last.left + last.width / 2:.0f}" y="{last.bottom + 27:.1f}" text-anchor="middle"'
    yield f'<text class="label" {place}>{escaped(axis.label)}</text>'
