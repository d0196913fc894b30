"""Simulated sensors that deviate from what is stated of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.simulation import default_sensors
from sprung.vehicle import TABLE_1_CAR, Sensor, uncertainties_of

STILL = {"gain_std": 0.0, "tilt_std": 0.0, "position_std": 0.0, "delay_std": 0.0}


def simulated(errors: bool, **stds: float) -> sprung.Campaign:
    sensors = [replace(sensor, **{**STILL, **stds}) for sensor in default_sensors(TABLE_1_CAR)]  # type: ignore[arg-type]
    return sprung.simulate(
        TABLE_1_CAR, sensors=sensors, drops=[{"wheels": ["fl", "fr"]}], noise=0.0, seed=3, sensor_errors=errors
    )


def motion(campaign: sprung.Campaign) -> np.ndarray:
    values = campaign.recordings[0].values
    return np.asarray(values - values[:, :1])


def test_a_simulated_campaign_knows_its_sensors() -> None:
    """Without errors the sensors are exact, whatever was stated, and the campaign says so."""
    campaign = sprung.simulate(TABLE_1_CAR, drops=[{"wheels": ["fl"]}], seed=1)
    assert uncertainties_of(campaign.sensors) == {}
    assert uncertainties_of([Sensor(channel="as usual", on="fl")])


def test_gains_are_drawn_and_stated() -> None:
    exact, campaign = simulated(False), simulated(True, gain_std=0.01)
    ratios = np.array([np.dot(a, b) / np.dot(b, b) for a, b in zip(motion(campaign), motion(exact), strict=True)])
    # Eight draws of 1 %: no two alike, none beyond five standard deviations.
    assert len(set(ratios.round(6))) == 8
    assert np.abs(ratios - 1).max() < 0.05
    np.testing.assert_allclose(motion(campaign), ratios[:, None] * motion(exact), atol=1e-9)
    assert {sensor.gain_std for sensor in campaign.sensors} == {0.01}
    assert np.array_equal(simulated(True, gain_std=0.01).recordings[0].values, campaign.recordings[0].values)


def test_a_place_adds_angular_acceleration() -> None:
    """The difference on the body is a combination of pitch and roll acceleration; wheels have no place."""
    difference = motion(simulated(True, position_std=0.01)) - motion(exact := simulated(False))
    assert np.abs(difference[4:]).max() == 0
    fl, fr, rl, _ = motion(exact)[:4]
    angular = np.array([fl - rl, fl - fr]).T
    left = difference[0] - angular @ np.linalg.lstsq(angular, difference[0], rcond=None)[0]
    assert np.abs(difference[0]).max() > 1e-3
    assert np.abs(left).max() < 1e-9


def test_a_delay_shifts_a_channel() -> None:
    exact, campaign = simulated(False), simulated(True, delay_std=1e-3)
    before, after = motion(exact)[4][600:1500], motion(campaign)[4][600:1500]
    rate = np.gradient(before) * exact.recordings[0].rate
    delay = -np.dot(after - before, rate) / np.dot(rate, rate)
    assert 1e-5 < abs(delay) < 5e-3
    # To the second order in a delay that is a hundredth of a period of wheel hop.
    assert np.std(after - before + delay * rate) < 0.1 * np.std(after - before)


def test_a_tilt_lowers_the_gain_and_shows_gravity() -> None:
    """On a wheel only its cosine; on the body the part of gravity that the angle of pitch or roll brings, too."""
    exact, campaign = motion(simulated(False)), motion(simulated(True, tilt_std=5.0))
    for wheel in range(4, 8):
        cosine = np.dot(campaign[wheel], exact[wheel]) / np.dot(exact[wheel], exact[wheel])
        assert 0.9 < cosine < 1
        np.testing.assert_allclose(campaign[wheel], cosine * exact[wheel], atol=1e-9)
    # The front falls by 5 cm over a wheelbase of 2.76 m: gravity times this angle times the sine of the tilt.
    settled = campaign[0][-1] - exact[0][-1]
    assert abs(settled) < 9.81 * 0.05 / 2.76 * np.sin(np.radians(25.0))
    assert abs(settled) > 1e-4


@pytest.mark.parametrize("key", ["gain_std", "tilt_std", "position_std", "delay_std"])
def test_an_uncertainty_is_not_negative(key: str) -> None:
    with pytest.raises(sprung.errors.InputError, match=key):
        Sensor(channel="wheel", on="fl", **{key: -0.1})  # type: ignore[arg-type]
