"""Drops used from their release on: what that tells beyond the decays, and when it is not done."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.preprocess import find_flights, prepare
from sprung.preprocess.flight import FROM_RELEASE
from sprung.vehicle import TABLE_1_CAR

LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}
DROPS: list[dict[str, Any]] = [
    {"wheels": ("fl", "fr")},
    {"wheels": ("fl", "rl")},
    {"wheels": ("fl", "fr"), "load": "ballast"},
]


@pytest.fixture(scope="module")
def campaign() -> sprung.Campaign:
    return sprung.simulate(TABLE_1_CAR, loads=[LOAD], drops=DROPS, rate=250, duration=1.6, noise=0.2, seed=3)


@pytest.fixture(scope="module")
def landed(campaign: sprung.Campaign) -> sprung.Result:
    return sprung.identify(campaign, fall=False)


@pytest.fixture(scope="module")
def fallen(campaign: sprung.Campaign) -> sprung.Result:
    return sprung.identify(campaign)


def assert_true(found: sprung.Result, vehicle: sprung.Vehicle) -> None:
    """Check that every parameter is within four standard errors of the vehicle's."""
    for name, truth in vehicle.parameters.items():
        one = found.parameters[name]
        assert one.value is not None
        assert one.std is not None
        assert abs(one.value - truth) < 4 * one.std


def test_where_the_decays_tell_too_little_the_fall_is_used(landed: sprung.Result, fallen: sprung.Result) -> None:
    """Every parameter within four standard errors of the truth, and these hardly more than half of what they were."""
    assert (landed.fit.since, fallen.fit.since) == ("landing", "release")
    assert "the fall is used too" in fallen.fit.why
    narrower = []
    for name, truth in TABLE_1_CAR.parameters.items():
        before, after = landed.parameters[name], fallen.parameters[name]
        assert before.std is not None
        assert after.value is not None
        assert after.std is not None
        assert abs(after.value - truth) < 4 * after.std
        narrower.append(after.std / before.std)
    assert np.median(narrower) < 0.7
    assert fallen.fit.inflation < 1.5
    assert all(drop.used_from is not None and 0.4 < drop.used_from < 0.42 for drop in fallen.drops)  # released at 0.4 s


def test_the_fall_is_used_with_sensors_as_they_are(campaign: sprung.Campaign) -> None:
    """What a sensor that leans reads of gravity is of a displacement: readings of a fall are not of accelerations alone."""
    leaning = tuple(replace(one, tilt_std=2.0) for one in campaign.sensors)
    found = sprung.identify(replace(campaign, sensors=leaning))
    assert found.fit.since == "release"
    assert_true(found, TABLE_1_CAR)


@pytest.mark.long
def test_the_blocks_need_not_have_been_measured(campaign: sprung.Campaign, fallen: sprung.Result) -> None:
    unmeasured = replace(campaign, drops=tuple(replace(drop, height=None) for drop in campaign.drops))
    found = sprung.identify(unmeasured)
    assert found.fit.since == "release"
    for name, one in fallen.parameters.items():
        assert found.parameters[name].value == pytest.approx(one.value, rel=1e-3)


@pytest.mark.long
def test_a_fall_that_the_model_does_not_explain_is_not_used(campaign: sprung.Campaign, landed: sprung.Result) -> None:
    """Somebody holds on to the body after the release: the decays are used as before, and it is said."""
    held = []
    for recording in campaign.recordings:
        time = recording.start + np.arange(recording.values.shape[1]) / recording.rate
        pull = 8.0 * ((time > 0.405) & (time < 0.43)) * np.array([[1.0]] * 4 + [[0.0]] * 4)
        held.append(replace(recording, values=recording.values + pull))
    found = sprung.identify(campaign.with_recordings(held), fall=True)
    assert found.fit.since == "landing"
    assert "was tried and does not determine the parameters better" in found.fit.why
    for channel, noise in landed.fit.noise.items():
        assert found.fit.noise[channel] == pytest.approx(noise, rel=0.02)


def test_which_falls_can_be_used(campaign: sprung.Campaign) -> None:
    """Those after a release that was found, of which nobody said from when on to use them, and whose samples are whole."""
    prepared = prepare(campaign)
    found = find_flights(prepared.decays, prepared.observations)
    for one, decay, seen in zip(found, prepared.decays, prepared.observations, strict=True):
        assert one is not None
        assert one.events.why_fit == FROM_RELEASE
        assert one.end == pytest.approx(decay.end)
        np.testing.assert_array_equal(one.values, seen.recording.values[:, -one.samples :])
        assert one.start - (one.events.release or 0.0) == pytest.approx(0.012)
    started = [replace(drop, start=0.6) for drop in campaign.drops]
    prepared = prepare(replace(campaign, drops=tuple(started)))
    assert find_flights(prepared.decays, prepared.observations) == [None] * 3
    clipped = [replace(one, values=np.clip(one.values, -30.0, 30.0)) for one in campaign.recordings]
    prepared = prepare(campaign.with_recordings(clipped))
    assert find_flights(prepared.decays, prepared.observations) == [None] * 3


def test_the_campaign_may_say_whether_the_fall_is_used(campaign: sprung.Campaign) -> None:
    told = replace(campaign, model=replace(campaign.model, fall=False))
    assert sprung.identify(told).fit.since == "landing"


def test_a_tyre_that_damps_touches_the_ground_before_it_pushes() -> None:
    """Where its damper pushed the wheel in the air, samples of landings were 80 times the noise off: no fall was used."""
    damped = sprung.Vehicle.from_parameters(TABLE_1_CAR.parameters | {"c_tf": 80.0, "c_tr": 80.0})
    tested = sprung.simulate(damped, loads=[LOAD], drops=DROPS, rate=500, duration=1.6, noise=0.02, seed=3)
    found = sprung.identify(tested, fall=True, extras=["tyre-damping"])
    assert found.fit.since == "release"
    assert_true(found, damped)
    assert found.fit.inflation < 1.5
