"""The study of modal identification, small; and that its stored numbers are those that were wanted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import modal
from sprung.modal import APPROXIMATE, METHODS


def test_the_study(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modal, "SEEDS", 1)
    monkeypatch.setattr(modal, "LEVELS", (40.0,))
    trials = [modal.trial(seed) for seed in range(3)]
    methods = {name: (modal.ours(name), 4) for name in ("ml", "era")}
    rows, one = modal.compared(methods), modal.compared({"ml": (modal.ours("ml"), 1)})
    assert rows[0]["40 dB"]["found"] == 7
    assert rows[0]["40 dB"]["body"][0] < rows[1]["40 dB"]["body"][0] * 2
    assert one[0]["40 dB"]["wheels"] == [None, None]
    page = modal.page(trials, rows, one, {modal.OWN: 50.0, "another": 200.0}, [])
    assert "3 of 3 sets gave exactly seven modes" in page
    assert "0.25 of its time" in page


def test_the_stored_numbers_are_as_wanted() -> None:
    stored = json.loads((Path(modal.__file__).parent / "modal.json").read_text(encoding="utf-8"))
    every = stored["headline"][-1]
    assert every["sets"] >= 1000
    assert every["with_all_modes"] == every["sets"]
    assert every["worst_rmse_over_bound"] <= modal.WANTED_RMSE
    assert modal.COVERAGE[0] <= every["covered"] <= modal.COVERAGE[1]
    assert every["body_percent"][0] <= modal.WANTED_FREQUENCY
    assert every["body_percent"][1] <= modal.WANTED_DAMPING
    exact = {row["method"]: row["without_noise"] for row in stored["methods"]}
    assert all(exact[method] == 7 for method in METHODS if method not in APPROXIMATE)
