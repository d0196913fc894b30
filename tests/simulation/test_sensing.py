"""What sensors and loggers do to a signal."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from sprung.campaign import Drop
from sprung.simulation import simulate
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR

Array = NDArray[np.float64]
BOUNCE = [Drop()]


def wheel(channel: str, **properties: object) -> dict[str, object]:
    return {"channel": channel, "on": "fl", **properties}


def record(*sensors: dict[str, object], noise: float = 0.0, offset: float = 0.0, seed: int = 1) -> Array:
    campaign = simulate(TABLE_1_CAR, sensors=sensors, drops=BOUNCE, noise=noise, offset=offset, seed=seed)
    return campaign.recordings[0].values


def test_noise_is_white_normal_and_of_the_given_size() -> None:
    sizes = {"a": 0.02, "b": 0.5, "c": 0.0}
    sensors = [wheel(channel) for channel in sizes]
    noisy = simulate(TABLE_1_CAR, sensors=sensors, drops=BOUNCE * 4, noise=sizes, seed=5)
    exact = record(*sensors)
    noise = np.hstack([recording.values - exact for recording in noisy.recordings])
    assert_array_equal(noise[2], 0.0)
    samples = noise.shape[1]
    for channel, size in zip(noise[:2], (0.02, 0.5), strict=True):
        # One chance in a million each: sum of squares, mean and the first autocorrelations of white normal noise.
        assert 1e-6 < 2 * chi2.cdf((channel**2).sum() / size**2, samples) < 2 - 1e-6
        limit = norm.ppf(1 - 5e-7) / np.sqrt(samples)
        assert abs(channel.mean()) < limit * size
        for lag in (1, 2, 3):
            assert abs((channel[lag:] * channel[:-lag]).mean()) < limit * size**2
    assert abs(np.corrcoef(noise[0], noise[1]).item(0, 1)) < norm.ppf(1 - 5e-7) / np.sqrt(samples)


def test_offset_is_drawn_for_each_channel_and_drop_and_stays_within_it() -> None:
    sensors = [wheel("a"), wheel("b")]
    campaign = simulate(TABLE_1_CAR, sensors=sensors, drops=BOUNCE * 50, noise=0.0, offset=0.3, seed=2, duration=0.1)
    exact = simulate(TABLE_1_CAR, sensors=sensors, drops=BOUNCE, noise=0.0, duration=0.1).recordings[0].values
    offsets = np.array([recording.values - exact for recording in campaign.recordings])
    assert_allclose(offsets, np.broadcast_to(offsets[:, :, :1], offsets.shape), atol=1e-12)
    drawn = offsets[:, :, 0].ravel()
    assert np.unique(drawn).size == 100
    assert 1e-6 < 2 * chi2.cdf((drawn**2).sum() / 0.3**2, 100) < 2 - 1e-6


@pytest.mark.parametrize(("unit", "factor"), [(None, 1.0), ("m/s²", 1.0), ("g", STANDARD_GRAVITY), ("mg", 0.00980665)])
def test_range_clips_and_resolution_rounds_in_the_sensor_s_unit(unit: str | None, factor: float) -> None:
    full_scale, step = 20.0 / factor, 0.05 / factor
    exact, clipped, rounded, both = record(
        wheel("exact", unit=unit),
        wheel("clipped", unit=unit, range=full_scale),
        wheel("rounded", unit=unit, resolution=step),
        wheel("both", unit=unit, range=full_scale, resolution=step),
    )
    assert exact.min() < -20
    assert exact.max() > 20
    assert_allclose(clipped, np.clip(exact, -20, 20), rtol=1e-12)
    assert np.abs(rounded - exact).max() <= 0.025 + 1e-9
    assert np.abs(rounded - exact).max() > 0.02
    assert_allclose(rounded / 0.05, np.round(rounded / 0.05), atol=1e-8)
    assert_allclose(both, np.clip(rounded, -20, 20), rtol=1e-12)


def test_direction_matters_only_in_the_file() -> None:
    properties = {"range": 3.0, "resolution": 0.01, "unit": "g"}
    up, down = record(wheel("up", **properties), wheel("down", direction="down", **properties))
    assert_array_equal(up, down)


def test_dc_coupled_sensor_at_rest_reads_gravity_and_an_ac_coupled_one_nothing() -> None:
    dc, ac = record(wheel("dc"), wheel("ac", high_pass=0.5))
    assert_array_equal(dc[:200], STANDARD_GRAVITY)
    assert_array_equal(ac[:200], 0.0)


def test_ac_coupling_is_a_first_order_high_pass() -> None:
    corner = 2.0
    dc, ac = record(wheel("dc"), wheel("ac", high_pass=corner), offset=0.5)
    assert np.ptp(ac[:200]) == 0  # the offset does not pass
    acceleration = record(wheel("dc"))[0] - STANDARD_GRAVITY
    # Independent: ẏ = ẍ' - ω y, x linear between samples; the bilinear rule differs by (ω/rate)² of the signal.
    omega, step = 2 * np.pi * corner, 0.002
    decay = np.exp(-omega * step)
    expected = np.zeros_like(acceleration)
    for i in range(1, acceleration.size):
        rise = (acceleration[i] - acceleration[i - 1]) / step
        expected[i] = expected[i - 1] * decay + rise * (1 - decay) / omega
    assert np.abs(ac - expected).max() < 0.01 * np.abs(acceleration).max()
    assert np.abs(ac - acceleration).max() > 0.05 * np.abs(acceleration).max()
    assert dc[0] != STANDARD_GRAVITY
