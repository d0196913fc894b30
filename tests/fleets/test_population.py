"""Mean, spread and conditional estimates of a population against published numbers, closed forms and simulation."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from fleet_population import random_correlation
from sprung.fleets import estimate_vehicles, fit_population
from sprung.fleets.population import _loglikelihood

Real = NDArray[np.float64]

# G. Colditz et al., J. Am. Med. Assoc. 271 (1994) 698: thirteen trials, cases and others among vaccinated and controls.
TRIALS = np.array(
    [
        (4, 119, 11, 128),
        (6, 300, 29, 274),
        (3, 228, 11, 209),
        (62, 13536, 248, 12619),
        (33, 5036, 47, 5761),
        (180, 1361, 372, 1079),
        (8, 2537, 10, 619),
        (505, 87886, 499, 87892),
        (29, 7470, 45, 7232),
        (17, 1699, 65, 1600),
        (186, 50448, 141, 27197),
        (5, 2493, 3, 2338),
        (27, 16886, 29, 17825),
    ],
    dtype=float,
)


def log_risk_ratios() -> tuple[Real, Real]:
    """Return logarithms of the risk ratios and their covariance matrices."""
    a, b, c, d = TRIALS.T
    return np.log(a / (a + b) / (c / (c + d)))[:, None], (1 / a - 1 / (a + b) + 1 / c - 1 / (c + d))[:, None, None]


def restricted_likelihood(spread: Real, positions: Real, covariances: Real) -> float:
    weights = np.asarray(np.linalg.inv(covariances + spread), dtype=float)
    covariance = np.asarray(np.linalg.inv(weights.sum(axis=0)), dtype=float)
    rest = positions - covariance @ np.einsum("nij,nj->i", weights, positions)
    return _loglikelihood(weights, covariance, np.asarray(np.einsum("nij,nj->ni", weights, rest), dtype=float), rest)


def test_the_restricted_likelihood_is_that_of_other_programs() -> None:
    """R's metafor states for these trials: τ² = 0.3132, mean -0.7145 with a standard error of 0.1798 (method REML)."""
    positions, covariances = log_risk_ratios()
    found = minimize_scalar(
        lambda t: -restricted_likelihood(np.array([[t]]), positions, covariances),
        bounds=(0, 2),
        options={"xatol": 1e-7},
    )
    assert found.x == pytest.approx(0.3132, abs=5e-5)
    weights = 1 / (covariances[:, 0, 0] + found.x)
    assert np.average(positions[:, 0], weights=weights) == pytest.approx(-0.7145, abs=5e-5)
    assert weights.sum() ** -0.5 == pytest.approx(0.1798, abs=5e-5)


def test_the_spread_maximises_restricted_likelihood_and_prior() -> None:
    positions, covariances = log_risk_ratios()
    best = minimize_scalar(
        lambda t: -restricted_likelihood(np.array([[t]]), positions, covariances) - 0.5 * np.log(t),
        bounds=(1e-4, 2),
        options={"xatol": 1e-7},
    ).x
    population = fit_population(positions, covariances)
    assert population.spread[0, 0] == pytest.approx(best, rel=0.02)  # the iteration ends at a gain of 1e-4
    assert population.std_error[0] == pytest.approx(
        0.1664 / 0.3132 / 2, rel=0.2
    )  # metafor: 0.1664 for τ², without prior


def test_without_errors_of_the_tests_the_spread_is_that_of_the_sample() -> None:
    positions = np.random.default_rng(1).normal(size=(30, 1))
    population = fit_population(positions, np.full((30, 1, 1), 1e-12))
    # -(N - 1)/2 ln T - S/(2T) + ½ ln T has its maximum at S / (N - 2).
    assert population.spread[0, 0] == pytest.approx(float(((positions - positions.mean()) ** 2).sum()) / 28, rel=1e-3)
    assert population.mean[0] == pytest.approx(positions.mean(), rel=1e-9)


def test_an_estimate_is_pulled_to_the_mean_by_the_ratio_of_variances() -> None:
    """θ̂ = μ + T/(T + v) (x - μ), the textbook's shrinkage, and nothing of it for an exact test."""
    positions = np.random.default_rng(2).normal(size=(200, 1))
    variances = np.tile([1e-10, 1.0], 100)
    population = fit_population(positions, variances[:, None, None])
    found = estimate_vehicles(positions, variances[:, None, None], population)
    ratio = population.spread[0, 0] / (population.spread[0, 0] + variances)
    np.testing.assert_allclose(
        found.positions[:, 0], population.mean[0] + ratio * (positions[:, 0] - population.mean[0])
    )
    np.testing.assert_allclose(found.positions[::2], positions[::2], atol=1e-8)


def test_correlations_are_found_where_the_data_support_them() -> None:
    random = np.random.default_rng(3)
    spread = random_correlation(random, 4) * 0.03**2
    errors = 0.01**2 * np.eye(4)
    joint = random.multivariate_normal(np.zeros(4), spread + errors, 200)
    population = fit_population(joint, np.broadcast_to(errors, (200, 4, 4)))
    assert population.correlated
    np.testing.assert_allclose(population.spread, spread, atol=4 * 0.03**2 * np.sqrt(2 / 200))
    alone = random.multivariate_normal(np.zeros(4), 0.03**2 * np.eye(4) + errors, 200)
    assert not fit_population(alone, np.broadcast_to(errors, (200, 4, 4))).correlated


def test_a_vehicle_that_does_not_determine_a_parameter_gets_it_from_the_others() -> None:
    """One that is not weighed: its scale is the population's, its ratios are its own."""
    random = np.random.default_rng(4)
    true = 0.02 * random.normal(size=(100, 3))
    covariances = np.broadcast_to(0.002**2 * np.eye(3), (100, 3, 3)).copy()
    covariances[0] += 100 * np.ones((3, 3))
    positions = true + 0.002 * random.normal(size=(100, 3))
    positions[0] += 1.7
    found = estimate_vehicles(positions, covariances, fit_population(positions[1:], covariances[1:]))
    assert np.ptp(found.positions[0] - true[0]) < 0.01  # the same shift in all: their ratios are kept
    assert np.abs(found.positions[0] - true[0]).max() < 0.05
    assert found.stds[0] == pytest.approx(np.full(3, 0.02 / np.sqrt(3)), rel=0.3)  # mean of three independent ones


@pytest.mark.long
@pytest.mark.parametrize(("count", "fleets"), [(5, 120), (10, 80), (30, 30), (300, 3)])
def test_coverage_of_the_estimates(count: int, fleets: int) -> None:
    """95 % intervals contain the truth in 93 to 97 %, also of small fleets, whose spread is hardly known."""
    random = np.random.default_rng(count)
    width, covered = 15, []
    for _ in range(fleets):
        std = random.uniform(0.01, 0.08, width)
        true = random.multivariate_normal(
            np.zeros(width), random_correlation(random, width, 0.5) * np.outer(std, std), count
        )
        own = random.uniform(0.005, 0.1, (count, width))
        covariances = np.array([random_correlation(random, width) * np.outer(s, s) + 1e-8 * np.eye(width) for s in own])
        positions = np.array([random.multivariate_normal(t, c) for t, c in zip(true, covariances, strict=True)])
        found = estimate_vehicles(positions, covariances, fit_population(positions, covariances))
        covered.append(np.abs(found.positions - true) < 1.96 * found.stds)
    assert 0.93 < np.mean(covered) < 0.97


@pytest.mark.slow
def test_coverage_of_parameters_whose_spread_no_test_resolves() -> None:
    """Over many fleets each parameter has its coverage, though a single fleet may take its spread for too little."""
    random = np.random.default_rng(11)
    spread, error = np.array([0.03, 0.03, 0.005, 0.005]), 0.013
    # As of two drops: nearly all errors are one error, here of a position that hardly differs between vehicles.
    shared = np.array([1.0, -1.0, 1.0, 0.3])
    errors = error**2 * np.outer(shared, shared) + np.diag([0.003, 0.003, 0.001, 0.008]) ** 2
    for count, fleets in ((5, 400), (30, 150)):
        covered = []
        for _ in range(fleets):
            true = spread * random.normal(size=(count, 4))
            positions = true + random.multivariate_normal(np.zeros(4), errors, count)
            covariances = np.broadcast_to(errors, (count, 4, 4))
            found = estimate_vehicles(positions, covariances, fit_population(positions, covariances))
            covered.append((np.abs(found.positions - true) < 1.96 * found.stds).mean(axis=0))
        # The standard errors of the means are 0.5 to 1 %.
        assert np.all(np.abs(np.mean(covered, axis=0) - 0.95) < 0.03), (count, np.mean(covered, axis=0))
