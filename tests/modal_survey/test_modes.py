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
        errors = np.array([mode.frequency for mode in modes]) - truth
        stated = np.array([mode.frequency_std for mode in modes], dtype=float)
        assert np.all(np.abs(errors) < 4 * stated)  # of fourteen normal numbers one in a thousand cases has one beyond
        assert np.all(stated < 0.002 * truth)
    assert sprung.modes(campaign, method="era")["bags"][0].frequency_std is None  # not claimed where it is not computed


def test_one_drop_cannot_tell_the_wheel_hops_apart_and_says_so() -> None:
    # The bound of one drop is about 100 % for each of the four (10.768/10.771 and 11.286/11.288 Hz).
    one = sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "rl"], "height": 0.05}], noise=0.02, seed=1)
    found = sprung.modes(one)["empty"]
    wheels = [mode for mode in found if mode.frequency > 5]
    assert 1 <= len(wheels) < 4
    assert any("4 wheels have 4 modes of hop and tramp, of which 1 drop" in said for said in found.unresolved)
    # Asked for all fourteen poles, it does not invent those that it cannot tell.
    forced = sprung.modes(one, order=14)["empty"]
    assert len(forced) == len(found)
    assert any("its parameters cost" in reason for _, reason in forced.rejected)


def test_the_fourier_transform_stands_beside_it_as_in_table_3() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.005, seed=1)
    for mode in sprung.modes(campaign)["empty"]:
        if mode.fft_frequency is not None and mode.fft_difference is not None:
            # Table 3: (2.018 - 1.9913) / 1.9913 is its 1.34 %.
            assert mode.fft_difference == pytest.approx(100 * (mode.fft_frequency / mode.damped_frequency - 1))


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


@pytest.mark.slow
def test_diagram_and_amplitudes_come_where_they_are_asked_for() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.005, seed=1)
    plain = sprung.modes(campaign)["empty"]
    assert plain.diagram is None
    assert not any(mode.amplitudes for mode in plain)
    whole = sprung.modes(campaign, amplitude=True, diagram=True)["empty"]
    assert whole.diagram is not None
    # All seven, or six where two of one chain's wheel hops took turns: 0.003 Hz apart they count as one pole.
    assert len(whole.diagram.chosen) >= 6
    assert whole.document()["diagram"]["criteria"]["frequency"] == 0.02
    bounce = whole[0]
    assert len(bounce.amplitudes) > 2
    # A linear car: no trend beyond four standard errors.
    assert bounce.frequency_trend is not None
    assert abs(bounce.frequency_trend[0]) < 4 * bounce.frequency_trend[1]
