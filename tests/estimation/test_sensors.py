"""Uncertain sensors in the likelihood, against finite differences, exact sensors and the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sprung.estimation import fit_linear, fit_nonlinear, lift_priors, uncertainty_of
from sprung.estimation.closed_form import ClosedFormObjective
from sprung.estimation.matrix_exponential import MatrixExponentialAt
from sprung.estimation.time_stepping import TimeSteppingObjective
from sprung.preprocess import prepare
from sprung.selection import choose_structure
from sprung.simulation import free_decays
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Load, Readout, Sensor, is_of_sensor, parse_record, uncertainties_of

Real = NDArray[np.float64]

LOAD = parse_record(Load, {"name": "bags", "items": [{"mass": 200, "position": (-1.0, 0.3, 0.5)}]})
EXACT = free_decays(TABLE_1_CAR, loads=[LOAD], states=2, noise=0.02, seed=3, duration=1.5, rate=200)
NAMES = tuple(TABLE_1_CAR.parameters)
MODELS = {load.name: TABLE_1_CAR.linear_model(load) for load in EXACT.loads}
WEIGHTS = np.full(8, 0.02**-2)


def uncertain(delay_std: float = 0.0) -> tuple[Sensor, ...]:
    return tuple(
        replace(sensor, gain_std=0.01, tilt_std=2.0, position_std=0.01, delay_std=delay_std) for sensor in EXACT.sensors
    )


def deviating(readout: Readout) -> Real:
    """Return the car with sensors that deviate by 1 to 3 % in gain, by centimetres, some degrees and up to 3 ms."""
    own = {"gain": 0.02, "x": -0.03, "y": 0.02, "tilt_x": 0.05, "tilt_y": -0.04, "delay": 0.002}
    values = TABLE_1_CAR.parameters | {name: own[name.split(" ")[0]] for name in readout.names if is_of_sensor(name)}
    factors = np.linspace(0.5, 1.5, len(readout.names))
    return np.array([values[name] for name in readout.names]) * np.where(
        np.arange(len(factors)) < len(NAMES), 1.0, factors
    )


def cost(objective: ClosedFormObjective | TimeSteppingObjective, values: Real) -> float:
    at = objective.at(values, WEIGHTS)
    return float((at.residual_sums @ WEIGHTS).sum() + at.penalty)


@pytest.mark.parametrize("delay_std", [0.0, 1e-3])
def test_gradient_is_the_slope_of_the_residual(delay_std: float) -> None:
    readout = Readout.with_unknowns(uncertain(delay_std), NAMES)
    objective, values = ClosedFormObjective(prepare(EXACT).decays, MODELS, readout), deviating(readout)
    gradient = objective.at(values, WEIGHTS).gradient
    assert len(gradient) == len(NAMES) + 8 + 16 + 8 * (delay_std > 0)
    for i, (name, value) in enumerate(zip(readout.names, values, strict=True)):
        step = 1e-6 if is_of_sensor(name) else 1e-5 * value
        ends = [cost(objective, values + side * step * (np.arange(len(values)) == i)) for side in (1, -1)]
        # Central differences of a cost of size 1e6 are rounded to 1e-10 of it over the step.
        rounding = 1e-9 * ends[0] / step
        assert gradient[i] == pytest.approx(-(ends[0] - ends[1]) / (4 * step), rel=2e-4, abs=rounding), name


def test_the_matrix_exponential_agrees() -> None:
    readout = Readout.with_unknowns(uncertain(), NAMES)
    decays, values = prepare(EXACT).decays, deviating(readout)
    closed = ClosedFormObjective(decays, MODELS, readout).at(values, WEIGHTS)
    other = MatrixExponentialAt(ClosedFormObjective(decays, MODELS, readout), MODELS, readout, values, WEIGHTS)
    np.testing.assert_allclose(other.residual_sums, closed.residual_sums, rtol=1e-7)
    scale = np.sqrt(np.diag(closed.information))
    np.testing.assert_allclose(
        other.information / scale / scale[:, None], closed.information / scale / scale[:, None], atol=1e-6
    )


def test_time_stepping_agrees() -> None:
    """With a friction of no force its fit is the linear one, sensors included.

    Its delays are of the second order and from differences, which at 200 Hz are 2 % too small at the hop of the wheels. Of a
    delay that is common to all channels neither says anything.
    """
    campaign = replace(EXACT, sensors=uncertain(5e-4))
    decays, plain = prepare(campaign).decays, choose_structure(campaign, "shared", ())
    known = {**plain.known, "total_mass": KnownValue(TABLE_1_CAR.total_mass, 1.0)}
    linear = fit_linear(decays, plain.linear_models, campaign.sensors, known, start=TABLE_1_CAR.parameters)
    larger = plain.with_terms(("friction",))
    start = linear.parameters | {"F_f": 0.0, "F_r": 0.0, "s_f": 2e5, "s_r": 2e5}
    held = known | {name: KnownValue(value) for name, value in start.items() if name[:2] in ("F_", "s_")}
    found = fit_nonlinear(
        decays, larger.nonlinear_models, campaign.sensors, held, start=start, states=linear.states, near=True
    )
    errors = uncertainty_of(linear)
    stds = dict(zip(errors.names, np.sqrt(np.diag(errors.covariance)), strict=True))
    off = {name: (found.parameters[name] - value) / stds[name] for name, value in linear.parameters.items()}
    assert max(abs(one) for name, one in off.items() if not name.startswith("delay of ")) < 0.1
    assert np.ptp([one for name, one in off.items() if name.startswith("delay of ")]) < 0.3


def test_sensors_that_are_exact_change_no_digit() -> None:
    decays = prepare(EXACT).decays
    assert uncertainties_of(EXACT.sensors) == {}
    readout = Readout.with_unknowns(EXACT.sensors, NAMES)
    values = np.array(list(TABLE_1_CAR.parameters.values()))
    assert readout.names == NAMES
    assert np.array_equal(readout.at(values), readout.rows.at(values))
    assert readout.slopes(values) is readout.rows.slopes
    assert ClosedFormObjective(decays, MODELS, readout).at(values, WEIGHTS).information.shape == (15, 15)


def test_a_gain_common_to_all_channels_is_held_by_its_priors_alone() -> None:
    """Free motion does not show it: it scales the initial states. It affects no parameter, and none is undetermined."""
    known = {"wheelbase": KnownValue(TABLE_1_CAR.wheelbase), "total_mass": KnownValue(TABLE_1_CAR.total_mass, 1.0)}
    fit = fit_linear(prepare(EXACT).decays, MODELS, uncertain(), known)
    statistics = uncertainty_of(fit)
    assert statistics.undetermined.shape[1] == 0
    gains = [i for i, name in enumerate(statistics.names) if name.startswith("gain of ")]
    mean = np.ones(8) / 8
    # The mean of eight gains that are known to 1.04 % (1 %, and 2.4 times 0.12 % by the tilt) each.
    std = np.sqrt(mean @ statistics.covariance[np.ix_(gains, gains)] @ mean)
    assert std == pytest.approx(np.hypot(0.01, 2.4 * np.radians(2) ** 2) / np.sqrt(8), rel=0.01)
    louder = [replace(decay, values=1.5 * decay.values) for decay in prepare(EXACT).decays]
    again = fit_linear(louder, MODELS, uncertain(), known)
    of_vehicle = [statistics.names.index(name) for name in NAMES]
    # Both fits have converged to 1e-4 of a standard error.
    stds = np.sqrt(np.diag(statistics.covariance))[of_vehicle]
    assert np.abs((again.values - fit.values)[of_vehicle] / stds).max() < 1e-3


def test_a_lifted_prior_is_the_fit_without_it() -> None:
    """A gain of 5 %: the estimate without its prior, and what is gained, are those of a fit that states nothing of it."""
    campaign = replace(EXACT, sensors=uncertain())
    louder = [
        replace(decay, values=decay.values * (1 + 0.05 * (np.arange(8) == 5))[:, None])
        for decay in prepare(campaign).decays
    ]
    known = {"wheelbase": KnownValue(TABLE_1_CAR.wheelbase), "total_mass": KnownValue(TABLE_1_CAR.total_mass, 1.0)}
    fit = fit_linear(louder, MODELS, campaign.sensors, known)
    (distance, std, _) = lift_priors(fit, ["gain of wheel_fr"])["gain of wheel_fr"]
    free = [replace(sensor, gain_std=0.5) if sensor.channel == "wheel_fr" else sensor for sensor in campaign.sensors]
    other = fit_linear(louder, MODELS, free, known, start=fit.parameters)
    mean = -(np.radians(2) ** 2)
    assert distance == pytest.approx(other.parameters["gain of wheel_fr"] - mean, abs=0.02 * std)
    gained = 2 * (other.loglikelihood - fit.loglikelihood)
    assert (distance / std) ** 2 == pytest.approx(gained, rel=0.05)
    assert distance == pytest.approx(0.05 - mean, abs=3 * 0.005)
