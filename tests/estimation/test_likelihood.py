"""The likelihood against the same quantities computed the long way, sample by sample."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sprung.estimation.closed_form import ClosedFormObjective
from sprung.estimation.matrix_exponential import MatrixExponentialAt
from sprung.estimation.modal_solution import differentiate_modes, solve_modes
from sprung.preprocess import prepare
from sprung.simulation import free_decays
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Load, Readout, Vehicle, affine_response, parse_record

Real = NDArray[np.float64]

LOAD = parse_record(Load, {"name": "bags", "items": [{"mass": 200, "position": (-1.0, 0.3, 0.5)}]})


WITH_RUBBER = TABLE_1_CAR.with_values(
    k_df=2.1e5,
    k_dr=2.6e5,
    c_df=80.0,
    c_dr=110.0,
    k_zf=3500.0,
    k_zr=3000.0,
    c_zf=190.0,
    c_zr=140.0,
    name="car with rubber",
)
"""Damper mounts and Zener branches: eight coordinates without mass."""

# 1/σ² with which the initial states' own reach weighs nothing beside the records.
HEAVY = 1e8


def likelihood_of(vehicle: Vehicle, noise: float = 0.1) -> tuple[ClosedFormObjective, Real, list[Real], list[str]]:
    campaign = free_decays(vehicle, loads=[LOAD], states=2, noise=noise, seed=3, duration=1.5, rate=200)
    decays = prepare(campaign).decays
    names = tuple(vehicle.parameters)
    models = {load.name: vehicle.linear_model(load) for load in campaign.loads}
    sensors = Readout.of(campaign.sensors, names)
    likelihood = ClosedFormObjective(decays, models, sensors)
    values = np.array(list(vehicle.parameters.values()))
    return likelihood, values, [decay.values for decay in decays], [decay.load for decay in decays]


def basis(likelihood: ClosedFormObjective, values: Real, load: str, samples: int, rate: float = 200) -> Real:
    """Return every column of a free initial state and the offsets, channel after channel, from matrix exponentials."""
    matrices = likelihood.models[load].matrices(values)
    sensors = likelihood.sensors.at(values)
    columns = []
    A = matrices.state
    for state in np.eye(len(A)):
        states = affine_response(A, np.zeros(len(A)), state, 1 / rate, samples)
        columns.append((sensors @ (A @ A @ states)[: len(matrices.M)]).ravel())
    offsets = np.kron(np.eye(len(sensors)), np.ones(samples)).reshape(len(sensors), -1)
    return np.column_stack([*columns, *offsets])


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS, WITH_RUBBER])
def test_residual_is_that_of_plain_least_squares(vehicle: Vehicle) -> None:
    likelihood, values, records, loads = likelihood_of(vehicle)
    values = values * 1.07
    weights = np.linspace(1.0, 2.0, 8) * HEAVY
    found = likelihood.at(values, weights)
    for record, load, residual in zip(records, loads, found.residual_sums, strict=True):
        root = np.repeat(np.sqrt(weights), record.shape[1])
        columns = basis(likelihood, values, load, record.shape[1])
        coefficients = np.linalg.lstsq(columns * root[:, None], record.ravel() * root, rcond=None)[0]
        left = (record.ravel() - columns @ coefficients).reshape(record.shape)
        np.testing.assert_allclose(residual, np.sum(left**2, axis=1), rtol=1e-8)
    np.testing.assert_allclose(likelihood.at(values, weights).residual_sums, found.residual_sums, rtol=1e-12)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, WITH_RUBBER])
def test_gradient_is_the_slope_of_the_residual(vehicle: Vehicle) -> None:
    likelihood, values, *_ = likelihood_of(vehicle)
    values = values * np.linspace(0.95, 1.08, len(values))
    weights = np.linspace(0.5, 1.0, 8) * HEAVY
    gradient = likelihood.at(values, weights).gradient
    for i, value in enumerate(values):
        step = 1e-5 * value
        up, down = values.copy(), values.copy()
        up[i] += step
        down[i] -= step
        slope = np.sum(
            (likelihood.at(up, weights).residual_sums - likelihood.at(down, weights).residual_sums) @ weights
        ) / (2 * step)
        assert gradient[i] == pytest.approx(-slope / 2, rel=1e-5, abs=1e-6 * abs(slope).max())


def test_information_is_the_projected_jacobian_squared() -> None:
    likelihood, values, records, loads = likelihood_of(TABLE_1_CAR, noise=0.0)
    weights = np.full(8, HEAVY)
    information = likelihood.at(values, weights).information / HEAVY
    expected = np.zeros_like(information)
    for record, load in zip(records, loads, strict=True):
        columns = basis(likelihood, values, load, record.shape[1])
        orthonormal = np.linalg.svd(columns, full_matrices=False)[0]
        coefficients = np.linalg.lstsq(columns, record.ravel(), rcond=None)[0]
        slopes = []
        for i, value in enumerate(values):
            up, down = values.copy(), values.copy()
            up[i] += 1e-5 * value
            down[i] -= 1e-5 * value
            difference = basis(likelihood, up, load, record.shape[1]) - basis(likelihood, down, load, record.shape[1])
            slope = difference @ coefficients / (2e-5 * value)
            slopes.append(slope - orthonormal @ (orthonormal.T @ slope))
        jacobian = np.array(slopes)
        expected += jacobian @ jacobian.T
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(information / np.outer(scale, scale), expected / np.outer(scale, scale), atol=2e-6)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, WITH_RUBBER])
def test_poles_and_their_slopes(vehicle: Vehicle) -> None:
    names = tuple(vehicle.parameters)
    values = np.array(list(vehicle.parameters.values()))
    model = vehicle.linear_model()
    sensors = Readout.of([], names)
    found = solve_modes(model, sensors, values)
    poles_by_parameter, _ = differentiate_modes(model, sensors, values, found, 3.0)
    for i, value in enumerate(values):
        up, down = values.copy(), values.copy()
        up[i] += 1e-5 * value
        down[i] -= 1e-5 * value
        poles = [np.linalg.eigvals(model.matrices(side).state) for side in (up, down)]
        nearest = [side[np.argmin(np.abs(side[:, None] - found.poles), axis=0)] for side in poles]
        numeric = (nearest[0] - nearest[1]) / (2e-5 * value)
        np.testing.assert_allclose(poles_by_parameter[i] * value, numeric * value, atol=2e-5)


def test_repeated_poles_do_not_spoil_the_derivative() -> None:
    """Front and rear axles alike: every hop mode is there twice, at the very same pole."""
    symmetric = Vehicle(
        m_s=1200, I_yy=1200 * 1.3**2, I_xx=1200 * 0.7**2, m_uf=40, m_ur=40, k_sf=2e4, k_sr=2e4, k_tf=2e5, k_tr=2e5, c_sf=1200,
        c_sr=1200, a=1.3, b=1.3, t_f=0.7, t_r=0.7,
    )  # fmt: skip
    poles = np.linalg.eigvals(symmetric.matrices().state)
    gaps = np.abs(poles[:, None] - poles[None, :])[np.triu_indices(14, 1)]
    assert gaps.min() < 1e-9  # this is what the test is about
    likelihood, values, *_ = likelihood_of(symmetric)
    weights = np.full(8, HEAVY)
    start = values * 1.0
    gradient = likelihood.at(start, weights).gradient
    for i, value in enumerate(start):
        step = 2e-5 * value
        up, down = start.copy(), start.copy()
        up[i] += step
        down[i] -= step
        slope = np.sum(
            (likelihood.at(up, weights).residual_sums - likelihood.at(down, weights).residual_sums) @ weights
        ) / (2 * step)
        assert gradient[i] * value == pytest.approx(-slope / 2 * value, rel=1e-4, abs=1e-2)


def critically_damped() -> Vehicle:
    """Make a vehicle two of whose modes meet in one shape, at a double real pole: damper rates tuned by bisection."""

    def vehicle(rate: float) -> Vehicle:
        return TABLE_1_CAR.with_values(
            t_f=None, t_r=None, t_f1=0.5, t_r1=0.5, t_f2=0.74, t_r2=0.74, c_sf=rate, c_sr=rate
        )

    low, high = 1500.0, 40000.0  # without and with real poles
    for _ in range(60):
        middle = (low + high) / 2
        real = np.any(np.linalg.eigvals(vehicle(middle).matrices().state).imag == 0)
        low, high = (low, middle) if real else (middle, high)
    return vehicle(high)


def test_modes_that_meet_in_one_shape() -> None:
    """Critical damping: modal coordinates do not exist, and yet everything must come out."""
    vehicle = critically_damped()
    shapes = np.linalg.eig(vehicle.matrices().state).eigenvectors
    assert np.linalg.cond(shapes) > 1e6  # this is what the test is about
    likelihood, values, records, loads = likelihood_of(vehicle, noise=0.02)
    weights = np.full(8, 1 / 0.02**2)
    found = likelihood.at(values, weights)
    for record, load, residual in zip(records, loads, found.residual_sums, strict=True):
        columns = basis(likelihood, values, load, record.shape[1])
        left = record.ravel() - columns @ np.linalg.lstsq(columns, record.ravel(), rcond=None)[0]
        np.testing.assert_allclose(residual, np.sum(left.reshape(record.shape) ** 2, axis=1), rtol=1e-3)
    relative = found.information * np.outer(values, values)
    beside = values * (1 + 1e-3 * np.cos(np.arange(len(values))))  # where modal coordinates exist again
    reference = likelihood.at(beside, weights).information * np.outer(values, values)
    np.testing.assert_allclose(np.linalg.eigvalsh(relative), np.linalg.eigvalsh(reference), rtol=0.05)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS, WITH_RUBBER])
def test_modal_coordinates_and_matrix_exponentials_agree(vehicle: Vehicle) -> None:
    likelihood, values, *_ = likelihood_of(vehicle)
    values, weights = values * np.linspace(0.97, 1.04, len(values)), np.linspace(0.5, 1.0, 8) * HEAVY
    found = likelihood.at(values, weights)
    gradients, informations = found.by_drop
    reference = MatrixExponentialAt(likelihood, likelihood.models, likelihood.sensors, values, weights)
    np.testing.assert_allclose(found.residual_sums, reference.residual_sums, rtol=1e-9)
    np.testing.assert_allclose(gradients * values, reference.by_drop[0] * values, rtol=1e-7, atol=1e-3)
    for own, other in zip(informations, reference.by_drop[1], strict=True):
        size = np.sqrt(np.diag(other))
        np.testing.assert_allclose((own - other) / np.outer(size, size), 0.0, atol=1e-9)
    np.testing.assert_allclose(found.fitted, reference.fitted, atol=1e-9)
    np.testing.assert_allclose(found.states, reference.states, atol=1e-9)
    np.testing.assert_allclose(found.leverage, reference.leverage, rtol=1e-6)
    np.testing.assert_allclose(found.motion(1, 20, 50), reference.motion(1, 20, 50), atol=1e-7)
    np.testing.assert_allclose(found.gradient, gradients.sum(axis=0), rtol=1e-9, atol=1e-9 * np.abs(gradients).max())
    scale = np.sqrt(np.diag(reference.information))
    difference = (found.information - reference.information) / np.outer(scale, scale)
    np.testing.assert_allclose(difference, 0.0, atol=1e-9)
    moved = reference.moved(values * 1.01).of_drop(1)
    np.testing.assert_allclose(moved.residual_sums, found.moved(values * 1.01).of_drop(1).residual_sums, rtol=1e-9)
