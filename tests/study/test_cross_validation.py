"""A validation: what it gives, and its way to files and back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung.study import Validation
from sprung.vehicle import TABLE_1_CAR


@pytest.fixture(scope="module")
def found() -> Validation:
    made = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=5, known={"total_mass": TABLE_1_CAR.total_mass})
    return sprung.validate(made, tracks="shared", extras=())


@pytest.mark.slow
def test_its_result_is_that_of_identify(found: Validation) -> None:
    made = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=5, known={"total_mass": TABLE_1_CAR.total_mass})
    assert found.result.to_json() == sprung.identify(made, tracks="shared", extras=(), amplitude=True).to_json()


def test_every_drop_is_validated(found: Validation) -> None:
    names = [motion.name for motion in found.motions]
    assert list(found.result.validation) == names == list(found.result.series)
    for motion in found.motions:
        assert motion.measured.shape == motion.simulated.shape == (3, len(motion.time))
        np.testing.assert_array_equal(motion.time, found.result.series[motion.name].time)


def test_results_keep_it(found: Validation, tmp_path: Path) -> None:
    found.result.save(tmp_path)
    assert sprung.load(tmp_path).validation == found.result.validation
    document = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    first = document["validation"]["empty_bounce"]
    assert first.keys() >= {
        "vertical",
        "pitch",
        "roll",
        "fitted",
        "residual",
        "predicted",
        "predicted_residual",
        "whiteness",
    }
    assert first["roll"] is None  # dropped on all wheels, it does not roll
    assert first["whiteness"].keys() == set(document["fit"]["noise"])


def test_its_files_hold_what_is_drawn(found: Validation, tmp_path: Path) -> None:
    folder = found.save(tmp_path / "validation")
    document = json.loads((folder / "validation.json").read_text(encoding="utf-8"))
    assert document == json.loads(json.dumps(found.document()))
    assert document["verdict"]["state"] == found.result.verdict.state
    assert list(document["amplitude"]) == ["body bounce", "body pitch", "body roll"]
    with np.load(folder / "validation.npz") as archive:
        np.testing.assert_array_equal(archive["empty_bounce/measured"], found.motions[0].measured)
        for one in found.amplitudes:
            np.testing.assert_array_equal(archive[f"amplitude/{one.mode}/model/frequency"], one.model.frequency)
            for trace in one.records:
                where = f"amplitude/{one.mode}/records/{trace.name}/amplitude"
                np.testing.assert_array_equal(archive[where], trace.amplitude)
