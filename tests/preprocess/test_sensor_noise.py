"""Noise at rest against processes whose variance is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

import sprung
from sprung.campaign import Campaign
from sprung.preprocess import FreeDecay, estimate_sensor_noise, pool_moments, prepare
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR

Real = NDArray[np.float64]

COUNT, RESTED = 1600, 150
"""Samples of each residual record, and of each rest."""


def process(shape: tuple[int, ...], rho: float, random: np.random.Generator) -> Real:
    """Return a first-order process of variance 1 whose neighbours are correlated by rho."""
    driven = random.standard_normal((*shape[:-1], shape[-1] + 200))
    whole = np.asarray(lfilter([np.sqrt(1 - rho**2)], [1, -rho], driven, axis=-1), dtype=np.float64)
    return whole[..., 200:]


def rested(like: FreeDecay, noise: Real) -> FreeDecay:
    """Return a decay whose rest shows this, less level and creep, as a release reads it."""
    time = np.arange(noise.shape[1]) - (noise.shape[1] - 1) / 2
    level, creep = noise.mean(axis=1, keepdims=True), noise @ time / (time @ time)
    return replace(like, rest=like.rest._replace(noise=noise - level - creep[:, None] * time))


@pytest.fixture(scope="module")
def decays() -> tuple[FreeDecay, ...]:
    return prepare(sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1)).decays


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 0.9])
def test_the_variance_of_coloured_noise_is_found_in_short_rests(decays: tuple[FreeDecay, ...], rho: float) -> None:
    random = np.random.default_rng(3)
    found = []
    for _ in range(40):
        own = [rested(one, process((8, RESTED), rho, random)) for one in decays]
        left = pool_moments(process((len(decays), 8, COUNT), rho, random))
        found.append(estimate_sensor_noise(own, left))
    # Of neighbours correlated by rho as many samples make one independent variance (Bartlett 1946).
    worth = (1 + rho**2) / (1 - rho**2)
    assert np.mean([one.per_independent for one in found]) == pytest.approx(worth, rel=0.1)
    assert np.mean([one.variance for one in found]) == pytest.approx(1.0, abs=0.06)
    spread = np.sqrt(2 * worth / (len(decays) * RESTED))
    assert np.std([one.variance for one in found]) == pytest.approx(spread, rel=0.3)


def test_a_quiet_rest_does_not_take_the_colour_of_what_moves(decays: tuple[FreeDecay, ...]) -> None:
    """Residuals of a wrong model are coloured; sensors that are white at rest are so in motion."""
    random = np.random.default_rng(4)
    own = [rested(one, random.standard_normal((8, RESTED))) for one in decays]
    found = estimate_sensor_noise(own, pool_moments(5 * process((len(decays), 8, COUNT), 0.99, random)))
    assert np.all(found.per_independent < 1.2)
    assert found.variance == pytest.approx(np.ones(8), abs=0.3)


def test_a_vehicle_that_still_moves_on_its_blocks_is_no_noise(decays: tuple[FreeDecay, ...]) -> None:
    """Released soon after it was set down: four of ten rests show the motion."""
    random = np.random.default_rng(5)
    swinging = 10 * np.sin(0.08 * np.arange(RESTED))
    own = [
        rested(one, random.standard_normal((8, RESTED)) + (swinging if number % 5 > 2 else 0.0))
        for number, one in enumerate(decays)
    ]
    found = estimate_sensor_noise(own, pool_moments(5 * process((len(decays), 8, COUNT), 0.99, random)))
    assert found.variance == pytest.approx(np.ones(8), abs=0.3)
    assert np.all(found.samples >= RESTED * np.ceil(len(decays) / 2))


def rounded(clean: Campaign, step: float) -> Campaign:
    return clean.with_recordings(replace(r, values=step * np.round(r.values / step)) for r in clean.recordings)


def test_steps_are_known_though_a_high_pass_was_undone() -> None:
    step = 20 * STANDARD_GRAVITY / 2**12
    clean = sprung.simulate(TABLE_1_CAR, noise=0.01, seed=1)
    sensors = tuple(replace(one, high_pass=0.1) for one in clean.sensors)
    centred = [replace(r, values=r.values - r.values[:, :100].mean(axis=1, keepdims=True)) for r in clean.recordings]
    campaign = rounded(replace(clean.with_recordings(centred), sensors=sensors), step)
    for decay in prepare(campaign).decays:
        assert decay.resolution == pytest.approx(np.full(8, step))
        assert decay.high_pass == (0.1,) * 8
