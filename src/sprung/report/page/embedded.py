"""The data of a figure, embedded in the page for its script, which zooms, reads out and saves the figure.

Every column is quantised to a fraction of its span and stored as 32-bit differences from sample to sample. Their bytes are
grouped by significance, which deflate compresses several times better than interleaved ones.
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
"""Quantisation steps per span of a column; the coarse ones for the noisy samples of recordings and fits."""

_GAP = -1
"""Code of a missing value."""


@dataclass(frozen=True, eq=False)
class _Column:
    """Quantised values, or logarithms of values."""

    steps: NDArray[np.int64]
    low: float
    step: float
    log: bool

    @property
    def header(self) -> dict[str, Any]:
        return {"n": self.steps.size, "low": self.low, "step": self.step, "log": self.log}


def figure_json(picture: Picture) -> str:
    """Return the data of a figure as JSON that may be embedded in an HTML page.

    Parameters
    ----------
    picture
        Any.

    Returns
    -------
    str
        Axes, panels with their positions in the drawing, curves as indices of columns, and the compressed columns.
    """
    columns: list[_Column] = []
    indices: dict[bytes, int] = {}

    def column_index(values: Real, axis: Axis, across: bool) -> int:
        key = np.ascontiguousarray(values, dtype=float).tobytes() + bytes([across])
        if key not in indices:
            indices[key] = len(columns)
            steps = _FINE if across or not picture.zoomable else _COARSE
            columns.append(_column(np.asarray(values, dtype=float), axis.log, steps, across))
        return indices[key]

    layout, panels = layout_of(picture), []
    for panel, box in zip(picture.panels, layout.boxes, strict=True):
        curves = []
        for mark in panel.marks:
            if isinstance(mark, Curve | Points):
                curve: dict[str, Any] = {
                    "name": mark.label,
                    "x": column_index(mark.x, picture.x, True),
                    "y": column_index(mark.y, panel.y, False),
                }
                if isinstance(mark, Points):
                    curve["points"] = True
                bars = mark.bars if isinstance(mark, Points) else mark.band
                if bars is not None:
                    curve["bars"] = column_index(bars, Axis("", 0, 1), False)
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
        "columns": [column.header for column in columns],
        "bytes": _compressed(columns),
    }
    # No text of a recording may close the element that holds it.
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")


def _axis(axis: Axis) -> dict[str, Any]:
    return {"label": axis.label, "low": axis.low, "high": axis.high, "log": axis.log, "descending": axis.descending}


def _column(values: Real, log: bool, most: int, across: bool) -> _Column:
    with np.errstate(divide="ignore", invalid="ignore"):
        levels = np.log(values) if log else values
    finite = np.isfinite(levels)
    low, high = (float(levels[finite].min()), float(levels[finite].max())) if finite.any() else (0.0, 0.0)
    count = values.size - 1
    evenly = across and finite.all() and count > 0 and float(np.ptp(np.diff(levels))) < 1e-3 * (high - low) / count
    step = (high - low) / (count if evenly else most) or 1.0
    steps = np.where(finite, np.round((np.where(finite, levels, low) - low) / step), _GAP).astype(np.int64)
    return _Column(steps, low, step, log)


def _compressed(columns: list[_Column]) -> str:
    changes = [np.diff(column.steps, prepend=0) for column in columns]
    values = np.concatenate([np.empty(0, dtype=np.int64), *changes])
    # Zigzag coding: small changes of either sign become small numbers: 0, -1, 1, -2 are 0, 1, 2, 3.
    folded = np.where(values < 0, -2 * values - 1, 2 * values).astype("<u4")
    planes = folded.view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")
