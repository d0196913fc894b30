"""The exact response against closed forms and an independent integrator."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from sprung.simulation import drive_over_half_sine_bump, tyre_rates
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, WHEELS, Matrices, Vehicle, affine_response, free_decay

Array = NDArray[np.float64]

TYRE_DAMPED = Vehicle.from_parameters(SCHOOL_BUS.parameters | {"c_tf": 900.0, "c_tr": 1500.0})


def single(omega: float, zeta: float, q: float, v: float, t: Array) -> Array:
    """Displacement of one oscillator from (q, v); textbook closed forms for every kind of damping."""
    if omega == 0:
        return q + v * t
    if zeta == 1:
        return np.asarray((q + (v + omega * q) * t) * np.exp(-omega * t))
    root = omega * np.emath.sqrt(1 - zeta**2)
    wave = np.cos(root * t) * q + np.sin(root * t) / root * (v + zeta * omega * q)
    return np.asarray((np.exp(-zeta * omega * t) * wave).real)


KINDS = {
    "undamped": (7.0, 0.0),
    "free": (0.0, 0.0),
    "underdamped": (7.0, 0.3),
    "critical": (7.0, 1.0),
    "nearly critical": (7.0, 1.0 + 1e-9),
    "overdamped": (7.0, 2.5),
    "fast": (90.0, 0.1),
}


@pytest.mark.parametrize(
    "kinds",
    [tuple(KINDS), ("underdamped",) * 7, ("critical",) * 7, ("overdamped",) * 3 + ("undamped",) * 4],
    ids=["one of each", "sevenfold pair", "seven defective", "repeated real and pairs"],
)
def test_free_decay_for_every_kind_of_eigenvalue(kinds: tuple[str, ...]) -> None:
    # Seven oscillators with known answers, mixed by a coordinate transformation X = T q.
    random = np.random.default_rng(1)
    T = np.linalg.qr(random.standard_normal((7, 7))).Q * np.linspace(0.5, 2.0, 7)
    inverse = np.linalg.inv(T)
    omega, zeta = np.array([KINDS[kind] for kind in kinds]).T
    M, C, K = (inverse.T @ np.diag(d) @ inverse for d in (np.ones(7), 2 * zeta * omega, omega**2))
    q, v = random.standard_normal((2, 7))
    t = np.arange(300) / 200
    motion = free_decay(Matrices(M, C, K), np.concatenate([T @ q, T @ v]), 1 / 200, 300)
    expected = T @ [single(*each, t) for each in zip(omega, zeta, q, v, strict=True)]
    assert_allclose(motion.displacement, expected, atol=1e-8 if "nearly critical" in kinds else 1e-10)
    assert_allclose(M @ motion.acceleration + C @ motion.velocity + K @ motion.displacement, 0, atol=1e-8)


def integrate(f: Callable[[float, Array], Array], state: Array, times: ArrayLike) -> Array:
    times = np.asarray(times, dtype=np.float64)
    solution: Any = solve_ivp(f, (times[0], times[-1]), state, "DOP853", times, rtol=1e-12, atol=1e-14)
    return np.asarray(solution.y, dtype=np.float64)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS], ids=lambda vehicle: vehicle.name)
def test_free_decay_against_an_integrator(vehicle: Vehicle) -> None:
    state = 0.05 * np.random.default_rng(2).standard_normal(14)
    matrices = vehicle.matrices()
    motion = free_decay(matrices, state, 0.01, 101)
    expected = integrate(lambda _, Y: matrices.state @ Y, state, 0.01 * np.arange(101))
    assert_allclose(np.vstack([motion.displacement, motion.velocity]), expected, atol=1e-10)


@given(st.floats(1e-4, 0.05), st.integers(1, 300), st.integers(0, 2**32))
@settings(max_examples=20, deadline=None)
def test_decay_goes_on_from_any_of_its_samples_and_is_linear_in_the_state(step: float, split: int, seed: int) -> None:
    matrices = TABLE_1_CAR.matrices()
    states = np.random.default_rng(seed).standard_normal((2, 14))
    first, second, both = (free_decay(matrices, state, step, 301) for state in (*states, states[0] - 2 * states[1]))
    middle = np.concatenate([first.displacement[:, split], first.velocity[:, split]])
    assert_allclose(
        free_decay(matrices, middle, step, 301 - split).acceleration, first.acceleration[:, split:], atol=1e-8
    )
    assert_allclose(both.acceleration, first.acceleration - 2 * second.acceleration, atol=1e-8)


def test_affine_response_reaches_and_keeps_the_rest_under_a_constant_force() -> None:
    A = np.array([[0.0, 1.0], [-9.0, -4.0]])
    Y = affine_response(A, [0.0, 18.0], [0.0, 0.0], 0.25, 100)
    assert_allclose(Y[:, -1], [2.0, 0.0], atol=1e-12)  # 18 N on 9 N/m
    assert Y.shape == (2, 100)
    assert_allclose(affine_response(A, [0.0, 18.0], [2.0, 0.0], 0.25, 1), [[2.0], [0.0]])


def shifted_bump(t: float) -> tuple[float, float]:
    """What eq. (19) means: z_g = 0.09 sin 5π(t - 0.1) from 0.1 to 0.3 s, here from 0 on; and its derivative."""
    if t <= 0.2:
        return 0.09 * float(np.sin(5 * np.pi * t)), 0.45 * np.pi * float(np.cos(5 * np.pi * t))
    return 0.0, 0.0


def literal_bump(t: float) -> tuple[float, float]:
    """Eq. (19) as printed, z_g = 0.09 sin 5πt from 0.1 to 0.3 s, here from 0 on; and its derivative within."""
    if t <= 0.2:
        return 0.09 * float(np.sin(5 * np.pi * (t + 0.1))), 0.45 * np.pi * float(np.cos(5 * np.pi * (t + 0.1)))
    return 0.0, 0.0


def over_bump(vehicle: Vehicle, ground: Callable[[float], tuple[float, float]], times: ArrayLike) -> Array:
    """Integrate eq. (1) with the left wheels on the ground's profile, in two parts about its end at 0.2 s."""
    A, M = vehicle.matrices().state, vehicle.matrices().M
    times = np.asarray(times, dtype=np.float64)
    rates = np.array([tyre_rates(vehicle)[wheel] for wheel in WHEELS])
    left = np.array([1.0, 0.0, 1.0, 0.0])

    def derivative(t: float, Y: Array) -> Array:
        force = np.concatenate([np.zeros(3), left * (rates @ ground(t))])
        return np.asarray(A @ Y + np.concatenate([np.zeros(7), np.linalg.solve(M, force)]), dtype=np.float64)

    before, after = times[times < 0.2 - 1e-9], times[times > 0.2 + 1e-9]
    during = integrate(derivative, np.zeros(14), np.append(before, 0.2))
    later = integrate(lambda _, Y: A @ Y, during[:, -1], np.append(0.2, after))
    # The end of the bump belongs to both; it is kept where it is one of the times.
    return np.hstack([during[:, : times.size - after.size], later[:, 1:]])


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, TYRE_DAMPED], ids=["car", "bus with tyre damping"])
@pytest.mark.parametrize("step", [0.002, 0.0033], ids=["end on a sample", "end between samples"])
def test_half_sine_bump_against_an_integrator(vehicle: Vehicle, step: float) -> None:
    samples = int(0.6 / step)
    motion, end = drive_over_half_sine_bump(
        vehicle.matrices(), tyre_rates(vehicle), ("fl", "rl"), 0.09, 0.2, step, samples
    )
    expected = over_bump(vehicle, shifted_bump, step * np.arange(samples))
    assert_allclose(np.vstack([motion.displacement, motion.velocity]), expected, atol=1e-9)

    # The state goes through the end of the bump without a jump; free vibration follows from it.
    later = int(np.ceil(0.2 / step - 1e-9))
    decay = free_decay(vehicle.matrices(), end, later * step - 0.2 + step, 2)
    assert_allclose(decay.acceleration[:, 1], motion.acceleration[:, later + 1], atol=1e-9)
    close, at_end = drive_over_half_sine_bump(
        vehicle.matrices(), tyre_rates(vehicle), ("fl", "rl"), 0.09, 0.2, 0.2 - 1e-9, 2
    )
    assert_allclose(close.displacement[:, 1], at_end[:7], atol=1e-8)
    assert_allclose(close.velocity[:, 1], at_end[7:], atol=1e-6)


def test_acceleration_over_the_bump_is_the_derivative_of_velocity() -> None:
    motion, _ = drive_over_half_sine_bump(
        TYRE_DAMPED.matrices(), tyre_rates(TYRE_DAMPED), ("fr",), 0.05, 0.2, 1e-5, 20_000
    )
    slope = (motion.velocity[:, 2:] - motion.velocity[:, :-2]) / 2e-5
    assert_allclose(slope, motion.acceleration[:, 1:-1], atol=1e-4)


def test_equation_19_as_printed_jumps_and_is_not_the_half_sine_that_is_meant() -> None:
    assert literal_bump(0.0)[0] == pytest.approx(0.09)
    assert literal_bump(0.2)[0] == pytest.approx(-0.09)
    assert shifted_bump(0.0)[0] == pytest.approx(0.0)
    assert shifted_bump(0.2)[0] == pytest.approx(0.0, abs=1e-15)
    times = 0.002 * np.arange(250)
    motion, _ = drive_over_half_sine_bump(
        TABLE_1_CAR.matrices(), tyre_rates(TABLE_1_CAR), ("fl", "rl"), 0.09, 0.2, 0.002, 250
    )
    literal = over_bump(TABLE_1_CAR, literal_bump, times)[:7]
    assert np.abs(literal - motion.displacement).max() > 0.05


@pytest.mark.parametrize("samples", [1, 50, 100, 101, 102])
def test_half_sine_bump_gives_as_many_samples_as_asked_for(samples: int) -> None:
    motion, _ = drive_over_half_sine_bump(
        TABLE_1_CAR.matrices(), tyre_rates(TABLE_1_CAR), ("fl",), 0.09, 0.2, 0.002, samples
    )
    assert {part.shape for part in motion} == {(7, samples)}


def natural_frequencies(vehicle: Vehicle) -> Array:
    eigenvalues = np.linalg.eigvals(vehicle.matrices().state)
    return np.sort(np.abs(eigenvalues[eigenvalues.imag > 0])) / (2 * np.pi)


def test_natural_frequencies_of_the_school_bus() -> None:
    found = natural_frequencies(SCHOOL_BUS)
    # Table 3, column ω_n: roll, bounce, pitch, then the wheels. Tables 4 and 5 are rounded: its pitch is 3 % off.
    table_3 = [1.0707, 2.0074, 2.8995, 12.3449, 12.4550, 14.0952, 14.1808]
    assert_allclose(found, table_3, rtol=0.031)
    assert_allclose(found[[0, 5, 6]], np.array(table_3)[[0, 5, 6]], rtol=1e-4)
    # What Tables 4 and 5 give, computed once with an independent program.
    assert_allclose(found, [1.071, 2.015, 2.812, 12.417, 12.442, 14.096, 14.181], atol=6e-4)


def test_natural_frequencies_of_the_table_1_car_come_in_close_pairs() -> None:
    # Wheel hop of the car, computed once with an independent program: 10.768/10.771 and 11.286/11.288 Hz.
    assert_allclose(natural_frequencies(TABLE_1_CAR)[3:], [10.768, 10.771, 11.286, 11.288], atol=6e-4)
