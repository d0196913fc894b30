"""Force curves of an identified vehicle: true within their standard errors, over the range that the drops reached."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung.assessment import Verdict
from sprung.report import report_html, result_view, text_of
from sprung.results import Result, damper_tables, withhold_estimates
from sprung.simulation import BlockSupport, simulate_nonlinear_drops
from sprung.vehicle import EMPTY, TABLE_1_CAR, WHEELS, Rows, Wheel
from sprung.vehicle.kinematics import travel

CAR = TABLE_1_CAR.with_values(r_f=2.4, r_r=1.8)
DROPPED: tuple[tuple[Wheel, ...], ...] = (WHEELS, ("rl", "rr"), ("fl", "rl"))


@pytest.fixture(scope="module")
def result() -> Result:
    drops = [{"wheels": list(dropped), "load": "empty"} for dropped in DROPPED]
    known = {"total_mass": CAR.total_mass}
    campaign = sprung.simulate(CAR, drops=drops, noise=0.02, seed=1, rate=200, duration=1.4, known=known)
    return sprung.identify(campaign, extras="rebound", tracks="shared", fall=False)


@pytest.mark.slow
def test_the_curves_are_true_within_their_standard_errors(result: Result) -> None:
    assert list(result.curves) == ["damper_front", "damper_rear"]
    for name, curve in result.curves.items():
        assert (curve.x_unit, curve.force_unit, curve.friction) == ("m/s", "N", None)
        axle = name.removeprefix("damper_")[0]
        velocity = np.linspace(*curve.reached, 9)
        true = getattr(CAR, f"c_s{axle}") * velocity * np.where(velocity > 0, getattr(CAR, f"r_{axle}"), 1.0)
        force, std = curve.at(velocity)
        # Four standard errors: exceeded by chance once in 16 000 times.
        assert np.all(np.abs(force - true) <= 4 * std)
        assert np.all(std <= 0.02 * np.abs(true))


@pytest.mark.slow
def test_the_standard_error_follows_from_the_joint_covariance(result: Result) -> None:
    c, r, cov = result.parameters["c_sf"].value, result.parameters["r_f"].value, result.covariance
    assert c is not None
    assert r is not None
    # Rebound: F = c r v; compression: F = c v.
    rebound = 0.4**2 * (r**2 * cov["c_sf", "c_sf"] + c**2 * cov["r_f", "r_f"] + 2 * r * c * cov["c_sf", "r_f"])
    curve = result.curves["damper_front"]
    assert curve.at(0.4) == pytest.approx((0.4 * c * r, rebound**0.5), rel=1e-3)
    assert curve.at(-0.4) == pytest.approx((-0.4 * c, 0.4 * cov["c_sf", "c_sf"] ** 0.5), rel=1e-3)
    assert curve.at(0.0) == pytest.approx((0.0, 0.0), abs=1e-9)
    # Beyond the stored points a line goes on: so does this law.
    assert curve.at(10.0).force == pytest.approx(10 * c * r, rel=1e-3)


def test_the_range_is_that_of_the_decays(result: Result) -> None:
    blocks = [BlockSupport(EMPTY, dropped, 0.05) for dropped in DROPPED]  # 0.05 m: what `simulate` drops from
    values = list(CAR.parameters.values())
    row = Rows.of([travel("fl", "t_f"), travel("fr", "t_f")], tuple(CAR.parameters)).at(values)
    motions = simulate_nonlinear_drops(CAR, blocks, 0.005, 280, 0.0)
    rates = np.concatenate([row @ motion.velocity for motion in motions], axis=1)
    low, high = result.curves["damper_front"].reached
    # The decays begin after the last lift-off: less than the whole drop, more than a quarter of it.
    assert 1.02 * rates.min() < low < 0.25 * rates.min()
    assert 0.25 * rates.max() < high < 1.02 * rates.max()


@pytest.mark.slow
def test_curves_are_saved_and_come_back(result: Result, tmp_path: Path) -> None:
    document = json.loads((result.save(tmp_path) / "results.json").read_text(encoding="utf-8"))
    own = document["curves"]["damper_front"]
    assert {"x", "force", "std", "x_unit", "force_unit"} <= own.keys()
    again = sprung.load(tmp_path).curves["damper_front"]
    assert again.at(0.3) == result.curves["damper_front"].at(0.3)
    assert again.reached == result.curves["damper_front"].reached
    assert report_html(sprung.load(tmp_path)) == report_html(result)


@pytest.mark.slow
def test_the_report_has_the_curves(result: Result) -> None:
    html = report_html(result)
    assert "Force curves" in html
    assert "front from " in html
    assert "Force curves" not in report_html(replace(result, curves={}))


def test_damper_forces_are_tabulated_as_far_as_the_drops_reached(result: Result) -> None:
    [table] = damper_tables(result.curves)
    curve = result.curves["damper_front"]
    for velocity, rebound, compression, *_ in table.rows:
        for cell, signed in ((rebound, float(velocity)), (compression, -float(velocity))):
            force, std = curve.at(signed)
            if curve.reached[0] <= signed <= curve.reached[1]:
                value, _, error = cell.partition(" ± ")
                assert abs(float(value) - float(force)) < float(std)
                assert float(error) == pytest.approx(float(std), rel=0.06)  # two figures
            else:
                assert not cell
    assert "Damper forces" in text_of(result_view(result))
    assert not damper_tables({})


def test_a_rejected_result_has_no_curves(result: Result) -> None:
    rejected = replace(result, verdict=Verdict("reject", ("for a test",)))
    assert not withhold_estimates(rejected).curves
