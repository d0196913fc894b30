"""Whether a low-pass of the loggers is found behind which a nonlinear vehicle was recorded, and none where there is none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import butter, lfilter, lfilter_zi

import sprung
from sprung.campaign import Campaign
from sprung.estimation import LowPass, fit_linear
from sprung.preprocess import prepare
from sprung.selection import ModelSearch, choose_structure, confirm_low_pass, corner_of, select_low_pass
from sprung.selection.low_pass import states_behind
from sprung.selection.stepwise import try_likeliest
from sprung.vehicle import TABLE_1_CAR, Vehicle

RATE, FINER, NOISE = 500.0, 8, 0.01
CAR = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"r_f": 2.5, "r_r": 2.2, "F_f": 80.0, "F_r": 60.0})
TRUTH = CAR.parameters
LOGGER = LowPass(90.0, 4)


@cache
def fine() -> Campaign:
    """The car without noise, sampled so fast that a digital low-pass is that of an amplifier."""
    drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fl", "fr", "rl", "rr"))]
    return sprung.simulate(CAR, drops=drops, seed=2, known={"m_s": TRUTH["m_s"]}, rate=FINER * RATE, noise=0.0)


def fitted(
    low_pass: LowPass | None, terms: tuple[str, ...] = ("friction", "rebound"), finer: int = FINER
) -> ModelSearch:
    """Fit some of the true terms to the recordings, sampled behind a low-pass with the noise of the converter."""
    random, recordings, rate = np.random.default_rng(3), [], FINER * RATE / finer
    for one in fine().recordings:
        values = one.values
        if low_pass is not None:
            numerator, denominator = butter(low_pass.order, low_pass.corner, fs=FINER * RATE)
            begin = lfilter_zi(numerator, denominator) * values[:, :1]
            values = lfilter(numerator, denominator, values, axis=1, zi=begin)[0]
        sampled = values[:, ::finer]
        recordings.append(replace(one, values=sampled + NOISE * random.standard_normal(sampled.shape), rate=rate))
    campaign = fine().with_recordings(recordings)
    decays, plain = prepare(campaign).decays, choose_structure(campaign, "shared", ())
    start = {name: TRUTH[name] for name in plain.names}
    linear = fit_linear(decays, plain.linear_models, plain.sensors, plain.known, start=start, most=0)
    return ModelSearch(plain, linear, decays).refit(choose_structure(campaign, "shared", terms), enough=0.1)


def errors(search: ModelSearch) -> dict[str, float]:
    """Relative error of every parameter."""
    return {name: value / TRUTH[name] - 1 for name, value in search.fit.parameters.items() if name in TRUTH}


@pytest.mark.slow
@pytest.mark.parametrize("finer", [FINER, 2 * FINER])
def test_a_low_pass_of_the_loggers_is_found(finer: int) -> None:
    """Its corner, and the parameters that it had moved, also in 250 samples a second, of which 160 Hz is more than half."""
    search = fitted(LOGGER, finer=finer)
    found = select_low_pass(search)
    assert found.structure.low_pass is not None
    # Friction that turns round within a step of 1 ms seems to do so half a step later, a tenth of the delay of the low-pass.
    assert corner_of(found) == pytest.approx(LOGGER.corner, rel=0.15)
    assert found.overdispersion < 0.7 * search.overdispersion
    before, after = (np.array([*errors(one).values()]) for one in (search, found))
    assert np.sqrt(np.mean(after**2)) < 0.5 * np.sqrt(np.mean(before**2))


@pytest.mark.slow
def test_without_one_there_is_none() -> None:
    """One that seemed to be there while the model had no friction is gone once it has."""
    search = fitted(None)
    assert select_low_pass(search) is search
    wrong = replace(search.structure.with_terms(("rebound",)), low_pass=LOGGER)
    seemingly = search.refit(wrong)
    completed = seemingly.refit(seemingly.with_terms(("friction",)))
    assert completed.structure.low_pass == LOGGER
    confirmed = confirm_low_pass(completed)
    assert confirmed.structure.low_pass is None
    assert confirmed.gain_over(completed) > 100


@pytest.mark.slow
def test_a_rival_of_a_low_pass_is_fitted_if_its_first_steps_gain_enough() -> None:
    """The first steps with the friction that is missing reach a tenth of what it gains, and not ten times as much."""
    search = fitted(None, ("rebound",))
    whole = 2 * (search.refit(search.with_terms(("friction",))).fit.loglikelihood - search.fit.loglikelihood)
    accepted = try_likeliest(search, ("friction",), 0.1 * whole)
    assert accepted.structure.terms == ("friction", "rebound")
    refused = try_likeliest(search, ("friction",), 10 * whole)
    assert refused.structure is search.structure
    assert refused.fit is search.fit
    assert refused.steps[-1].against == "a low-pass of the loggers explains more"


@pytest.mark.slow
def test_a_fit_behind_a_low_pass_begins_as_late_as_that_leaves_motions() -> None:
    """A third of a sample, of 25 m/s² of wheels at 12 Hz, is many times the noise."""
    search = fitted(LOGGER)
    behind = replace(search.structure, low_pass=LOGGER)
    as_before, later = (
        search.refit(behind, 0, beginning_only=True, states=states) for states in (None, states_behind(search, LOGGER))
    )
    best = search.refit(behind, beginning_only=True)
    lost = [best.fit.loglikelihood - one.fit.loglikelihood for one in (as_before, later)]
    assert lost[1] < 0.1 * lost[0]
    np.testing.assert_allclose(states_behind(search, None), search.fit.states, atol=1e-12)
