"""The studies of docs/studies in miniature: they run, their page and numbers come out, and the numbers make sense."""

from __future__ import annotations

import importlib
import importlib.util
import json
import subprocess
import sys
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.vehicle import TABLE_1_CAR

STUDIES = Path(__file__).resolve().parents[2] / "docs" / "studies"
VERDICTS = {"accept", "doubtful", "reject"}


def study(script: str, folder: Path, *arguments: str) -> tuple[str, Any]:
    """Run a study as the command its page prints; gives page and numbers."""
    command = [sys.executable, str(STUDIES / script), *arguments, "--to", str(folder)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)  # noqa: S603 (our own script)
    name = Path(script).stem.replace("_", "-")
    page = (folder / f"{name}.md").read_text(encoding="utf-8")
    return page, json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))


def check_errors(case: dict[str, Any], campaigns: int, quantities: Collection[int] = (15, 17)) -> None:
    assert case["campaigns"] == campaigns
    assert case["verdicts"].keys() == VERDICTS
    assert sum(case["verdicts"].values()) == campaigns
    assert len(case["quantities"]) in quantities  # with half-distances shared, and not
    for one in case["quantities"].values():
        assert one["undetermined"] == 0
        # Errors are standard normal in units of the bound: beyond six of them something is wrong.
        assert 0 <= one["rmse_over_bound"] < 6
        assert abs(one["bias_over_bound"]) <= one["rmse_over_bound"] * 1.001  # four figures
        assert 0.6 < one["stated_over_bound"] < 1.6  # it is a function of the parameters, and these are off a little
    assert case["rmse_over_bound"] > 0.02  # and they are not all hit


@pytest.fixture
def campaigns(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(STUDIES))
    return importlib.import_module("campaigns")


def test_campaigns_are_those_of_simulate(campaigns: Any) -> None:
    case = campaigns.Case(TABLE_1_CAR, True, ("total_mass",), 0.05)
    ours = case.campaign(3)
    loads = [campaigns.ballast(TABLE_1_CAR)]
    simulated = sprung.simulate(TABLE_1_CAR, loads=loads, noise=0.05, seed=case.seed(3), known=ours.known)
    assert (ours.sensors, ours.drops, ours.loads, ours.known) == (
        simulated.sensors,
        simulated.drops,
        simulated.loads,
        simulated.known,
    )
    for one, other in zip(ours.recordings, simulated.recordings, strict=True):
        assert (one.name, one.start, one.rate) == (other.name, other.start, other.rate)
        np.testing.assert_array_equal(one.values, other.values)


def test_what_is_weighed_is_drawn_from_its_own_uncertainty(campaigns: Any) -> None:
    case = campaigns.Case(TABLE_1_CAR, False, campaigns.AXLES, 0.02)
    drawn = [case.known(np.random.default_rng(seed)) for seed in range(400)]
    for name, truth in case.known().items():
        off = np.array([one[name].value - truth.value for one in drawn]) / truth.std
        assert abs(off.mean()) < 4 / np.sqrt(400)
        assert off.std() == pytest.approx(1, abs=4 / np.sqrt(800))  # four standard errors of a standard deviation


def test_the_bound_is_that_of_the_plan(campaigns: Any) -> None:
    case = campaigns.Case(TABLE_1_CAR, False, ("total_mass",), 0.02)
    planned = sprung.plan(TABLE_1_CAR, known=case.known(), noise=0.02).rows[0].bound
    assert planned is not None
    expected = [(planned.percents[name] or np.nan) / 100 for name in TABLE_1_CAR.parameters]
    np.testing.assert_allclose(case.bound(range(5)), expected, rtol=1e-9)


@pytest.mark.long
def test_at_the_bound(tmp_path: Path) -> None:
    page, numbers = study("at_the_bound.py", tmp_path, "--campaigns", "1", "--each", "1", "--noise", "0.1")
    assert "| five drops, axles weighed | 0.02 |" in page
    assert "1 campaigns in every row" in page
    assert "nan" not in page
    assert len(numbers["headline"]) == 6
    assert {case["vehicle"] for case in numbers["others"]} == {"Small car", "Van", "School bus"}
    for case in numbers["headline"]:
        check_errors(case, 1)
    for case in numbers["others"]:
        check_errors(case, 1)
        assert case["wrong_models"] == case["incomplete"] == 0
        per_mass = [name for name in case["quantities"] if name.endswith("/ total mass")]
        assert len(per_mass) == (11 if case["test"] == "five drops, nothing weighed" else 0)
    drawn = importlib.util.find_spec("matplotlib") is not None
    assert (tmp_path / "at-the-bound.svg").exists() == drawn == ("at-the-bound.svg" in page)


@pytest.mark.long
def test_exported_drops(tmp_path: Path) -> None:
    for package in ("fmpy", "rumoca", "mujoco"):
        pytest.importorskip(package)
    page, numbers = study("exported_drops.py", tmp_path, "--cases", "quarter", "mount")
    quarter, mount = numbers["cases"]
    assert max(quarter["modelica"], quarter["fmu"], quarter["mjcf"]) < 0.01
    assert mount["mjcf"] is None
    assert "are met" in page
    assert "| mount |" in page


@pytest.mark.long
def test_parts_of_a_vehicle(tmp_path: Path) -> None:
    page, numbers = study("parts_of_a_vehicle.py", tmp_path, "--campaigns", "1")
    assert "nan" not in page
    assert {case["vehicle"] for case in numbers["cases"]} == {"Quarter car", "Roll plane", "Pitch plane"}
    for case in numbers["cases"]:
        check_errors(case, 1, {"Quarter car": (5,), "Roll plane": (7, 8), "Pitch plane": range(9, 14)}[case["vehicle"]])
        assert case["wrong_models"] == case["incomplete"] == 0


@pytest.mark.long
def test_pads(tmp_path: Path) -> None:
    page, numbers = study("pads.py", tmp_path, "--campaigns", "1")
    assert "nan" not in page
    assert {case["vehicle"] for case in numbers["cases"]} == {"Table 1 car", "Quarter car", "Roll plane", "Pitch plane"}
    for case in numbers["cases"]:
        assert case["campaigns"] == case["accepted"] == 1
        assert case["largest_error_percent"] < 1.0
        for one in case["quantities"].values():
            # Errors are standard normal in units of the bound: beyond six of them something is wrong.
            assert 0 <= one["rmse_over_bound"] < 6
            assert 0.6 < one["stated_over_bound"] < 1.6


@pytest.mark.long
def test_excitations(tmp_path: Path) -> None:
    page, numbers = study("excitations.py", tmp_path, "--campaigns", "1")
    assert "nan" not in page
    assert len(numbers["cases"]) == 14
    for case in numbers["cases"]:
        assert case["verdicts"]["reject"] == case["wrong_models"] == case["incomplete"] == 0
        assert case["rmse_over_bound"] < 3
    is_there = importlib.util.find_spec("mujoco") is not None
    assert bool(numbers["engine"]) == is_there == ("A car of another engine" in page)


@pytest.mark.long
def test_coloured(tmp_path: Path) -> None:
    page, numbers = study("coloured.py", tmp_path, "--campaigns", "1", "--tests", "1")
    assert "row has 1 campaigns" in page
    assert [case["kind"].split(",")[0] for case in numbers["cases"]] == ["white", "low-passed", "white", "white"]
    white, low_passed, drifting, _ = numbers["cases"][:4]
    check_errors(white, 1)
    for case in (low_passed, drifting):
        assert case["inflated"] == 1  # neighbours correlated to 0.9, or a drift of twice the noise, never go unseen
        assert case["coverage_percent"] > 50


@pytest.mark.long
def test_no_guess(tmp_path: Path) -> None:
    page, numbers = study("no_guess.py", tmp_path, "--campaigns", "2")
    assert "2 two-axle vehicles" in page
    assert "The optimum was missed 0 times" in page
    assert len({vehicle["parameters"]["m_s"] for vehicle in numbers["vehicles"]}) == 2
    for vehicle in numbers["vehicles"]:
        assert abs(vehicle["gain_over_start_at_truth"]) < 0.01
        assert vehicle["verdict"] in VERDICTS
        assert 0 < vehicle["worst_error_over_stated"] < 6


@pytest.mark.long
def test_differences(tmp_path: Path) -> None:
    page, numbers = study("differences.py", tmp_path, "--campaigns", "1")
    assert "## Unchanged vehicle" in page
    assert len(numbers["cases"]) == 10
    for case in numbers["cases"]:
        assert 0.2 < case["z_rms"] < (3 if case["change"] == 0 else 30)
    # 75 N s/m of 1500, told to 8 or so.
    assert [case["damper_seen"] for case in numbers["cases"] if case["change"] == 0.05] == [1.0, 1.0]


@pytest.mark.long
def test_ride(tmp_path: Path) -> None:
    page, numbers = study("ride.py", tmp_path, "--campaigns", "1")
    assert "nan" not in page
    assert len(numbers["cases"]) == 5
    for case in numbers["cases"]:
        assert case["campaigns"] == 1
        for one in case["numbers"].values():
            assert one["coverage_percent"] in (0, 100)
            assert one["rms_error_over_std"] < 6


@pytest.mark.long
def test_fleets(tmp_path: Path) -> None:
    page, numbers = study("fleets.py", tmp_path, "--campaigns", "12", "--fleets", "1")
    assert {one["parameter"] for one in numbers["errors"]} >= {"m_s", "k_sf", "a", "wheelbase"}
    for one in numbers["errors"]:
        assert one["vehicles"] == 12
        assert 0 <= one["single_coverage"] <= 100
        assert one["hierarchical_stated"] <= one["single_stated"] * 1.01
    assert {(one["vehicles"], one["fleets"]) for one in numbers["coverage"]} == {(30, 20), (12, 4)}
    for one in numbers["coverage"]:
        assert one["least_coverage"] <= one["coverage"] <= 100
        assert one["coverage"] == pytest.approx(95, abs=7)  # 48 vehicles, of which those of a fleet share one spread
        assert one["gain"] > 1
    assert [one["computed"] for one in numbers["identified"]] == [12, 7]  # from the middle on, and the weak dampers
    assert [one["count"] for one in numbers["charts"]] == [1] * 4
    assert "python docs/studies/fleets.py --campaigns 12 --fleets 1" in page
