"""The study of parts of vehicles as they are: what is drawn, and what its page says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import parts_as_they_are
import pytest
from parts_as_they_are import Judged, page
from real_outcomes import Outcome
from rigs import EFFECTS, MODELS, READINGS, draw_rig


def test_every_kind_is_drawn_and_always_the_same() -> None:
    drawn = [draw_rig(number) for number in range(120)]
    assert {one.vehicle.model for one in drawn} == {*MODELS}
    assert {effect for one in drawn for effect in one.effects} == {*EFFECTS}
    assert {one.readings for one in drawn} == {*READINGS}
    assert 0.2 < np.mean([one.are_exact for one in drawn]) < 0.47  # a third, within three standard errors
    assert draw_rig(7).vehicle.parameters == drawn[7].vehicle.parameters


def test_the_recordings_are_those_that_the_test_says() -> None:
    rig = draw_rig(1)
    campaign = rig.record()
    assert {drop.load for drop in campaign.drops} == {"empty", "load"}
    recording = campaign.recordings[0]
    assert recording.rate == rig.rate
    assert recording.values.shape[0] == len(rig.sensors)
    # At rest each channel shows the noise that was drawn for it.
    at_rest = recording.values[:, : int(0.35 * rig.rate)].std(axis=1)
    np.testing.assert_allclose(at_rest, [*rig.noise.values()], rtol=0.3)


def test_the_page_names_what_was_not_right(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rig, other = draw_rig(0), draw_rig(4)
    right = Outcome("quarter", 0, rig.label, "accept", "", errors={"m_s": (0.01, 1.0, True)}, seconds=1.0)
    errors = {"m_s": (0.01, 1.0, True), "k_t": (-0.05, -5.0, False)}
    wide = Outcome("quarter", 4, other.label, "accept", "", errors=errors, seconds=3.0)
    written = page([Judged(rig, right), Judged(other, wide)])
    assert "- number 4, quarter with friction and tyre curve" in written
    assert "5 standard errors (k_t, -5 %)" in written
    assert "- number 0" not in written
    assert "| all | 2 | 2 / 0 / 0 / 0 | 0 | 5 | 66.7 | 2, 3 |" in written
    monkeypatch.setattr("sys.argv", ["parts_as_they_are.py", "--first", "1", "--campaigns", "1", "--to", str(tmp_path)])
    parts_as_they_are.main()
    assert "| all | 1 | 1 / 0 / 0 / 0 | 0 |" in (tmp_path / "parts-as-they-are.md").read_text(encoding="utf-8")
