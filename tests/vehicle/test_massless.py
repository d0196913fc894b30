"""Coordinates without mass: dampers behind rubber mounts, and Zener branches beside the springs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import eigvals

import sprung
from sprung.errors import InputError
from sprung.simulation import drop_from_blocks, static_wheel_loads
from sprung.vehicle import TABLE_1_CAR, Item, Load, Vehicle, coordinates, free_decay, state_variables
from sprung.vibration import compute_modes

Array = NDArray[np.float64]

MOUNTS = {"k_df": 2.0e5, "k_dr": 2.4e5, "c_df": 90.0, "c_dr": 120.0}
BRANCHES = {"k_zf": 3000.0, "k_zr": 4500.0, "c_zf": 150.0, "c_zr": 290.0}
WITH_MOUNTS = Vehicle.from_parameters(TABLE_1_CAR.parameters | MOUNTS)
WITH_BRANCHES = Vehicle.from_parameters(TABLE_1_CAR.parameters | BRANCHES)
WITH_BOTH = Vehicle.from_parameters(TABLE_1_CAR.parameters | MOUNTS | BRANCHES, name="car with rubber")

BALLAST = Load(name="ballast", items=(Item(mass=150.0, position=(-2.3, 0.3, 0.5)),))


def rates_of_change(car: Vehicle, state: Array) -> Array:
    """Newton's equations of a car with rubber, element by element: nothing here comes from `sprung.vehicle`.

    The state is {X, x_d, x_z, Ẋ} with the travels of the dampers behind the mounts and in the branches.
    """
    z, theta, phi, *wheels = state[:7]
    dampers, branches, velocities = state[7:11], state[11:15], state[15:]
    accelerations, relaxations = np.zeros(7), np.zeros(8)
    masses = (car.m_s, car.I_yy, car.I_xx, car.m_uf, car.m_uf, car.m_ur, car.m_ur)
    for i, (axle, side) in enumerate((("f", 1), ("f", -1), ("r", 1), ("r", -1))):
        k_s, k_t, c_s, k_d, c_d, k_z, c_z, half = (
            getattr(car, f"{name}{axle}") for name in ("k_s", "k_t", "c_s", "k_d", "c_d", "k_z", "c_z", "t_")
        )
        lever = -car.a if axle == "f" else car.b
        travel = z + lever * theta + side * half * phi - wheels[i]
        rate = velocities[0] + lever * velocities[1] + side * half * velocities[2] - velocities[3 + i]
        # The damper carries what its mount carries: c_s v = k_d (x - x_d) + c_d (rate - v).
        relaxations[i] = (k_d * (travel - dampers[i]) + c_d * rate) / (c_s + c_d)
        branch = k_z * (travel - branches[i])
        relaxations[4 + i] = branch / c_z
        mount = c_s * relaxations[i]
        force = k_s * travel + mount + branch
        accelerations[:3] -= force * np.array([1.0, lever, side * half])
        accelerations[3 + i] += force - k_t * wheels[i]
    return np.concatenate([velocities, relaxations, accelerations / masses])


def test_a_free_decay_is_that_of_newtons_equations() -> None:
    state = np.random.default_rng(2).standard_normal(22) * np.repeat([0.02, 0.01, 0.3], [7, 8, 7])
    motion = free_decay(WITH_BOTH.matrices(), state, 0.01, 60)
    times = np.arange(60) * 0.01
    found = solve_ivp(
        lambda _, y: rates_of_change(WITH_BOTH, y), (0, 0.6), state, "DOP853", times, rtol=1e-11, atol=1e-14
    ).y
    rates = np.array([rates_of_change(WITH_BOTH, one) for one in found.T]).T
    assert_allclose(motion.displacement, found[:15], atol=1e-9)
    assert_allclose(motion.velocity, rates[:15], atol=1e-7)
    assert_allclose(motion.acceleration[:7], rates[15:], atol=1e-6)


@pytest.mark.parametrize("car", [WITH_MOUNTS, WITH_BRANCHES, WITH_BOTH])
def test_poles_are_the_finite_ones_of_the_quadratic_pencil(car: Vehicle) -> None:
    M, C, K = car.matrices(BALLAST)
    n, unit, zero = len(M), np.eye(len(M)), np.zeros_like(M)
    pencil = eigvals(np.block([[zero, unit], [-K, -C]]), np.block([[unit, zero], [zero, M]]))
    finite = pencil[np.abs(pencil) < 1e6]
    poles = np.linalg.eigvals(car.matrices(BALLAST).state)
    assert len(poles) == len(finite) == n + 7 == len(state_variables(car.parameters))
    distances = np.abs(poles[:, None] - finite) / np.abs(finite)
    assert_allclose(distances.min(axis=0), 0.0, atol=1e-7)
    assert_allclose(distances.min(axis=1), 0.0, atol=1e-7)


@pytest.mark.long
def test_a_stiff_mount_and_a_branch_of_next_to_nothing_are_none() -> None:
    stiff = TABLE_1_CAR.with_values(k_df=1e10, k_dr=1e10, k_zf=1e-3, k_zr=1e-3)
    ours, plain = (drop_from_blocks(car, wheels=("fl", "rr")).motion(0.002, 400) for car in (stiff, TABLE_1_CAR))
    # Rounding in the exponential of a matrix grows with its norm, here 1e10 / 1500 per second.
    assert_allclose(ours.displacement[:7], plain.displacement, atol=1e-5 * np.abs(plain.displacement).max())


def test_a_branch_on_one_axle_alone_is_no_branch_on_the_other() -> None:
    front = TABLE_1_CAR.with_values(k_zf=3000.0, c_zf=150.0)
    almost = front.with_values(k_zr=1e-6)
    ours, other = (drop_from_blocks(car, BALLAST, height=0.03).motion(0.002, 300) for car in (front, almost))
    assert_allclose(ours.displacement[:7], other.displacement[:7], atol=1e-9)


def test_rubber_weighs_nothing_and_at_rest_the_branches_have_relaxed() -> None:
    assert_allclose(static_wheel_loads(WITH_BOTH, BALLAST), static_wheel_loads(TABLE_1_CAR, BALLAST), rtol=1e-12)


def test_its_relaxations_are_no_modes() -> None:
    modes = compute_modes(WITH_BOTH.matrices(), coordinates(WITH_BOTH.parameters))
    plain = compute_modes(TABLE_1_CAR.matrices())
    assert sorted(str(mode.name) for mode in modes) == sorted(str(mode.name) for mode in plain)
    assert all(mode.pole.imag > 0 for mode in modes)


def test_mounts_of_one_axle_alone_are_refused() -> None:
    with pytest.raises(InputError, match="k_dr"):
        TABLE_1_CAR.with_values(k_df=2e5)
    with pytest.raises(InputError, match="c_sf"):
        WITH_MOUNTS.with_values(c_sf=0.0)


@pytest.mark.parametrize("car", [WITH_MOUNTS, WITH_BRANCHES, WITH_BOTH])
def test_without_noise_identification_returns_what_was_simulated(car: Vehicle) -> None:
    campaign = sprung.simulate(car, loads=[BALLAST], noise=0.0)
    result = sprung.identify(campaign, extras=car.extras)
    for name, value in car.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize("car", [WITH_MOUNTS, WITH_BRANCHES, WITH_BOTH])
@pytest.mark.slow
def test_requested_rubber_is_estimated_within_its_errors(car: Vehicle) -> None:
    campaign = sprung.simulate(car, loads=[BALLAST], noise=0.02, seed=4)
    result = sprung.identify(campaign, extras=car.extras)
    assert result.verdict.state == "accept"
    for name, value in car.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - value) < 4 * found.std
        assert found.std < 0.05 * value


@pytest.mark.parametrize(
    "car",
    [TABLE_1_CAR, *(pytest.param(car, marks=pytest.mark.long) for car in (WITH_MOUNTS, WITH_BRANCHES)), WITH_BOTH],
)
@pytest.mark.slow
def test_rubber_is_selected_where_it_is(car: Vehicle) -> None:
    campaign = sprung.simulate(car, loads=[BALLAST], noise=0.02, seed=1)
    assert sprung.identify(campaign).fit.model == car.extras
