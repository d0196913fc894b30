"""Speed of the joint fit beside the plain SciPy fit of the same records; the result is kept in benchmarks/result.json.

Run with `nox -s bench`, on one thread for figures that can be compared (OMP_NUM_THREADS=1).
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sprung
from plain import fit_plainly
from sprung.pipeline.choice import choose_model
from sprung.prepare import prepare
from sprung.vehicle import TABLE_1_CAR

LOAD = {
    "name": "ballast",
    "items": [
        {"mass": 140.0, "position": (-1.0, 0.0, 0.55), "inertia": (10.0, 80.0)},
        {"mass": 60.0, "position": (-2.9, 0.0, 0.55), "inertia": (5.0, 5.0)},
    ],
}


@pytest.fixture(scope="module")
def sedan() -> sprung.Campaign:
    """Ten drops of the paper's car, 500 Hz, 3 s, 0.02 m/s²: the campaign of the development recordings."""
    return sprung.simulate(TABLE_1_CAR, loads=[LOAD], rate=500, noise=0.02, seed=1, duration=3.2)


def test_identify(benchmark: Any, sedan: sprung.Campaign) -> None:
    result = benchmark(sprung.identify, sedan)
    assert result.verdict.state == "accept"


def test_identify_beside_plain_scipy(benchmark: Any, sedan: sprung.Campaign) -> None:
    found = sprung.identify(sedan)
    # Both fit the very same samples: from where the whole walk found that the decays begin.
    drops = tuple(
        drop.model_copy(update={"start": one.start}) for drop, one in zip(sedan.drops, found.drops, strict=True)
    )
    same = replace(sedan, drops=drops)
    result = sprung.identify(same)
    choice, decays = choose_model(same), prepare(same).decays
    noise = np.array(list(result.fit.noise.values()))
    start = np.array(list(TABLE_1_CAR.parameters.values())) * 1.2

    names, plain = benchmark.pedantic(
        fit_plainly, (decays, choice.models, sedan.sensors, TABLE_1_CAR.wheelbase, noise, start), rounds=1
    )
    for name, value in zip(names, plain, strict=True):
        ours = result.parameters[name]
        assert ours.value is not None
        assert ours.std is not None
        assert abs(value - ours.value) < 0.01 * ours.std  # the same optimum

    ours_seconds = []
    for _ in range(9):
        begin = time.perf_counter()
        sprung.identify(sedan)
        ours_seconds.append(time.perf_counter() - begin)
    benchmark.extra_info["plain_over_ours"] = benchmark.stats.stats.median / float(np.median(ours_seconds))
