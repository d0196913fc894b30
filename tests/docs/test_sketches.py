"""The sketches of the documentation are those that the program draws."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import sprung
from sprung.report import blank_sketch, sketch_sheet, vehicle_sketch

DOCS = Path(__file__).resolve().parents[2] / "docs"


def demo() -> str:
    return sketch_sheet(vehicle_sketch(sprung.study.demo_campaign()))


@pytest.mark.parametrize(("name", "drawn"), [("vehicle-sketch.svg", demo), ("blank-sketch.svg", blank_sketch)])
def test_a_sketch_is_what_the_program_draws(name: str, drawn: Callable[[], str], regenerate: bool) -> None:
    if regenerate:
        (DOCS / name).write_text(drawn(), encoding="utf-8")
    told = f"write it anew: pytest {Path(__file__).name} --regenerate"
    assert (DOCS / name).read_text(encoding="utf-8") == drawn(), told
