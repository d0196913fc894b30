"""A picture as SVG text: small, without anything but shapes and words, its colours left to the page's style."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.report.axis import Axis
from sprung.report.lanes import thinned
from sprung.report.picture import Band, Curve, Mark, Panel, Picture, Points, Rule
from sprung.tables import escaped

Real = NDArray[np.float64]

WIDTH = 440
"""Units across a picture: so few that it can be read on a telephone, and two stand beside each other on a desk."""

_HEIGHT = 96.0
"""Of a panel of height 1."""

_LEFT, _RIGHT, _BELOW, _LINE, _GAP = 52.0, 8.0, 34.0, 13.0, 9.0
"""Left and right of the panels, below the last; from line to line of words; between panels."""

_LETTER = 5.6
"""Width of a letter, on average, at the size of labels."""

_BINS = 400
"""Stretches into which a curve is parted across a panel: nobody sees more."""

_FINE = 10
"""Steps of a unit in which curves are drawn."""

_NAME = 18
"""Letters of a name that are shown."""


@dataclass(frozen=True)
class _Box:
    """Where a panel is, in units."""

    left: float
    top: float
    width: float
    height: float
    x: Axis
    y: Axis

    def across(self, values: Real) -> Real:
        return self.left + self.width * self.x.at(values)

    def down(self, values: Real) -> Real:
        return self.top + self.height * (1 - self.y.at(values))

    @property
    def bottom(self) -> float:
        return self.top + self.height


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
    longest = max((len(panel.name[:_NAME]) for panel in picture.panels), default=0)
    left = max(_LEFT, 34 + longest * _LETTER)
    rows = list(_legend_rows(picture, left))
    labels = [mark for mark in picture.panels[0].marks if isinstance(mark, Rule) and mark.label and not mark.lying]
    box_width = WIDTH - left - _RIGHT
    levels = _levels(labels, picture.x, box_width)
    top = 4 + _LINE * len(rows) + _LINE * (max(levels, default=-1) + 1) + (4 if rows or labels else 2)
    parts, boxes = [*_legend(rows)], []
    for panel in picture.panels:
        boxes.append(_Box(left, top, box_width, _HEIGHT * panel.height, picture.x, panel.y))
        top += _HEIGHT * panel.height + (_GAP if not panel.name else 0)
    for panel, box in zip(picture.panels, boxes, strict=True):
        parts += _panel(panel, box)
    parts += _rule_labels(labels, levels, boxes[0])
    parts += _across(picture.x, boxes)
    return "".join(parts), boxes[-1].bottom + _BELOW


def _panel(panel: Panel, box: _Box) -> Iterator[str]:
    for value, text in panel.y.marked:
        y = float(box.down(np.array(value)))
        yield f'<path class="grid" d="M{box.left:.0f} {y:.1f}h{box.width:.0f}"/>'
        yield f'<text class="tick" x="{box.left - 4:.0f}" y="{y + 3:.1f}" text-anchor="end">{escaped(text)}</text>'
    for mark in panel.marks:
        yield from _mark(mark, box)
    yield f'<path class="frame" d="M{box.left:.0f} {box.top:.1f}v{box.height:.1f}"/>'
    middle = box.top + box.height / 2
    if panel.name:
        name = panel.name if len(panel.name) <= _NAME else f"{panel.name[: _NAME - 1]}…"
        yield f'<text class="name" x="2" y="{middle + 3:.1f}">{escaped(name)}</text>'
    elif panel.y.label:
        turned = f'transform="translate(10 {middle:.1f}) rotate(-90)" text-anchor="middle"'
        yield f'<text class="label" {turned}>{escaped(panel.y.label)}</text>'
    notes = [(text, kind) for text, kind in ((panel.note, "note"), (panel.wrong, "note wrong")) if text]
    for line, (text, kind) in enumerate(notes):
        place = f'x="{WIDTH - _RIGHT - 2:.0f}" y="{box.top + 10 + 11 * line:.1f}" text-anchor="end"'
        yield f'<text class="{kind}" {place}>{escaped(text)}</text>'


def _mark(mark: Mark, box: _Box) -> Iterator[str]:
    match mark:
        case Curve():
            steps = "".join(_path(part, box) for part in _stretches(mark))
            if steps:
                look = f'stroke-width="{_FINE * mark.width:g}"'
                if mark.dashed:
                    look += f' stroke-dasharray="{4 * _FINE} {2.5 * _FINE:g}"'
                yield f'<path class="curve {mark.role}" {look} transform="scale({1 / _FINE})" d="{steps}"/>'
        case Points():
            yield from _points(mark, box)
        case Rule(lying=True):
            y = float(box.down(np.array(mark.at)))
            if box.top - 1 <= y <= box.bottom + 1:
                dashes = " dashed" if mark.dashed else ""
                yield f'<path class="rule {mark.role}{dashes}" d="M{box.left:.1f} {y:.1f}h{box.width:.1f}"/>'
        case Rule():
            if 0 <= (part := float(box.x.at(np.array(mark.at)))) <= 1:
                dashes = " dashed" if mark.dashed else ""
                x = box.left + box.width * part
                yield f'<path class="rule {mark.role}{dashes}" d="M{x:.1f} {box.top:.1f}v{box.height:.1f}"/>'
        case Band():
            low, high = (box.left + box.width * np.clip(box.x.at(np.array([mark.low, mark.high])), 0, 1)).tolist()
            place = f'x="{low:.1f}" y="{box.top:.1f}" width="{high - low:.1f}" height="{box.height:.1f}"'
            yield f'<rect class="band" {place}/>'


def _stretches(curve: Curve) -> Iterator[tuple[Real, Real]]:
    """Give the parts of a curve between its gaps, each thinned to what can be seen."""
    there = np.isfinite(curve.x) & np.isfinite(curve.y)
    for part in np.split(np.arange(there.size), np.flatnonzero(np.diff(there)) + 1):
        if part.size > 1 and there[part[0]]:
            shown = part[thinned(curve.y[part], _BINS)]
            yield curve.x[shown], curve.y[shown]


def _path(part: tuple[Real, Real], box: _Box) -> str:
    """Write a polyline in steps of a fraction of a unit, each from the one before."""
    across, down = (_FINE * box.across(part[0])).round(), (_FINE * np.clip(box.down(part[1]), -1e4, 1e4)).round()
    places = np.stack([across, down]).astype(int)
    steps = np.diff(places, axis=1)
    steps = steps[:, (steps != 0).any(axis=0)]
    numbers = " ".join(map(str, steps.T.ravel().tolist())).replace(" -", "-")
    return f"M{places[0, 0]} {places[1, 0]}" + (f"l{numbers}" if numbers else "h0")


def _points(points: Points, box: _Box) -> Iterator[str]:
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
        yield f'<path class="points {points.role}" stroke-width="{4.4 * points.size:.2g}" d="{dots}"/>'
        if points.hollow:
            yield f'<path class="points paper" stroke-width="{2.4 * points.size:.2g}" d="{dots}"/>'


def _across(axis: Axis, boxes: list[_Box]) -> Iterator[str]:
    last = boxes[-1]
    yield f'<path class="frame" d="M{last.left:.0f} {last.bottom:.1f}h{last.width:.0f}"/>'
    for value, text in axis.marked:
        x = float(last.across(np.array(value)))
        yield f'<path class="frame" d="M{x:.1f} {last.bottom:.1f}v3"/>'
        yield f'<text class="tick" x="{x:.1f}" y="{last.bottom + 13:.1f}" text-anchor="middle">{escaped(text)}</text>'
    place = f'x="{last.left + last.width / 2:.0f}" y="{last.bottom + 27:.1f}" text-anchor="middle"'
    yield f'<text class="label" {place}>{escaped(axis.label)}</text>'


def _legend_rows(picture: Picture, left: float) -> Iterator[list[tuple[float, Curve | Points]]]:
    """Part the legend into rows that fit, each entry with its place."""
    row: list[tuple[float, Curve | Points]] = []
    x = left
    for mark in picture.legend:
        width = 24 + _LETTER * len(mark.label) + 10
        if row and x + width > WIDTH:
            yield row
            row, x = [], left
        row.append((x, mark))
        x += width
    if row:
        yield row


def _legend(rows: list[list[tuple[float, Curve | Points]]]) -> Iterator[str]:
    for line, row in enumerate(rows):
        y = 10 + _LINE * line
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


def _levels(labels: list[Rule], axis: Axis, width: float) -> list[int]:
    """Say on which line above the panels each label stands, so that none lies on another: 0 for the lowest."""
    order = sorted(range(len(labels)), key=lambda i: float(axis.at(np.array(labels[i].at))))
    ends: list[float] = []
    levels = [0] * len(labels)
    for i in order:
        half = _LETTER * len(labels[i].label) / 2 + 2
        middle = _held(float(axis.at(np.array(labels[i].at))) * width, half, width)
        level = next((level for level, end in enumerate(ends) if middle - half > end), len(ends))
        ends[level : level + 1] = [middle + half]
        levels[i] = level
    return levels


def _held(middle: float, half: float, width: float) -> float:
    """Move a label so that it does not stand out of the picture."""
    return min(max(middle, half), width + _RIGHT - half)


def _rule_labels(labels: list[Rule], levels: list[int], box: _Box) -> Iterator[str]:
    """Write the labels above the first panel; lines from the higher ones go behind the lower ones."""
    words = []
    for mark, level in zip(labels, levels, strict=True):
        place = float(box.x.at(np.array(mark.at))) * box.width
        if not 0 <= place <= box.width:
            continue
        half = _LETTER * len(mark.label) / 2
        x, y = box.left + _held(place, half, box.width), box.top - 5 - _LINE * level
        if level:
            yield f'<path class="rule {mark.role}" d="M{box.left + place:.1f} {box.top:.1f}V{y + 3:.1f}"/>'
        words.append(
            f'<text class="tick {mark.role}" x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{escaped(mark.label)}</text>'
        )
    yield from words
