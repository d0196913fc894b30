"""What a validation shows: every drop in the table, drawings that are SVG and show the numbers that were found."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from rich.console import Console

import sprung
from layouts import check_view_is_whole
from sprung.report import Curve, amplitude_pictures, draw_validation, motion_picture, text_of, validation_view
from sprung.study import Validation
from sprung.vehicle import FULL, TABLE_1_CAR


@pytest.fixture(scope="module")
def found() -> Validation:
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "fr"], ["fl", "rl"])]
    made = sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=2, known={"total_mass": TABLE_1_CAR.total_mass})
    return sprung.validate(made, tracks="shared", extras=())


def test_the_table_names_every_drop_mode_and_the_verdict(found: Validation) -> None:
    check_view_is_whole(validation_view(found), tables=2)
    shown = text_of(validation_view(found), Console(width=160, highlight=False, color_system=None))
    for name, drop in found.result.validation.items():
        row = next(line for line in shown.splitlines() if line.startswith(f"{name} "))
        assert f"{drop.residual:.2f}" in row
    assert all(one.mode in shown for one in found.amplitudes)
    assert f"Verdict: {found.result.verdict.state}" in shown


def test_drawings_are_svg_and_the_same_again(found: Validation) -> None:
    drawn = draw_validation(found)
    assert list(drawn) == ["amplitude.svg", *(f"{motion.name}.svg" for motion in found.motions)]
    for text in drawn.values():
        assert ET.fromstring(text).tag.endswith("svg")  # noqa: S314 (it was made here)
    assert drawn == draw_validation(found)


def test_a_drop_is_drawn_as_it_was(found: Validation) -> None:
    motion, result = found.motions[1], found.result
    picture = motion_picture(motion.name, result.series[motion.name], result.validation[motion.name], FULL)
    assert picture is not None
    assert len(picture.panels) == 6
    for i in range(3):
        measured, simulated, left = (
            mark.y for panel in picture.panels[2 * i : 2 * i + 2] for mark in panel.marks if isinstance(mark, Curve)
        )
        np.testing.assert_array_equal(measured, motion.measured[i].astype(np.float32))
        np.testing.assert_array_equal(simulated, motion.simulated[i].astype(np.float32))
        np.testing.assert_array_equal(left, measured - simulated)


def test_modes_are_drawn_in_mm_the_largest_amplitude_on_the_left(found: Validation) -> None:
    pictures = amplitude_pictures(found.amplitudes)
    assert [picture.title for picture in pictures] == [one.mode for one in found.amplitudes]
    for picture, one in zip(pictures, found.amplitudes, strict=True):
        assert picture.x.descending
        assert picture.x.high > 1e3 * one.records[0].amplitude.max()
        frequency = picture.panels[0].y
        # What is flat is drawn flat.
        assert frequency.high - frequency.low > 0.1 * one.frequency
