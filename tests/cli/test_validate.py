"""`sprung validate`: what it prints, what it writes, and with which status it leaves."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from command_line import Folder, linear_leafbus, run


@pytest.mark.slow
def test_it_prints_and_writes_only_where_it_is_asked_to(folder: Folder, tmp_path: Path) -> None:
    before = sorted(folder.path.rglob("*"))
    plain = run("validate", folder.path)
    assert plain.status == 0
    assert "empty_pitch_front" in plain.out
    assert "Verdict:" in plain.out
    assert sorted(folder.path.rglob("*")) == before
    said = run("validate", folder.path, "-o", tmp_path / "validation", "--json")
    assert said.status == 0
    written = json.loads((tmp_path / "validation" / "validation.json").read_text(encoding="utf-8"))
    assert said.json == written
    assert {"verdict", "validation", "amplitude", "faults"} <= written.keys()
    drawn = {path.name for path in (tmp_path / "validation").glob("*.svg")}
    assert drawn == {"amplitude.svg", *(f"{name}.svg" for name in written["validation"])}


@pytest.mark.long
def test_a_model_that_does_not_hold_is_rejected_with_numbers(tmp_path: Path) -> None:
    said = run("validate", linear_leafbus(tmp_path / "campaign"), "--json")
    assert said.status == 3
    assert said.json["verdict"]["state"] == "reject"
    # The linear vehicle leaves the noise far behind in every drop.
    assert all(drop["residual"] > 2 for drop in said.json["validation"].values())


@pytest.mark.parametrize("missing", ["nowhere", "nowhere/campaign.toml"])
def test_bad_input_is_refused_like_everywhere(missing: str, tmp_path: Path) -> None:
    said = run("validate", tmp_path / missing)
    assert said.status == 2
    assert said.out == ""
    assert "Traceback" not in said.err
