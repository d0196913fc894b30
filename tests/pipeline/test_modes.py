"""Modes without a vehicle model, and the look at recordings alone."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from sprung.errors import InputError
from sprung.vehicle import TABLE_1_CAR


def test_modes_of_each_load_come_out() -> None:
    load = {"name": "bags", "items": [{"mass": 150, "position": (-1.0, 0.2, 0.5)}]}
    campaign = sprung.simulate(TABLE_1_CAR, loads=[load], noise=0.005, seed=1)
    found = sprung.modes(campaign)
    assert set(found) == {"empty", "bags"}
    for name, modes in found.items():
        poles = np.linalg.eigvals(TABLE_1_CAR.matrices(campaign.load(name)).state)
        truth = np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)
        np.testing.assert_allclose([mode.frequency for mode in modes], truth, rtol=0.01)
        assert modes[0].frequency_std is None  # not claimed where it is not computed


def test_the_papers_method_is_behind_the_same_door() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.0, seed=1)
    svm = sprung.modes(campaign, method="svm")["empty"]
    poles = np.linalg.eigvals(TABLE_1_CAR.matrices().state)
    truth = np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)
    np.testing.assert_allclose([mode.frequency for mode in svm], truth, rtol=1e-4)


def test_an_unknown_method_is_refused() -> None:
    with pytest.raises(InputError, match="era"):
        sprung.modes(sprung.simulate(TABLE_1_CAR, seed=1), method="erra")


def test_check_names_every_drop_and_its_limits() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1)
    check = sprung.check(campaign)
    assert check.usable
    assert check.faults == ()
    assert [drop.file for drop in check.drops] == [drop.file for drop in campaign.drops]
    for drop in check.drops:
        assert drop.start is not None
        assert drop.end is not None
        assert 0.4 < drop.start < 0.8
        assert drop.end == pytest.approx(3.6, abs=0.01)
