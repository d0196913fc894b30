"""The data beside a figure: decoded as the page's script does it, they are what was drawn."""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

import numpy as np
import pytest

from sprung.report import Curve, Panel, Picture, Points
from sprung.report.drawing.axis import Axis
from sprung.report.page.embedded import figure_json


def picture(zoomable: bool, log: bool = False) -> Picture:
    random = np.random.default_rng(2)
    time = 1.3 + np.arange(700) / 512
    values = np.where(np.arange(700) % 97 == 5, np.nan, 3 * np.sin(9 * time) + 0.02 * random.normal(size=700))
    few = np.array([1.4, 1.5, 2.1])
    above = Panel(
        Axis("vertical, m/s²", -4, 4),
        (Curve(time, values, "measured", "</script>"), Points(few, few**2, "fault", bars=few / 10)),
        channel="vertical",
    )
    below = Panel(Axis("m/s² per √Hz", 1e-4, 2, log=log), (Curve(time, np.geomspace(1e-4, 2, 700), "simulated"),))
    return Picture("One", Axis("time, s", 1.3, 2.7), (above, below), zoomable=zoomable)


def decoded(text: str) -> tuple[dict[str, Any], list[np.ndarray]]:
    held = json.loads(text)
    planes = np.frombuffer(zlib.decompress(base64.b64decode(held["bytes"])), dtype=np.uint8).reshape(4, -1)
    folded = np.ascontiguousarray(planes.T).view("<u4").ravel().astype(np.int64)
    changes = np.where(folded % 2 == 1, -(folded + 1) // 2, folded // 2)
    columns, at = [], 0
    for column in held["columns"]:
        levels = np.cumsum(changes[at : at + column["n"]])
        at += column["n"]
        values = column["low"] + column["step"] * levels
        columns.append(np.where(levels < 0, np.nan, np.exp(values) if column["log"] else values))
    assert at == folded.size
    return held, columns


@pytest.mark.parametrize("zoomable", [True, False])
@pytest.mark.parametrize("log", [True, False])
def test_they_are_what_was_drawn(zoomable: bool, log: bool) -> None:
    shown = picture(zoomable, log)
    held, columns = decoded(figure_json(shown))
    steps = 2**15 if zoomable else 2**24  # half a step of the span is how finely a column is kept
    for panel, drawn in zip(held["panels"], shown.panels, strict=True):
        for curve, mark in zip(panel["curves"], drawn.marks, strict=True):
            assert isinstance(mark, Curve | Points)
            span = np.nanmax(mark.y) - np.nanmin(mark.y)
            if drawn.y.log:
                np.testing.assert_allclose(columns[curve["y"]], mark.y, rtol=0.51 * np.log(2e4) / steps)
            else:
                np.testing.assert_allclose(columns[curve["y"]], mark.y, atol=0.51 * span / steps)
            np.testing.assert_allclose(columns[curve["x"]], mark.x, atol=1e-7)
    bars = held["panels"][0]["curves"][1]["bars"]
    np.testing.assert_allclose(columns[bars], [0.14, 0.15, 0.21], atol=1e-5)


def test_words_cannot_end_the_element_that_holds_them() -> None:
    assert "</script>" not in figure_json(picture(True))


def test_evenly_sampled_time_costs_next_to_nothing() -> None:
    time = np.arange(20000) / 1000
    flat = Picture("Flat", Axis("time, s", 0, 20), (Panel(Axis("", 0, 1), (Curve(time, 0 * time, "signal"),)),))
    assert len(figure_json(flat)) < 800
