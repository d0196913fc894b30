"""Spikes put into simulated recordings, and recordings without any: no landing may pass for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import sprung
from sprung.campaign import Recording
from sprung.preprocess import prepare
from sprung.preprocess.spikes import detect_spikes, remove_spikes
from sprung.simulation import default_sensors, simulate
from sprung.vehicle import TABLE_1_CAR, Vehicle
from strategies import vehicles

CLEAN = simulate(TABLE_1_CAR, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})


def spiked(recording: Recording, count: int, width: int, size: float, seed: int) -> tuple[Recording, NDArray[np.bool_]]:
    """Put spikes of random sign after the landing into every channel, none within 16 samples of another."""
    random = np.random.default_rng(seed)
    values, where = recording.values.copy(), np.zeros(recording.values.shape, dtype=bool)
    for channel in range(len(values)):
        for begin in 280 + 20 * random.choice(75, count, replace=False):
            run = slice(begin, begin + width)
            values[channel, run] += size * random.choice([-1, 1]) * random.uniform(0.8, 1.2, width)
            where[channel, run] = True
    return replace(recording, values=values), where


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    vehicle=vehicles,
    rate=st.sampled_from([200.0, 256.0, 500.0, 1000.0, 2000.0]),
    noise=st.floats(0.002, 0.2),
    height=st.floats(0.005, 0.15),
    coarse=st.booleans(),
)
@pytest.mark.slow
def test_no_landing_and_no_noise_is_a_spike(
    vehicle: Vehicle, rate: float, noise: float, height: float, coarse: bool
) -> None:
    sensors = default_sensors(vehicle)
    if coarse:
        sensors = tuple(replace(sensor, unit="g", resolution=20 / 2**12) for sensor in sensors)
    drops = [{"wheels": wheels, "height": height} for wheels in (("fl", "fr", "rl", "rr"), ("fl", "fr"), ("rl",))]
    campaign = simulate(vehicle, sensors=sensors, drops=drops, noise=noise, rate=rate, duration=1.5, seed=1)
    for recording in campaign.recordings:
        assert remove_spikes(recording)[0] is recording


@pytest.mark.parametrize(("width", "size"), [(1, 1.0), (1, 100.0), (3, 3.0), (4, 100.0)])
def test_spikes_are_found_and_filled(width: int, size: float) -> None:
    found = total = 0
    for seed, clean in enumerate(CLEAN.recordings):
        recording, where = spiked(clean, 10, width, size, seed)
        mended, _ = remove_spikes(recording)
        changed = mended.values != recording.values
        assert not (changed & ~where).any()
        found += int((changed & where).sum())
        total += int(where.sum())
        assert np.abs(mended.values - clean.values)[changed].max() < 0.5
        assert {fault.code for fault in mended.faults} == {"spike"}
    # In the first tenths of a second the wheels' own steps are as large as the small ones.
    assert found > 0.9 * total


def test_the_fault_tells_how_many_and_where() -> None:
    clean = CLEAN.recordings[0]
    values = clean.values.copy()
    values[3, 700] += 40
    values[3, 1000:1002] -= 30
    (fault,) = remove_spikes(replace(clean, values=values))[0].faults
    assert (fault.code, fault.where) == ("spike", "empty_bounce.csv: body_rr")
    assert fault.what.startswith("2 spikes (3 samples), the first at 1.4 s; replaced by interpolation")


def test_the_fit_is_none_the_worse() -> None:
    recordings = [spiked(clean, 6, 2, 60.0, seed)[0] for seed, clean in enumerate(CLEAN.recordings)]
    result = sprung.identify(CLEAN.with_recordings(recordings))
    assert result.verdict.state == "accept"
    assert {fault.code for fault in result.faults} == {"spike"}
    for name, one in sprung.identify(CLEAN).parameters.items():
        value = result.parameters[name].value
        assert value is not None
        assert one.value is not None
        assert abs(value - one.value) <= 0.5 * (one.std or 0.0)


def test_too_many_leave_the_channel_out() -> None:
    clean = CLEAN.recordings[0]
    values = clean.values.copy()
    values[2, 300::12] += 50
    values[2, 301::12] += 50
    mended, _ = remove_spikes(replace(clean, values=values))
    assert mended.usable.tolist() == [True, True, False, True, True, True, True, True]
    assert "the channel is left out" in mended.faults[0].what


def test_what_every_logger_recorded_is_mended() -> None:
    clean = CLEAN.recordings[0]
    part, _ = spiked(clean, 3, 1, 50.0, 1)
    whole, _ = remove_spikes(replace(clean, parts=(part, replace(clean, name="other.csv"))))
    assert len(whole.faults) == 8
    np.testing.assert_allclose(whole.parts[0].values, clean.values, atol=0.5)


def test_nothing_is_told_below_200_samples_a_second() -> None:
    recording = simulate(TABLE_1_CAR, noise=0.02, rate=100, seed=1).recordings[0]
    values = recording.values.copy()
    values[0, 200] += 100
    assert not detect_spikes(values, recording.rate).any()


def test_a_channel_that_is_left_out_stays_so() -> None:
    values = CLEAN.recordings[0].values.copy()
    values[5] = np.nan
    decays = prepare(CLEAN.with_recordings((replace(CLEAN.recordings[0], values=values), *CLEAN.recordings[1:])))
    assert not decays.decays[0].usable[5]
