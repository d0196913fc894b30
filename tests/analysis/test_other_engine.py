"""A car that a rigid-body engine which is not ours drives over a bump; skipped where that engine is not installed."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.vehicle import PARAMETERS

pytest.importorskip("mujoco")

STUDIES = Path(__file__).resolve().parents[2] / "docs" / "studies"


@pytest.fixture(scope="module")
def engine() -> Iterator[Any]:
    sys.path.insert(0, str(STUDIES))
    yield importlib.import_module("other_engine")
    sys.path.remove(str(STUDIES))


def test_the_engine_and_we_agree_on_a_pass(engine: Any) -> None:
    """To the second order of rotation and of the speed, which falls a little on the bump: below a part in a hundred."""
    theirs = engine.drive_over(("fl", "fr", "rl", "rr"))
    drops = [{"excitation": "pass", "speed": engine.SPEED}]
    ours = sprung.simulate(engine.CAR, drops=drops, noise=0.0, duration=3.0).recordings[0].values
    samples = min(ours.shape[1], theirs.shape[1])
    off, motion = ours[:, :samples] - theirs[:, :samples], ours[:, :samples] - 9.80665
    assert np.all(off.std(axis=1) < 0.01 * motion.std(axis=1))


@pytest.mark.parametrize("known", [(), ("front_axle_mass",)], ids=["nothing weighed", "an axle weighed"])
@pytest.mark.slow
def test_passes_of_its_car_determine_every_parameter(known: tuple[str, ...], engine: Any) -> None:
    """Four passes each on both sides, left and right: masses and rates as ratios, and all with one axle weighed, to 1 %."""
    car = engine.CAR
    result = sprung.identify(engine.campaign_of_passes(4, 0.05, 1, known))
    assert result.verdict.state == ("accept" if known else "doubtful")
    assert not result.faults
    assert not result.fit.model
    for name, truth in car.parameters.items():
        if known or not PARAMETERS[name].scales:
            value, unit = result.parameters[name].value, truth
        else:
            value, unit = result.scale.per_total_mass[name].value, truth / car.total_mass
        assert value == pytest.approx(unit, rel=0.01), name
