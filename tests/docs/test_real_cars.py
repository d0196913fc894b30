"""The simulator of real cars, which shares no equation with the package, equals it where both have the same physics."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from real_campaigns import record
from real_kinds import KINDS, NO_VEHICLE, Draw, add_knee, add_tyre, draw_test
from real_motion import BallastItem, Motion, Row, Rows, follow
from real_outcomes import Outcome, examine
from real_rotations import follow_turning
from real_vehicle import BodyMode, Occupant, RealCar

import sprung
from sprung.vehicle import TABLE_1_CAR, Vehicle

SIZES: dict[str, Any] = dict(TABLE_1_CAR.parameters)
PLAIN = RealCar(**SIZES)
ITEMS = (BallastItem(140, -1.1, 0.3), BallastItem(80, -2.2, -0.3, (3.0, 4.0)))
LOAD = {
    "name": "ballast",
    "items": [{"mass": one.mass, "position": (one.x, one.y, 0.5), "inertia": one.inertia} for one in ITEMS],
}
DROPS = [{"load": "empty", "wheels": ("fl", "fr")}, {"load": "ballast", "wheels": ("fl", "rl")}]
ROWS = (Row(PLAIN, (), ("fl", "fr"), release=0.1), Row(PLAIN, ITEMS, ("fl", "rl"), release=0.1))


def difference(car: RealCar, vehicle: Vehicle, step: float) -> float:
    """Return the largest difference of wheel accelerations over the largest acceleration."""
    simulated = sprung.simulate(vehicle, loads=[LOAD], drops=DROPS, noise=0.0, rest=0.1, duration=0.15)
    motion = follow([replace(row, car=car) for row in ROWS], 500.0, 0.25, step)
    every = round(0.002 / motion.step)
    theirs = np.array([one.values[4:] for one in simulated.recordings]) - 9.80665
    ours = motion.acceleration[:, 4:8, ::every]
    # At the release itself a block is gone at once here, and there.
    return float(np.abs(ours - theirs)[:, :, 52:].max() / np.abs(theirs).max())


def test_equals_simulate_for_the_plain_car() -> None:
    # Landings are kinks: the error of one step falls with its third power on average, 1e-5 at 0.25 ms.
    assert difference(PLAIN, TABLE_1_CAR, 2.5e-4) < 2e-5
    assert difference(PLAIN, TABLE_1_CAR, 1e-4) < 4e-6


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ({"anti_roll": (9e3, 4e3)}, {"k_af": 9e3, "k_ar": 4e3}),
        ({"rebound": (1.8, 2.2)}, {"r_f": 1.8, "r_r": 2.2}),
        ({"progressive": (2.0, 3.0)}, {"p_f": 2.0, "p_r": 3.0}),
        ({"friction": (60.0, 50.0), "presliding": (3e5, 2e5)}, {"F_f": 60.0, "F_r": 50.0, "s_f": 3e5, "s_r": 2e5}),
    ],
    ids=["anti-roll", "rebound", "progressive", "friction"],
)
@pytest.mark.slow
def test_equals_simulate_for_laws_that_both_have(ours: dict[str, Any], theirs: dict[str, Any]) -> None:
    # Time stepping of nonlinear elements has errors of 1e-4 there; the noise is 2e-4 of the largest acceleration.
    assert difference(replace(PLAIN, **ours), replace(TABLE_1_CAR, **theirs), 2.5e-4) < 3e-4


def test_energy_is_conserved_without_dampers() -> None:
    car = replace(
        PLAIN, c_sf=1e-9, c_sr=1e-9, body_mode=BodyMode("twist", 12.0, damping=0.0), anti_roll=(5e3, 3e3),
        occupants=(Occupant(-1.0, 0.4, damping=0.0),),
    )  # fmt: skip
    motion = follow([Row(car, ITEMS, ("fl", "rl"), release=0.1)], 500.0, 0.5, with_energy=True)
    falling = motion.energy[0, 401:]
    assert np.ptp(falling) < 1e-4 * (falling[0] - energy_at_rest(car))


def energy_at_rest(car: RealCar) -> float:
    system = Rows([Row(car, ITEMS)])
    flat = np.zeros((1, 4))
    return float(system.energy(system.rest(flat), flat)[0])


def test_a_relaxed_branch_and_a_stiff_mount_change_nothing() -> None:
    motions: list[Motion] = []
    for car in (
        PLAIN,
        replace(PLAIN, mount=(60 * 17e3, 60 * 22e3), mount_damping=(1e6, 1e6)),
        replace(PLAIN, zener=(0.2, 0.2), relaxation=(1e-3, 1e-3), c_sf=1500 - 3.4, c_sr=1500 - 4.4),
    ):
        motions.append(follow([replace(ROWS[0], car=car)], 500.0, 0.25))
    plain, mounted, relaxed = (one.acceleration[0, 4:8, 500:] for one in motions)
    assert np.abs(mounted - plain).max() < 5e-3 * np.abs(plain).max()  # c / (c + 1e6) of the travel
    assert np.abs(relaxed - plain).max() < 5e-3 * np.abs(plain).max()  # a branch of 1 ms is a damper of k τ


def test_damper_curve_is_inverted() -> None:
    car = draw_test("usual", 3).car
    system = Rows([Row(car)])
    rates = np.array([[0.01, -0.3, 1.0, -2.0]])
    pull = system.damper(rates) + system.mount_damping * rates
    np.testing.assert_allclose(system.damper_rate(pull), rates, rtol=1e-12)
    np.testing.assert_allclose(system.damper(rates)[0, 0], car.damper_force(rates[0, 0], 0), rtol=1e-12)


def test_small_rotations_are_those_of_the_plane_equations() -> None:
    test = draw_test("tall", 1)
    rows = [Row(test.car, (), wheels, height=1e-5, release=0.1) for wheels in (("fl", "fr"), ("fl", "rl"))]
    turning = follow_turning(rows, test.sensors, 0.5, 0.5, 500.0, 0.3)
    flat = follow(rows, 500.0, 0.3, turning.step)
    assert turning.readings is not None
    for row in range(len(rows)):
        ours = np.array([one.reading(test.car, flat, row, 0.5) for one in test.sensors])
        # Second order in the angle of 1e-5 rad: 1e-9 m/s² of gravity and less.
        np.testing.assert_allclose(turning.readings[row], ours, rtol=0, atol=3e-9)


@pytest.mark.slow
def test_a_campaign_of_every_kind() -> None:
    tests = [draw_test(kind, 5) for kind in (*KINDS, *NO_VEHICLE)]
    short = [replace(one, drops=one.drops[1:2]) for one in tests]
    for test, (campaign, truth) in zip(short, record([replace(one, duration=0.8) for one in short]), strict=True):
        assert campaign.name == f"{test.kind} 5"
        assert len(campaign.drops) == 1
        values = campaign.recordings[0].values
        assert values.shape == (8, 400)
        assert np.abs(values[:, :190] - 9.81).max() < 0.5  # gravity, with gains of one per cent
        assert 20 < np.abs(values[4:6]).max() < 300
        assert 0.42 < truth.last_lift_off[0] < 0.7
        # Nothing is thrown away that the recordings' noise would show.
        assert values[:, :190].std(axis=1) == pytest.approx(0.02, rel=0.35)


@pytest.mark.slow
def test_what_fails_is_an_outcome() -> None:
    ((campaign, truth),) = record([replace(draw_test("plain", 0), drops=draw_test("plain", 0).drops[:1], duration=1.2)])
    failed = examine(campaign, truth, 30.0, extras=["no such term"])
    assert isinstance(failed, Outcome)
    assert failed.verdict == "failed"
    assert "no such term" in failed.reason
    late = examine(campaign, truth, 0.01)
    assert (late.verdict, late.reason) == ("failed", "more than 0.01 s of processor time")


@pytest.mark.slow
def test_a_tall_car_is_identified_whose_body_turns_by_finite_angles() -> None:
    """To second order in the angles the roll inertia was 1 % off, the rear anti-roll bar 0.5 %."""
    test = draw_test("tall", 1)
    ((campaign, truth),) = record([replace(test, noise=1e-3)])
    assert (test.cg_height or 0.0) > 0.75
    known = replace(campaign, cg_height=test.cg_height, wheel_height=test.wheel_height)
    result = sprung.identify(known, extras=("anti-roll",))
    for name, value in truth.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=2e-3), name


@pytest.mark.slow
def test_finite_rotation_shows_beside_noise() -> None:
    """It gains 185 and one Newton step from the other geometry promised a loss: the pitch inertia was 3.1 errors off."""
    ((campaign, truth),) = record([replace(draw_test("tall", 511), noise=0.1, duration=2.0)])
    result = sprung.identify(campaign, extras=("anti-roll", "gravity"), fall=False)
    assert any(step.stage == "select_finite_rotation" for step in result.trace)
    for name, value in truth.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - value) < 4 * found.std, name


@pytest.mark.long
def test_tyres_that_stiffen_a_little_beside_much_noise_are_no_wrong_clock() -> None:
    """The drop that compresses them most seemed to have a clock that runs 0.7 % too fast, and was left out."""
    ((campaign, truth),) = record([replace(draw_test("tyre", 516), height=0.03, rate=400.0, noise=0.1, duration=8.0)])
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, {*outcome.model}, outcome.faults) == ("accept", {"tyre-damping", "tyre-curve"}, ())


@pytest.mark.long
def test_a_wheel_still_in_the_air_hides_no_rounded_knee() -> None:
    """One sample of one wheel left as much as all the rest: knees of dampers were 13 standard errors off, and accepted."""
    ((campaign, truth),) = record([replace(draw_test("knee", 501), height=0.03, rate=250.0, noise=0.05, duration=3.0)])
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, outcome.model) == ("accept", ("rebound", "damper-curve", "rounded-knee"))
    assert outcome.worst_scaled[0] < 4


@pytest.mark.slow
def test_what_a_refused_body_that_bends_explained_is_looked_for_again() -> None:
    """People on seats were not tried beside it, nor after it was refused: rejected, and a healthy sensor blamed."""
    ((campaign, truth),) = record(
        [replace(draw_test("seats", 628), height=0.08, rate=1000.0, noise=0.05, duration=3.0)]
    )
    outcome = examine(campaign, truth, 300.0)
    assert outcome.verdict != "reject"
    assert ("occupants" in outcome.model, outcome.faults) == (True, ())
    assert outcome.worst_scaled[0] < 4


@pytest.mark.slow
def test_what_the_filter_of_all_loggers_still_rings_of_blames_no_sensor() -> None:
    """A filter of order 4 at 100 Hz rings for 15 ms after a landing: a healthy sensor was left out, variances enlarged."""
    test = draw_test("sensors", 36)
    exact = tuple(replace(one, gain=1.0, tilt=(0.0, 0.0), misplaced=(0.0, 0.0)) for one in test.sensors)
    ((campaign, truth),) = record([replace(test, sensors=exact)])
    result = sprung.identify(campaign)
    assert (result.verdict.state, result.faults, result.fit.inflation) == ("accept", (), 1.0)
    for drop, lift_off in zip(result.drops, truth.last_lift_off, strict=True):
        assert drop.start is not None
        assert 0.005 < drop.start - lift_off < 0.03


@pytest.mark.long
def test_a_fit_far_from_the_recordings_does_not_shift_mass_to_the_wheels() -> None:
    """From an ordinary vehicle that bends it went to wheels of 300 kg, and everything after that failed."""
    ((campaign, truth),) = record([draw_test("bending", 4)])
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, outcome.model, outcome.faults) == ("accept", ("bending",), ())
    assert outcome.worst[0] < 0.02


@pytest.mark.long
def test_friction_is_not_lost_on_the_way_from_an_ordinary_vehicle() -> None:
    """A fit of everything at once lost it: a low-pass, rubber and tyre damping made up for it, at up to 4.9 standard errors."""
    ((campaign, truth),) = record([draw_test("usual", 5)])
    outcome = examine(campaign, truth, 600.0)
    assert (outcome.verdict, outcome.faults) == ("accept", ())
    assert {"friction", "mount-damping"} <= {*outcome.model}
    assert outcome.worst_scaled[0] < 4


@pytest.mark.long
def test_no_drop_stays_with_frictions_that_hold_with_more_than_they_can() -> None:
    """Two drops did, contradicted all others by 15, and hid a low-pass at 100 Hz: doubtful, rubber 19 % wrong."""
    ((campaign, truth),) = record([draw_test("usual", 1)])
    outcome = examine(campaign, truth, 900.0)
    assert (outcome.verdict, outcome.faults) == ("accept", ())
    assert outcome.worst_scaled[0] < 4


@pytest.mark.long
def test_a_body_that_turns_far_is_no_brake() -> None:
    """Its loaded roll drops differ from all others to second order in the angle: they were left out as with the brake on."""
    ((campaign, truth),) = record([draw_test("tall", 7)])
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, outcome.faults) == ("accept", ())
    assert outcome.worst_scaled[0] < 4


@pytest.mark.long
def test_a_part_that_made_up_for_finite_rotation_is_not_subtracted_from_the_recordings() -> None:
    """People of half a kilogram on seats that drive them: their motion grew, and what it seemed to turn was subtracted."""
    ((campaign, truth),) = record([draw_test("tall", 4)])
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, outcome.model, outcome.faults) == ("accept", ("anti-roll", "gravity"), ())
    assert outcome.worst_scaled[0] < 4


@pytest.mark.long
def test_the_samples_that_a_poorer_model_gives_up_show_what_it_lacks() -> None:
    """To a body that bends on tyres that do not damp wheels seem to hop for long: the rest accepted a wheel 11 errors off."""
    test = draw_test("bending", 0)
    stiffening = replace(test, car=add_tyre(test.car, Draw("tyre", 0)), height=0.07)
    ((campaign, truth),) = record([replace(stiffening, noise=0.03, rate=400.0, duration=3.0)])
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, {*outcome.model}, outcome.faults) == (
        "accept",
        {"bending", "tyre-damping", "tyre-curve"},
        (),
    )
    assert outcome.worst_scaled[0] < 4


@pytest.mark.long
def test_laws_of_the_same_springs_are_compared() -> None:
    """Air springs were taken for progressive ones with bump stops: at up to 5.6 standard errors."""
    test = draw_test("air", 3)
    ((campaign, truth),) = record(
        [replace(test, car=add_knee(test.car, Draw("knee", 3)), height=0.03, rate=1000.0, noise=0.07)]
    )
    outcome = examine(campaign, truth, 300.0)
    assert (outcome.verdict, outcome.faults) == ("accept", ())
    assert "air" in outcome.model
    assert not {"progressive", "bump-stop"} & {*outcome.model}
    assert outcome.worst_scaled[0] < 4


@pytest.mark.long
@pytest.mark.parametrize(("seed", "terms"), [(34, {"occupants", "air"}), (64, {"occupants", "friction"})])
def test_two_unusual_properties_are_tried_together_before_every_usual_term(seed: int, terms: set[str]) -> None:
    """Each hid the other: every usual term was fitted to the rigid body and to flexible ones first, in three times the time."""
    ((campaign, truth),) = record([draw_test("two effects", seed)])
    steps: list[str] = []
    outcome = examine(campaign, truth, 600.0, progress=lambda step: steps.append(str(step)))
    assert (outcome.verdict, outcome.faults) == ("accept", ())
    assert terms <= {*outcome.model}
    assert outcome.worst_scaled[0] < 4
    assert sum(step.endswith("every usual term") for step in steps) == 1
