"""Profile intervals against a likelihood re-maximised the long way, and against the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from sprung.campaign import Campaign
from sprung.estimation import FitResult, FitStatistics, estimate_of, fit_linear, profiled, uncertainty_of
from sprung.estimation.closed_form import ClosedFormObjective
from sprung.preprocess import prepare
from sprung.simulation import free_decays
from sprung.uncertainty import Estimate, KnownValue
from sprung.vehicle import TABLE_1_CAR, Readout

Real = NDArray[np.float64]

NAMES = tuple(TABLE_1_CAR.parameters)
TRUTH = TABLE_1_CAR.parameters
CHI_SQUARED_95 = 3.841458820694124
"""95 % quantile of χ² with one degree of freedom, from any table."""


def drops(seed: int, noise: float, known: dict[str, KnownValue] | None = None) -> Campaign:
    """Three short decays, scale known: at 2 m/s² of noise they hardly show the roll, at 0.05 everything."""
    weighed = {"total_mass": KnownValue(TABLE_1_CAR.total_mass)} if known is None else known
    return free_decays(TABLE_1_CAR, states=3, noise=noise, seed=seed, rate=100, duration=1.5, known=weighed)


def body_alone(campaign: Campaign) -> Campaign:
    chosen = [i for i, sensor in enumerate(campaign.sensors) if sensor.on == "body"]
    recordings = tuple(
        replace(one, values=one.values[chosen], channels=tuple(one.channels[i] for i in chosen))
        for one in campaign.recordings
    )
    return replace(campaign.with_recordings(recordings), sensors=tuple(campaign.sensors[i] for i in chosen))


def fitted(campaign: Campaign) -> tuple[FitResult, FitStatistics, dict[str, KnownValue]]:
    known = dict(campaign.known)
    assert campaign.wheelbase is not None
    known["wheelbase"] = campaign.wheelbase
    decays = prepare(campaign).decays
    models = {load.name: TABLE_1_CAR.linear_model(load) for load in campaign.loads}
    optimum = fit_linear(decays, models, campaign.sensors, known, start=TRUTH)
    return optimum, uncertainty_of(optimum), known


def both(campaign: Campaign, name: str) -> tuple[Estimate, Estimate]:
    """Return an estimate with its interval from the curvature, and from the profile."""
    optimum, fit, known = fitted(campaign)
    estimate = estimate_of(fit, known, name)
    return estimate, profiled(optimum, fit, name, estimate)


def limits(estimate: Estimate) -> tuple[float | None, float | None]:
    assert estimate.interval95 is not None
    return estimate.interval95


def holds(estimate: Estimate, truth: float) -> bool:
    low, high = limits(estimate)
    return (low is None or low < truth) and (high is None or truth < high)


class LongWay:
    """-2 ln L of a campaign whose total mass and wheelbase are exact, maximised over all but t_f by quasi-Newton."""

    def __init__(self, campaign: Campaign) -> None:
        decays = prepare(campaign).decays
        models = {load.name: TABLE_1_CAR.linear_model(load) for load in campaign.loads}
        rows = Readout.of(campaign.sensors, NAMES)
        self.objective = ClosedFormObjective(decays, models, rows)
        self.free = [name for name in NAMES if name not in ("m_s", "b", "t_f")]
        self.samples = len(decays) * decays[0].samples

    def cost(self, logarithms: Real, t_f: float) -> float:
        values = dict(zip(self.free, np.exp(logarithms).tolist(), strict=True)) | {"t_f": t_f}
        values["m_s"] = TABLE_1_CAR.total_mass - 2 * (values["m_uf"] + values["m_ur"])
        values["b"] = TABLE_1_CAR.wheelbase - values["a"]
        if min(values["m_s"], values["b"]) <= 0:
            return 1e6
        point = np.array([values[name] for name in NAMES])
        variance = np.ones(8)
        for _ in range(4):  # noise levels and initial states in turn
            variance = self.objective.at(point, 1 / variance).residual_sums.sum(axis=0) / self.samples
        return float(self.samples * np.log(variance).sum())

    def whole(self, logarithms: Real) -> float:
        return self.cost(logarithms[1:], float(np.exp(logarithms[0])))

    def best(self, start: Real, t_f: float) -> tuple[float, Real]:
        found = minimize(self.cost, start, (t_f,), method="BFGS", options={"gtol": 0.05})
        return float(found.fun), found.x


@pytest.mark.long
def test_the_interval_ends_where_a_likelihood_maximised_the_long_way_has_fallen_by_chi_squared() -> None:
    """t_f at 1 m/s² of noise: standard uncertainty 33 %."""
    campaign = drops(seed=0, noise=1.0)
    optimum, fit, known = fitted(campaign)
    profile = profiled(optimum, fit, "t_f", estimate_of(fit, known, "t_f"))
    assert fit.inflation == 1
    way = LongWay(campaign)
    start = np.log([optimum.parameters[name] for name in way.free])
    top = minimize(
        way.whole, np.append(np.log(optimum.parameters["t_f"]), start), method="BFGS", options={"gtol": 0.05}
    )
    for end in limits(profile):
        assert end is not None
        grid = end * np.array([0.98, 1.02])
        falls, near = [], start
        for t_f in grid:
            cost, near = way.best(near, t_f)
            falls.append(cost - top.fun)
        # The grid's own crossing, in the middle where the profile says it is.
        assert min(falls) < CHI_SQUARED_95 < max(falls)
        crossing = np.interp(CHI_SQUARED_95, np.sort(falls), grid[np.argsort(falls)])
        assert crossing == pytest.approx(end, rel=0.005)


@pytest.mark.parametrize("name", ["m_s", "k_tf", "c_sr", "a", "t_f", "total_mass", "front_axle_mass"])
def test_well_determined_quantities_keep_their_intervals(name: str) -> None:
    """Where the likelihood is a parabola, its profile and its curvature say the same; with a scale of 0.3 % besides."""
    known = {"total_mass": KnownValue(1.002 * TABLE_1_CAR.total_mass, 0.003 * TABLE_1_CAR.total_mass)}
    curvature, profile = both(drops(seed=1, noise=0.02, known=known), name)
    assert (curvature.interval_from, profile.interval_from) == ("curvature", "profile")
    low, high = limits(curvature)
    assert low is not None
    assert high is not None
    # The fall counts samples, the curvature degrees of freedom: 2 % fewer here, 1 % of the width.
    np.testing.assert_allclose(np.array(limits(profile), float), [low, high], rtol=0, atol=0.015 * (high - low))
    assert (profile.value, profile.std, profile.status) == (curvature.value, curvature.std, "estimated")


def test_inflation_widens_the_profile_as_it_widens_the_curvature() -> None:
    """Drops of two different cars disagree; the weighing is as good as it was, and alone decides about the mass."""
    campaign = drops(seed=2, noise=0.02, known={"total_mass": KnownValue(1.001 * TABLE_1_CAR.total_mass, 5.0)})
    other = TABLE_1_CAR.with_values(k_sf=1.03 * TABLE_1_CAR.k_sf)
    differs = free_decays(other, states=3, noise=0.02, seed=2, rate=100, duration=1.5)
    mixed = campaign.with_recordings((*campaign.recordings[:2], differs.recordings[2]))
    optimum, fit, known = fitted(mixed)
    assert fit.inflation > 4
    for name in ("total_mass", "k_sr", "t_r"):
        curvature = estimate_of(fit, known, name)
        low, high = limits(curvature)
        assert low is not None
        assert high is not None
        ends = limits(profiled(optimum, fit, name, curvature))
        np.testing.assert_allclose(np.array(ends, float), [low, high], rtol=0, atol=0.03 * (high - low))


@pytest.mark.long
def test_asymmetric_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """The centre of gravity at 2 m/s² of noise, 40 seeds: of 95 % there may be 3 standard errors less, and not all."""
    estimates = [both(drops(seed=seed, noise=2.0), "a") for seed in range(120, 160)]
    asked = [profile for _, profile in estimates if profile.status == "estimated"]
    assert len(asked) > 30
    held = np.mean([holds(profile, TRUTH["a"]) for profile in asked])
    assert 0.95 - 3 * np.sqrt(0.95 * 0.05 / len(asked)) < held < 1
    # No centre of gravity lies behind the rear axle; the symmetric interval does not know that.
    wheelbase = TABLE_1_CAR.wheelbase
    assert all((limits(profile)[1] or np.inf) <= wheelbase for profile in asked)
    assert any((limits(curvature)[1] or np.inf) > wheelbase for curvature, _ in estimates if curvature.interval95)


@pytest.mark.slow
def test_an_interval_without_a_lower_end_says_so() -> None:
    """t_f, one of two half-distances that resist the same roll, under 2 m/s² of noise: the other can do it alone."""
    campaign = drops(seed=0, noise=2.0)
    _, profile = both(campaign, "t_f")
    low, high = limits(profile)
    assert low is None
    assert high is not None
    assert TRUTH["t_f"] < high
    # As the likelihood says itself, at next to nothing.
    optimum, _, _ = fitted(campaign)
    way = LongWay(campaign)
    start = np.log([optimum.parameters[name] for name in way.free])
    top, there = way.best(start, optimum.parameters["t_f"])
    for t_f in (0.3, 0.1, 0.02):
        cost, there = way.best(there, t_f)
    assert cost - top < CHI_SQUARED_95


def test_an_interval_ends_where_no_vehicle_is() -> None:
    """Body sensors alone, 0.3 m/s²: the centre of gravity may lie anywhere up to the rear axle, and no further."""
    _, profile = both(body_alone(drops(seed=1, noise=0.3)), "a")
    low, high = limits(profile)
    assert low is None
    assert high == pytest.approx(TABLE_1_CAR.wheelbase, rel=2e-3)


@pytest.mark.parametrize(("name", "status"), [("wheelbase", "known"), ("m_s", "unidentifiable")])
def test_nothing_to_ask(name: str, status: str) -> None:
    """Known exactly; and a mass without any scale."""
    curvature, profile = both(drops(seed=3, noise=0.02, known={}), name)
    assert profile == curvature
    assert (profile.status, profile.interval_from) == (status, None)
