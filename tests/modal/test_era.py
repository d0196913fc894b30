"""Eigensystem realisation, and the door to all methods."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from sprung.errors import InputError
from sprung.modal import APPROXIMATE, METHODS, eigensystem_realisation, identify_modes
from sprung.simulation import default_sensors
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle, free_decay, sensor_rows
from sprung.vibration import compute_modes, modal_assurance_criterion, name_modes_at_sensors
from strategies import vehicles

Array = NDArray[np.float64]
RATE = 500.0

# Wheels that still move when the last of the dropped ones has landed: all, front, rear, left, right.
SIDES = np.array([[1, 1, 1, 1], [1, 1, 0, 0], [0, 0, 1, 1], [1, 0, 1, 0], [0, 1, 0, 1]])


def records(vehicle: Vehicle, noise: float, offset: float, seed: int, seconds: float = 3.0) -> list[Array]:
    """Eight accelerometers in five decays of a vehicle that comes down with 0.5 m/s at the wheels dropped."""
    rng = np.random.default_rng(seed)
    rows = sensor_rows(default_sensors(vehicle), ("a",)).at([vehicle.a])
    found = []
    for dropped in SIDES:
        front, rear, left, right = dropped[:2].mean(), dropped[2:].mean(), dropped[::2].mean(), dropped[1::2].mean()
        body = [dropped.mean(), (rear - front) / vehicle.wheelbase, (left - right) / 1.4]
        state = np.concatenate([np.zeros(7), -0.5 * np.concatenate([body, dropped])])
        seen = rows @ free_decay(vehicle.matrices(), state, 1 / RATE, round(seconds * RATE)).acceleration
        found.append(seen + noise * rng.standard_normal(seen.shape) + offset * rng.standard_normal((8, 1)))
    return found


@pytest.mark.parametrize("vehicle", [SCHOOL_BUS, TABLE_1_CAR], ids=lambda vehicle: vehicle.name)
def test_without_noise_poles_shapes_and_names_are_exact_whatever_the_offsets(vehicle: Vehicle) -> None:
    truth = compute_modes(vehicle.matrices())
    found = eigensystem_realisation(records(vehicle, 0.0, 5.0, seed=1), RATE)
    assert_allclose([mode.pole for mode in found], [mode.pole for mode in truth], rtol=1e-9)
    named = name_modes_at_sensors(found, default_sensors(vehicle), vehicle.a)
    assert [mode.name for mode in named] == [mode.name for mode in truth]
    for one, other in zip(named, truth, strict=True):
        assert modal_assurance_criterion(one.shape[:, None], other.shape[:, None])[0, 0] > 1 - 1e-9


@given(vehicles)
@settings(max_examples=8, deadline=None)
def test_any_vehicle_without_noise(vehicle: Vehicle) -> None:
    expected = np.linalg.eigvals(vehicle.matrices().state)
    found = eigensystem_realisation(records(vehicle, 0.0, 0.5, seed=2), RATE, order=14)
    poles = np.array([mode.pole for mode in found])
    upper = expected[expected.imag > 0]
    assert np.all(np.abs(poles[:, None] - upper).min(axis=0) < 1e-5 * np.abs(upper))


@pytest.mark.parametrize("seed", range(3))
def test_noise_of_a_usual_sensor_leaves_every_mode_within_one_percent(seed: int) -> None:
    # 0.02 m/s² rms (2 mg). A prototype measured 0.02-0.3 % over such drops (median of four seeds).
    truth = compute_modes(TABLE_1_CAR.matrices())
    found = identify_modes(records(TABLE_1_CAR, 0.02, 0.1, seed), RATE)
    assert len(found) == 7
    distance = np.abs(np.array([mode.pole for mode in found])[:, None] - [mode.pole for mode in truth]).min(axis=0)
    assert np.all(distance < 0.01 * np.abs([mode.pole for mode in truth]))


def test_the_order_is_what_the_drops_excite() -> None:
    # All four wheels at once excite only what is alike left and right: body bounce and pitch and two wheel modes.
    found = eigensystem_realisation(records(TABLE_1_CAR, 0.0, 0.0, seed=0)[:1], RATE)
    names = {mode.name for mode in name_modes_at_sensors(found, default_sensors(TABLE_1_CAR), TABLE_1_CAR.a)}
    assert len(found) == 4
    assert {"body bounce", "body pitch"} < names
    assert "body roll" not in names


@given(st.permutations(range(8)), st.integers(0, 40), st.floats(0.01, 100))
@settings(max_examples=8, deadline=None)
def test_channel_order_start_and_unit_do_not_matter(order: list[int], shift: int, factor: float) -> None:
    measured = records(TABLE_1_CAR, 0.0, 0.1, seed=3)
    plain = eigensystem_realisation(measured, RATE)
    changed = eigensystem_realisation([factor * record[order, shift:] for record in measured], RATE)
    assert_allclose([mode.pole for mode in changed], [mode.pole for mode in plain], rtol=1e-7)
    for one, other in zip(plain, changed, strict=True):
        assert modal_assurance_criterion(one.shape[order, None], other.shape[:, None])[0, 0] > 1 - 1e-7


@pytest.mark.parametrize("method", [method for method in METHODS if method not in (*APPROXIMATE, "svm-printed")])
def test_every_method_is_exact_without_noise_behind_the_one_door(method: str) -> None:
    truth = compute_modes(TABLE_1_CAR.matrices())
    found = identify_modes(records(TABLE_1_CAR, 0.0, 0.0, seed=4), RATE, method=method)
    assert_allclose([mode.pole for mode in found], [mode.pole for mode in truth], rtol=1e-7)
    assert all(mode.shape.shape == (8,) for mode in found)


@pytest.mark.slow
def test_order_is_obeyed() -> None:
    measured = records(TABLE_1_CAR, 0.02, 0.0, seed=5)
    for method in METHODS:
        assert sum(2 if m.pole.imag else 1 for m in identify_modes(measured, RATE, method, order=10)) <= 10


def test_a_wrong_method_is_named_with_what_was_probably_meant() -> None:
    with pytest.raises(ValueError, match=r"found 'eraa'; expected 'ml' or 'era' or .*'svm'.*\. Did you mean 'era'\?"):
        identify_modes([np.ones((8, 100))], RATE, method="eraa")


def test_what_cannot_be_used_is_refused() -> None:
    with pytest.raises(InputError, match="Give longer decays"):
        identify_modes([np.arange(96.0).reshape(8, 12)], RATE, "era")
    with pytest.raises(InputError, match="era: order: found 0"):
        identify_modes(records(TABLE_1_CAR, 0.0, 0.0, seed=0)[:1], RATE, "era", order=0)
    with pytest.raises(InputError, match="svm: order"):
        identify_modes(records(TABLE_1_CAR, 0.0, 0.0, seed=0)[:1], RATE, "svm", order=18)
    for method in METHODS:
        with pytest.raises(InputError, match="at least one"):
            identify_modes([], RATE, method)
