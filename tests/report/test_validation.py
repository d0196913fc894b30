"""What a validation shows: every drop in the table, drawings that are SVG and show the numbers that were found."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from rich.console import Console

import sprung
from sprung.errors import InputError
from sprung.pipeline import Validation
from sprung.report import draw_validation, drawing, text_of, validation_view
from sprung.report.amplitude import figure_of_amplitudes
from sprung.report.motion import figure_of_motion
from sprung.vehicle import TABLE_1_CAR


@pytest.fixture(scope="module")
def found() -> Validation:
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "fr"], ["fl", "rl"])]
    made = sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=2, known={"total_mass": TABLE_1_CAR.total_mass})
    return sprung.validate(made, tracks="shared", extras=())


def test_the_table_names_every_drop_mode_and_the_verdict(found: Validation) -> None:
    for width in (80, 160):
        shown = text_of(validation_view(found), Console(width=width, highlight=False, color_system=None))
        for name, drop in found.result.validation.items():
            row = next(line for line in shown.splitlines() if line.startswith(f"{name} "))
            assert f"{drop.residual:.2f}" in row
        assert all(one.mode in shown for one in found.amplitudes)
        assert f"Verdict: {found.result.verdict.state}" in shown
        assert max(map(len, shown.splitlines())) <= width


def test_drawings_are_svg_and_the_same_again(found: Validation) -> None:
    drawn = draw_validation(found)
    assert list(drawn) == ["amplitude.svg", *(f"{motion.name}.svg" for motion in found.motions)]
    for text in drawn.values():
        assert ET.fromstring(text).tag.endswith("svg")  # noqa: S314 (it was made here)
    assert drawn == draw_validation(found)


def test_a_drop_is_drawn_as_it_was(found: Validation) -> None:
    motion = found.motions[1]
    figure = figure_of_motion(motion, found.result.validation[motion.name])
    assert len(figure.axes) == 6
    for i in range(3):
        above, below = figure.axes[2 * i : 2 * i + 2]
        measured, simulated = (line.get_ydata() for line in above.lines[:2])
        np.testing.assert_array_equal(measured, motion.measured[i])
        np.testing.assert_array_equal(simulated, motion.simulated[i])
        np.testing.assert_array_equal(below.lines[0].get_ydata(), motion.measured[i] - motion.simulated[i])


def test_modes_are_drawn_in_mm_the_largest_amplitude_on_the_left(found: Validation) -> None:
    figure = figure_of_amplitudes(found.amplitudes, "Modes")
    assert len(figure.axes) == 2 * len(found.amplitudes)
    for above, one in zip(figure.axes[::2], found.amplitudes, strict=True):
        left, right = above.get_xlim()
        assert left > right
        assert left > 1e3 * one.records[0].amplitude.max()
        low, high = above.get_ylim()
        # What is flat is drawn flat.
        assert high - low > 0.1 * one.frequency


def test_without_matplotlib_it_is_named(found: Validation, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(_: str) -> object:
        raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib")

    monkeypatch.setattr(drawing, "import_module", missing)
    with pytest.raises(InputError, match="matplotlib"):
        draw_validation(found)
