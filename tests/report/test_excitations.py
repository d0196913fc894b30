"""Captions are true of what was recorded: drops, pushes, passes, pads, and sensors of every quantity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import sprung
from quarter_car import QUARTER
from sprung import plot
from sprung.checking import ChannelReport, Check, DropReport
from sprung.errors import InputError
from sprung.report import check_html, check_view, decays_by_load, report_html, text_of
from sprung.report.drawing.axis import Axis
from sprung.report.drawing.marks import Box, mark_elements
from sprung.report.drawing.picture import Curve
from sprung.report.excitations import excitations_text, limits_text, readings_text, records_text
from sprung.results import Result
from sprung.units import Quantity


def drop(kind: str, *quantities: Quantity) -> DropReport:
    channels = tuple(ChannelReport(name, "body", None, None, True, (), name) for name in quantities)
    return DropReport(
        f"{kind}.csv", "empty", 0.5, 4.0, (), kind=kind, why_start="one", why_end="two", channels=channels
    )


@pytest.fixture(scope="module")
def falling() -> Result:
    return sprung.identify(sprung.simulate(QUARTER, noise=0.02, seed=1, known={"m_s": QUARTER.m_s}))


@pytest.fixture(scope="module")
def driven(falling: Result) -> Result:
    """The same, as if pads had driven the vehicle."""
    return replace(falling, drops=tuple(replace(one, kind="pads", release=None) for one in falling.drops))


@pytest.mark.parametrize(
    ("kinds", "tests", "records"),
    [
        ((), "drop tests", "free decays"),
        (("bounce", "fl rr"), "drop tests", "free decays"),
        (("push front", "pass"), "pushes and passes over a bump", "free decays"),
        (("pads", "pads left"), "tests on pads", "forced responses"),
        (
            ("pads", "pitch front", "push"),
            "drop tests, pushes and tests on pads",
            "free decays and forced responses",
        ),
    ],
)
def test_tests_and_records_are_named(kinds: Sequence[str], tests: str, records: str) -> None:
    drops = [drop(kind) for kind in kinds]
    assert excitations_text(drops) == tests
    assert records_text(drops) == records


def test_limits_and_readings_are_named() -> None:
    assert limits_text(drop("pads left")) == "Forced response from 0.500 s (one) to 4.000 s (two)."
    assert limits_text(drop("roll left")) == "Free decay from 0.500 s (one) to 4.000 s (two)."
    assert limits_text(replace(drop("pads"), start=None)) == ""
    assert readings_text([drop("bounce", "acceleration")]) == "Accelerations in m/s²"
    assert readings_text([drop("bounce", "acceleration"), drop("pitch", "displacement", "force")]) == (
        "Readings in m/s², m, N"
    )


def test_a_check_names_what_was_recorded() -> None:
    check = Check((drop("pads", "acceleration", "displacement"),), ())
    page, terminal = check_html(check), text_of(check_view(check))
    assert "recordings of tests on pads" in page
    assert "Readings in m/s², m, time in s" in page
    assert "Shaded: the forced response" in page
    assert "Limits of the forced responses" in terminal
    for shown in (page, terminal):
        assert "drop test" not in shown
        assert "ree decay" not in shown


def test_a_report_of_pads_has_no_free_decay(falling: Result, driven: Result) -> None:
    pages = {name: report_html(result) for name, result in (("falling", falling), ("driven", driven))}
    for text in (
        "drop tests",
        "Spectra of the free decays",
        "Free decay from",
        'id="stabilisation"',
        "release and landing",
    ):
        assert text in pages["falling"]
        assert text not in pages["driven"]
    for text in ("tests on pads", "Spectra of the forced responses", "Forced response from"):
        assert text in pages["driven"]


def test_poles_are_those_of_free_decays_alone(falling: Result, driven: Result) -> None:
    assert plot.stabilisation(falling) is not None
    with pytest.raises(InputError, match="forced responses on pads"):
        plot.stabilisation(driven)
    mixed = replace(falling, drops=(*driven.drops[:1], *falling.drops[1:]))
    load = next(iter(falling.modes))
    titles = [(records.title, len(records.measured)) for records in decays_by_load(mixed) if records.load == load]
    count = sum(one.load == load for one in falling.drops)
    assert titles == [(load, count - 1), (f"{load}, on pads", 1)] if count > 1 else [(f"{load}, on pads", 1)]


def test_a_curve_ends_at_the_edge_of_its_panel() -> None:
    box = Box(0.0, 100.0, 100.0, 50.0, Axis("", 0.0, 10.0), Axis("", 0.0, 1.0))
    curve = Curve(np.arange(6.0), np.array([0.5, 0.5, -20.5, -20.5, 0.5, 20.5]), "simulated")
    [path] = mark_elements(curve, box)
    pieces = path.partition(' d="M')[2].rstrip('"/>').split("M")
    ends = []
    for piece in pieces:
        start, _, steps = piece.partition("l")
        numbers = np.array(steps.replace("-", " -").split(), dtype=int).reshape(-1, 2)
        ends.append(np.vstack([np.array(start.split(), dtype=int), numbers]).cumsum(axis=0) / 10)
    assert len(ends) == 2
    for end in ends:
        assert end[:, 1].min() >= 99.0
        assert end[:, 1].max() <= 151.0
    # It leaves at y = -0.02, a unit below the edge: 0.52/21 of the way.
    assert ends[0][-1] == pytest.approx([10 + 10 * 0.52 / 21, 151.0], abs=0.1)
