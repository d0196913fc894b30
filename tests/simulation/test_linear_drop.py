"""The drop from blocks: laws of mechanics, an independent integrator, and what must not change the answer."""

from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sprung.errors import InputError, SprungError
from sprung.simulation import DropMotion, drop_from_blocks, static_wheel_loads, tyre_rates
from sprung.simulation.ground import Ground
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import (
    EMPTY,
    PARAMETERS,
    SCHOOL_BUS,
    TABLE_1_CAR,
    WHEELS,
    Item,
    Load,
    Motion,
    Vehicle,
    Wheel,
    free_decay,
)

Array = NDArray[np.float64]

HEAVE = np.array([1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
SIDEBAG = Load(name="sidebag", items=(Item(mass=150, position=(-0.4, 0.5, 0.8)),))
DAMPED_TYRES = {"c_tf": 900.0, "c_tr": 1500.0}


def with_changes(vehicle: Vehicle, **changes: float) -> Vehicle:
    return Vehicle.from_parameters(vehicle.parameters | changes, name=vehicle.name)


@st.composite
def vehicles(draw: st.DrawFn) -> Vehicle:
    """A car or a bus with rates and masses changed, with or without tyre damping, sometimes hardly damped at all."""
    base = draw(st.sampled_from([TABLE_1_CAR, SCHOOL_BUS]))
    changed = {
        name: base.parameters[name] * draw(st.floats(0.5, 2.0))
        for name in ("I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "a")
    }
    dampers = {name: base.parameters[name] * draw(st.sampled_from([0.0, 0.2, 1.0, 3.0])) for name in ("c_sf", "c_sr")}
    tyres = {name: draw(st.sampled_from([0.0, 100.0, 2000.0, 20_000.0])) for name in ("c_tf", "c_tr")}
    return with_changes(base, **changed, **dampers, **tyres)


SOME_WHEELS = st.lists(st.sampled_from(WHEELS), min_size=1, unique=True).map(tuple)
HEIGHTS = st.floats(0.001, 0.2)


def tyre_forces(vehicle: Vehicle, load: Load, motion: Motion) -> Array:
    """The law of the tyre, written here once more: a push while compressed, nothing otherwise; shape (4, time)."""
    k, c = np.array([tyre_rates(vehicle)[wheel] for wheel in WHEELS]).T[:, :, None]
    W = static_wheel_loads(vehicle, load)[:, None]
    push = W - k * motion.displacement[3:] - c * motion.velocity[3:]
    return np.where(W - k * motion.displacement[3:] > 0, np.maximum(0.0, push), 0.0)


def inner_matrices(vehicle: Vehicle, load: Load) -> tuple[Array, Array, Array]:
    """M, and C and K without tyres."""
    M, C, K = vehicle.matrices(load)
    k, c = np.array([tyre_rates(vehicle)[wheel] for wheel in WHEELS]).T
    return M, C - np.diag(np.append(np.zeros(3), c)), K - np.diag(np.append(np.zeros(3), k))


@given(vehicles(), st.sampled_from([EMPTY, SIDEBAG]), SOME_WHEELS, HEIGHTS)
@example(with_changes(SCHOOL_BUS, c_tf=5e4, c_tr=5e4), EMPTY, ("fl", "rl"), 0.2)  # lands before its tyre has relaxed
@settings(max_examples=40, deadline=None)
def test_equations_of_motion_hold_at_every_sample(
    vehicle: Vehicle, load: Load, wheels: tuple[Wheel, ...], height: float
) -> None:
    drop = drop_from_blocks(vehicle, load, wheels, height, duration=2.0)
    motion = drop.motion(0.001, 2000)
    M, C, K = inner_matrices(vehicle, load)
    W = static_wheel_loads(vehicle, load)
    beyond_static = np.vstack([np.zeros((3, 2000)), tyre_forces(vehicle, load, motion) - W[:, None]])
    residual = M @ motion.acceleration + C @ motion.velocity + K @ motion.displacement - beyond_static
    assert np.abs(residual).max() < 1e-6 * W.max()

    # Each wheel lifts off and lands in turn; at a landing its tyre just touches, at a lift-off it carries nothing.
    limits = {wheel: W[i] / tyre_rates(vehicle)[wheel][0] for i, wheel in enumerate(WHEELS)}
    damping = {wheel: tyre_rates(vehicle)[wheel][1] for wheel in WHEELS}
    for i, wheel in enumerate(WHEELS):
        mine = [event for event in drop.events if event.wheel == wheel]
        assert [event.kind for event in mine] == (["lift-off", "landing"] * len(mine))[: len(mine)]
        for event in mine:
            state = drop.state(event.time)
            if event.time > 0 and damping[wheel] == 0:
                assert state[3 + i] == pytest.approx(limits[wheel], abs=1e-12)
            elif event.time > 0 and event.kind == "lift-off":
                stiffness, c = tyre_rates(vehicle)[wheel]
                assert stiffness * (limits[wheel] - state[3 + i]) - c * state[10 + i] == pytest.approx(0, abs=1e-6)
    times = [event.time for event in drop.events]
    assert times == sorted(times)
    assert np.all(np.diff(drop.starts) >= 0)

    # Energy: springs and tyres store it, gravity is in the static tyre forces, and it never grows.
    k = np.array([tyre_rates(vehicle)[wheel][0] for wheel in WHEELS])[:, None]
    z = motion.displacement[3:]
    energy = 0.5 * np.einsum("it,ij,jt->t", motion.velocity, M, motion.velocity)
    energy += 0.5 * np.einsum("it,ij,jt->t", motion.displacement, K, motion.displacement)
    energy += (W[:, None] * z + np.maximum(0.0, W[:, None] - k * z) ** 2 / (2 * k)).sum(axis=0)
    growth = np.diff(energy)
    # A tyre that has stopped pushing while still compressed relaxes at no cost, which is energy lost at that moment.
    assert growth.max() < 1e-9 * np.abs(energy).max()
    if not vehicle.matrices().C.any():
        assert_allclose(energy, energy[0], rtol=1e-9)


def test_undamped_vehicle_keeps_its_energy_and_never_settles() -> None:
    bouncing = with_changes(TABLE_1_CAR, c_sf=0.0, c_sr=0.0)
    drop = drop_from_blocks(bouncing, height=0.1, duration=3.0)
    assert not drop.is_settled
    assert drop.until == 3.0
    assert len(drop.events) > 10
    M, _, K = inner_matrices(bouncing, EMPTY)
    W, k = static_wheel_loads(bouncing), 192_000
    states = np.array([drop.state(time) for time in np.linspace(0, 3, 40)])
    X, V, z = states[:, :7], states[:, 7:], states[:, 3:7]
    energy = 0.5 * np.einsum("ti,ij,tj->t", V, M, V) + 0.5 * np.einsum("ti,ij,tj->t", X, K, X)
    energy += (W * z + np.maximum(0.0, W - k * z) ** 2 / (2 * k)).sum(axis=1)
    assert_allclose(energy, energy[0], rtol=1e-10)
    with pytest.raises(ValueError, match=r"known from 0 to 3 s .* but 3.5 to 3.5 s were asked for"):
        drop.state(3.5)
    with pytest.raises(ValueError, match="give a longer duration"):
        drop.motion(0.5, 8)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS], ids=lambda vehicle: vehicle.name)
@pytest.mark.parametrize("load", [EMPTY, SIDEBAG], ids=lambda load: load.name)
def test_in_free_flight_gravity_alone_changes_the_momentum(vehicle: Vehicle, load: Load) -> None:
    drop = drop_from_blocks(vehicle, load, height=0.1)
    first_landing = min(event.time for event in drop.events if event.kind == "landing")
    motion = drop.motion(first_landing / 50, 50)
    M = vehicle.matrices(load).M
    weight = STANDARD_GRAVITY * (vehicle.total_mass + load.total_mass())
    assert_allclose(HEAVE @ M @ motion.acceleration, -weight, rtol=1e-10)
    assert_allclose(HEAVE @ M @ motion.velocity, -weight * first_landing / 50 * np.arange(50), atol=1e-8 * weight)


def integrated(vehicle: Vehicle, load: Load, start: Array, times: Array) -> Array:
    """The same drop by a step-by-step integrator that knows nothing of events."""
    M, C, K = inner_matrices(vehicle, load)
    W = static_wheel_loads(vehicle, load)
    inverse = np.linalg.inv(M)

    def derivative(_: float, Y: Array) -> Array:
        motion = Motion(Y[:7, None], Y[7:, None], np.empty((7, 1)))
        force = -K @ Y[:7] - C @ Y[7:]
        force[3:] += tyre_forces(vehicle, load, motion)[:, 0] - W
        return np.concatenate([Y[7:], inverse @ force])

    solution: Any = solve_ivp(derivative, (0, times[-1]), start, "RK45", times, rtol=1e-9, atol=1e-11, max_step=1e-3)
    return np.asarray(solution.y, dtype=np.float64)


@pytest.mark.parametrize(
    ("vehicle", "load", "wheels", "height"),
    [
        pytest.param(TABLE_1_CAR, EMPTY, WHEELS, 0.08, marks=pytest.mark.long),
        pytest.param(SCHOOL_BUS, EMPTY, ("fl", "rl"), 0.06, marks=pytest.mark.long),
        pytest.param(with_changes(SCHOOL_BUS, **DAMPED_TYRES), EMPTY, WHEELS, 0.06, marks=pytest.mark.long),
        (with_changes(TABLE_1_CAR, c_tf=100.0, c_tr=100.0), SIDEBAG, ("fr",), 0.15),
    ],
    ids=["car", "bus, left wheels", "bus with tyre damping", "loaded car, one wheel"],
)
@pytest.mark.slow
def test_drop_against_an_integrator(vehicle: Vehicle, load: Load, wheels: tuple[Wheel, ...], height: float) -> None:
    drop = drop_from_blocks(vehicle, load, wheels, height)
    times = np.linspace(0, 0.4, 81)
    motion = drop.motion(0.005, 81)
    expected = integrated(vehicle, load, drop.state(0.0), times)
    assert any(0 < event.time < 0.4 for event in drop.events)
    # The integrator steps over the events; what it loses there bounds the agreement.
    assert_allclose(motion.displacement, expected[:7], atol=1e-7)
    assert_allclose(motion.velocity, expected[7:], atol=2e-5)


@pytest.mark.parametrize("tyres", [{}, DAMPED_TYRES], ids=["plain", "tyre damping"])
@pytest.mark.parametrize("load", [EMPTY, SIDEBAG], ids=lambda load: load.name)
@pytest.mark.parametrize("wheels", [WHEELS, ("fl", "fr"), ("fr", "rr"), ("rl",)], ids="-".join)
def test_after_the_last_event_it_is_the_free_decay(
    tyres: dict[str, float], load: Load, wheels: tuple[Wheel, ...]
) -> None:
    vehicle = with_changes(SCHOOL_BUS, **tyres)
    drop = drop_from_blocks(vehicle, load, wheels, 0.05)
    assert drop.is_settled
    assert drop.decay_start == drop.events[-1].time > 0
    expected = free_decay(vehicle.matrices(load), drop.state(drop.decay_start), 0.002, 2000)
    for part, decay in zip(drop.motion(0.002, 2000, start=drop.decay_start), expected, strict=True):
        assert_allclose(part, decay, atol=1e-10 * np.abs(decay).max())


def test_low_drop_never_leaves_the_ground_and_is_linear() -> None:
    drops = [drop_from_blocks(TABLE_1_CAR, wheels=("fl", "rl"), height=height) for height in (0.001, 0.002)]
    low, higher = (drop.motion(0.002, 500).acceleration for drop in drops)
    for drop in drops:
        assert drop.events == ()
        assert drop.is_settled
        assert drop.decay_start == 0
    assert_allclose(higher, 2 * low, atol=1e-12)
    M, _, K = TABLE_1_CAR.matrices()
    rest = np.linalg.solve(K, 192_000 * 0.001 * np.array([0, 0, 0, 1, 0, 1, 0]))
    expected = free_decay(TABLE_1_CAR.matrices(), np.append(rest, np.zeros(7)), 0.002, 500)
    assert_allclose(low, expected.acceleration, atol=1e-12)
    assert_allclose(M @ low[:, 0], -K @ rest, atol=1e-8)


@pytest.mark.parametrize(("height", "flies"), [(0.0182, False), (0.0184, True)])
def test_a_tyre_stays_down_if_it_was_compressed_by_more_than_the_block(height: float, flies: bool) -> None:
    # Rear tyres of Table 1: (1380 · 1.25/2.76 + 90.8)/2 kg · 9.80665 m/s² / 192000 N/m = 0.01828 m.
    drop = drop_from_blocks(TABLE_1_CAR, wheels=("rl", "rr"), height=height)
    assert [event for event in drop.events if event.time == 0] == (
        [(0.0, "rl", "lift-off"), (0.0, "rr", "lift-off")] if flies else []
    )


@given(st.floats(1e-4, 0.02), st.floats(0, 0.3))
@settings(max_examples=25, deadline=None)
def test_samples_do_not_depend_on_the_rate_or_the_first_one(step: float, start: float) -> None:
    motion = BUS_DROP.motion(step, 40, start)
    half = BUS_DROP.motion(step / 2, 79, start)
    scale = np.abs(BUS_DROP.motion(0.001, 500).acceleration).max()
    assert_allclose(half.displacement[:, ::2], motion.displacement, atol=1e-12)
    assert_allclose(motion.displacement[:, -1], BUS_DROP.state(start + 39 * step)[:7], atol=1e-12)
    assert_allclose(half.acceleration[:, ::2], motion.acceleration, atol=1e-10 * scale)


BUS_DROP: DropMotion = drop_from_blocks(SCHOOL_BUS, height=0.06)


@pytest.mark.parametrize("tyres", [{}, DAMPED_TYRES], ids=["plain", "tyre damping"])
def test_left_and_right_mirror_each_other(tyres: dict[str, float]) -> None:
    vehicle = with_changes(TABLE_1_CAR, **tyres)
    mirrored = Load(name="m", items=(Item(mass=150, position=(-0.4, -0.5, 0.8)),))
    left = drop_from_blocks(vehicle, SIDEBAG, ("fl", "rl"), 0.07).motion(0.002, 400)
    right = drop_from_blocks(vehicle, mirrored, ("fr", "rr"), 0.07).motion(0.002, 400)
    mirror = np.eye(7)[[0, 1, 2, 4, 3, 6, 5]] * np.array([1, 1, -1, 1, 1, 1, 1])
    for one, other in zip(left, right, strict=True):
        assert_allclose(mirror @ one, other, atol=1e-10 * np.abs(one).max())


@pytest.mark.parametrize("tyres", [{}, DAMPED_TYRES], ids=["plain", "tyre damping"])
def test_drop_of_all_wheels_does_not_roll(tyres: dict[str, float]) -> None:
    motion = drop_from_blocks(with_changes(SCHOOL_BUS, **tyres), height=0.06).motion(0.002, 1000)
    for part in motion:
        assert np.abs(part[2]).max() < 1e-10 * np.abs(part).max()
        assert_allclose(part[3], part[4], atol=1e-9 * np.abs(part).max())


def test_front_and_rear_change_places() -> None:
    swap = {"f": "r", "r": "f"}
    turned = Vehicle.from_parameters(
        {
            {"a": "b", "b": "a"}.get(name, name[:-1] + swap.get(name[-1], name[-1])): value
            for name, value in TABLE_1_CAR.parameters.items()
        }
    )
    ahead = drop_from_blocks(TABLE_1_CAR, wheels=("fl", "fr"), height=0.07).motion(0.002, 400)
    behind = drop_from_blocks(turned, wheels=("rl", "rr"), height=0.07).motion(0.002, 400)
    turn = np.eye(7)[[0, 1, 2, 5, 6, 3, 4]] * np.array([1, -1, 1, 1, 1, 1, 1])
    assert_allclose(turn @ ahead.acceleration, behind.acceleration, atol=1e-10 * np.abs(ahead.acceleration).max())


@given(st.floats(0.1, 10.0))
@settings(max_examples=10, deadline=None)
def test_scaling_masses_and_rates_together_changes_no_acceleration(factor: float) -> None:
    base = with_changes(TABLE_1_CAR, **DAMPED_TYRES)
    scaled = with_changes(base, **{n: v * factor for n, v in base.parameters.items() if PARAMETERS[n].scales})
    assert_allclose(static_wheel_loads(scaled), factor * static_wheel_loads(base), rtol=1e-12)
    one, other = (drop_from_blocks(v, wheels=("fl", "fr"), height=0.06).motion(0.002, 400) for v in (base, scaled))
    assert_allclose(one.acceleration, other.acceleration, atol=1e-9 * np.abs(one.acceleration).max())


def test_acceleration_is_the_derivative_of_velocity_and_velocity_of_displacement() -> None:
    motion = BUS_DROP.motion(1e-5, 4000, start=0.06)  # between a landing and a lift-off
    for part, slope in ((motion.displacement, motion.velocity), (motion.velocity, motion.acceleration)):
        assert_allclose((part[:, 2:] - part[:, :-2]) / 2e-5, slope[:, 1:-1], atol=1e-5 * np.abs(slope).max())


def test_without_tyre_damping_the_acceleration_is_continuous_through_every_event() -> None:
    for event in BUS_DROP.events[4:]:
        before, after = BUS_DROP.motion(2e-9, 2, start=event.time - 1e-9).acceleration.T
        assert_allclose(before, after, atol=1e-4)


def test_a_stiff_light_wheel_chatters_and_comes_to_rest() -> None:
    hard = with_changes(TABLE_1_CAR, k_tf=5e6, k_tr=5e6, m_uf=5.0, m_ur=5.0, c_sf=200.0, c_sr=200.0)
    drop = drop_from_blocks(hard, height=0.1)
    assert drop.is_settled
    assert len(drop.events) > 50
    assert drop.decay_start < 10


def test_settled_means_that_no_tyre_force_reaches_zero_again() -> None:
    for vehicle in (TABLE_1_CAR, with_changes(SCHOOL_BUS, **DAMPED_TYRES)):
        drop = drop_from_blocks(vehicle, height=0.05)
        motion = drop.motion(0.0005, 10_000, start=drop.decay_start + 1e-6)
        assert tyre_forces(vehicle, EMPTY, motion).min() > 0
        ground = Ground.under(vehicle, EMPTY, STANDARD_GRAVITY)
        assert not ground.keeps_contact(np.append(drop.state(0.0), 1.0))
        assert ground.keeps_contact(np.append(drop.state(5.0), 1.0))


def test_a_drop_without_end_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sprung.simulation.contact_motion._MOST_SEGMENTS", 20)
    with pytest.raises(SprungError, match="is the vehicle damped"):
        drop_from_blocks(with_changes(TABLE_1_CAR, c_sf=0.0, c_sr=0.0), height=0.1)


def test_impossible_drops_name_every_fault() -> None:
    tail_heavy = Load(name="tail", items=(Item(mass=900, position=(-6.0, 0, 1)),))
    with pytest.raises(InputError) as caught:
        drop_from_blocks(TABLE_1_CAR, tail_heavy, ("fl", "lf"), -0.1)  # type: ignore[arg-type]
    assert [problem.expected for problem in caught.value.problems] == [
        "a wheel station",
        "a positive height",
        "all wheels pressed to the ground",
    ]
    with pytest.raises(InputError, match="found no wheels"):
        drop_from_blocks(TABLE_1_CAR, wheels=())
