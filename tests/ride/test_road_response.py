"""The response to roads: transfer functions and white noise in closed form, and records that are simulated in time."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.signal import bilinear_zpk, sosfilt, zpk2sos

from quarter_car import BODY_ACCELERATION, M_S, M_U, QUARTER, TRAVEL, TYRE_LOAD, VALUES, mean_square, transfer
from sprung.ride import Road, frequency_weighting, ride_numbers
from sprung.ride.ride_model import RideModel
from sprung.ride.road_response import Drive, respond, spectral_lines
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR, Item, Load, Vehicle

Real = NDArray[np.float64]

WIDE = (1e-3, 2e4)
"""Hz: so wide that what is beyond matters less than 1e-4 of the closed forms, which have no limits. The slowest to fade is the
wheel load, whose mean square beyond f falls as 1/f."""


def test_transmissibility_of_a_quarter_car() -> None:
    model = RideModel.of(QUARTER)
    f = np.geomspace(0.1, 60, 50)
    found = model.displacements(VALUES, 2 * np.pi * f)[:, :, 0]
    assert_allclose(found, np.stack(transfer(f), axis=1), rtol=1e-10)


def test_white_noise_response_of_a_quarter_car_is_the_closed_form() -> None:
    speed, road = 22.0, Road.of_class("B")
    response = respond(RideModel.of(QUARTER, places=[(0.0, 0.0)]), VALUES, Drive(road, speed, band=WIDE))
    white = 4 * np.pi**2 * road.roughness * 0.1**2 * speed
    body = np.sqrt(response.accelerations(response.model.point.at(VALUES)).sum())
    # The lines are 0.8 % apart: the trapezoidal rule is within 1e-4 of the integral over a resonance.
    assert_allclose(body, np.sqrt(mean_square(BODY_ACCELERATION, white)), rtol=2e-4)
    assert_allclose(response.suspension_travel, np.sqrt(mean_square(TRAVEL, white)), rtol=2e-4)
    assert_allclose(response.wheel_loads, np.sqrt(mean_square(TYRE_LOAD, white)), rtol=2e-4)


def test_load_coefficient_is_over_the_static_load() -> None:
    road = ride_numbers(QUARTER, roads="B").on("B").wheels["wheel"]
    load, coefficient = road["load"].value, road["load_coefficient"].value
    assert load is not None
    assert coefficient == pytest.approx(load / ((M_S + M_U) * STANDARD_GRAVITY), rel=1e-12)


def test_lines_add_up_to_an_integral() -> None:
    for delay in (0.0, 0.01, 1.0):
        f, weights = spectral_lines((0.5, 80.0), delay)
        assert_allclose(weights @ (1 / f**2), 1 / 0.5 - 1 / 80, rtol=1e-4)
        assert np.all(np.diff(f) > 0)
        if delay:
            assert np.diff(f).max() <= 1 / (12 * delay) * (1 + 1e-9)


def simulated(vehicle: Vehicle, speed: float, roughness: float, seed: int) -> tuple[Real, float]:
    """Return the states of many vehicles of two axles on as many roads, shape (time, state, road), and the time step.

    White noise is the velocity under the front wheels, and the same a wheelbase later under the rear wheels; every step is
    exact.
    """
    source, step, roads = np.random.default_rng(seed), 1e-3, 300
    delay = round(vehicle.wheelbase / speed / step)
    M, C, K = vehicle.matrices()
    n, front, rear = 4, vehicle.k_tf, vehicle.k_tr
    A = np.zeros((2 * n + 2, 2 * n + 2))
    A[:n, n : 2 * n] = np.eye(n)
    forces = np.zeros((n, 2))
    forces[2, 0], forces[3, 1] = front, rear
    A[n : 2 * n] = np.linalg.solve(M, np.hstack([-K, -C, forces]))
    propagator = expm(A * step)
    # The heights of the road are states; those of the rear are the front's of earlier.
    rms = np.sqrt(4 * np.pi**2 * roughness * 0.1**2 * speed / (2 * step)) * step
    samples, settled = 9000, 4000
    increments = rms * source.standard_normal((samples + delay, roads))
    heights = np.cumsum(increments, axis=0)
    state, kept = np.zeros((2 * n + 2, roads)), np.empty((samples - settled, 2 * n + 2, roads))
    for i in range(samples):
        state[2 * n], state[2 * n + 1] = heights[i + delay], heights[i]
        state = propagator @ state
        if i >= settled:
            kept[i - settled] = state
    return kept, step


def test_simulated_records_have_the_same_mean_squares_and_doses() -> None:
    """Pitch plane with the delay of the rear axle: 300 roads of 5 s each. Statistical uncertainty: some 2000 independent
    swings of the body (1 Hz, 0.25 damped), so that a root mean square has 2 %; allowed are three times as much."""
    car = TABLE_1_CAR
    names = ("m_s", "I_yy", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "a", "b")
    plane = Vehicle(model="pitch-plane", **{name: getattr(car, name) for name in names})
    speed, roughness = 20.0, 64e-6
    states, step = simulated(plane, speed, roughness, seed=3)
    M, C, K = plane.matrices()
    forces = np.zeros((4, 2))
    forces[2, 0], forces[3, 1] = plane.k_tf, plane.k_tr
    acceleration = np.einsum("ij,tjr->tir", np.linalg.solve(M, np.hstack([-K, -C, forces])), states)
    # A place at x m forward of the front axle rises by z_s - (x + a) θ.
    x = -0.4
    seat = acceleration[:, 0] - (x + plane.a) * acceleration[:, 1]
    duration = states.shape[0] * step
    numbers = ride_numbers(plane, roads="B", speeds=[speed], places={"seat": (x, 0.0)}, duration=duration).on("B")
    found = numbers.places["seat"]
    assert found["acceleration"].value == pytest.approx(float(np.sqrt((seat**2).mean())), rel=0.06)
    pitch = numbers.body["pitch"]["acceleration"].value
    assert pitch == pytest.approx(float(np.sqrt((acceleration[:, 1] ** 2).mean())), rel=0.06)
    travel = states[:, 0] + plane.b * states[:, 1] - states[:, 3]
    assert numbers.wheels["rear"]["travel"].value == pytest.approx(float(np.sqrt((travel**2).mean())), rel=0.06)
    load = plane.k_tr * (states[:, 9] - states[:, 3])
    assert numbers.wheels["rear"]["load"].value == pytest.approx(float(np.sqrt((load**2).mean())), rel=0.06)
    weighted = sosfilt(weighting_filter(step), seat, axis=0)[1000:]
    assert found["weighted"].value == pytest.approx(float(np.sqrt((weighted**2).mean())), rel=0.06)
    dose = (duration * float((weighted**4).mean())) ** 0.25
    assert found["vibration_dose"].value == pytest.approx(dose, rel=0.08)


def weighting_filter(step: float) -> Real:
    """Return W_k as a digital filter: the poles and zeros of ISO 8041 by the bilinear transformation."""
    w1, w2, w3, w5, w6 = (2 * np.pi * f for f in (0.4, 100.0, 12.5, 2.37, 3.35))

    def pair(corner: float, quality: float) -> list[complex]:
        return [complex(one) for one in np.roots([1 / corner**2, 1 / (quality * corner), 1.0])]

    butterworth = 1 / np.sqrt(2)
    zeros = [0.0, 0.0, -w3, *pair(w5, 0.91)]
    poles = [*pair(w1, butterworth), *pair(w2, butterworth), *pair(w3, 0.63), *pair(w6, 0.91)]
    gain = w2**2 * w3  # so that the gain is that of the weighting
    z, p, k = bilinear_zpk(np.array(zeros), np.array(poles), gain, 1 / step)
    return np.asarray(zpk2sos(z, p, k))


def test_the_digital_filter_of_these_tests_is_the_weighting() -> None:
    from scipy.signal import sosfreqz  # noqa: PLC0415

    f = np.array([0.5, 1.0, 4.0, 8.0, 20.0])
    _, response = sosfreqz(weighting_filter(1e-3), 2 * np.pi * f * 1e-3)
    # The bilinear transformation bends the frequency by (π f Δt)²/3, 0.13 % at 20 Hz.
    assert_allclose(np.abs(response), np.abs(frequency_weighting("W_k", f)), rtol=5e-3)


def test_one_profile_on_both_sides_is_the_pitch_plane() -> None:
    """A symmetric vehicle with one profile under left and right wheels moves as its pitch plane with doubled wheels."""
    car = TABLE_1_CAR
    doubled = {
        name: 2 * getattr(car, name) for name in ("m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr")
    }
    whole = {name: getattr(car, name) for name in ("m_s", "I_yy", "a", "b")}
    plane = Vehicle(model="pitch-plane", **doubled, **whole)
    one = ride_numbers(car, roads="C", tracks="same").on("C")
    other = ride_numbers(plane, roads="C").on("C")
    for place, own in other.places.items():
        for name, estimate in own.items():
            assert one.places[place][name].value == pytest.approx(estimate.value, rel=1e-9)
    assert one.wheels["fl"]["travel"].value == pytest.approx(other.wheels["front"]["travel"].value, rel=1e-9)
    assert one.wheels["rr"]["load_coefficient"].value == pytest.approx(
        other.wheels["rear"]["load_coefficient"].value, rel=1e-9
    )
    assert "roll" not in one.body


def test_independent_tracks_add_up_in_roll() -> None:
    """With independent tracks the mean square of roll is twice that by one side alone; and of bounce half that of one
    profile."""
    car = TABLE_1_CAR
    same, apart = (ride_numbers(car, roads="C", tracks=one).on("C") for one in ("same", "independent"))
    ratio = same.body["pitch"]["acceleration"].value / apart.body["pitch"]["acceleration"].value  # type: ignore[operator]
    assert ratio == pytest.approx(np.sqrt(2), rel=1e-9)


def test_a_load_makes_a_softer_ride_and_other_static_loads() -> None:
    load = Load(name="two people", items=(Item(mass=150.0, position=(-1.3, 0.0, 0.7)),))
    empty, loaded = (ride_numbers(TABLE_1_CAR, roads="C", load=one) for one in (Load(name="empty"), load))
    assert loaded.load == "two people"
    static = [sum(one["static_load"].value or 0 for one in found.plates.values()) for found in (empty, loaded)]
    assert static[1] - static[0] == pytest.approx(150 * STANDARD_GRAVITY, rel=1e-9)
    for axle in ("front", "rear"):
        assert loaded.axles[axle]["body_frequency"].value < empty.axles[axle]["body_frequency"].value  # type: ignore[operator]


def test_horizontal_motion_is_that_of_pitch_times_the_height() -> None:
    """A seat 0.6 m above the axis of pitch, nothing else moving forward: the W_d-weighted pitch times 0.6 m."""
    car = TABLE_1_CAR.with_values(cg_height=0.5)
    found = ride_numbers(car, roads="C", places={"seat": (-1.2, 0.3, 1.1)}).on("C")
    model = RideModel.of(car)
    values = np.array(list(car.parameters.values()))
    response = respond(model, values, Drive(Road.of_class("C"), 80 / 3.6))
    row = np.eye(1, 7, 1)
    weighting = np.abs(frequency_weighting("W_d", response.frequency)) ** 2
    expected = 0.6 * np.sqrt(weighting @ response.accelerations(row)[:, 0])
    seat = found.places["seat"]
    assert seat["forward_weighted"].value == pytest.approx(float(expected), rel=1e-9)
    squares = [seat[name].value ** 2 for name in ("weighted", "forward_weighted", "left_weighted")]  # type: ignore[operator]
    assert seat["total"].value == pytest.approx(float(np.sqrt(sum(squares))), rel=1e-12)
