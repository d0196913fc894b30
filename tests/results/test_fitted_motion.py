"""The motion of a drop from the fitted readings, and the forces of the dampers beyond the model, against known truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import sprung
from sprung.errors import InputError
from sprung.results import Result, damper_points, fitted_motion
from sprung.results.dampers import damper_rate_behind_mount
from sprung.results.excess_force import excess_forces, smooth
from sprung.results.motion import read_drop
from sprung.vehicle import TABLE_1_CAR, Sensor, Vehicle

KNEE, RATE, BEYOND = 0.15, 1500.0, 0.4
DIGRESSIVE = Vehicle(model="quarter", m_s=345.0, m_u=40.5, k_s=17000.0, k_t=192000.0, c_s=RATE, v_k=KNEE, q=BEYOND)
NOISE = 0.02
"""Of the accelerometers, m/s² rms."""

RATE_NOISE = 1e-3
"""m/s rms: what `sprung.simulate` gives a sensor of velocity."""


@pytest.fixture(scope="module")
def linear() -> Result:
    """The Table 1 car, from two drops of which the second tilts it."""
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "rl"], ["fl", "fr"])]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    campaign = sprung.simulate(TABLE_1_CAR, drops=drops, noise=NOISE, seed=1, known=known)
    return sprung.identify(campaign, extras=(), tracks="shared", fall=False)


@pytest.fixture(scope="module")
def digressive() -> Result:
    """A quarter car whose damper has a knee."""
    sensors = [
        Sensor(channel="body", on="body", position=(0.0, 0.0, 0.5), gain_std=0.0, tilt_std=0.0),
        Sensor(channel="wheel", on="wheel", gain_std=0.0),
    ]
    known = {"m_s": DIGRESSIVE.m_s}
    campaign = sprung.simulate(DIGRESSIVE, sensors=sensors, noise=NOISE, seed=1, known=known)
    return sprung.identify(campaign, extras=("damper-curve",), tracks="shared", fall=False)


def suspension_rate(
    vehicle: Vehicle, drop: str, wheel: str, time: NDArray[np.float64], **options: object
) -> NDArray[np.float64]:
    """Velocity of a suspension in the same simulated drop, as a sensor of it measures: m/s."""
    sensor = Sensor(channel="rate", on="body", quantity="velocity", relative_to=wheel, unit="m/s")  # type: ignore[arg-type]
    made = sprung.simulate(vehicle, sensors=[sensor], seed=2, **options)  # type: ignore[arg-type]
    recording = next(one.recording for one in made.drops if (one.file or "").removesuffix(".csv") == drop)
    assert recording is not None
    return np.asarray(np.interp(time, recording.time, recording.values[0]))


def test_a_linear_vehicle_moves_as_its_free_decay(linear: Result) -> None:
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "rl"], ["fl", "fr"])]
    for drop in linear.series:
        found = fitted_motion(linear, drop)
        assert found.is_linear
        assert found.deviation < 1e-9  # the fitted readings are those of a free decay
        assert found.coordinates[:3] == ("z_s", "theta", "phi")
        for point in damper_points(linear, drop)[:2]:
            truth = suspension_rate(TABLE_1_CAR, drop, point.wheel, found.time, drops=drops)
            # 1 % of the largest velocity, from the estimates, and the sensor's own noise.
            assert np.std(point.velocity - truth) < 0.01 * np.abs(point.velocity).max() + 1.2 * RATE_NOISE


def test_velocities_and_accelerations_are_derivatives(linear: Result, digressive: Result) -> None:
    for result in (linear, digressive):
        found = fitted_motion(result, next(iter(result.series)))
        step = found.time[1] - found.time[0]
        for lower, higher in zip(found.motion[:2], found.motion[1:], strict=True):
            middle = np.gradient(lower, step, axis=1)[:, 5:-5] - higher[:, 5:-5]
            # Differences over two samples of 12 Hz at 500 Hz err by (2 π 12 / 500)² / 6 = 0.4 %.
            assert np.abs(middle).max(axis=1) == pytest.approx(0, abs=0.02 * np.abs(higher).max())


@pytest.mark.slow
def test_a_nonlinear_vehicle_moves_as_simulated(digressive: Result) -> None:
    drop = next(iter(digressive.series))
    found = fitted_motion(digressive, drop)
    assert not found.is_linear
    assert found.deviation > 0.1  # the knee is reached: the nearest linear motion is far away
    (point,) = damper_points(digressive, drop)
    truth = suspension_rate(DIGRESSIVE, drop, "wheel", found.time)
    assert np.std(point.velocity - truth) < 1.2 * RATE_NOISE + 0.01 * truth.std()
    size = np.minimum(np.abs(truth), KNEE) + BEYOND * np.maximum(np.abs(truth) - KNEE, 0.0)
    force = np.sign(truth) * RATE * size
    # Noise of the accelerometers, that of the velocity in `truth` times the rate, and 1 % of the force.
    assert np.std(point.force - force) < 1.2 * np.hypot(point.noise, RATE * RATE_NOISE) + 0.01 * force.std()


def test_forces_beyond_the_model_are_found(linear: Result) -> None:
    """Readings of the linear vehicle under known forces at its dampers, integrated by SciPy, with noise."""
    drop = next(iter(linear.series))
    read = read_drop(linear, drop)
    M, C, K = read.model.matrices(read.values)
    car = read.vehicle
    corners = [(car.a, car.t_f), (car.a, -car.t_f), (-car.b, car.t_r), (-car.b, -car.t_r)]
    travels = np.zeros((4, 7))  # body minus wheel: z_s - x θ + y φ - z_u
    for i, (x, y) in enumerate(corners):
        travels[i, :3] = 1.0, -x, y
        travels[i, 3 + i] = -1.0
    time = np.arange(0, 2, 1 / 500)

    def forces(t: NDArray[np.float64] | float) -> NDArray[np.float64]:
        t = np.asarray(t)
        return np.array([60 * np.sin(2 * np.pi * f * t) * np.exp(-t) for f in (3.0, 4.0, 7.0, 11.0)])

    def accelerations(t: NDArray[np.float64] | float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        pull = C @ state[7:] + K @ state[:7] + travels.T @ forces(t)
        return np.asarray(-np.linalg.solve(M, pull))

    moved = solve_ivp(
        lambda t, state: np.concatenate([state[7:], accelerations(t, state)]),
        (0.0, time[-1]), np.zeros(14), t_eval=time, rtol=1e-9, atol=1e-12,
    )  # fmt: skip
    readings = read.readout.of_accelerations(read.readout.at(read.readings)) @ accelerations(time, moved.y)
    noise = np.random.default_rng(3).normal(size=readings.shape) * read.noise[:, None]
    found = excess_forces(read, readings + noise, time)
    truth = forces(time)
    for own, true, level in zip(found.force, truth, found.noise, strict=True):
        assert np.std(own - true) < level
        assert true @ own / (true @ true) == pytest.approx(1, abs=0.1)
    # What all four exert together accelerates the body, and is known better than the forces of one diagonal against the other.
    together = found.force.sum(axis=0) - truth.sum(axis=0)
    assert together.std() < 0.35 * truth.sum(axis=0).std()
    rates = read.model.velocities(read.values) @ moved.y
    assert np.abs(found.velocity - rates).max() < 0.05 * np.abs(rates).max()
    nothing = excess_forces(read, noise, time)
    assert np.all(np.std(nothing.force, axis=1) < 1.3 * nothing.noise)
    assert np.all(nothing.noise < 0.1 * np.std(truth, axis=1))


def test_points_of_the_right_model_scatter_by_the_noise(linear: Result) -> None:
    for drop in linear.series:
        for point in damper_points(linear, drop):
            assert np.std(point.force - point.model) < 1.3 * point.noise
            assert point.noise < 1.2  # N: m_u times the noise, 0.8 N, where the wheels have accelerometers


def test_a_smoother_is_least_squares() -> None:
    """A random walk with noisy readings: the estimate solves the normal equations of all samples together."""
    rng = np.random.default_rng(5)
    samples, driven, noise, start = 30, 0.3, 0.5, 2.0
    walk = np.cumsum(driven * rng.normal(size=samples))
    measured = walk + noise * rng.normal(size=samples)
    states, variances = smooth(
        np.eye(1), np.array([[1 / noise]]), measured[None] / noise, np.array([start]), np.array([driven])
    )
    steps = np.diff(np.eye(samples), axis=0) / driven
    information = np.eye(samples) / noise**2 + steps.T @ steps
    information[0, 0] += 1 / start**2
    assert states[0] == pytest.approx(np.linalg.solve(information, measured / noise**2), abs=1e-9)
    assert variances[0] == pytest.approx(np.linalg.inv(information)[samples // 2, samples // 2], rel=1e-6)


def test_a_damper_behind_a_mount_moves_as_spring_and_damper_in_series() -> None:
    """Its velocity over that of both is 1 / (1 + iωc/k) (two elements in series)."""
    damping, stiffness, omega = 1500.0, 150000.0, 2 * np.pi * 12
    time = np.arange(0, 1, 1 / 500)
    curve = (np.array([-10.0, 10.0]), np.array([-10.0, 10.0]) * damping)
    rate = damper_rate_behind_mount(time, np.sin(omega * time) / omega, np.cos(omega * time), curve, stiffness, 0.0)
    share = 1 / (1 + 1j * omega * damping / stiffness)
    expected = (share * np.exp(1j * omega * time)).real
    assert np.abs(rate - expected)[100:].max() < 0.02  # backward Euler: ω h / 2 with h = 1/4000 s


def test_what_cannot_be_shown_is_refused_with_the_reason(linear: Result) -> None:
    with pytest.raises(InputError, match="no fitted readings"):
        fitted_motion(linear, "another")
    drop = next(iter(linear.series))
    few = linear.series[drop].fitted.copy()
    few[:5] = np.nan  # the wheels front right, rear left and rear right are left
    reduced = replace(linear, series={drop: replace(linear.series[drop], fitted=few)})
    assert fitted_motion(reduced, drop).is_linear  # of a linear vehicle three readings are sufficient
    with pytest.raises(InputError, match="do not tell the forces of 4 dampers apart"):
        damper_points(reduced, drop)


@pytest.mark.long
def test_a_drop_that_is_fitted_from_its_release_moves_as_simulated() -> None:
    """The fall, in which tyres are off the ground, is no free decay of the linear vehicle."""
    drops = [{"wheels": wheels, "load": "empty"} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "rl"], ["fl", "fr"])]
    options = {"drops": drops, "rate": 250}
    known = {"total_mass": TABLE_1_CAR.total_mass, "wheelbase": TABLE_1_CAR.wheelbase}
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.05, seed=1, known=known, **options)  # type: ignore[arg-type]
    result = sprung.identify(campaign, extras=(), tracks="shared", fall=True)
    assert result.fit.since == "release"
    for drop in result.series:
        found = fitted_motion(result, drop)
        assert not found.is_linear
        for point in damper_points(result, drop):
            truth = suspension_rate(TABLE_1_CAR, drop, point.wheel, found.time, **options)
            assert np.std(point.velocity - truth) < 0.01 * np.abs(truth).max() + 1.2 * RATE_NOISE
