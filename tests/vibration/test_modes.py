"""Modes against the undamped eigenvalue problem, hand-made systems and the paper's bus."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from sprung.simulation import default_sensors
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Matrices, Vehicle, sensor_rows
from sprung.vibration import (
    MODE_NAMES,
    Mode,
    compute_modes,
    expand_to_coordinates,
    make_modes,
    modal_assurance_criterion,
    name_modes,
    name_modes_at_sensors,
)
from strategies import vehicles


def test_a_mode_says_what_its_pole_means() -> None:
    mode = Mode(complex(-3, 4), np.ones(1, dtype=complex))
    # |−3 + 4i| = 5: the 3-4-5 triangle.
    assert mode.frequency == pytest.approx(5 / (2 * np.pi), rel=1e-15)
    assert mode.damped_frequency == pytest.approx(4 / (2 * np.pi), rel=1e-15)
    assert mode.damping_ratio == pytest.approx(0.6, rel=1e-15)


def test_rounding_does_not_choose_the_sign_of_a_shape() -> None:
    """Left and right wheels move equally far in opposition; which of them rounding makes the larger differs by processor."""
    for left in (1 - 1e-14, 1 + 1e-14):
        shape = np.array([0.2, left, -1.0])[:, None]
        [mode] = make_modes([complex(-1, 5)], shape)
        assert mode.shape == pytest.approx([0.2, 1.0, -1.0])


def test_a_real_pole_has_no_damped_frequency_and_critical_damping() -> None:
    mode = Mode(complex(-3, 0), np.ones(1, dtype=complex))
    assert (mode.damped_frequency, mode.damping_ratio) == (0.0, 1.0)


def test_the_bus_has_the_frequencies_of_tables_3_to_5() -> None:
    # Natural frequencies of Tables 4 and 5; Table 3 prints those of roll and of the front axle to four digits.
    expected = [
        ("body roll", 1.071),
        ("body bounce", 2.015),
        ("body pitch", 2.812),
        ("rear axle hop", 12.417),
        ("rear axle tramp", 12.442),
        ("front axle hop", 14.096),
        ("front axle tramp", 14.181),
    ]
    modes = compute_modes(SCHOOL_BUS.matrices())
    assert [mode.name for mode in modes] == [name for name, _ in expected]
    assert_allclose([mode.frequency for mode in modes], [frequency for _, frequency in expected], atol=6e-4)


def test_table_3_prints_the_damping_ratios_of_the_bus() -> None:
    # Table 3, column ζ, where it agrees with Tables 4 and 5 to all its digits.
    ratio = {mode.name: mode.damping_ratio for mode in compute_modes(SCHOOL_BUS.matrices())}
    printed = {"body roll": 0.1297, "rear axle tramp": 0.0984, "front axle hop": 0.1835, "front axle tramp": 0.1736}
    assert {name: round(ratio[name], 4) for name in printed} == printed


def test_the_ends_of_the_body_move_together_in_bounce_and_apart_in_pitch() -> None:
    for vehicle in (SCHOOL_BUS, TABLE_1_CAR):
        shape = {mode.name: mode.shape.real for mode in compute_modes(vehicle.matrices())}
        ends = {name: (z - vehicle.a * theta) * (z + vehicle.b * theta) for name, (z, theta, *_) in shape.items()}
        assert ends["body bounce"] > 0 > ends["body pitch"]


def test_wheels_of_like_axles_are_named_all_together() -> None:
    # A symmetric vehicle: every mode is a pure pattern of the four wheels, so the words can be checked one by one.
    car = Vehicle(
        m_s=1380, I_yy=2440, I_xx=380, m_uf=40, m_ur=40, k_sf=20000, k_sr=20000, k_tf=192000, k_tr=192000,
        c_sf=1500, c_sr=1500, a=1.4, b=1.4, t_f=0.74, t_r=0.74,
    )  # fmt: skip
    patterns = {
        "wheel bounce": [1, 1, 1, 1],
        "wheel pitch": [-1, -1, 1, 1],
        "wheel roll": [1, -1, 1, -1],
        "wheel warp": [1, -1, -1, 1],
    }
    shapes = {mode.name: mode.shape[3:, None] for mode in compute_modes(car.matrices())}
    for name, pattern in patterns.items():
        assert modal_assurance_criterion(shapes[name], np.array(pattern)[:, None])[0, 0] == pytest.approx(1.0, abs=1e-3)


@given(vehicles)
@settings(max_examples=30, deadline=None)
def test_poles_solve_the_equation_of_motion_and_there_are_fourteen(vehicle: Vehicle) -> None:
    M, C, K = vehicle.matrices()
    modes = compute_modes(Matrices(M, C, K))
    assert sum(2 if mode.pole.imag else 1 for mode in modes) == 14
    for mode in modes:
        forces = [mode.pole**2 * M @ mode.shape, mode.pole * C @ mode.shape, K @ mode.shape]
        assert np.linalg.norm(sum(forces)) < 1e-7 * max(float(np.linalg.norm(force)) for force in forces)


@given(vehicles)
@settings(max_examples=30, deadline=None)
def test_every_name_is_used_once_or_for_a_pair_of_real_poles(vehicle: Vehicle) -> None:
    modes = compute_modes(vehicle.matrices())
    poles: dict[str | None, list[complex]] = {}
    for mode in modes:
        poles.setdefault(mode.name, []).append(mode.pole)
    assert set(poles) <= {*MODE_NAMES, None}
    assert {"body bounce", "body pitch", "body roll"} < set(poles)
    named = [found for name, found in poles.items() if name is not None]
    assert all(len(found) == 1 or (len(found) == 2 and not np.imag(found).any()) for found in named)


@given(vehicles)
@settings(max_examples=20, deadline=None)
def test_the_product_of_all_frequencies_is_that_of_the_undamped_vehicle(vehicle: Vehicle) -> None:
    # det A = det(M⁻¹K): damping moves the fourteen poles but not their product.
    M, _, K = vehicle.matrices()
    undamped = np.sqrt(eigh(K, M, eigvals_only=True)) / (2 * np.pi)
    logs = [np.log(mode.frequency) / (1 if mode.pole.imag else 2) for mode in compute_modes(vehicle.matrices())]
    assert sum(logs) == pytest.approx(float(np.sum(np.log(undamped))), abs=1e-7)


def test_overdamped_modes_come_in_adjacent_pairs_at_their_undamped_frequency() -> None:
    # Two uncoupled oscillators in two channels: λ² + 50 λ + 400 (poles -10, -40, √400 = 20 rad/s) and 5 rad/s undamped.
    poles = [-40, complex(-0.1, 5), complex(-0.1, -5), -10]
    shapes = np.array([[1, 0, 0, 1], [0, 1, 1, 0]])
    modes = make_modes(poles, shapes)
    assert [mode.pole for mode in modes] == [complex(-0.1, 5), -10, -40]


@given(vehicles, st.floats(0.0, 2 * np.pi), st.floats(0.01, 100))
@settings(max_examples=10, deadline=None)
def test_similarity_ignores_size_and_phase_and_lies_between_0_and_1(
    vehicle: Vehicle, phase: float, size: float
) -> None:
    shapes = np.stack([mode.shape for mode in compute_modes(vehicle.matrices())], axis=1)
    alike = modal_assurance_criterion(shapes, size * np.exp(1j * phase) * shapes)
    assert_allclose(np.diag(alike), 1.0, atol=1e-12)
    assert_allclose(alike, alike.T, atol=1e-12)
    assert alike.min() >= 0
    assert alike.max() <= 1 + 1e-12


@pytest.mark.parametrize("vehicle", [SCHOOL_BUS, TABLE_1_CAR], ids=lambda vehicle: vehicle.name)
def test_shapes_at_eight_sensors_give_back_coordinates_and_names(vehicle: Vehicle) -> None:
    sensors = default_sensors(vehicle)
    rows = sensor_rows(sensors, ("a",)).at([vehicle.a])
    truth = compute_modes(vehicle.matrices())
    seen = [Mode(mode.pole, rows @ mode.shape) for mode in truth]
    for mode, back in zip(truth, expand_to_coordinates(seen, sensors, vehicle.a), strict=True):
        assert_allclose(back.shape, mode.shape, atol=1e-12)
    # Also without knowing where the centre of gravity is.
    assert [mode.name for mode in name_modes_at_sensors(seen, sensors)] == [mode.name for mode in truth]


def test_a_few_modes_get_the_names_that_fit_them() -> None:
    truth = compute_modes(SCHOOL_BUS.matrices())
    some = [truth[i] for i in (2, 0, 4)]
    assert [mode.name for mode in name_modes(some)] == ["body roll", "body pitch", "rear axle tramp"]
    assert name_modes([]) == ()
