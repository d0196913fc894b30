"""Delays of several loggers in the likelihood, against finite differences, brute force and laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from sprung.campaign import LoggerClock
from sprung.estimation import FitResult, fit_linear, uncertainty_of
from sprung.estimation.closed_form import ClosedFormObjective
from sprung.preprocess import FlightLikelihood, FreeDecay, prepare
from sprung.simulation import free_decays
from sprung.vehicle import TABLE_1_CAR, Load, Readout, parse_record

Real = NDArray[np.float64]

LOAD = parse_record(Load, {"name": "bags", "items": [{"mass": 200, "position": (-1.0, 0.3, 0.5)}]})
CAMPAIGN, QUIET = (
    free_decays(TABLE_1_CAR, loads=[LOAD], states=2, noise=noise, seed=3, duration=1.5, rate=200)
    for noise in (0.02, 0.0)
)
NAMES = tuple(TABLE_1_CAR.parameters)
TRUTH = np.array(list(TABLE_1_CAR.parameters.values()))
MODELS = {load.name: TABLE_1_CAR.linear_model(load) for load in CAMPAIGN.loads}
ROWS = Readout.of(CAMPAIGN.sensors, NAMES)
WEIGHTS = np.full(8, 0.02**-2)


def clocks(late: float = 0.0, std: float = 0.05, follows: float = 0.0) -> tuple[LoggerClock, ...]:
    """Return three loggers: the body's sensors, two wheels and two wheels; the second one late."""
    groups = ((0, 1, 2, 3), (4, 5), (6, 7))
    return tuple(
        LoggerClock(
            str(number),
            group,
            0.0,
            delay=late if number == 1 else 0.0,
            delay_std=std,
            d_delay_d_parameter={"c_sf": follows * (number == 1)},
        )
        for number, group in enumerate(groups)
    )


def decays(**what: float) -> list[FreeDecay]:
    return [replace(decay, clocks=clocks(**what)) for decay in prepare(CAMPAIGN).decays]


def likelihood(those: list[FreeDecay]) -> ClosedFormObjective:
    return ClosedFormObjective(those, MODELS, ROWS)


def cost(fit: ClosedFormObjective, values: Real) -> float:
    at = fit.at(values, WEIGHTS)
    return float((at.residual_sums @ WEIGHTS).sum() + at.penalty)


APART = (*NAMES[:-2], "t_f1", "t_f2", "t_r1", "t_r2")
ONTO = np.array([[own.startswith(name) for own in APART] for name in NAMES], dtype=float)
"""Half-distances of springs and dampers by those that both share."""


def flown(those: list[FreeDecay], at: Real) -> list[FreeDecay]:
    """Add flights to the first two decays that determine three quantities to some parts in a thousand, and wrongly."""
    random = np.random.default_rng(5)
    for i in (0, 1):
        told = random.standard_normal((17, 3)) / (0.003 * (at @ ONTO)[:, None])
        flight = FlightLikelihood(APART, at @ ONTO, told @ random.standard_normal(3), told @ told.T, 0.0, 0)
        those[i] = replace(those[i], flight=flight)
    return those


def test_what_flights_tell_adds_to_cost_gradient_and_information() -> None:
    values, at = TRUTH * np.linspace(0.97, 1.05, 15), TRUTH * 1.01
    with_flights = flown(decays(), at)
    plain, told = likelihood(decays()), likelihood(with_flights)
    before, after = (fit.at(values, WEIGHTS) for fit in (plain, told))
    flights = [one.flight for one in with_flights if one.flight is not None]
    missed = sum(flight.chi_square_at(values @ ONTO) for flight in flights)
    assert cost(told, values) - cost(plain, values) == pytest.approx(missed, rel=1e-9)
    assert after.penalty - before.penalty == pytest.approx(missed, rel=1e-9)
    gradient = sum(ONTO @ (flight.gradient - flight.information @ ((values - at) @ ONTO)) for flight in flights)
    np.testing.assert_allclose((after.gradient - before.gradient) / gradient, 1.0, rtol=1e-5)
    information = np.sum([ONTO @ flight.information @ ONTO.T for flight in flights], axis=0)
    scale = np.outer(TRUTH, TRUTH)
    added = (after.information - before.information) * scale
    np.testing.assert_allclose(added, information * scale, atol=1e-6 * np.abs(information * scale).max())


@pytest.mark.parametrize("follows", [0.0, 2e-7])
def test_gradient_is_the_slope_of_the_cost(follows: float) -> None:
    fit, values = likelihood(decays(late=0.0007, std=0.0005, follows=follows)), TRUTH * np.linspace(0.95, 1.08, 15)
    gradient = fit.at(values, WEIGHTS).gradient
    for i, value in enumerate(values):
        step = np.zeros(15)
        step[i] = 1e-5 * value
        slope = (cost(fit, values + step) - cost(fit, values - step)) / (2e-5 * value)
        assert gradient[i] == pytest.approx(-slope / 2, rel=2e-4, abs=1e-6 * np.abs(gradient).max())


@pytest.mark.parametrize("follows", [0.0, 2e-7])
def test_information_is_half_the_curvature_of_the_cost_at_the_truth(follows: float) -> None:
    # Without noise the Gauss-Newton information is the curvature itself.
    at_truth = -follows * float(TABLE_1_CAR.c_sf)
    fit = likelihood(
        [replace(d, clocks=clocks(late=at_truth, std=0.0005, follows=follows)) for d in prepare(QUIET).decays]
    )
    information = fit.at(TRUTH, WEIGHTS).information
    random = np.random.default_rng(1)
    for _ in range(4):
        direction = TRUTH * random.standard_normal(15)
        step = 1e-5 * direction
        curvature = (cost(fit, TRUTH + step) - 2 * cost(fit, TRUTH) + cost(fit, TRUTH - step)) / 1e-10
        assert direction @ information @ direction == pytest.approx(curvature / 2, rel=1e-3)


def test_delays_are_where_brute_force_finds_them() -> None:
    those = decays()
    values = TRUTH * 1.002
    likeliest = likelihood(those).at(values, WEIGHTS).modal
    assert likeliest is not None
    found = likeliest.clock_delays(np.zeros((15, 15)))[0]

    def at(late: Real) -> float:
        told = [replace(clock, delay=float(one), delay_std=1e-9) for clock, one in zip(clocks(), late, strict=True)]
        residual = likelihood([replace(those[0], clocks=tuple(told))]).at(values, WEIGHTS).residual_sums
        return float((residual @ WEIGHTS).sum() + np.sum((late / 0.05) ** 2))

    def scaled(late: NDArray[np.float64]) -> float:
        return at(1e-4 * late)

    best = minimize(scaled, [0.0, 0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-7})
    differences = found[0] - found[0][0]
    np.testing.assert_allclose(differences, 1e-4 * (best.x - best.x[0]), atol=2e-7)
    assert np.abs(differences).max() > 1e-5


def test_one_clock_for_all_is_the_fit_without_loggers() -> None:
    together = [replace(decay, clocks=()) for decay in decays()]
    certain = [replace(decay, clocks=clocks(std=1e-12)) for decay in together]
    plain, bound = (likelihood(those).at(TRUTH * 1.01, WEIGHTS) for those in (together, certain))
    np.testing.assert_allclose(bound.residual_sums, plain.residual_sums, rtol=1e-9)
    np.testing.assert_allclose(bound.gradient, plain.gradient, rtol=1e-6, atol=1e-6 * np.abs(plain.gradient).max())
    np.testing.assert_allclose(bound.information, plain.information, rtol=1e-6, atol=1e-6 * plain.information.max())


def test_unknown_delays_only_take_information_away() -> None:
    together = prepare(QUIET).decays
    apart = [replace(decay, clocks=clocks()) for decay in together]
    plain, free = (likelihood(list(those)).at(TRUTH, WEIGHTS).information for those in (together, apart))
    scale = np.sqrt(np.diag(plain))
    lost = np.linalg.eigvalsh((plain - free) / np.outer(scale, scale))
    assert lost.min() > -1e-9
    assert lost.max() > 0.01


def test_records_moved_in_time_give_the_same_vehicle_and_that_delay() -> None:
    # Two samples at 200 Hz: the second logger's samples were taken 10 ms after the others'.
    shift = 2
    moved = []
    for decay in decays():
        values = decay.values.copy()
        values[[4, 5], :-shift] = decay.values[[4, 5], shift:]
        moved.append(replace(decay, values=values[:, :-shift], clocks=clocks()))
    still = [replace(decay, values=decay.values[:, : -2 * shift]) for decay in decays()]
    start = dict(zip(NAMES, (TRUTH * 1.01).tolist(), strict=True))
    known = CAMPAIGN.known

    def fitted(those: list[FreeDecay]) -> FitResult:
        return fit_linear(those, MODELS, CAMPAIGN.sensors, known, start=start)

    one, other = fitted(still), fitted(moved)
    std = np.sqrt(np.diag(uncertainty_of(one).covariance))
    assert np.all(np.abs(one.values - other.values) < 1.5 * std + 1e-12)  # all but two samples are the same
    late, _ = other.clock_delays(np.zeros((15, 15)))[0]
    assert late[1] - late[0] == pytest.approx(shift / 200, abs=3e-4)
