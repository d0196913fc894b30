"""A drop that the others do not predict is named, and nothing is said where they do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.assessment import Verdict, body_motions, cross_validate_drops, decide_verdict, estimate_model_error
from sprung.campaign import Campaign
from sprung.estimation import FitResult, FitStatistics, Prediction, fit_linear, to_estimates, uncertainty_of
from sprung.preprocess import prepare
from sprung.selection.structure import choose_structure
from sprung.uncertainty import Estimate
from sprung.vehicle import TABLE_1_CAR

LOAD = {"name": "bags", "items": [{"mass": 150, "position": (-1.0, 0.2, 0.5)}]}


def campaign(seed: int, **changed: float) -> Campaign:
    vehicle = sprung.Vehicle.from_parameters({**TABLE_1_CAR.parameters, **changed})
    return sprung.simulate(vehicle, loads=[LOAD], noise=0.02, seed=seed, known={"total_mass": TABLE_1_CAR.total_mass})


def fitted(made: Campaign) -> tuple[FitResult, FitStatistics, dict[str, Estimate], list[str]]:
    """Fit without looking for what may be wrong; with uncertainties, estimates and channels."""
    choice, decays = choose_structure(made), prepare(made).decays
    optimum = fit_linear(decays, choice.linear_models, made.sensors, choice.known, start=TABLE_1_CAR.parameters)
    fit = uncertainty_of(optimum)
    return optimum, fit, dict(to_estimates(fit, choice.known)), [sensor.channel for sensor in made.sensors]


def judged(made: Campaign, contradicting: int = 0) -> Verdict:
    """Fit and judge without looking for what may be wrong, which would leave the drop out."""
    optimum, fit, parameters, channels = fitted(made)
    motions = body_motions(optimum, optimum.decays, optimum.fitted, made.sensors)
    drops = cross_validate_drops(optimum, fit, optimum.decays, channels, motions)
    return decide_verdict(
        fit,
        estimate_model_error(optimum),
        parameters,
        channels,
        (),
        drops,
        contradicting,
    )


@pytest.mark.parametrize("changed", [{"c_sf": 1650.0}, {"k_tf": 230_000.0}, {"k_sf": 17_700.0}])
def test_another_vehicle_in_one_drop_is_named(changed: dict[str, float]) -> None:
    made, other = campaign(1), campaign(2, **changed)
    spoilt = tuple(
        two if i == 3 else one for i, (one, two) in enumerate(zip(made.recordings, other.recordings, strict=True))
    )
    verdict = judged(made.with_recordings(spoilt))
    assert verdict.state != "accept"
    said = [reason for reason in verdict.reasons if "do not predict" in reason]
    assert len(said) == 1
    assert said[0].startswith(f"the other drops do not predict {prepare(made).decays[3].name}:")


def test_drops_of_one_vehicle_are_predicted() -> None:
    for seed in range(6):
        verdict = judged(campaign(seed))
        assert verdict.state == "accept"
        assert verdict.reasons[1].startswith("each drop is predicted by the others")


def test_two_drops_of_different_kinds_leave_much_open() -> None:
    drops, known = [{"wheels": ["fl", "fr"]}, {"wheels": ["fl", "rl"]}], {"total_mass": TABLE_1_CAR.total_mass}
    verdict = judged(sprung.simulate(TABLE_1_CAR, drops=drops, noise=0.02, seed=1, known=known))
    assert verdict.state == "accept"
    assert verdict.reasons[1].startswith("each drop is predicted by the others within what these leave open, to ")


@pytest.mark.parametrize(("contradicting", "state"), [(1, "accept"), (5, "accept"), (6, "reject"), (9, "reject")])
def test_more_than_a_third_of_all_drops_are_no_mishap(contradicting: int, state: str) -> None:
    """Of recordings of two vehicles those of one are left out one after the other, until the rest agrees."""
    verdict = judged(campaign(1), contradicting)
    assert verdict.state == state
    assert ("no vehicle recorded all of them" in verdict.reasons[0]) == (state == "reject")


def test_one_drop_alone_has_no_others() -> None:
    made = sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl", "rl"], "load": "empty"}], noise=0.02, seed=1)
    (drop,) = sprung.identify(made, tracks="shared", extras=()).validation.values()
    assert (drop.predicted, drop.predicted_residual, drop.unexpected) == (None, None, 0.0)
    assert drop.apart is None


def test_a_residual_below_rounding_has_no_ratio(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without noise, sums of squares cancel to nothing in some drops, and rounding decides in which."""
    made = sprung.simulate(TABLE_1_CAR, noise=0.0, seed=1, drops=[{"wheels": ["fl", "rl"]}, {"wheels": ["fl", "fr"]}])
    nothing = Prediction(fitted=0.0, squares=0.0, by_chance=(3.0, 2.0), distance=(0.0, 13))
    monkeypatch.setattr("sprung.assessment.cross_validation.predictions", lambda *_: (nothing, nothing))
    result = sprung.identify(made, tracks="shared", extras=())
    assert {drop.predicted_residual for drop in result.validation.values()} == {None}
    assert {drop.predicted for drop in result.validation.values()} == {0.0}


@pytest.mark.parametrize(("size", "state"), [(0.002, "doubtful"), (0.02, "reject")])
def test_a_fit_that_has_not_converged_is_rejected_only_where_it_explains_little(size: float, state: str) -> None:
    _, fit, parameters, channels = fitted(campaign(1))
    error = np.full(len(channels), size), np.full(len(channels), 2.0)
    verdict = decide_verdict(replace(fit, converged=False), error, parameters, channels)
    assert verdict.state == state
    assert any("did not converge" in reason for reason in verdict.reasons)
    assert decide_verdict(fit, error, parameters, channels).state == ("accept" if size < 0.01 else "doubtful")
