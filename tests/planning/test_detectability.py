"""What a test would show of model terms and of inexact sensors: against fits of simulated recordings, and by its laws."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import sprung
from sprung.planning import MeasurementSetup, PlannedDrop, TermCandidate, TermDetectability, detect_terms
from sprung.simulation import default_sensors
from sprung.uncertainty import KnownValue
from sprung.vehicle import EMPTY, TABLE_1_CAR, Vehicle, Wheel

MASS = {"total_mass": {"value": TABLE_1_CAR.total_mass, "std": 2.0}}
WHEELS: tuple[tuple[Wheel, ...], ...] = (
    ("fl", "fr", "rl", "rr"),
    ("fl", "fr"),
    ("rl", "rr"),
    ("fl", "rl"),
    ("fr", "rr"),
)
DROPS = tuple(PlannedDrop(EMPTY, wheels, 0.03) for wheels in WHEELS)
TYRES = TermCandidate("tyre-damping", {"c_tf": 90.0, "c_tr": 90.0}, 0.06, 30.0)
RUBBER = TermCandidate("zener", {"k_zf": 2500.0, "k_zr": 3300.0, "c_zf": 100.0, "c_zr": 130.0}, 0.15, 40.0)
FRICTION = TermCandidate("friction", {"F_f": 34.0, "F_r": 44.0, "s_f": 17e4, "s_r": 22e4}, 1.0, 40.0)


def setup(noise: float = 0.02) -> MeasurementSetup:
    known = {"wheelbase": KnownValue(TABLE_1_CAR.wheelbase), "total_mass": KnownValue(TABLE_1_CAR.total_mass, 2.0)}
    sensors = tuple(sensor.exact for sensor in default_sensors(TABLE_1_CAR))
    return MeasurementSetup(TABLE_1_CAR, "shared", (), known, sensors, np.full(8, noise), 500.0, 3.2)


@cache
def found() -> dict[str, TermDetectability]:
    return {one.name: one for one in detect_terms(setup(), DROPS, (TYRES, RUBBER, FRICTION))}


@pytest.mark.parametrize(
    "candidate", [RUBBER, pytest.param(FRICTION, marks=pytest.mark.long)], ids=["zener", "friction"]
)
@pytest.mark.slow
def test_the_gain_is_that_of_fits_with_and_without_the_term(candidate: TermCandidate) -> None:
    """At four times the size from which it is found, sixteen times the gain that is required.

    Friction gains a little less than by the square of its size: where it is larger it stops the motion earlier.
    By chance a gain g has the standard deviation 2 sqrt(g), 9 % of 480; and the fits begin 2 samples earlier than the plan, in
    which hop loses 15 % of its energy (22 1/s).
    """
    expected = found()[candidate.name]
    part = 4 * expected.smallest / expected.size
    assert expected.gain * part**2 == pytest.approx(16 * candidate.required)
    sizes = {name: value * part for name, value in candidate.parameters.items()}
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | sizes)
    drops = [{"wheels": wheels, "height": 0.03} for wheels in WHEELS]
    campaign = sprung.simulate(car, drops=drops, noise=0.02, seed=1, known=MASS)
    without, with_it = (
        sprung.identify(campaign, extras=extras, tracks="shared", fall=False) for extras in ((), (candidate.name,))
    )
    gained = 2 * (with_it.loglikelihood - without.loglikelihood)
    assert gained == pytest.approx(16 * candidate.required, rel=0.4)


@pytest.mark.slow
def test_half_the_noise_shows_half_the_size() -> None:
    """Nearly: both are computed at twice the size that is found, and gains grow as its square where it is small."""
    for quiet in detect_terms(setup(0.01), DROPS, (TYRES, RUBBER)):
        assert quiet.smallest == pytest.approx(0.5 * found()[quiet.name].smallest, rel=0.1)


@pytest.mark.slow
def test_repeats_add_their_gains_and_a_term_is_its_own_rival() -> None:
    """Two times the same drops; and of two candidates that are the same term neither is told from the other."""
    twice = detect_terms(setup(), (*DROPS, *DROPS), (TYRES,))[0]
    assert twice.gain == pytest.approx(2 * found()["tyre-damping"].gain, rel=0.1)
    own, _ = detect_terms(setup(), DROPS, (TYRES, TYRES._replace(name="other")))
    assert own.rival == "other"
    assert own.smallest_beside > 100 * own.smallest


@pytest.mark.long
def test_the_plan_states_terms_and_json_has_them() -> None:
    plan = sprung.plan(TABLE_1_CAR, terms=True, known=MASS)
    assert list(plan.terms) == ["as planned", "blocks twice as high"]
    terms = {one.name: one for one in plan.terms["as planned"]}
    assert {"damper-mount", "zener", "friction", "damper-curve", "tyre-damping"} <= set(terms)
    assert all(one.is_found for one in terms.values())
    document = plan.document()["terms"]["as planned"]
    assert {one["name"]: one["smallest"] for one in document} == {name: one.smallest for name, one in terms.items()}
    assert "told from it from" in sprung.report.text_of(sprung.report.plan_view(plan))
    assert sprung.plan(TABLE_1_CAR, known=MASS).terms == {}


@pytest.mark.slow
def test_sensors_enter_the_bound_as_they_enter_the_fit() -> None:
    """Stated sensors have their default uncertainties: 1 %, 2 degrees and 1 cm; those of a plan without any are exact."""
    sensors = [replace(one, gain_std=0.01, tilt_std=2.0, position_std=0.01) for one in default_sensors(TABLE_1_CAR)]
    campaign = sprung.simulate(TABLE_1_CAR, sensors=sensors, sensor_errors=True, noise=0.02, seed=3, known=MASS)
    result = sprung.identify(campaign, extras=(), tracks="shared", fall=False)
    assert result.fit.inflation == 1
    plan = sprung.plan(TABLE_1_CAR, sensors=sensors, known=MASS, model={"tracks": "shared"})
    exact = sprung.plan(TABLE_1_CAR, known=MASS, model={"tracks": "shared"})
    bound, without = plan.rows[0].bound, exact.rows[0].bound
    assert bound is not None
    assert without is not None
    for name, percent in bound.percents.items():
        assert result.parameters[name].percent == pytest.approx(percent, rel=0.06)
    growth = [(bound.percents[name] or 0.0) / (without.percents[name] or 1.0) for name in ("I_xx", "t_f", "a")]
    assert max(growth) > 1.5
