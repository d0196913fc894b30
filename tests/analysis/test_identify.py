"""The whole walk, on recordings that another engine made and on our own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung.errors import InputError
from sprung.uncertainty import KnownValue
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Item, Load

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture(scope="module")
def sedan() -> sprung.Result:
    return sprung.identify(sprung.read(DATA / "sedan"))


@pytest.fixture(scope="module")
def leafbus() -> sprung.Result:
    return sprung.identify(sprung.read(DATA / "leafbus"))


@pytest.mark.parametrize("name", list(TABLE_1_CAR.parameters))
def test_the_sedan_comes_out_with_true_error_bars(sedan: sprung.Result, name: str) -> None:
    """MuJoCo recordings of the paper's Table 1 car, nothing known but the wheelbase and the load."""
    found, truth = sedan.parameters[name], TABLE_1_CAR.parameters[name]
    assert found.status == "estimated"
    assert found.value is not None
    assert found.std is not None
    assert abs(found.value / truth - 1) < 0.025
    assert abs(found.value - truth) < 4 * found.std
    # Places of four sensors, known to 1 cm at 0.7 m from the centreline, determine half-distances to 0.7 % and I_xx to 1.4 %.
    assert found.std < (0.015 if name == "I_xx" else 0.01) * truth


def test_the_sedan_is_accepted(sedan: sprung.Result) -> None:
    assert sedan.verdict.state == "accept"
    assert sedan.faults == ()
    assert sedan.fit.drops == 10
    assert sedan.scale.known
    for noise in sedan.fit.noise.values():
        assert noise == pytest.approx(0.02, rel=0.03)  # what was put on the recordings


LEAFBUS = SCHOOL_BUS.parameters | {"t_f": 0.5, "t_r": 0.5, "F_f": 1000.0, "F_r": 1500.0, "s_f": 2e6, "s_r": 3e6}
"""Of the MuJoCo recordings: the paper's Table 5 with half-distances of 0.5 m, and friction as their page says."""


@pytest.mark.long
def test_friction_is_found_without_being_asked_for(leafbus: sprung.Result) -> None:
    assert leafbus.fit.model == ("friction",)
    assert leafbus.verdict.state == "accept"
    assert leafbus.faults == ()  # no sensor, drop or load is blamed for what the linear model lacks
    taken = {one.extra: one for one in leafbus.fit.path if one.taken}
    assert taken["friction"].gain > 1000 * taken["friction"].asked
    noise = np.array(list(leafbus.fit.noise.values()))
    assert float(np.sqrt(np.mean(noise**2))) == pytest.approx(0.02, rel=0.05)  # what was put on the recordings


@pytest.mark.parametrize("name", [name for name in LEAFBUS if name not in ("t_f1", "t_r1", "t_f2", "t_r2")])
@pytest.mark.long
def test_leaf_springs_come_out(leafbus: sprung.Result, name: str) -> None:
    found = leafbus.parameters[name]
    assert found.value is not None
    assert found.std is not None
    error = abs(found.value / LEAFBUS[name] - 1)
    assert error < 0.02
    assert error < 0.005 or abs(found.value - LEAFBUS[name]) < 4 * found.std


@pytest.mark.long
def test_without_friction_nothing_is_said_of_leaf_springs() -> None:
    """Leaf springs, 1000 and 1500 N of dry friction: the linear model must not pass, and no number of it be printed."""
    result = sprung.identify(sprung.read(DATA / "leafbus"), extras=[])
    assert result.verdict.state == "reject"
    assert result.faults == ()
    assert "does not explain" in result.verdict.reasons[0]
    assert "friction" in result.verdict.reasons[0]
    assert max(result.fit.misfit.values()) > 0.04
    assert {one.status for one in result.parameters.values()} == {"known", "unidentifiable"}


@pytest.mark.shared
def test_the_shared_recordings_are_the_ones_tested(shared: Path) -> None:
    for name in ("sedan", "leafbus"):
        for file in (shared / "data" / name).iterdir():
            assert (DATA / name / file.name).read_bytes() == file.read_bytes()


def test_modes_carry_both_names_and_true_uncertainty(sedan: sprung.Result) -> None:
    assert set(sedan.modes) == {"empty", "ballast"}
    poles = np.linalg.eigvals(TABLE_1_CAR.matrices().state)
    truth = np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)
    modes = sedan.modes["empty"]
    assert {mode.name: mode.paper_name for mode in modes} == {
        "body bounce": "body bounce", "body pitch": "body pitch", "body roll": "body roll",
        "rear axle hop": "wheel bounce", "rear axle tramp": "wheel pitch",
        "front axle hop": "wheel roll", "front axle tramp": "wheel articulation",
    }  # fmt: skip
    for mode, frequency in zip(modes, truth, strict=True):
        assert mode.frequency_std is not None
        assert 0 < mode.frequency_std < 1e-3 * frequency
        assert mode.frequency == pytest.approx(frequency, rel=2e-3)


def test_saved_and_loaded_results_are_the_same(sedan: sprung.Result, tmp_path: Path) -> None:
    folder = sedan.save(tmp_path / "results")
    again = sprung.load(folder)
    assert again == replace(sedan, series=again.series, recordings=again.recordings)
    assert again.to_json() == sedan.to_json()
    for name, series in sedan.series.items():
        np.testing.assert_array_equal(again.series[name].measured, series.measured)
        np.testing.assert_array_equal(again.series[name].fitted, series.fitted)


def test_without_load_or_weighing_the_scale_is_unknown() -> None:
    result = sprung.identify(sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1))
    assert not result.scale.known
    assert result.verdict.state == "doubtful"
    assert result.parameters["m_s"].value is None
    assert result.parameters["a"].status == "estimated"
    ratio = result.scale.per_total_mass["k_sf"]
    assert ratio.unit == "1/s^2"
    assert ratio.value == pytest.approx(17000 / TABLE_1_CAR.total_mass, rel=0.01)


def test_one_drop_says_what_it_cannot_tell() -> None:
    drop = {"wheels": ["fl", "fr", "rl", "rr"]}
    campaign = sprung.simulate(
        TABLE_1_CAR, drops=[drop], noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass}
    )
    result = sprung.identify(campaign)
    assert result.verdict.state == "doubtful"
    assert {"I_xx", "t_f", "t_r"} <= {n for n, one in result.parameters.items() if one.status == "unidentifiable"}
    named = {name for combination in result.unidentifiable for name in combination.parameters}
    assert {"I_xx", "t_f"} <= named
    roll = next(mode for mode in result.modes["empty"] if mode.name == "body roll")
    bounce = next(mode for mode in result.modes["empty"] if mode.name == "body bounce")
    assert roll.frequency_std is None
    assert bounce.frequency_std is not None


def test_what_is_known_exactly_stays_and_makes_the_rest_known() -> None:
    known = {
        "total_mass": KnownValue(SCHOOL_BUS.total_mass, 5.0),
        "a": KnownValue(2.22),
        "t_f2": KnownValue(0.4),
        "t_r2": KnownValue(0.5),
    }
    result = sprung.identify(sprung.simulate(SCHOOL_BUS, noise=0.02, seed=2, known=known))
    assert result.fit.tracks == "separate"  # a known t_2 says so
    for name, value in {"a": 2.22, "b": SCHOOL_BUS.wheelbase - 2.22, "t_f2": 0.4, "t_r2": 0.5}.items():
        one = result.parameters[name]
        assert (one.status, one.std) == ("known", 0.0)
        assert one.value == pytest.approx(value, rel=1e-12)
    assert "a" not in result.correlation.names
    for name in ("m_s", "k_sf", "c_sr", "t_f1"):
        one = result.parameters[name]
        assert one.value is not None
        assert one.std is not None
        assert abs(one.value - SCHOOL_BUS.parameters[name]) < 4 * one.std


@pytest.mark.slow
def test_knowledge_that_contradicts_the_recordings_is_doubted() -> None:
    load = {"name": "bags", "items": [{"mass": 150, "position": (-1.0, 0.2, 0.5)}]}
    wrong = {"total_mass": KnownValue(1.2 * TABLE_1_CAR.total_mass, 2.0)}  # 10 % would be the mass of the load
    result = sprung.identify(sprung.simulate(TABLE_1_CAR, loads=[load], noise=0.005, seed=3, known=wrong))
    assert result.verdict.state != "accept"
    assert any("total_mass" in reason for reason in result.verdict.reasons)


def test_no_usable_drop_is_refused_with_every_reason() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, seed=1, duration=0.3)
    with pytest.raises(InputError) as caught:
        sprung.identify(campaign)
    assert str(caught.value).count("free vibration") == 5


def test_every_channel_of_a_correlation_has_ones_on_its_diagonal(sedan: sprung.Result) -> None:
    matrix = np.array(sedan.correlation.matrix)
    np.testing.assert_allclose(np.diag(matrix), 1.0)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    assert np.abs(matrix).max() <= 1 + 1e-12


def test_a_load_that_no_drop_has_adds_nothing() -> None:
    """People on seats who took part in no drop have no frequency that any recording tells."""
    campaign = sprung.simulate(
        TABLE_1_CAR, rate=250.0, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass}
    )
    driver = Load(name="driver", items=(Item(mass=75.0, position=(-1.2, 0.35, 0.9), on="seat"),))
    result = sprung.identify(replace(campaign, loads=(*campaign.loads, driver)))
    assert result.verdict.state == "accept"
    assert "w_l" not in result.parameters
