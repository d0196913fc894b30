"""Pushes and passes over a bump, against laws that hold for every vehicle and against time stepping."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

import sprung
from sprung.errors import InputError
from sprung.simulation import Bump, Push, drive_over_bump, drive_over_half_sine_bump, push_body, tyre_rates
from sprung.simulation.excited_motion import bump_drive
from sprung.simulation.ground import Ground
from sprung.vehicle import EMPTY, TABLE_1_CAR, Load, Vehicle, Wheel

ALMOST = TABLE_1_CAR.with_values(F_f=1e-9, s_f=1e5, F_r=1e-9, s_r=1e5)
"""The same car with a friction that nobody feels: its motions are stepped."""

DAMPED_TYRES = TABLE_1_CAR.with_values(c_tf=400.0, c_tr=300.0)


def test_a_low_bump_is_the_half_sine_of_the_paper() -> None:
    """All wheels of a side over a bump at once: front and rear wheels are in phase where the wheelbase is a bump behind."""
    speed, length = 3.0, 1.2
    motion = drive_over_bump(TABLE_1_CAR, wheels=("fl", "fr"), speed=speed, bump=Bump(height=0.02, length=length))
    paper, at_end = drive_over_half_sine_bump(
        TABLE_1_CAR.matrices(), tyre_rates(TABLE_1_CAR), ("fl", "fr"), 0.02, length / speed, 0.002, 500
    )
    assert not motion.events
    assert motion.decay_start == length / speed
    assert_allclose(motion.state(motion.decay_start), at_end, atol=1e-12)
    ours = motion.motion(0.002, 500)
    assert_allclose(ours.acceleration, paper.acceleration, atol=1e-9)
    assert_allclose(ours.displacement, paper.displacement, atol=1e-12)


@pytest.mark.parametrize(
    ("bump", "vehicle"),
    [
        (Bump(), TABLE_1_CAR),
        (Bump(shape="plank", height=0.04), DAMPED_TYRES),
        (Bump(shape="kerb", height=0.08), TABLE_1_CAR),
    ],
    ids=["half-sine", "plank", "kerb"],
)
@pytest.mark.slow
def test_a_pass_obeys_the_equations_of_motion(bump: Bump, vehicle: Vehicle) -> None:
    """An ordinary differential equation solver with the same ground, wheels that may leave it included."""
    wheels: tuple[Wheel, ...] = ("fl", "rl")
    speed, until = 5.0, 0.9
    motion = drive_over_bump(vehicle, EMPTY, wheels, speed, bump, duration=2.0)
    drive, ground = bump_drive(vehicle, wheels, speed, bump), Ground.under(vehicle, EMPTY, 9.80665)
    M, C, K = ground.matrices
    free = K - np.diag([0, 0, 0, *ground.stiffness]), C - np.diag([0, 0, 0, *ground.damping])

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        X, V = state[:7], state[7:]
        value, rate = (part[:, 0] for part in drive.values(np.array([time])))
        squeezed = ground.wheel_loads - ground.stiffness * (X[3:] - drive.heights @ value)
        force = squeezed - ground.damping * (V[3:] - drive.heights @ rate)
        force = np.where(squeezed > 0, np.maximum(force, 0.0), 0.0) - ground.wheel_loads
        return np.concatenate([V, np.linalg.solve(M, np.r_[0, 0, 0, force] - free[0] @ X - free[1] @ V)])

    times = np.arange(0, until, 0.01)
    solved = solve_ivp(rates, (0, until), np.zeros(14), t_eval=times, rtol=1e-9, atol=1e-11, max_step=4e-4)
    assert_allclose(motion.motion(0.01, len(times)).displacement, solved.y[:7], atol=2e-7)


def test_behind_a_kerb_the_vehicle_rests_on_the_level_above() -> None:
    motion = drive_over_bump(TABLE_1_CAR, bump=Bump(shape="kerb", height=0.06))
    assert motion.is_settled
    assert_allclose(motion.state(40.0)[:7], 0.06 * np.array([1, 0, 0, 1, 1, 1, 1]), atol=1e-9)


def test_a_rope_holds_the_body_in_equilibrium_until_it_is_released() -> None:
    load = Load(name="bag", items=({"mass": 100.0, "position": (-2.0, 0.3, 0.5)},))  # type: ignore[arg-type]
    motion = push_body(TABLE_1_CAR, load, ("rl", "rr"), Push(shape="rope", force=1200.0))
    start = motion.state(0.0)
    force = TABLE_1_CAR.matrices(load).K @ start[:7]
    assert_allclose(start[7:], 0.0)
    assert_allclose(force[0], -1200.0)
    assert_allclose(force[1], 1200.0 * -TABLE_1_CAR.b, rtol=1e-9)  # nose up: the force is behind the centre of gravity
    assert_allclose(force[2:], 0.0, atol=1e-9)


def test_pushes_by_hand_end_when_the_last_one_does() -> None:
    push = Push(count=3, frequency=1.5, force=400.0)
    motion = push_body(TABLE_1_CAR, push=push)
    assert motion.decay_start == pytest.approx((2 + 0.5) / 1.5)
    moved = motion.motion(0.002, 1000).displacement[0]
    assert moved.min() < -0.005
    assert not motion.events


@pytest.mark.parametrize("excitation", ["push", "pass"])
@pytest.mark.parametrize("shapes", [("hand", "half-sine"), ("rope", "plank"), ("lift", "kerb")])
@pytest.mark.slow
def test_a_vehicle_that_is_hardly_nonlinear_moves_like_a_linear_one(excitation: str, shapes: tuple[str, str]) -> None:
    push, bump = shapes
    test = {
        "drops": [{"excitation": excitation, "wheels": ["fl", "rl"]}],
        "push": {"shape": push},
        "bump": {"shape": bump, "height": 0.05},
        "noise": 0.0,
        "rest": 0.2007,
        "duration": 1.5,
        "known": {},
    }
    linear, stepped = (sprung.simulate(car, **test).recordings[0] for car in (TABLE_1_CAR, ALMOST))  # type: ignore[arg-type]
    assert_allclose(stepped.values, linear.values, atol=0.004 if excitation == "pass" else 2e-5)


def test_a_campaign_records_as_long_after_the_excitation_as_asked() -> None:
    drops: list[dict[str, object]] = [
        {"excitation": "pass", "speed": 2.0},
        {"excitation": "push"},
        {"wheels": ["fl", "fr"]},
    ]
    campaign = sprung.simulate(TABLE_1_CAR, drops=drops, rest=0.3, duration=2.0, push={"count": 1, "frequency": 1.0})
    driven = [(TABLE_1_CAR.wheelbase + 0.5) / 2.0, 0.5, 0.0]
    lengths = [recording.values.shape[1] / recording.rate for recording in campaign.recordings]
    assert_allclose(lengths, 2.3 + np.array(driven), atol=0.003)
    assert [drop.label for drop in campaign.drops] == ["empty_pass", "empty_push", "empty_pitch_front"]


@pytest.mark.parametrize("wheels", [(), ("lf",)])
def test_wheels_that_do_not_exist_are_named(wheels: tuple[str, ...]) -> None:
    for excite in (push_body, drive_over_bump):
        with pytest.raises(InputError):
            excite(TABLE_1_CAR, wheels=wheels)  # type: ignore[arg-type]


def test_a_push_or_bump_that_is_wrong_is_a_problem_of_the_arguments() -> None:
    with pytest.raises(InputError) as caught:
        sprung.simulate(TABLE_1_CAR, push={"shape": "foot"}, bump={"height": -1.0})
    assert {problem.where for problem in caught.value.problems} == {"simulate: push.shape", "simulate: bump.height"}
