"""Pictures as SVG: a golden one with everything in it, laws of scales and ticks, and words that could be markup."""

from __future__ import annotations

import html
import re
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import sprung
from sprung.campaign import Campaign
from sprung.errors import InputError
from sprung.report import Band, Curve, Panel, Picture, Points, Rule, picture_svg, report_html
from sprung.report.drawing.axis import Axis, axis_limits, round_ticks
from sprung.report.drawing.legend import WIDTH
from sprung.report.drawing.picture import merge_labels
from sprung.results import Result
from sprung.vehicle import TABLE_1_CAR

HERE = Path(__file__).parent


def everything() -> Picture:
    """One of each mark, a gap in a curve, labels that are close, an axis that falls and one that is logarithmic."""
    x = np.linspace(1, 9, 9)
    broken = np.where(x == 5, np.nan, x**2)
    points = Points(x[1:4], x[1:4] ** 2, "first", "points", hollow=True, bars=np.array([2.0, 3.0, 4.0]))
    rules = (
        Rule(2.0, "mode", "two"),
        Rule(2.2, "landing", "beside it", dashed=True),
        Rule(20.0, "reference", horizontal=True),
    )
    above = Panel(
        Axis("m/s²", 0, 90),
        (Band(3, 6), *rules, Curve(x, broken, "measured", "broken", 2.0), points),
        note="a <note> & more",
        warning="a fault",
    )
    below = Panel(
        Axis("", 0.1, 100, log=True),
        (Curve(x, x, "simulated", "", dashed=True, band=0.3 * x),),
        0.5,
        name="a channel's name that is long",
    )
    return Picture("Everything", Axis("time, s", 1, 9, descending=True), (above, below), "One of each.")


def test_a_picture(regenerate: bool) -> None:
    shown = picture_svg(everything()).replace("><", ">\n<") + "\n"
    path = HERE / "picture.svg"
    if regenerate:
        path.write_text(shown, encoding="utf-8")
    assert shown == path.read_text(encoding="utf-8")


def test_where_things_are() -> None:
    """Positions follow from the axes: here in the upper panel, whose axis runs from 90 down to 0 over 96 units."""
    shown = ET.fromstring(picture_svg(everything()))  # noqa: S314
    paths = {one.get("class"): one.get("d", "") for one in shown.iter("path")}
    numbers = [float(one) for one in re.findall(r"[\d.]+", paths["rule reference"])]
    frame = [
        float(one)
        for one in re.findall(
            r"[\d.]+", next(one.get("d", "") for one in shown.iter("path") if one.get("class") == "frame")
        )
    ]
    left, top, height = frame
    assert numbers[1] == pytest.approx(top + height * (1 - 20 / 90), abs=0.1)
    curves = [
        one.get("d", "") for one in shown.iter("path") if one.get("class") == "curve measured" and one.get("transform")
    ]
    assert [one.count("M") for one in curves] == [2]  # it parts at the gap
    start = [int(one) / 10 for one in curves[0][1:].split("l")[0].split()]
    width = WIDTH - left - 8
    assert start == pytest.approx([left + width, top + height * (1 - 1 / 90)], abs=0.1)  # the axis falls


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
def test_ticks_are_round_few_and_inside(low: float, span: float) -> None:
    assume(span > 1e-7 * abs(low))
    high = low + span
    found = list(round_ticks(low, high))
    assert 1 <= len(found) <= 7
    assert all(low - 1e-6 * span <= value <= high + 1e-6 * span for value, _ in found)
    steps = np.diff([value for value, _ in found])
    assert steps.size == 0 or np.allclose(steps, steps[0], rtol=1e-5)


@given(st.lists(st.floats(-1e9, 1e9) | st.just(float("nan")), max_size=20))
def test_an_axis_has_room_for_everything(values: list[float]) -> None:
    low, high = axis_limits(np.array(values, dtype=float), least=1.0)
    assert high - low >= 1.0
    assert all(low <= value <= high for value in values if not np.isnan(value))


def test_lines_that_look_like_one_are_labelled_together() -> None:
    rules = [Rule(14.1, "mode", "c"), Rule(12.40, "mode", "a"), Rule(12.42, "mode", "b")]
    found = merge_labels(rules, Axis("Hz", 0.3, 40, log=True))
    assert [(one.at, one.label) for one in found] == [(12.40, "a, b"), (12.42, ""), (14.1, "c")]


def hostile() -> Campaign:
    """A vehicle, a channel and a load that would like to be markup."""
    made = sprung.simulate(
        TABLE_1_CAR, drops=[{"load": "empty"}, {"wheels": ["rl", "rr"], "load": "empty"}], noise=0.02, seed=1
    )
    name = '</script><script>alert("1")</script>&amp;'
    sensors = (replace(made.sensors[0], channel=name), *made.sensors[1:])
    recordings = tuple(replace(one, channels=(name, *one.channels[1:])) for one in made.recordings)
    return replace(made.with_recordings(recordings), name=f"{name}\x1b[31m", sensors=sensors)


@pytest.fixture(scope="module")
def odd() -> Result:
    return sprung.identify(hostile())


def test_words_are_never_markup(odd: Result) -> None:
    page = report_html(odd)
    # The page's own, the wire car, and the data of every figure.
    assert page.count("<script") == 2 + len(re.findall(r'<script type="application/json" class="data">', page))
    assert "&lt;/script&gt;&lt;script&gt;alert(" in page
    for picture in re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL):
        ET.fromstring(picture)  # noqa: S314 (well-formed, or it raises)


def test_without_a_library_that_sets_pages(odd: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "weasyprint", None)
    with pytest.raises(InputError, match=re.escape('pip install "sprung[pdf]"')):
        sprung.report.pdf_of(odd)


@pytest.mark.long
def test_on_paper(odd: Result) -> None:
    pytest.importorskip("weasyprint")
    written = sprung.report.pdf_of(odd)
    assert written.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", written)) >= 3 or b"/ObjStm" in written


def test_a_note_has_a_ground_that_its_text_lies_on() -> None:
    svg = picture_svg(everything())
    grounds = [
        tuple(map(float, match))
        for match in re.findall(r'class="ground" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)"', svg)
    ]
    notes = re.findall(r'class="note[^"]*" x="([\d.]+)" y="([\d.]+)" text-anchor="end">([^<]*)<', svg)
    assert len(grounds) == len(notes) > 0
    for (left, top, width), (right, base, text) in zip(grounds, notes, strict=True):
        assert left + width >= float(right)
        assert top < float(base) - 7 < float(base) < top + 12
        assert width > 4.5 * len(html.unescape(text))
