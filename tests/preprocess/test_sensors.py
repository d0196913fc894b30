"""Sensors as they are: coarse, clipping, AC-coupled, spiky; the fit must be none the worse."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign
from sprung.preprocess import prepare
from sprung.simulation import default_sensors
from sprung.vehicle import TABLE_1_CAR


def campaign(change: Mapping[str, Any], seed: int = 1, noise: float = 0.02, **options: Any) -> Campaign:
    sensors = [replace(sensor, **dict(change)) for sensor in default_sensors(TABLE_1_CAR)]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    return sprung.simulate(TABLE_1_CAR, sensors=sensors, noise=noise, seed=seed, known=known, **options)


def worst_score(result: sprung.Result) -> float:
    truth = TABLE_1_CAR.parameters
    return max(
        abs(one.value - truth[name]) / one.std
        for name, one in result.parameters.items()
        if one.value is not None and one.std
    )


@pytest.mark.parametrize(("bits", "noise"), [(12, 0.01), (12, 0.05), (10, 0.05)])
def test_coarse_sensors(bits: int, noise: float) -> None:
    """Full scale of ±10 g: steps of 0.048 and 0.19 m/s², the latter far above the noise."""
    result = sprung.identify(campaign({"unit": "g", "resolution": 20 / 2**bits}, noise=noise))
    assert result.faults == ()
    assert result.verdict.state == "accept"
    assert worst_score(result) < 4


@pytest.mark.parametrize("rate", [64.0, 128.0, 1000.0])
def test_slow_and_fast_records(rate: float) -> None:
    result = sprung.identify(campaign({}, rate=rate))
    assert result.faults == ()
    assert result.verdict.state == "accept"
    assert worst_score(result) < 4


@pytest.mark.parametrize("told", [True, False])
def test_sensors_that_clip_at_the_landing(told: bool) -> None:
    clipping = campaign({"unit": "g", "range": 5.0})
    if not told:
        blank = tuple(replace(sensor, range=None) for sensor in clipping.sensors)
        clipping = replace(clipping, sensors=blank)
    result = sprung.identify(clipping)
    assert {fault.code for fault in result.faults} == {"clipped"}
    assert result.verdict.state == "accept"
    assert worst_score(result) < 4


def test_clean_records_are_not_said_to_clip() -> None:
    for seed in range(5):
        coarse = campaign({"unit": "g", "resolution": 20 / 2**12}, seed=seed)
        assert all(decay.faults == () for decay in prepare(coarse).decays)
        assert all(decay.faults == () for decay in prepare(campaign({}, seed=seed, noise=0.0)).decays)


@pytest.mark.parametrize("corner", [0.1, 0.5])
def test_ac_coupled_sensors(corner: float) -> None:
    result = sprung.identify(campaign({"high_pass": corner}))
    assert result.verdict.state == "accept"
    assert worst_score(result) < 4


def test_ac_coupled_sensors_that_clip() -> None:
    """Nobody says their range: the plateaus tell, and they are level only before the high-pass is undone."""
    clipping = campaign({"high_pass": 0.5, "unit": "g", "range": 4.0})
    blank = tuple(replace(sensor, range=None) for sensor in clipping.sensors)
    result = sprung.identify(replace(clipping, sensors=blank))
    assert {fault.code for fault in result.faults} == {"clipped"}
    assert result.verdict.state == "accept"
    assert worst_score(result) < 4


def test_a_spike_does_not_pass_for_the_landing() -> None:
    clean = campaign({})
    spiked = []
    for number, recording in enumerate(clean.recordings):
        values = recording.values.copy()
        values[number % 8, 1100:1104] += 200.0
        spiked.append(replace(recording, values=values))
    for decay, truth in zip(prepare(clean.with_recordings(spiked)).decays, prepare(clean).decays, strict=True):
        assert abs(decay.start - truth.start) < 0.1


def test_wheels_without_sensors_fall_too() -> None:
    """Sensors on the front wheels only: the rear ones must have landed all the same."""
    clean = campaign({})
    kept = [i for i, sensor in enumerate(clean.sensors) if sensor.on not in ("rl", "rr")]
    half = replace(
        clean.with_recordings(
            replace(r, values=r.values[kept], channels=tuple(r.channels[i] for i in kept)) for r in clean.recordings
        ),
        sensors=tuple(clean.sensors[i] for i in kept),
    )
    result = sprung.identify(half)
    assert result.verdict.state == "accept"
    assert worst_score(result) < 4
    assert np.all([drop.used_from is not None and drop.used_from < 0.65 for drop in result.drops])
