"""Low-passes of single channels: in a simulation that is sampled eight times as fast, undone where it is recorded."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import butter, lfilter, lfilter_zi

import sprung
from sprung.estimation import LowPass
from sprung.faults.low_pass import inverse_kernel, recorded_energy, undo_low_pass
from sprung.preprocess import detect_release
from sprung.uncertainty import KnownValue
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR

BALLAST = {"name": "ballast", "items": [{"mass": 140.0, "position": [-1.0, 0.2, 0.6]}]}
KNOWN = {"total_mass": KnownValue(TABLE_1_CAR.total_mass, 1.0)}
RATE, FINER, NOISE = 500.0, 8, 0.02


@cache
def fine() -> sprung.Campaign:
    """The car without noise, sampled so fast that a digital low-pass is that of an amplifier."""
    return sprung.simulate(TABLE_1_CAR, loads=[BALLAST], seed=2, known=KNOWN, rate=FINER * RATE, noise=0.0)


def recorded(order: int, corner: float, *channels: str) -> sprung.Campaign:
    """Return the campaign with a low-pass in some channels, then sampled, with the noise of the converter."""
    random, recordings = np.random.default_rng(3), []
    numerator, denominator = butter(order, corner, fs=FINER * RATE)
    for one in fine().recordings:
        values = one.values.copy()
        for channel in (one.channels.index(name) for name in channels):
            begin = lfilter_zi(numerator, denominator) * values[channel, 0]
            values[channel] = lfilter(numerator, denominator, values[channel], zi=begin)[0]
        sampled = values[:, ::FINER]
        recordings.append(replace(one, values=sampled + NOISE * random.standard_normal(sampled.shape), rate=RATE))
    return fine().with_recordings(recordings)


def identified(campaign: sprung.Campaign) -> sprung.Result:
    return sprung.identify(campaign, tracks="shared", extras=(), fall=False)


@pytest.mark.parametrize(
    ("channel", "order", "corner"), [pytest.param("wheel_fr", 1, 40.0, marks=pytest.mark.long), ("wheel_rl", 2, 30.0)]
)
@pytest.mark.slow
def test_it_is_named_and_undone(channel: str, order: int, corner: float) -> None:
    """The channel, the order and the corner; no parameter is moved by more than the noise moves it."""
    result = identified(recorded(order, corner, channel))
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("low-pass", channel)
    assert f"of {('first', 'second')[order - 1]} order" in fault.what
    assert "corrected" in fault.what
    found = float(fault.what.split("corner frequency of ")[1].split(" ")[0])
    # 0.05 Hz by the noise; the bilinear transform bends 40 Hz at 4 kHz by (pi 40/4000)²/3, 0.03 %.
    assert found == pytest.approx(corner, rel=0.01)
    assert result.verdict.state == "accept"
    for name, estimate in result.parameters.items():
        assert estimate.value is not None
        assert estimate.std is not None
        assert abs(estimate.value - TABLE_1_CAR.parameters[name]) < 4 * estimate.std
        assert estimate.std < 0.004 * abs(estimate.value)


@pytest.mark.slow
def test_the_same_in_all_channels_is_no_fault() -> None:
    """Every mode of free vibration is filtered as a whole: amplitudes change, the vehicle does not."""
    channels = [sensor.channel for sensor in fine().sensors]
    result = identified(recorded(2, 60.0, *channels))
    assert result.faults == ()
    assert result.verdict.state == "accept"
    for name, estimate in result.parameters.items():
        assert estimate.value is not None
        assert estimate.std is not None
        assert abs(estimate.value - TABLE_1_CAR.parameters[name]) < 4 * estimate.std


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("rate", [400.0, 500.0, 1000.0])
def test_the_kernel_undoes_the_low_pass_of_vehicle_modes(order: int, rate: float) -> None:
    """Bounce at 1.2 Hz, hop at 11 and 15 Hz, much damping, and a mode that does not vibrate; a calibration is worse by far."""
    low_pass = LowPass(50.0, order)
    advance, kernel = inverse_kernel(low_pass, rate)
    lags = np.arange(kernel.size) - kernel.size // 2
    for pole in (-2 + 7.8j, -8 + 70j, -15 + 94j, -30 + 60j, -40 + 0j):
        gain = kernel @ np.exp(-pole * lags / rate) * np.exp(pole * advance / rate)
        assert gain * low_pass.response(np.array(pole)) == pytest.approx(1, abs=5e-4)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_the_response_is_butterworths(order: int) -> None:
    frequencies = np.array([1.0, 10.0, 40.0, 90.0])
    low_pass = LowPass(40.0, order)
    gain = np.abs(low_pass.response(2j * np.pi * frequencies))
    assert gain == pytest.approx(1 / np.sqrt(1 + (frequencies / 40) ** (2 * order)))
    slow = np.angle(low_pass.response(np.array(2j * np.pi * 0.01)))
    assert -slow / (2 * np.pi * 0.01) == pytest.approx(low_pass.delay, rel=1e-6)
    assert LowPass(1.0, 1).delay == pytest.approx(1 / (2 * np.pi))


def test_noise_has_its_recorded_energy() -> None:
    """What is undone and counted as recorded is the noise as it was, but for the ends of the record."""
    noise = np.random.default_rng(5).standard_normal((1, 4000))
    low_pass = LowPass(40.0, 2)
    corrected = undo_low_pass(0, low_pass).samples
    assert corrected is not None
    raised = corrected(noise, RATE)[0]
    assert recorded_energy(raised, low_pass, RATE) == pytest.approx(float(np.sum(noise**2)), rel=0.01)
    assert np.sum(raised**2) > 1.2 * np.sum(noise**2)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_the_release_does_not_show_before_it_happens(order: int) -> None:
    """The fall begins at once; the level at rest, from which a high-pass is undone, is that of the recording."""
    random = np.random.default_rng(6)
    samples, release = 2000, 800
    noise = 0.01 * random.standard_normal((2, samples))
    values = noise + np.where(np.arange(samples) >= release, -STANDARD_GRAVITY * np.exp(-np.arange(samples) / 900), 0.0)
    values[:, 1200:] += 60 * np.exp(-np.arange(samples - 1200) / 100) * np.cos(np.arange(samples - 1200) / 7)
    undone = undo_low_pass(0, LowPass(40.0, order)).samples
    assert undone is not None
    found = detect_release(undone(values, RATE), RATE)
    stated = detect_release(values, RATE)
    assert found is not None
    assert stated is not None
    assert found.sample == stated.sample
    # Both channels have the same noise, of which means of 150 samples have a standard error of 0.0008 m/s².
    assert found.level == pytest.approx(stated.level, abs=0.004)
    assert found.noise[0].std() < 0.03
