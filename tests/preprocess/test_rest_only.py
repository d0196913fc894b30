"""Recordings in which nothing moves are left out, and nothing that vibrates is."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign
from sprung.preprocess import prepare
from sprung.preprocess.rest_only import is_noise
from sprung.vehicle import TABLE_1_CAR

RATE, NOISE = 250.0, 0.05


def at_rest(campaign: Campaign, seed: int = 3, *, seconds: float = 3.6, step: float = 0.0) -> Campaign:
    """Replace the first recording by one of noise about gravity, in steps if there are any."""
    first = campaign.recordings[0]
    noise = np.random.default_rng(seed).standard_normal((len(first.values), round(seconds * first.rate)))
    values = 9.80665 + NOISE * noise
    values = np.round(values / step) * step if step else values
    return campaign.with_recordings((replace(first, values=values), *campaign.recordings[1:]))


@pytest.mark.parametrize("step", [0.0, NOISE, 3 * NOISE])
def test_noise_alone_is_no_drop(step: float) -> None:
    campaign = at_rest(sprung.simulate(TABLE_1_CAR, noise=NOISE, seed=1, rate=RATE), step=step)
    checked = sprung.check(campaign)
    assert checked.summary == "4 of 5 drops usable"
    (fault,) = checked.faults
    assert (fault.code, fault.where) == ("no-motion", "empty_bounce.csv")
    assert "no channel moves more than its noise at rest in 3.6 s" in fault.what
    assert "logger was not stopped before the release" in fault.do
    assert "right file" in fault.do


@pytest.mark.parametrize("excitation", ["push", "pass"])
def test_noise_alone_is_no_push_and_no_pass(excitation: str) -> None:
    drops: list[dict[str, Any]] = [{"excitation": excitation}, {"excitation": excitation, "wheels": ["fl", "rl"]}]
    prepared = prepare(at_rest(sprung.simulate(TABLE_1_CAR, drops=drops, noise=NOISE, seed=1, rate=RATE)))
    assert [fault.code for fault in prepared.left_out[0][1]] == ["no-motion"]
    assert len(prepared.decays) == 1


def test_a_recording_that_ends_before_the_release_shows_no_free_vibration() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=NOISE, seed=1, rate=RATE)
    first = campaign.recordings[0]
    cut = campaign.with_recordings((replace(first, values=first.values[:, :88]), *campaign.recordings[1:]))
    stated = replace(campaign, drops=(replace(campaign.drops[0], end=0.35), *campaign.drops[1:]))
    for stopped, remedy in ((cut, "right file."), (stated, "correct start and end.")):
        ((_, faults),) = prepare(stopped).left_out
        assert [fault.code for fault in faults] == ["no-motion"]
        assert faults[0].do.endswith(remedy)


@pytest.mark.parametrize("seed", range(4))
def test_a_small_drop_in_loud_noise_stays(seed: int) -> None:
    """Blocks of 5 mm and a noise of 0.1 m/s², with a rest before it or without one."""
    campaign = sprung.simulate(TABLE_1_CAR, drops=[{"height": 0.005}], noise=0.1, seed=seed, rate=RATE)
    late = campaign.with_recordings(
        replace(recording, values=recording.values[:, round(0.6 * RATE) :]) for recording in campaign.recordings
    )
    for dropped in (campaign, late):
        prepared = prepare(dropped)
        assert len(prepared.decays) == 1
        assert "no-motion" not in {fault.code for fault in prepared.decays[0].faults}


@pytest.mark.parametrize("frequency", [0.8, 1.3, 5.0, 14.0])
@pytest.mark.parametrize("channels", [2, 8])
def test_a_vibration_as_large_as_its_noise_is_seen(frequency: float, channels: int) -> None:
    """Ride with 1.5 times the standard deviation of the noise and a damping ratio of 0.2, and others with as much energy."""
    time, random = np.arange(900) / RATE, np.random.default_rng(1)
    motion = 1.5 * (frequency / 1.3) ** 0.5 * np.exp(-0.2 * 2 * np.pi * frequency * time)
    motion *= np.cos(2 * np.pi * frequency * time)
    records = [motion + random.standard_normal((channels, 900)) for _ in range(40)]
    assert not any(is_noise(values, RATE) for values in records)


@pytest.mark.parametrize(("channels", "samples"), [(1, 900), (8, 88), (8, 900), (2, 5000)])
def test_pure_noise_is_recognised_at_the_stated_level(channels: int, samples: int) -> None:
    """At a level of 1 %, at most 6 of 100 are missed except once in some thousand times."""
    random = np.random.default_rng(2)
    records = (random.standard_normal((channels, samples)) for _ in range(100))
    assert sum(not is_noise(values, RATE) for values in records) <= 6


def test_a_few_samples_say_nothing() -> None:
    assert not is_noise(np.random.default_rng(2).standard_normal((1, 20)), RATE)
    assert is_noise(np.ones((2, 900)), RATE)
