"""Masses, loads, ride and hop of a vehicle: textbook formulas, statics, and gradients."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings

from sprung.simulation import static_wheel_loads
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import CHARACTERISTICS, SCHOOL_BUS, TABLE_1_CAR, Vehicle, evaluate_quantity, wheel_loads
from strategies import vehicles

UNEVEN = TABLE_1_CAR.with_values(
    y_s=0.03, d_ksf=700.0, d_ktr=9000.0, k_af=4000.0, c_tf=60.0, r_f=1.8, r_r=2.2, name="uneven"
)
"""With everything that changes a characteristic."""


def of(vehicle: Vehicle, name: str) -> float:
    names = tuple(vehicle.parameters)
    return evaluate_quantity(name, names, np.array(list(vehicle.parameters.values())))[0]


def test_they_are_what_textbooks_say() -> None:
    """Gillespie, Fundamentals of Vehicle Dynamics, chapter 5, worked out here for one axle by hand."""
    car = TABLE_1_CAR
    corner = car.m_s * car.b / (car.a + car.b) / 2
    ride_rate = 1 / (1 / car.k_sf + 1 / car.k_tf)
    expected = {
        "total_mass": car.m_s + 2 * car.m_uf + 2 * car.m_ur,
        "front_axle_mass": 2 * corner + 2 * car.m_uf,
        "front_ride_frequency": sqrt(ride_rate / corner) / (2 * pi),
        "front_ride_damping": car.c_sf / sqrt(4 * car.k_sf * corner),
        "front_hop_frequency": sqrt((car.k_sf + car.k_tf) / car.m_uf) / (2 * pi),
        "front_hop_damping": car.c_sf / sqrt(4 * (car.k_sf + car.k_tf) * car.m_uf),
    }
    assert {name: of(car, name) for name in expected} == pytest.approx(expected, rel=1e-14)


def test_the_damper_counts_as_the_mean_of_compression_and_rebound_and_the_tyre_damps_the_wheel() -> None:
    car = UNEVEN
    expected = (car.c_sf * (1 + 1.8) / 2 + 60.0) / sqrt(4 * (car.k_sf + car.k_tf) * car.m_uf)
    assert of(car, "front_hop_damping") == pytest.approx(expected, rel=1e-14)


@given(vehicles)
@settings(max_examples=30, deadline=None)
def test_masses_balance(vehicle: Vehicle) -> None:
    """The moments of the axle loads about the front axle are that of the centre of gravity."""
    front, rear, total, cg = (
        of(vehicle, name) for name in ("front_axle_mass", "rear_axle_mass", "total_mass", "cg_from_front_axle")
    )
    assert front + rear == pytest.approx(total, rel=1e-13)
    assert rear * vehicle.wheelbase == pytest.approx(total * cg, rel=1e-13)
    assert of(vehicle, "front_axle_share") == pytest.approx(front / total, rel=1e-13)
    loads, _ = loads_of(vehicle)
    assert loads == pytest.approx(np.repeat([front, rear], 2) * STANDARD_GRAVITY / 2, rel=1e-10)
    assert loads == pytest.approx(static_wheel_loads(vehicle), rel=1e-10)


def loads_of(vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    return wheel_loads(vehicle.linear_model(), np.array(list(vehicle.parameters.values())))


def test_uneven_loads_are_in_equilibrium() -> None:
    """Forces of the ground carry the weight and its moments about both axes, whatever the rates are."""
    loads, _ = loads_of(UNEVEN)
    body = UNEVEN.m_s * STANDARD_GRAVITY
    wheels = 2 * (UNEVEN.m_uf + UNEVEN.m_ur) * STANDARD_GRAVITY
    assert loads.sum() == pytest.approx(body + wheels, rel=1e-12)
    assert loads[2:].sum() * UNEVEN.wheelbase == pytest.approx(
        body * UNEVEN.a + 2 * UNEVEN.m_ur * STANDARD_GRAVITY * UNEVEN.wheelbase, rel=1e-12
    )
    sides = np.array([1, -1, 1, -1]) * np.array([UNEVEN.t_f2, UNEVEN.t_f2, UNEVEN.t_r2, UNEVEN.t_r2])
    assert float(sides @ loads) == pytest.approx(body * 0.03, rel=1e-9)


def value_of(name: str, names: tuple[str, ...], values: np.ndarray) -> float:
    return evaluate_quantity(name, names, values)[0]


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS, UNEVEN], ids=lambda one: one.name)
def test_gradients_are_those_of_differences(vehicle: Vehicle) -> None:
    """Central differences: their own error is about the square of the step, 1e-10, and rounding over the step, 1e-11."""
    names, values = tuple(vehicle.parameters), np.array(list(vehicle.parameters.values()))
    steps = 1e-5 * np.maximum(np.abs(values), 1e-3)
    model = vehicle.linear_model()

    def differences(function: Callable[[np.ndarray], np.ndarray | float]) -> np.ndarray:
        moved = [(function(values + move), function(values - move)) for move in np.diag(steps)]
        return np.array([(up - down) / (2 * step) for (up, down), step in zip(moved, steps, strict=True)])

    for name, one in CHARACTERISTICS.items():
        if one.needs <= set(names):
            value, gradient = evaluate_quantity(name, names, values)
            expected = differences(partial(value_of, name, names))
            assert gradient * values == pytest.approx(expected * values, abs=1e-8 * max(abs(value), 1e-3))
    loads, gradient = wheel_loads(model, values)
    expected = differences(lambda moved: wheel_loads(model, moved)[0]).T
    assert gradient * values == pytest.approx(expected * values, abs=1e-8 * float(loads.max()))
