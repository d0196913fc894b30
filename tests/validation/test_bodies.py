"""Motions of the body, and what is left of them and of every channel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from sprung.identification import Fit
from sprung.pipeline.fitted import fit_campaign
from sprung.pipeline.stand import Fitted
from sprung.validation import body_motions, remainders, validate_drops
from sprung.vehicle import TABLE_1_CAR


@pytest.fixture(scope="module")
def fitted() -> Fitted:
    made = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=3, known={"total_mass": TABLE_1_CAR.total_mass})
    return fit_campaign(made, tracks="shared", extras=())


def test_motions_are_those_of_a_rigid_body(fitted: Fitted) -> None:
    """A point x ahead of the front axle and y left of the centreline reads z - (x + a) pitch + y roll."""
    sensors, fit = fitted.campaign.sensors, fitted.fit
    a = fit.values[fit.names.index("a")]
    on_body = [i for i, sensor in enumerate(sensors) if sensor.on == "body"]
    places = np.array([sensors[i].position for i in on_body], dtype=float)
    rows = np.column_stack([np.ones(len(places)), -(places[:, 0] + a), places[:, 1]])
    decay, motion = fitted.prepared.decays[1], body_motions(fit, fitted.prepared.decays, sensors)[1]
    centred = decay.values[on_body] - decay.values[on_body].mean(axis=1, keepdims=True)
    # Weighted by the sensors' noise, which is nearly the same in all of them.
    np.testing.assert_allclose(motion.measured, np.linalg.lstsq(rows, centred, rcond=None)[0], atol=2e-3)
    assert motion.time[0] == pytest.approx(decay.start)
    assert motion.time[-1] == pytest.approx(decay.end)


def test_what_is_left_is_what_noise_makes_of_the_motion(fitted: Fitted) -> None:
    for motion in body_motions(fitted.fit, fitted.prepared.decays, fitted.campaign.sensors):
        left = (motion.measured - motion.simulated).std(axis=1)
        # 1500 samples tell a standard deviation to 2 %; six decays and three motions.
        np.testing.assert_allclose(left / motion.noise, 1, atol=0.08)
        moved = ~np.isnan(motion.errors)
        expected = motion.noise / np.sqrt((motion.measured**2).mean(axis=1))
        np.testing.assert_allclose(motion.errors[moved], expected[moved], rtol=0.1)
    bounce = body_motions(fitted.fit, fitted.prepared.decays, fitted.campaign.sensors)[0]
    assert np.isnan(bounce.errors).tolist() == [False, False, True]  # dropped on all wheels, it does not roll


def test_what_the_sensors_in_use_do_not_tell_is_said_to_be_unknown(fitted: Fitted) -> None:
    """With the sensors of one side alone vertical and roll motion cannot be told apart; pitch can."""
    sensors = fitted.campaign.sensors
    right = [i for i, one in enumerate(sensors) if one.position is not None and one.position[1] < 0]
    assert len(right) == 2
    decays = []
    for decay in fitted.prepared.decays:
        values = decay.values.copy()
        values[right] = np.nan
        decays.append(replace(decay, values=values))
    for motion in body_motions(fitted.fit, decays, sensors):
        assert np.isnan(motion.errors[[0, 2]]).all()
        assert np.isfinite(motion.measured[1]).all()


def spoilt(fit: Fit, drop: int, channel: int, wave: NDArray[np.float64]) -> Fit:
    records = [record.copy() for record in fit.fitted]
    records[drop][channel] += wave
    return replace(fit, fitted=tuple(records))


def test_what_is_not_white_is_seen_in_its_drop_and_channel(fitted: Fitted) -> None:
    decays = fitted.prepared.decays
    clean = remainders(fitted.fit, decays, fitted.fit.noise)
    colours = np.array([[left.colour for left in drop.values()] for drop in clean])
    # Ljung and Box: of white noise a chi-squared of many degrees of freedom, here in its standard deviations.
    assert np.abs(colours).max() < 5
    assert abs(colours.mean()) < 0.5
    period = 40
    wave = 0.02 * np.sin(2 * np.pi * np.arange(decays[2].samples) / period)
    found = remainders(spoilt(fitted.fit, 2, 5, wave), decays, fitted.fit.noise)
    changed = {(i, channel) for i, drop in enumerate(found) for channel, left in drop.items() if left.colour > 20}
    assert changed == {(2, 5)}
    left = found[2][5]
    # Noise of 0.02 and a wave of 0.02/√2 beside it: a third of the variance correlates with itself.
    assert abs(left.correlation) == pytest.approx(1 / 3, abs=0.07)
    assert left.over_noise == pytest.approx(np.sqrt(1.5), rel=0.06)


def test_drops_of_the_right_model_are_explained_and_predicted(fitted: Fitted) -> None:
    decays, sensors = fitted.prepared.decays, fitted.campaign.sensors
    motions = body_motions(fitted.fit, decays, sensors)
    channels = [sensor.channel for sensor in sensors]
    found = validate_drops(fitted.summit, fitted.fit, decays, channels, motions)
    assert list(found) == [decay.name for decay in decays]
    for decay, drop in zip(decays, found.values(), strict=True):
        # The rests of six drops tell the noise to a few percent.
        assert drop.residual == pytest.approx(1, abs=0.06)
        assert drop.predicted_residual == pytest.approx(drop.residual, rel=0.01)
        assert drop.fitted == pytest.approx(0.02 / decay.values.std(axis=1).mean(), rel=0.6)
        assert drop.unexpected == 0
        assert list(drop.whiteness) == channels
