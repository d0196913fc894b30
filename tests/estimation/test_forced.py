"""The likelihood of a vehicle on pads, against motions integrated in time, differences, and sums written out."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from parts_of_a_vehicle import QUARTER_CAR, ROLL_PLANE

from estimation.test_likelihood import LOAD
from estimation.test_likelihood import WITH_RUBBER as RUBBER
from sprung import simulate
from sprung.campaign import Campaign
from sprung.estimation import fit_jointly, fit_linear
from sprung.estimation.closed_form import ClosedFormObjective, linear_objective
from sprung.estimation.forced import ForcedAt, ForcedObjective
from sprung.estimation.joint_objective import JointObjective
from sprung.estimation.linear_fit import problem_of
from sprung.preprocess import FreeDecay, prepare
from sprung.simulation import PadMotion
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Readout, Vehicle

Real = NDArray[np.float64]

WITH_RUBBER = RUBBER.with_values(c_tf=80.0, c_tr=95.0)
"""Damper mounts, Zener branches and damping of the tyres."""

NOISE = {"acceleration": 0.02, "displacement": 5e-5, "force": 8.0}


@cache
def on_pads(vehicle: Vehicle, rate: float = 200.0, kind: str = "random", load: str = "empty") -> Campaign:
    if vehicle.model != "full":
        load = "empty"
    drops = [{"excitation": "pads", "load": load}]
    pads = PadMotion(kind, duration=14.0)  # type: ignore[arg-type]
    return simulate(vehicle, drops=drops, loads=[LOAD], noise=0, rate=rate, pads=pads)


def objective_of(vehicle: Vehicle, campaign: Campaign, decays: tuple[FreeDecay, ...] | None = None) -> ForcedObjective:
    names = tuple(vehicle.parameters)
    models = {load.name: vehicle.linear_model(load) for load in campaign.loads}
    decays = prepare(campaign).decays if decays is None else decays
    return ForcedObjective(decays, models, Readout.with_unknowns(campaign.sensors, names), campaign.sensors)


def weights_of(campaign: Campaign) -> Real:
    return np.array([NOISE[sensor.quantity] for sensor in campaign.sensors]) ** -2


def values_of(vehicle: Vehicle) -> Real:
    return np.array(list(vehicle.parameters.values()))


@pytest.mark.parametrize("load", ["empty", "bags"])
@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, WITH_RUBBER, ROLL_PLANE, QUARTER_CAR], ids=lambda one: one.name)
def test_the_vehicle_itself_explains_its_records_to_rounding(vehicle: Vehicle, load: str) -> None:
    """What remains of records from rest to rest is a millionth of the noise of usual sensors."""
    campaign = on_pads(vehicle, load=load)
    at = objective_of(vehicle, campaign).at(values_of(vehicle), weights_of(campaign))
    assert np.all(np.sqrt(at.residual_sums @ at.weights) < 1e-3)
    assert all(np.abs(np.diag(own)).all() for own in at.by_drop[1])


@pytest.mark.parametrize("rate", [100.0, 500.0])
def test_ends_of_a_slice_cost_less_than_one_sample_of_noise(rate: float) -> None:
    """Both ends are in the middle of the motion: jumps of 1 m/s² and of millimetres between them."""
    campaign = on_pads(TABLE_1_CAR, rate)
    (decay,) = prepare(campaign).decays
    part = replace(decay, values=decay.values[:, int(3 * rate) + 1 : int(10 * rate)])
    at = objective_of(TABLE_1_CAR, campaign, (part,)).at(values_of(TABLE_1_CAR), weights_of(campaign))
    assert float(np.sum(at.residual_sums @ at.weights)) < 2.0
    # 46 unknowns, of the size that their priors say.
    assert at.penalty < 10


def uncertain(campaign: Campaign) -> Campaign:
    """Return a campaign whose sensors have unknown gains, places and delays."""
    sensors = [replace(one, gain_std=0.01, position_std=0.01, delay_std=1e-3) for one in campaign.sensors]
    return replace(campaign, sensors=tuple(sensors))


@pytest.mark.slow
def test_gradient_is_that_of_the_likelihood() -> None:
    """By all parameters of the vehicle and its sensors, inputs and ends being eliminated anew at every point."""
    campaign = uncertain(on_pads(WITH_RUBBER, load="bags"))
    objective = objective_of(WITH_RUBBER, campaign)
    weights = weights_of(campaign)
    own = values_of(WITH_RUBBER) * 1.02
    values = np.concatenate([own, np.full(len(objective.sensors.names) - len(own), 1e-3)])

    def loglikelihood(at: ForcedAt) -> float:
        return -0.5 * (float(np.sum(at.residual_sums @ at.weights)) + at.penalty)

    gradient = objective.at(values, weights).gradient
    for i in range(0, len(values), 3):
        step = np.zeros(len(values))
        step[i] = 1e-5 * values[i]
        ahead, behind = (loglikelihood(objective.at(values + side * step, weights)) for side in (1, -1))
        assert gradient[i] == pytest.approx((ahead - behind) / (2 * step[i]), rel=1e-4, abs=1e-6 * abs(gradient).max())


def test_information_is_that_of_the_gradient() -> None:
    """Without noise and at the vehicle itself, the second derivative is that of Gauss and Newton."""
    campaign = on_pads(TABLE_1_CAR)
    objective, values, weights = objective_of(TABLE_1_CAR, campaign), values_of(TABLE_1_CAR), weights_of(campaign)
    information = objective.at(values, weights).information
    size = np.sqrt(np.diag(information))
    for i in range(0, len(values), 4):
        step = np.zeros(len(values))
        step[i] = 1e-5 * values[i]
        ahead, behind = (objective.at(values + side * step, weights).gradient for side in (1, -1))
        found = -(ahead - behind) / (2 * step[i])
        np.testing.assert_allclose(found / size / size[i], information[i] / size / size[i], atol=1e-5)


def test_residuals_in_time_are_those_of_the_lines() -> None:
    campaign = simulate(TABLE_1_CAR, drops=[{"excitation": "pads"}], noise=NOISE, seed=1, pads=PadMotion(duration=10.0))
    (decay,) = prepare(campaign).decays
    at = objective_of(TABLE_1_CAR, campaign).at(values_of(TABLE_1_CAR), weights_of(campaign))
    lines = at.objective.lines[0]
    residual = decay.values - at.fitted[0]
    spectrum = np.fft.rfft(residual, axis=1)[:, lines.numbers] * np.sqrt(2 / lines.samples)
    np.testing.assert_allclose(np.sum(np.abs(spectrum) ** 2, axis=1), at.residual_sums[0], rtol=1e-6)


def test_noise_levels_of_inputs_and_outputs_are_found_though_inputs_are_unknown() -> None:
    """The accelerometers on the wheels spend nine tenths of their lines on the motions of the pads."""
    campaign = simulate(TABLE_1_CAR, drops=[{"excitation": "pads"}], noise=NOISE, seed=2, pads=PadMotion(duration=20.0))
    objective = objective_of(TABLE_1_CAR, campaign)
    problem = problem_of(objective, {}, TABLE_1_CAR.parameters)
    iterate = problem.start(problem.priors.coordinates.from_parameters(TABLE_1_CAR.parameters))
    for _ in range(8):
        at = iterate.at
        iterate = replace(iterate, at=at.reweighted(1 / problem.noise_variance(at.residual_sums, at)))
    expected = [NOISE[sensor.quantity] for sensor in campaign.sensors]
    np.testing.assert_allclose(iterate.at.weights**-0.5, expected, rtol=0.2)
    assert np.all(iterate.at.leverage[4:8] > 0.8 * objective.lines[0].counts[4:8])


@pytest.mark.parametrize("quantity", ["displacement", "force"])
@pytest.mark.slow
def test_one_of_displacement_and_force_is_enough(quantity: str) -> None:
    """With the force alone the tyres' rates are not determined by it, but by the wheels' motions over what drives them."""
    campaign = simulate(TABLE_1_CAR, drops=[{"excitation": "pads"}], noise=NOISE, seed=1, pads=PadMotion(duration=20.0))
    kept = [i for i, sensor in enumerate(campaign.sensors) if sensor.pad is None or sensor.quantity == quantity]
    (decay,) = prepare(campaign).decays
    part = replace(decay, values=decay.values[kept], high_pass=())
    sensors = [campaign.sensors[i] for i in kept]
    known = {"total_mass": KnownValue(TABLE_1_CAR.total_mass)} if quantity == "displacement" else {}
    if quantity == "force":
        known = {"k_tf": KnownValue(TABLE_1_CAR.k_tf), "k_tr": KnownValue(TABLE_1_CAR.k_tr)}
    fit = fit_jointly([part], {"empty": TABLE_1_CAR.linear_model()}, sensors, known)
    errors = np.abs(fit.values / values_of(TABLE_1_CAR) - 1)
    assert errors.max() < 0.02
    assert not fit.undetermined.shape[1]


def joint() -> tuple[JointObjective, Real, Real]:
    drops: list[dict[str, object]] = [
        {"excitation": "pads"},
        {"wheels": ["fl", "fr"]},
        {"excitation": "pads", "wheels": ["fl", "rl"]},
        {},
    ]
    campaign = simulate(TABLE_1_CAR, drops=drops, noise=NOISE, seed=1, pads=PadMotion(duration=10.0))
    names = tuple(TABLE_1_CAR.parameters)
    readout = Readout.of(campaign.sensors, names)
    models = {"empty": TABLE_1_CAR.linear_model()}
    found = linear_objective(prepare(campaign).decays, models, readout, campaign.sensors)
    assert isinstance(found, JointObjective)
    return found, values_of(TABLE_1_CAR) * 1.01, weights_of(campaign)


def test_drops_and_pads_add_up() -> None:
    objective, values, weights = joint()
    at, free, driven = (one.at(values, weights) for one in (objective, *objective.parts))
    assert isinstance(objective.parts[0], ClosedFormObjective)
    np.testing.assert_allclose(at.gradient, free.gradient + driven.gradient)
    np.testing.assert_allclose(at.information, free.information + driven.information)
    np.testing.assert_allclose(at.residual_sums[[1, 3]], free.residual_sums)
    np.testing.assert_allclose(at.residual_sums[[0, 2]], driven.residual_sums)
    for drop, decay in enumerate(objective.decays):
        alone = at.of_drop(drop)
        np.testing.assert_allclose(
            alone.gradient, at.by_drop[0][drop], rtol=1e-6, atol=1e-9 * np.abs(at.gradient).max()
        )
        assert at.fitted[drop].shape == decay.values.shape
        assert at.motion(drop, 3, 5).shape == (14, 8)


def test_a_joint_fit_is_better_than_either() -> None:
    objective, _, _ = joint()
    sensors = on_pads(TABLE_1_CAR).sensors
    models = {"empty": TABLE_1_CAR.linear_model()}
    fits = [
        fit_linear(decays, models, sensors, {}, start=TABLE_1_CAR.parameters)
        for decays in (objective.decays, [one for one in objective.decays if one.pads])
    ]
    both, alone = (np.linalg.inv(fit.problem.system(fit.iterate)[0]) for fit in fits)
    assert np.all(np.diag(both) < np.diag(alone))


@pytest.mark.slow
def test_a_detour_by_fewer_lines_ends_where_all_lines_lead() -> None:
    """Records of a minute, looked through at a sixth of their lines, end at the optimum of all of them."""
    drops = [{"excitation": "pads", "load": "bags"}]
    motion = PadMotion("random", duration=60.0)
    campaign = simulate(TABLE_1_CAR, drops=drops, loads=[LOAD], noise=NOISE, rate=200, pads=motion, seed=3)
    decays = prepare(campaign).decays
    models = {load.name: TABLE_1_CAR.linear_model(load) for load in campaign.loads}
    whole = objective_of(TABLE_1_CAR, campaign, decays)
    few = whole.of_fewer_lines()
    assert few is not None
    assert few.observations.max() < whole.observations.max() / 3
    assert few.of_fewer_lines() is None
    guessed = fit_linear(decays, models, campaign.sensors, {})
    known_start = fit_linear(decays, models, campaign.sensors, {}, start=TABLE_1_CAR.parameters)
    assert (guessed.starts, guessed.starts_agreeing) == (3, 3)
    # Relative standard errors are some 1e-4.
    np.testing.assert_allclose(guessed.values, known_start.values, rtol=1e-6)
