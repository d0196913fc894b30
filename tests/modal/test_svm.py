"""The State Variable Method against state matrices that are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from sprung.errors import InputError
from sprung.modal import state_matrix, state_variable_method
from sprung.simulation import drive_over_half_sine_bump, tyre_rates
from sprung.vehicle import TABLE_1_CAR, Vehicle, free_decay
from sprung.vibration import compute_modes
from strategies import vehicles

Array = NDArray[np.float64]


def decays(vehicle: Vehicle, rate: float, samples: int, count: int = 4) -> list[Array]:
    """Accelerations from as many different states as asked for."""
    states = np.random.default_rng(7).standard_normal((count, 14)) * np.repeat([0.01, 0.3], 7)
    return [free_decay(vehicle.matrices(), state, 1 / rate, samples).acceleration for state in states]


def test_a_pendulum_by_hand() -> None:
    # x(k) = r^k cos(k ω): x(k + 2) = 2 r cos ω x(k + 1) - r² x(k), so A₁ = [[0, 1], [-r², 2 r cos ω]].
    r, omega = 0.9, 0.5
    record = (r ** np.arange(12) * np.cos(omega * np.arange(12)))[None]
    found = state_variable_method([record], rate=10.0)
    assert_allclose(found.transition, [[0, 1], [-(r**2), 2 * r * np.cos(omega)]], atol=1e-12)
    assert_allclose(sorted(found.poles.imag), [-10 * omega, 10 * omega], rtol=1e-12)
    assert_allclose(found.poles.real, 10 * np.log(r), rtol=1e-12)


@pytest.mark.parametrize("kind", ["displacement", "velocity", "acceleration"])
def test_one_bump_under_the_left_wheels_gives_the_state_matrix_exactly(kind: str) -> None:
    # The paper's simulation, section 3.
    matrices = TABLE_1_CAR.matrices()
    _, state = drive_over_half_sine_bump(matrices, tyre_rates(TABLE_1_CAR), ("fl", "rl"), 0.09, 0.2, 1e-3, 1)
    record = getattr(free_decay(matrices, state, 2e-3, 1000), kind)
    A = state_variable_method([record], 500.0, lag=10).state_matrix
    size = np.sqrt(np.outer(np.diag(matrices.K), np.diag(matrices.K)))
    assert np.max(np.abs(matrices.M @ A[7:, :7] + matrices.K) / size) < 1e-8
    assert_allclose(A[:7, 7:], np.eye(7), atol=1e-8)


@given(vehicles)
@settings(max_examples=15, deadline=None)
def test_poles_and_shapes_of_any_vehicle_overdamped_ones_too(vehicle: Vehicle) -> None:
    expected = np.sort_complex(np.linalg.eigvals(vehicle.matrices().state))
    found = state_variable_method(decays(vehicle, 1000.0, 1500), 1000.0, lag=8)
    distance = np.abs(found.poles[:, None] - expected)
    assert np.all(distance.min(axis=0) < 1e-5 * np.abs(expected))


def test_pairs_of_real_poles_are_found_and_put_into_the_state_matrix() -> None:
    vehicle = TABLE_1_CAR.with_values(c_sf=9000.0, c_sr=9000.0)
    matrices = vehicle.matrices()
    assert sum(mode.pole.imag == 0 for mode in compute_modes(matrices)) >= 4
    found = state_variable_method(decays(vehicle, 1000.0, 800), 1000.0, lag=5)
    assert_allclose(found.state_matrix, matrices.state, atol=1e-6 * np.abs(matrices.state).max())
    assert sum(mode.pole.imag == 0 for mode in found.modes) == sum(
        mode.pole.imag == 0 for mode in compute_modes(matrices)
    )


def test_units_of_channels_do_not_change_the_poles() -> None:
    records = decays(TABLE_1_CAR, 500.0, 600)
    scale = np.array([1, 1e3, 1e-3, 10, 1, 1, 9.80665])[:, None]
    plain = state_variable_method(records, 500.0, 10)
    scaled = state_variable_method([scale * record for record in records], 500.0, 10)
    assert_allclose(np.sort_complex(scaled.poles), np.sort_complex(plain.poles), rtol=1e-9)


def test_equation_12_puts_a_known_matrix_together_again() -> None:
    A = TABLE_1_CAR.matrices().state
    poles, vectors = np.linalg.eig(A)
    assert_allclose(state_matrix(poles, vectors[:7]), A, atol=1e-9 * np.abs(A).max())


def test_what_cannot_be_used_is_said_all_at_once() -> None:
    broken = np.ones((3, 40))
    broken[1, 2] = np.nan
    with pytest.raises(InputError) as caught:
        state_variable_method([np.ones((3, 40)), np.ones((2, 40)), broken, np.ones(4)], 0.0)
    assert len(caught.value.problems) == 4
    with pytest.raises(InputError, match="at least 14"):
        state_variable_method([np.ones((7, 12))], 100.0)
    with pytest.raises(InputError, match="one sample or more"):
        state_variable_method([np.ones((7, 12))], 100.0, lag=0)
    with pytest.raises(InputError, match="at least one"):
        state_variable_method([], 100.0)
