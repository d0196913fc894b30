"""Pushes and bumps that a vehicle file states."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import tomli_w
from numpy.testing import assert_array_equal

import sprung
from sprung.errors import InputError
from sprung.simulation import Bump, Push
from sprung.vehicle import TABLE_1_CAR

ROPE = {"shape": "rope", "force": 900.0}
PLANK = {"shape": "plank", "height": 0.04, "length": 0.3}
DROPS: list[dict[str, Any]] = [
    {"wheels": ["fl", "fr"], "excitation": "push"},
    {"wheels": ["fl", "fr", "rl", "rr"], "excitation": "pass", "speed": 4.0},
]


def vehicle_file(folder: Path, **sections: object) -> Path:
    path = folder / "VEHICLE.toml"
    stated = {"parameters": dict(TABLE_1_CAR.parameters), "drop": DROPS, **sections}
    path.write_text(tomli_w.dumps(stated), encoding="utf-8")
    return path


def test_they_act_as_those_of_python(tmp_path: Path) -> None:
    path = vehicle_file(tmp_path, push=ROPE, bump=PLANK)
    ours = sprung.simulate(TABLE_1_CAR, drops=DROPS, push=Push(**ROPE), bump=Bump(**PLANK), seed=1)  # type: ignore[arg-type]
    for one, other in zip(sprung.simulate(path, seed=1).recordings, ours.recordings, strict=True):
        assert_array_equal(one.values, other.values)
    plain = sprung.simulate(TABLE_1_CAR, drops=DROPS, seed=1)
    assert all(
        (one.values != two.values).any()
        for one, two in zip(ours.recordings, plain.recordings, strict=True)
        if one.values.shape == two.values.shape
    )
    # What is given in Python holds against the file.
    given = sprung.simulate(path, push=Push(), bump=Bump(), seed=1)
    for one, other in zip(given.recordings, plain.recordings, strict=True):
        assert_array_equal(one.values, other.values)


@pytest.mark.slow
def test_a_plan_counts_with_them(tmp_path: Path) -> None:
    """A plank of twice the height tells more of the tyres."""

    def tyres(height: float) -> float:
        path = vehicle_file(tmp_path, bump={**PLANK, "height": height}, drop=[{**DROPS[1], "load": "empty"}] * 3)
        planned = sprung.plan(path, known={"total_mass": TABLE_1_CAR.total_mass})
        bound = next(row.bound for row in planned.rows if row.label == "as planned")
        assert bound is not None
        percent = bound.percents["k_tf"]
        assert percent is not None
        return percent

    assert tyres(0.02) == pytest.approx(2 * tyres(0.04), rel=0.2)


def test_what_they_cannot_be_is_said_with_its_place(tmp_path: Path) -> None:
    path = vehicle_file(tmp_path, push={"shape": "shove"}, bump={"height": -0.1})
    with pytest.raises(InputError) as caught:
        sprung.simulate(path)
    text = str(caught.value)
    assert "push.shape" in text
    assert '"hand", "rope", "lift"' in text
    assert "bump.height" in text


def test_a_bump_in_memory_has_the_limits_of_one_in_a_file() -> None:
    with pytest.raises(
        InputError, match=r"simulate: bump\.height: found 40; expected 0\.002 to 0\.6 m, the range of bumps"
    ):
        sprung.simulate(TABLE_1_CAR, drops=DROPS, bump=Bump(height=40.0))
