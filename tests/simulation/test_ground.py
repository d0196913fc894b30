"""Static wheel loads, and rest on blocks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sprung.simulation import static_wheel_loads
from sprung.simulation.ground import Ground
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, SCHOOL_BUS, TABLE_1_CAR, WHEELS, Item, Load, Vehicle

UNEVEN = Vehicle.from_parameters(
    TABLE_1_CAR.parameters | {"y_s": 0.03, "d_ksf": 800.0, "d_ksr": -500.0, "d_ktf": 2e4, "d_ktr": -3e4}
)
CARS = st.sampled_from([TABLE_1_CAR, SCHOOL_BUS, UNEVEN])
LOADS = st.builds(
    lambda m, x, y: Load(name="load", items=(Item(mass=m, position=(x, y, 0.5)),)),
    st.floats(1, 300),
    st.floats(-2.5, 0),
    st.floats(-0.3, 0.3),
)


@given(CARS, LOADS)
@settings(max_examples=25, deadline=None)
def test_wheel_loads_hold_the_weight_and_its_moments(vehicle: Vehicle, load: Load) -> None:
    W = static_wheel_loads(vehicle, load)
    item = load.items[0]
    assert item.position is not None
    x, y, _ = item.position
    assert W.sum() == pytest.approx(STANDARD_GRAVITY * (vehicle.total_mass + load.total_mass()))
    # Moment about the front axle: the rear axle carries what lies behind it.
    behind = vehicle.m_s * vehicle.a - item.mass * x + 2 * vehicle.m_ur * vehicle.wheelbase
    assert W[2:].sum() * vehicle.wheelbase == pytest.approx(STANDARD_GRAVITY * behind)
    # Springs hold the body against roll at t_2, and the dampers carry nothing at rest.
    assert vehicle.t_f2 is not None
    assert vehicle.t_r2 is not None
    moment = vehicle.t_f2 * (W[0] - W[1]) + vehicle.t_r2 * (W[2] - W[3])
    assert moment == pytest.approx(STANDARD_GRAVITY * (item.mass * y + vehicle.m_s * vehicle.y_s), abs=1e-6)


@given(CARS, LOADS, st.lists(st.floats(0, 0.5), min_size=4, max_size=4))
@settings(max_examples=50, deadline=None)
def test_rest_on_blocks_is_in_equilibrium_and_no_tyre_pulls(vehicle: Vehicle, load: Load, heights: list[float]) -> None:
    ground = Ground.under(vehicle, load, STANDARD_GRAVITY)
    blocks = np.array(heights)
    X = ground.rest(blocks)
    force = np.maximum(0.0, ground.wheel_loads - ground.stiffness * (X[3:] - blocks))
    # Suspension force is what K says less the tyres; the wheels feel the ground's force beyond the static one.
    inner = ground.matrices.K @ X
    inner[3:] -= ground.stiffness * X[3:]
    assert_allclose(inner, np.append(np.zeros(3), force - ground.wheel_loads), atol=1e-6 * ground.wheel_loads.max())
    assert np.count_nonzero(force) >= 3


@pytest.mark.parametrize("height", [0.001, 0.5])
def test_one_high_block_leaves_the_opposite_wheel_hanging(height: float) -> None:
    ground = Ground.under(TABLE_1_CAR, EMPTY, STANDARD_GRAVITY)
    X = ground.rest(np.array([height, 0.0, 0.0, 0.0]))
    gap = X[3:] - ground.wheel_loads / ground.stiffness
    # The centre of gravity is ahead of the middle: it is the other front wheel, or the rear right one, that hangs.
    assert np.count_nonzero(gap > 0) == (1 if height > 0.1 else 0)


def test_blocks_of_one_height_lift_the_whole_vehicle_by_it() -> None:
    ground = Ground.under(SCHOOL_BUS, EMPTY, STANDARD_GRAVITY)
    X = ground.rest(np.full(len(WHEELS), 0.3))
    assert_allclose(X, 0.3 * np.array([1, 0, 0, 1, 1, 1, 1]), atol=1e-12)


def test_symmetric_vehicle_balanced_on_a_diagonal_still_stands() -> None:
    # Centre of gravity in the middle and blocks under two opposite wheels: either of the others may hang.
    even = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"b": 1.25, "k_sr": 17_000.0, "m_ur": 40.5})
    ground = Ground.under(even, EMPTY, STANDARD_GRAVITY)
    X = ground.rest(np.array([0.4, 0.0, 0.0, 0.4]))
    force = np.maximum(0.0, ground.wheel_loads - ground.stiffness * (X[3:] - [0.4, 0.0, 0.0, 0.4]))
    assert force.sum() == pytest.approx(STANDARD_GRAVITY * even.total_mass)


NO_SIGNALS = np.zeros(0)


@given(CARS, st.sampled_from([0.0, 1500.0, 20_000.0]))
@settings(max_examples=10, deadline=None)
def test_the_energy_that_can_just_lift_a_wheel_is_known_exactly(base: Vehicle, tyre_damping: float) -> None:
    vehicle = Vehicle.from_parameters(base.parameters | {"c_tf": tyre_damping, "c_tr": tyre_damping})
    ground = Ground.under(vehicle, EMPTY, STANDARD_GRAVITY)
    M, _, K = ground.matrices
    smallest = np.inf
    for i in range(4):
        # Of all states with its energy this one unloads tyre i most; scaled so that its force is just zero.
        unloading = np.eye(7)[3 + i]
        X = np.linalg.solve(K, ground.stiffness[i] * unloading)
        V = np.linalg.solve(M, ground.damping[i] * unloading)
        scale = ground.wheel_loads[i] / (ground.stiffness[i] * X[3 + i] + ground.damping[i] * V[3 + i])
        X, V = scale * X, scale * V
        assert ground.force(NO_SIGNALS)[i] @ np.concatenate([X, V, [1.0]]) == pytest.approx(
            0, abs=1e-9 * ground.wheel_loads[i]
        )
        assert not ground.keeps_contact(np.concatenate([1.001 * X, 1.001 * V, [1.0]]))
        energy = X @ K @ X + V @ M @ V
        if energy < smallest:
            smallest, least = energy, np.concatenate([0.999 * X, 0.999 * V, [1.0]])
    assert ground.keeps_contact(least)
