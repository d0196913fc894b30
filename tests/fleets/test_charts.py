"""Control charts: run lengths against simulation, a rig that drifts told from a vehicle that deviates."""

from __future__ import annotations

import numpy as np
import pytest

from fleet_population import NAMES, SPREAD, draw_fleet
from sprung.fleets import (
    RUN_LENGTH,
    WEIGHT,
    Population,
    alarm_limit,
    average_run_length,
    chart_vehicles,
    clipping_radius,
    largest_component,
    score_vehicles,
)


def simulated_run_lengths(width: int, limit: float, charts: int, longest: int) -> list[int]:
    """Return run lengths of charts in control, by drawing their scores."""
    random = np.random.default_rng(width)
    average, running, lengths = np.zeros((charts, width)), np.ones(charts, dtype=bool), np.zeros(charts, dtype=int)
    for _ in range(longest):
        score = random.standard_normal((charts, width))
        score *= np.minimum(1, clipping_radius(width) / np.linalg.norm(score, axis=1, keepdims=True))
        average = (1 - WEIGHT) * average + WEIGHT * score
        lengths += running
        running &= np.linalg.norm(average, axis=1) <= limit
    assert not running.any()
    return lengths.tolist()


@pytest.mark.parametrize("width", [1, 2, pytest.param(13, marks=pytest.mark.long)])
@pytest.mark.slow
def test_the_run_length_is_that_of_a_simulation(width: int) -> None:
    limit = alarm_limit(width, 50.0)
    assert average_run_length(limit, width) == pytest.approx(50, rel=1e-3)
    lengths = simulated_run_lengths(width, limit, 4000, 700)
    # The standard error of the mean of 4000 run lengths of about 50 is 0.8; the chain has 200 states.
    assert np.mean(lengths) == pytest.approx(50, abs=3.0)


@pytest.mark.long
@pytest.mark.parametrize("width", [1, 5, 13])
def test_the_promised_run_length(width: int) -> None:
    lengths = simulated_run_lengths(width, alarm_limit(width), 4000, 7000)
    assert np.mean(lengths) == pytest.approx(RUN_LENGTH, rel=0.06)  # three standard errors of 4000 run lengths: 5 %


def test_the_run_length_of_one_parameter_is_the_published_one() -> None:
    """J. Lucas, M. Saccucci, Technometrics 32 (1990) 1, table 3: λ = 0.1, 2.703 standard deviations, 500 samples.

    Theirs is not clipped, which shortens the tails here: the limit is a little larger there for the same run length.
    """
    limit = 2.814 * np.sqrt(WEIGHT / (2 - WEIGHT))
    assert average_run_length(limit, 1) == pytest.approx(500, rel=0.2)


def test_scores_of_vehicles_in_control_are_independent_and_normal() -> None:
    """Recursive residuals: exact for a known spread, whatever the accuracy of each test, from the second vehicle on."""
    random = np.random.default_rng(6)
    values = []
    for _ in range(60):
        fleet = draw_fleet(12, random)
        none = np.zeros(len(NAMES))
        population = Population(none, np.diag(none), np.diag(SPREAD**2), False, 0.0, none + 1e-3, 1)
        scores = score_vehicles(fleet.positions, fleet.covariances, population, 20.0, 20.0, WEIGHT)
        values.append(scores.values[1:])
    flat = np.array(values).reshape(60, -1)
    # 60 fleets of 143 numbers: standard errors 0.011 of the mean, 0.015 of the variance, 1.5 times 1/sqrt(60) of a correlation.
    assert abs(flat.mean()) < 0.04
    assert flat.var() == pytest.approx(1, abs=0.06)
    correlation = np.asarray(np.corrcoef(flat.T))
    np.fill_diagonal(correlation, 0)
    assert np.sqrt(np.mean(correlation**2)) == pytest.approx(1 / np.sqrt(59), rel=0.05)


def test_the_limit_of_independent_parameters_is_that_of_sidak() -> None:
    from scipy.stats import norm  # noqa: PLC0415

    sidak = norm.isf((1 - (1 - 1 / 500) ** (1 / 7)) / 2)
    assert largest_component(np.diag(np.arange(1.0, 8.0)), 500) == pytest.approx(sidak, abs=0.03)


@pytest.mark.slow
def test_a_rig_that_drifts_is_told_from_a_vehicle_that_deviates() -> None:
    fleet = draw_fleet(300, np.random.default_rng(9), drift=150, weak=80)
    chart, population = chart_vehicles(fleet)
    weak = [alarm for alarm in chart.vehicle_alarms if alarm.number == 81]
    assert [deviation.name for deviation in weak[0].deviations] == ["c_sf"]
    found = weak[0].deviations[0]
    assert abs(found.percent + 15) < 3 * found.percent_std
    drift = [alarm for alarm in chart.rig_alarms if alarm.deviation.name == "scale"]
    assert len(drift) == 1
    assert 130 < drift[0].since <= 171
    assert drift[0].number < 220
    assert abs(drift[0].deviation.percent - 1) < 4 * drift[0].deviation.percent_std
    # The mean is that since the drift: 1 % more of everything with a mass.
    scaled = slice(0, 11)
    error = population.mean[scaled] - np.log(1.01)
    assert np.abs(error / np.sqrt(np.diag(population.mean_covariance))[scaled]).max() < 4
    np.testing.assert_allclose(chart.offsets[0, scaled], np.log(1.01), atol=0.02)


@pytest.mark.slow
def test_a_vehicle_that_deviates_in_two_parameters_names_both() -> None:
    fleet = draw_fleet(60, np.random.default_rng(10))
    fleet.positions[30, [NAMES.index("m_uf"), NAMES.index("k_sr")]] += (0.2, -0.25)
    chart, _ = chart_vehicles(fleet)
    assert [alarm.number for alarm in chart.vehicle_alarms] == [31]
    assert {deviation.name for deviation in chart.vehicle_alarms[0].deviations} == {"m_uf", "k_sr"}


@pytest.mark.long
@pytest.mark.parametrize(("count", "fleets"), [(30, 120), (300, 16)])
def test_false_alarms_are_as_rare_as_promised(count: int, fleets: int) -> None:
    """Complete charts of fleets in control, mean and spread estimated from the same vehicles."""
    random = np.random.default_rng(count)
    vehicles = rigs = 0
    for _ in range(fleets):
        chart, _ = chart_vehicles(draw_fleet(count, random))
        vehicles, rigs = vehicles + len(chart.vehicle_alarms), rigs + len(chart.rig_alarms)
    expected = fleets * count / RUN_LENGTH
    # About eight alarms are expected of each chart, with a standard deviation of three.
    assert vehicles <= expected + 3.5 * np.sqrt(expected)
    assert rigs <= expected + 3.5 * np.sqrt(expected)
