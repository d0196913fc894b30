"""The one sensor in error of a car that is not linear is found beside its terms and corrected; what a model lacks blames none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from real_campaigns import record
from real_kinds import draw_test
from real_outcomes import examine

import sprung
from sprung.campaign import Campaign
from sprung.estimation import fit_linear
from sprung.faults import CandidateFit, correct_sensor_error
from sprung.preprocess import prepare
from sprung.selection import ModelSearch, SensorError, choose_structure
from sprung.selection.sensor_errors import with_sensor_error
from sprung.vehicle import TABLE_1_CAR, Vehicle

RATE, LATE, MOVED = 500.0, 3, 0.25
CAR = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"r_f": 2.5, "r_r": 2.2, "F_f": 80.0, "F_r": 60.0})
TERMS = ("friction", "rebound")
DROPS = [{"wheels": wheels} for wheels in (("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fl", "fr", "rl", "rr"))]


@cache
def sound() -> Campaign:
    known = {"m_s": TABLE_1_CAR.m_s}
    return sprung.simulate(CAR, drops=DROPS, seed=2, known=known, rate=RATE, noise=0.02, sensor_errors=True)


def delayed(campaign: Campaign, channel: str, samples: int) -> Campaign:
    """Delay a channel in all drops."""
    number = [sensor.channel for sensor in campaign.sensors].index(channel)
    recordings = []
    for one in campaign.recordings:
        values = one.values.copy()
        values[number, samples:] = one.values[number, :-samples]
        recordings.append(replace(one, values=values))
    return campaign.with_recordings(recordings)


def moved(campaign: Campaign, channel: str, by: float) -> Campaign:
    """State a sensor further forward than it is, m."""
    sensors = [
        replace(one, position=(one.position[0] + by, *one.position[1:]))
        if one.channel == channel and one.position is not None
        else one
        for one in campaign.sensors
    ]
    return replace(campaign, sensors=tuple(sensors))


def found(campaign: Campaign, terms: tuple[str, ...] = TERMS) -> tuple[ModelSearch, SensorError | None]:
    """Look for the error of a sensor beside a model that is fitted from the true vehicle."""
    decays, plain = prepare(campaign).decays, choose_structure(campaign, "shared", ())
    start = {name: CAR.parameters[name] for name in plain.names}
    linear = fit_linear(decays, plain.linear_models, plain.sensors, plain.known, start=start, most=0)
    search = ModelSearch(plain, linear, decays, seeks_sensor_errors=True)
    fitted = search.refit(choose_structure(campaign, "shared", terms), 22, beginning_only=True)
    return fitted, with_sensor_error(fitted).sensor_error


@pytest.mark.slow
def test_no_sensor_is_blamed_where_none_is_in_error() -> None:
    """Nor for friction that the model has not, whatever that leaves."""
    for terms in (TERMS, ("rebound",)):
        assert found(sound(), terms)[1] is None


@pytest.mark.slow
@pytest.mark.parametrize("channel", ["wheel_rl", "body_fr"])
def test_a_channel_that_is_late_is_found_and_corrected(channel: str) -> None:
    """To half a sample, on the way of a fit that went astray with it: what is left is an unknown then."""
    campaign = delayed(sound(), channel, LATE)
    search, error = found(campaign)
    assert error is not None
    assert (error.channel, [*error.found]) == (channel, ["delay"])
    assert error.found["delay"][0] == pytest.approx(LATE / RATE, abs=0.4 / RATE)
    wrong = correct_sensor_error(CandidateFit.of(search.structure, search.decays, search.fit), error)
    assert (wrong.fault.code, wrong.fault.where) == ("late", channel)
    corrected = wrong.correction.of_campaign(campaign)
    for one, before in zip(corrected.recordings, sound().recordings, strict=True):
        np.testing.assert_allclose(one.values[:, :-LATE], before.values[:, :-LATE], atol=1e-9)
    (sensor,) = (one for one in corrected.sensors if one.channel == channel)
    assert sensor.delay_std == pytest.approx(0.5 / RATE)


@pytest.mark.slow
def test_a_sensor_that_sits_elsewhere_is_found_and_corrected() -> None:
    campaign = moved(sound(), "body_rl", MOVED)
    search, error = found(campaign)
    assert error is not None
    assert error.channel == "body_rl"
    assert error.found["x"][0] == pytest.approx(-MOVED, abs=0.05)
    wrong = correct_sensor_error(CandidateFit.of(search.structure, search.decays, search.fit), error)
    assert (wrong.fault.code, wrong.fault.where) == ("position", "body_rl")
    places = {
        one.channel: one.position for one in wrong.correction.of_campaign(campaign).sensors if one.channel == "body_rl"
    }
    true = {one.channel: one.position for one in sound().sensors if one.channel == "body_rl"}
    np.testing.assert_allclose(places["body_rl"] or (), true["body_rl"] or (), atol=0.05)


@pytest.mark.long
def test_a_car_from_another_engine_with_a_late_channel_is_accepted() -> None:
    """With tyres that stiffen: it was rejected, as no term explains a delay and no linear vehicle its tyres."""
    ((campaign, truth),) = record([draw_test("tyre", 1)])
    outcome = examine(delayed(campaign, "wheel_fr", 4), truth, 400.0)
    assert outcome.verdict == "accept"
    assert outcome.faults == ("late (wheel_fr)",)
    assert outcome.worst[0] < 0.02
