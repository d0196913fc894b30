"""Suspension testers: EUSAMA and EGEA numbers of a quarter car in closed form, and of whole vehicles."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize_scalar

from quarter_car import K_T, M_S, M_U, QUARTER, VALUES, transfer
from sprung.ride import ride_numbers
from sprung.ride.bench import AMPLITUDE, Plate, phase_shift
from sprung.ride.ride_model import RideModel
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR, Vehicle

WEIGHT = (M_S + M_U) * STANDARD_GRAVITY


def force(frequency: float) -> complex:
    """Force on the plate over its displacement: K_T (1 - z_u/h)."""
    _, wheel = transfer(np.array([frequency]))
    return complex(K_T * (1 - wheel[0]))


def test_minimum_load_and_phase_of_a_quarter_car() -> None:
    found = Plate(RideModel.of(QUARTER), "wheel").test(VALUES)
    top = minimize_scalar(lambda f: -abs(force(f)), bounds=(6, 20), method="bounded", options={"xatol": 1e-9})
    assert_allclose(found.resonance, top.x, rtol=1e-4)
    assert_allclose(found.least_load, 1 + 0.003 * top.fun / WEIGHT, rtol=1e-6)
    low = minimize_scalar(
        lambda f: np.pi - np.angle(force(f)), bounds=(6, 18), method="bounded", options={"xatol": 1e-9}
    )
    assert found.phase is not None
    assert_allclose(found.phase, low.fun, rtol=1e-6)
    assert found.phase_frequency == pytest.approx(low.x, abs=0.01)
    assert AMPLITUDE == 0.003  # 6 mm from end to end


def test_phase_shift_is_none_of_slow_plates_and_half_a_turn_of_fast_ones() -> None:
    """A slow plate lifts the whole mass: the force is -ω² (m_s + m_u) h, smallest where the plate is highest. A fast one
    compresses the tyre alone, and the force is largest there."""
    slow, fast = Plate(RideModel.of(QUARTER), "wheel").respond(VALUES, np.array([0.01, 2000.0])).force
    assert_allclose(slow, -((2 * np.pi * 0.01) ** 2) * (M_S + M_U), rtol=1e-3)
    assert_allclose(fast, K_T, rtol=1e-3)
    assert_allclose(phase_shift(np.array([slow, fast])), [0.0, np.pi], atol=0.02)


def test_phase_shift_is_that_of_its_definition() -> None:
    """In time: from the highest place of the plate to the middle between the force falling and rising through its static
    value."""
    frequency = 9.0
    time = np.linspace(0, 2 / frequency, 200001)
    dynamic = (force(frequency) * np.exp(2j * np.pi * frequency * time)).real  # the plate is highest at 0
    crossings = np.flatnonzero(np.diff(np.sign(dynamic)))
    falling = next(i for i, at in enumerate(crossings) if dynamic[at] > 0)
    middle = time[crossings[falling : falling + 2]].mean()
    shift = (2 * np.pi * frequency * middle) % (2 * np.pi)
    assert shift == pytest.approx(float(phase_shift(np.array([force(frequency)]))[0]), abs=1e-3)


def test_another_quarter_car() -> None:
    """A front axle with a damped tyre, as others simulate the test: adhesion 57 to 58 %, sound (phase shift far above 35°)."""
    car = Vehicle(model="quarter", m_s=346.0, m_u=36.0, k_s=25570.0, k_t=253161.0, c_s=1474.0, c_t=150.0)
    plate = ride_numbers(car, roads="C").plates["wheel"]
    assert plate["least_load"].value == pytest.approx(0.58, abs=0.01)
    assert plate["least_phase"].value > np.deg2rad(60)


def test_weak_dampers_fail() -> None:
    """With a quarter of the damping (ratio 0.07) a car falls below 35°, and its minimum load gets worse."""
    sound = ride_numbers(TABLE_1_CAR, roads="C").plates["fl"]
    weak = ride_numbers(TABLE_1_CAR.with_values(c_sf=375.0, c_sr=375.0), roads="C").plates["fl"]
    assert sound["least_phase"].value > np.deg2rad(35) > weak["least_phase"].value
    assert sound["least_load"].value > weak["least_load"].value  # type: ignore[operator]


def test_phase_grows_with_damping_alone_nearly() -> None:
    """Lozia (2021): the dependence of the minimum phase on the damping of the suspension is close to linear."""
    phases = [
        ride_numbers(Vehicle(QUARTER.parameters | {"c_s": c}, model="quarter"), roads="C")
        .plates["wheel"]["least_phase"]
        .value
        for c in (400.0, 800.0, 1200.0)
    ]
    first, second, third = (one or 0.0 for one in phases)
    assert second / first == pytest.approx(2, rel=0.15)
    assert third / first == pytest.approx(3, rel=0.25)


def test_wheel_that_would_lift_off_has_no_load_left() -> None:
    """A light car on stiff tyres with hardly any damping: the minimum force is zero, not negative, and this is said."""
    found = ride_numbers(TABLE_1_CAR.with_values(c_sf=150.0, c_sr=150.0), roads="C")
    least = found.plates["fl"]["least_load"]
    assert least.value == 0.0
    assert any("lift off the plate" in note for note in found.notes)


def test_heavy_wheel_has_no_phase() -> None:
    """The resonance of this wheel is below the 6 Hz from which the phase counts."""
    heavy = Vehicle(model="quarter", m_s=2000.0, m_u=600.0, k_s=200e3, k_t=400e3, c_s=9000.0)
    found = ride_numbers(heavy, roads="C")
    assert "least_phase" not in found.plates["wheel"]
    assert any("below 6 Hz" in note for note in found.notes)


def test_sides_differ_where_the_vehicle_does() -> None:
    car = TABLE_1_CAR.with_values(d_csf=300.0)
    found = ride_numbers(car, roads="C").plates
    assert found["fl"]["least_phase"].value > found["fr"]["least_phase"].value  # type: ignore[operator]
    alike = ride_numbers(TABLE_1_CAR, roads="C").plates
    assert alike["fl"]["least_phase"] == alike["fr"]["least_phase"]
