"""Where a fit ends: the higher of two summits, and what a larger model would gain."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from sprung.estimation import escape_local_optimum, fit_linear, score_linear_term
from sprung.preprocess import prepare
from sprung.selection.structure import choose_structure
from sprung.simulation import simulate
from sprung.vehicle import TABLE_1_CAR, Load, Vehicle, parse_record

# Stiff and lightly damped at the rear, where five drops say little of the wheels: one of 500 drawn at random whose
# likelihood had two summits, and every start ended on the lower one.
TWO_SUMMITS = Vehicle(
    m_s=2813.7, I_yy=8182.0, I_xx=2259.2, m_uf=154.7, m_ur=62.35, k_sf=45723.0, k_sr=241030.0, k_tf=315400.0,
    k_tr=1763000.0, c_sf=673.9, c_sr=1620.9, a=2.172, b=1.2014, t_f=1.0779, t_r=1.059,
)  # fmt: skip


@pytest.mark.parametrize(("seed", "higher"), [(0, 0.0), (6, 2.0)])
def test_the_higher_of_two_summits_is_found(seed: int, higher: float) -> None:
    car = TWO_SUMMITS
    rear = car.m_s * car.a / car.wheelbase + 2 * car.m_ur
    weighed = {
        "front_axle_mass": {"value": car.total_mass - rear, "std": 3.0},
        "rear_axle_mass": {"value": rear, "std": 3.0},
    }
    campaign = simulate(car, noise=0.02, seed=seed, known=weighed, duration=3.2)
    decays, models = prepare(campaign).decays, {"empty": car.linear_model()}
    assert campaign.wheelbase is not None
    known = {"wheelbase": campaign.wheelbase, **campaign.known}
    from_truth = fit_linear(decays, models, campaign.sensors, known, start=car.parameters)
    unaided = fit_linear(decays, models, campaign.sensors, known)
    found = escape_local_optimum(unaided)
    assert found.converged
    assert found.loglikelihood > unaided.loglikelihood + 0.5  # this is what the seeds were chosen for
    assert found.loglikelihood > from_truth.loglikelihood + higher - 1e-3


@pytest.mark.parametrize("apart", [0.001, 0.01])
def test_the_gain_of_a_larger_model_is_known_before_it_is_fitted(apart: float) -> None:
    half = {"t_f1": 0.74 + apart, "t_r1": 0.74 - apart, "t_f2": 0.74, "t_r2": 0.74}
    shared = {name: value for name, value in TABLE_1_CAR.parameters.items() if not name.startswith("t_")}
    car = Vehicle.from_parameters(shared | half)
    ballast = parse_record(Load, {"name": "ballast", "items": [{"mass": 200, "position": (-1.5, 0.0, 0.5)}]})
    campaign = simulate(car, loads=[ballast], noise=0.05, seed=3)
    decays = prepare(campaign).decays
    assert campaign.wheelbase is not None
    known = {"wheelbase": campaign.wheelbase}
    small = {load.name: TABLE_1_CAR.linear_model(load) for load in campaign.loads}
    large = {load.name: car.linear_model(load) for load in campaign.loads}
    fitted = fit_linear(decays, small, campaign.sensors, known)
    start = fitted.parameters | {f"t_{axle}{which}": fitted.parameters[f"t_{axle}"] for axle in "fr" for which in "12"}
    ((expected, _),) = score_linear_term(fitted, large, campaign.sensors, known, [start])
    gained = 2 * (fit_linear(decays, large, campaign.sensors, known, start=start).loglikelihood - fitted.loglikelihood)
    np.testing.assert_allclose(expected, gained, rtol=0.1)


def test_a_step_to_an_unstable_vehicle_gains_nothing_and_warns_of_nothing() -> None:
    """Its motion has no bounds; times the weight of a channel that is left out, 0, its residuals would be no number at all."""
    bar = {"k_af": 0.0, "k_ar": 0.0}
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})
    barred = choose_structure(campaign, "shared", ("anti-roll",))
    fit = fit_linear(
        prepare(campaign).decays,
        barred.linear_models,
        campaign.sensors,
        barred.known,
        start=TABLE_1_CAR.parameters | bar,
    )
    step = np.where([name == "k_af" for name in fit.names], -100.0, 0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tried, gain = fit.problem.trial(fit.iterate, step)
    assert tried is fit.iterate
    assert gain == -np.inf
    assert fit.problem.maximise(fit.iterate.u + step).converged is False
    unstable = fit.iterate.at.moved(fit.problem.priors.coordinates.values(fit.iterate.u + step))
    assert [record.shape for record in unstable.fitted] == [decay.values.shape for decay in fit.decays]
    assert not any(record.any() for record in unstable.fitted)


def test_a_start_that_grows_beyond_all_bounds_is_begun_without_what_makes_it_grow() -> None:
    """A relaxing rate below zero: its force grows by e in 25 ms, for seconds."""
    relaxing = {"k_xf": -2000.0, "k_xr": 0.0, "c_xf": 50.0, "c_xr": 50.0}
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})
    structure = choose_structure(campaign, "shared", ("interconnection",))
    decays = prepare(campaign).decays

    def found(start: dict[str, float]) -> float:
        return fit_linear(
            decays, structure.linear_models, campaign.sensors, structure.known, start=TABLE_1_CAR.parameters | start
        ).loglikelihood

    np.testing.assert_allclose(found(relaxing), found(relaxing | {"k_xf": 0.0}), atol=1e-3)


def test_a_start_with_a_mass_below_zero_is_begun_with_a_small_one() -> None:
    """An engine of no mass at all on its mounts would have no equation of motion."""
    engine = {"m_e": -20.0, "k_e": 5e4, "c_e": 500.0, "x_e": 0.4}
    campaign = simulate(TABLE_1_CAR, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})
    structure = choose_structure(campaign, "shared", ("engine",))
    start, decays = TABLE_1_CAR.parameters | engine, prepare(campaign).decays
    fit = fit_linear(decays, structure.linear_models, campaign.sensors, structure.known, start=start)
    assert np.isfinite(fit.loglikelihood)
