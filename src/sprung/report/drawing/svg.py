"""A picture as SVG text: small, without anything but shapes and words, its colours left to the page's style."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.legend import LETTER, LINE, RIGHT, WIDTH, label_levels, legend, legend_rows, rule_labels
from sprung.report.drawing.marks import Box, mark_elements
from sprung.report.drawing.picture import Curve, Panel, Picture, Points, Rule
from sprung.tables import escaped

_HEIGHT = 96.0
"""Of a panel of height 1."""

_LEFT, _BELOW, _GAP = 58.0, 34.0, 9.0
"""Units left of the panels, below the last, and between panels."""

_MOST, _LEAST = 280.0, 0.5
"""Height of a picture on paper, units, and part of their height that its panels keep at the least."""

_NAME = 18
"""Letters of a name that are shown."""

_NUMBER = 9.0
"""Height of a number beside an axis, units."""

_NARROW = 5.0
"""Width of a letter, on average, of a label beside a panel that is too low for the usual ones."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the parts of a picture are, in a frame `WIDTH` units wide.

    Attributes
    ----------
    rows
        Of the legend: its entries, each with its place.
    labels, levels
        Lines with a label above the first panel, and on which line of words each label stands.
    boxes
        Of the panels, the first on top.
    """

    rows: list[list[tuple[float, Curve | Points]]]
    labels: list[Rule]
    levels: list[int]
    boxes: tuple[Box, ...]

    @property
    def height(self) -> float:
        """Of the frame, units."""
        return self.boxes[-1].bottom + _BELOW


def layout_of(picture: Picture) -> Layout:
    """Lay out a picture.

    Parameters
    ----------
    picture
        What it shows.
    """
    longest = max((len(panel.name[:_NAME]) for panel in picture.panels), default=0)
    left = max(_LEFT, 34 + longest * LETTER) if longest else _LEFT
    rows = list(legend_rows(picture, left))
    labels = [mark for mark in picture.panels[0].marks if isinstance(mark, Rule) and mark.label and not mark.lying]
    width = WIDTH - left - RIGHT
    levels = label_levels(labels, picture.x, width)
    top = 4 + LINE * len(rows) + LINE * (max(levels, default=-1) + 1) + (4 if rows or labels else 2)
    boxes = []
    for panel in picture.panels:
        boxes.append(Box(left, top, width, _HEIGHT * panel.height, picture.x, panel.y))
        top += _HEIGHT * panel.height + (_GAP if not panel.name else 0)
    return Layout(rows, labels, levels, tuple(boxes))


def lower(picture: Picture) -> Picture:
    """Return a picture whose panels are as low as paper needs it: three of its height fit on a page.

    Parameters
    ----------
    picture
        What it shows.
    """
    excess = layout_of(picture).height - _MOST
    panels = sum(panel.height for panel in picture.panels) * _HEIGHT
    factor = max(1 - excess / panels, _LEAST) if excess > 0 else 1.0
    return replace(picture, panels=tuple(replace(panel, height=factor * panel.height) for panel in picture.panels))


def svg_of(picture: Picture, style: str = "") -> str:
    """Draw a picture.

    Parameters
    ----------
    picture
        What it shows.
    style
        Rules of style to go with it, for where those of a page do not reach.

    Returns
    -------
    str
        An ``svg`` element; the same for the same picture.
    """
    parts, height = drawn(picture)
    title = f"<title>{escaped(picture.title)}</title>"
    told = f"<desc>{escaped(picture.told)}</desc>" if picture.told else ""
    return (
        f'<svg class="picture" viewBox="0 0 {WIDTH} {height:.0f}" role="img" aria-label="{escaped(picture.title)}">'
        f"{title}{told}{style}{parts}</svg>"
    )


def drawn(picture: Picture) -> tuple[str, float]:
    """Draw what is in a picture.

    Parameters
    ----------
    picture
        What it shows.

    Returns
    -------
    parts
        SVG elements in a frame `WIDTH` units wide.
    height
        Of the frame, units.
    """
    layout = layout_of(picture)
    parts = [*legend(layout.rows)]
    for panel, box in zip(picture.panels, layout.boxes, strict=True):
        inside = "".join(_panel(panel, box, picture.zoomable))
        parts.append(f'<g class="panel">{inside}</g>' if picture.zoomable else inside)
    parts += rule_labels(layout.labels, layout.levels, layout.boxes[0], picture.zoomable)
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
    notes = [(text, kind) for text, kind in ((panel.note, "note"), (panel.wrong, "note wrong")) if text]
    for line, (text, kind) in enumerate(notes):
        place = f'x="{WIDTH - RIGHT - 2:.0f}" y="{box.top + 10 + 11 * line:.1f}" text-anchor="end"'
        yield f'<text class="{kind}" {place}>{escaped(text)}</text>'


def _ticks(panel: Panel, box: Box) -> Iterator[str]:
    # Numbers keep clear of each other, and of those of the next panel where panels touch.
    inside = 4.5 if panel.name else -1.0
    last = np.inf
    for value, text in panel.y.marked:
        y = float(box.down(np.array(value)))
        yield f'<path class="grid" d="M{box.left:.0f} {y:.1f}h{box.width:.0f}"/>'
        if not box.top + inside <= y <= box.bottom - inside or abs(last - y) < _NUMBER:
            continue
        last = y
        yield f'<text class="tick" x="{box.left - 4:.0f}" y="{y + 3:.1f}" text-anchor="end">{escaped(text)}</text>'


def _label(panel: Panel, box: Box) -> Iterator[str]:
    """Write what a panel shows beside it: its name and unit one below the other, or the label of its axis, turned."""
    middle = box.top + box.height / 2
    if panel.name:
        name = panel.name if len(panel.name) <= _NAME else f"{panel.name[: _NAME - 1]}…"
        yield f'<text class="name" x="2" y="{middle + (-1 if panel.y.label else 3):.1f}">{escaped(name)}</text>'
        if panel.y.label:
            yield f'<text class="tick" x="2" y="{middle + 10:.1f}">{escaped(panel.y.label)}</text>'
    elif panel.y.label:
        # Beside a low panel what is shown and its unit stand in two lines, so that neither reaches into the next one.
        whole = len(panel.y.label) * _NARROW <= box.height + _GAP
        lines = [panel.y.label] if whole else panel.y.label.split(", ", 1)
        for place, line in zip((10, 21), lines, strict=False):
            turned = f'transform="translate({place} {middle:.1f}) rotate(-90)" text-anchor="middle"'
            yield f'<text class="label" {turned}>{escaped(line)}</text>'


def _across(axis: Axis, last: Box) -> Iterator[str]:
    yield f'<path class="frame" d="M{last.left:.0f} {last.bottom:.1f}h{last.width:.0f}"/>'
    for value, text in axis.marked:
        x = float(last.across(np.array(value)))
        yield f'<path class="frame" d="M{x:.1f} {last.bottom:.1f}v3"/>'
        yield f'<text class="tick" x="{x:.1f}" y="{last.bottom + 13:.1f}" text-anchor="middle">{escaped(text)}</text>'
    place = f'x="{last.left + last.width / 2:.0f}" y="{last.bottom + 27:.1f}" text-anchor="middle"'
    yield f'<text class="label" {place}>{escaped(axis.label)}</text>'
