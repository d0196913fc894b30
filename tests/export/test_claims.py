"""What the page of the exports says in figures is what its study has measured."""

from __future__ import annotations

import json
import re
from pathlib import Path

from exported_vehicles import CASES

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_page_says_what_was_measured() -> None:
    cases = json.loads((DOCS / "studies" / "exported-drops.json").read_text(encoding="utf-8"))["cases"]
    text = " ".join((DOCS / "exports.md").read_text(encoding="utf-8").split())
    assert [one["vehicle"] for one in cases] == list(CASES)
    assert f"exports {len(CASES)} vehicles" in text
    worst = {to: max(one[to] for one in cases if one[to] is not None) for to in ("modelica", "fmu", "mjcf")}
    stated = re.search(
        r"is ([\d.]+) % of the range of a motion in Modelica and in the FMU, and ([\d.]+) % in MuJoCo", text
    )
    assert stated is not None
    assert f"{max(worst['modelica'], worst['fmu']):.1g}" == stated[1]
    assert f"{worst['mjcf']:.1g}" == stated[2]
