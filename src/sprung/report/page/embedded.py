"""What a figure shows, as data beside its drawing: from it a page's script zooms, reads out and saves the figure.

Every column is kept in steps of a fraction of its own span, as differences from sample to sample in 32 bits, whose bytes are
put together by their significance, which deflate packs several times tighter than as they come.
"""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Curve, Picture, Points
from sprung.report.drawing.svg import layout_of

Real = NDArray[np.float64]

_FINE, _COARSE = 2**24, 2**15
"""Steps in the span of a column; the coarse ones of the many samples of recordings and fits, which hold noise."""

_GAP = -1
"""What stands for a value that is none."""


@dataclass(frozen=True, eq=False)
class _Column:
    """Values in whole steps from a lowest one, or of their logarithms."""

    steps: NDArray[np.int64]
    low: float
    step: float
    log: bool

    @property
    def told(self) -> dict[str, Any]:
        return {"n": self.steps.size, "low": self.low, "step": self.step, "log": self.log}


def figure_json(picture: Picture) -> str:
    """Write what a figure shows as JSON that may stand in an HTML page.

    Parameters
    ----------
    picture
        What it shows.

    Returns
    -------
    str
        Axes, panels with their places in the drawing, curves as numbers of columns, and the columns, packed.
    """
    columns: list[_Column] = []
    known: dict[bytes, int] = {}

    def place_of(values: Real, axis: Axis, across: bool) -> int:
        key = np.ascontiguousarray(values, dtype=float).tobytes() + bytes([across])
        if key not in known:
            known[key] = len(columns)
            steps = _FINE if across or not picture.zoomable else _COARSE
            columns.append(_column(np.asarray(values, dtype=float), axis.log, steps, across))
        return known[key]

    layout, panels = layout_of(picture), []
    for panel, box in zip(picture.panels, layout.boxes, strict=True):
        curves = []
        for mark in panel.marks:
            if isinstance(mark, Curve | Points):
                curve: dict[str, Any] = {
                    "name": mark.label,
                    "x": place_of(mark.x, picture.x, True),
                    "y": place_of(mark.y, panel.y, False),
                }
                if isinstance(mark, Points):
                    curve["points"] = True
                    if mark.bars is not None:
                        curve["bars"] = place_of(mark.bars, Axis("", 0, 1), False)
                curves.append(curve)
        place = [round(value, 1) for value in (box.left, box.top, box.width, box.height)]
        unit = panel.y.label.rpartition(", ")[2] if panel.channel else panel.y.label
        named = ", ".join(part for part in (panel.channel or panel.note, unit) if part)
        panels.append(
            {
                "name": named,
                "channel": panel.channel,
                "lane": bool(panel.name),
                "box": place,
                "y": _axis(panel.y),
                "curves": curves,
            }
        )
    document = {
        "title": picture.title,
        "zoomable": picture.zoomable,
        "x": _axis(picture.x),
        "panels": panels,
        "columns": [column.told for column in columns],
        "bytes": _packed(columns),
    }
    # No text of a recording may end the element that holds it.
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")


def _axis(axis: Axis) -> dict[str, Any]:
    return {"label": axis.label, "low": axis.low, "high": axis.high, "log": axis.log, "falling": axis.falling}


def _column(values: Real, log: bool, most: int, across: bool) -> _Column:
    with np.errstate(divide="ignore", invalid="ignore"):
        levels = np.log(values) if log else values
    there = np.isfinite(levels)
    low, high = (float(levels[there].min()), float(levels[there].max())) if there.any() else (0.0, 0.0)
    count = values.size - 1
    evenly = across and there.all() and count > 0 and float(np.ptp(np.diff(levels))) < 1e-3 * (high - low) / count
    step = (high - low) / (count if evenly else most) or 1.0
    steps = np.where(there, np.round((np.where(there, levels, low) - low) / step), _GAP).astype(np.int64)
    return _Column(steps, low, step, log)


def _packed(columns: list[_Column]) -> str:
    changes = [np.diff(column.steps, prepend=0) for column in columns]
    every = np.concatenate([np.empty(0, dtype=np.int64), *changes])
    # Small changes of either sign become small numbers: 0, -1, 1, -2 are 0, 1, 2, 3.
    folded = np.where(every < 0, -2 * every - 1, 2 * every).astype("<u4")
    planes = folded.view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")
