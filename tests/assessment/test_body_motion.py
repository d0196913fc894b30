"""When the body moved: statements about motions that are small, against noise and decaying motions of known size."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.assessment import BodyMotion, DropValidation
from sprung.report import motion_picture
from sprung.results import Series
from sprung.vehicle import FULL

RATE, SECONDS, NOISE = 500.0, 3.2, 0.02
TIME = np.arange(int(RATE * SECONDS)) / RATE
SEEDS = 200


def decaying(peak: float) -> np.ndarray:
    """A roll of 1.6 Hz, heavily damped, with its peak as a multiple of the noise."""
    motion: np.ndarray = np.exp(-8 * TIME) * np.sin(2 * np.pi * 1.6 * TIME)
    return np.asarray(peak * NOISE * motion / np.abs(motion).max())


def seen(motion: np.ndarray, noise: np.ndarray) -> BodyMotion:
    """One motion in all three coordinates, of which the model knows everything but the noise."""
    return BodyMotion("drop", TIME, np.tile(motion + noise, (3, 1)), np.tile(motion, (3, 1)), np.full(3, NOISE), 1000.0)


def white(seed: int) -> np.ndarray:
    return NOISE * np.random.default_rng(seed).standard_normal(TIME.size)


def coloured(seed: int, correlation: float = 0.9) -> np.ndarray:
    """First-order noise of the same variance."""
    drive = np.random.default_rng(seed).standard_normal(TIME.size)
    values = np.empty_like(drive)
    last = 0.0
    for i, one in enumerate(drive):
        last = correlation * last + np.sqrt(1 - correlation**2) * one
        values[i] = last
    return NOISE * values


@pytest.mark.parametrize("peak", [5.0, 13.0])
def test_a_motion_that_everybody_sees_is_no_noise(peak: float) -> None:
    # Peaks of five to thirteen times the noise whose root-mean-square over the whole decay is below three times the noise.
    motions = [seen(decaying(peak), white(seed)) for seed in range(20)]
    assert all(np.isnan(one.errors).all() for one in motions)
    assert all((one.over_noise > 1).all() for one in motions)


@pytest.mark.parametrize("noise", [white, coloured])
def test_noise_alone_is_no_motion(noise: object) -> None:
    # Four standard deviations: 3 in 100 000; of 200 draws one at the most.
    false = sum(bool(seen(np.zeros_like(TIME), noise(seed)).over_noise[0] > 0) for seed in range(SEEDS))  # type: ignore[operator]
    assert false <= 1


def test_what_the_sensors_do_not_tell_is_no_motion() -> None:
    one = BodyMotion("drop", TIME, np.full((3, TIME.size), np.nan), np.full((3, TIME.size), np.nan), np.full(3, NOISE))
    assert np.isnan(one.over_noise).all()
    assert np.isnan(one.errors).all()


@pytest.mark.parametrize(
    ("over_noise", "said"),
    [
        ({"roll": 1.84}, "1.8 times the noise, too small for an error in %"),
        ({"roll": None}, "no motion beyond the noise"),
    ],
)
def test_the_picture_says_which_of_both(over_noise: dict[str, float | None], said: str) -> None:
    values = np.tile(decaying(8.0), (3, 1)).astype(np.float32)
    one = values[:1].astype(np.float64)
    series = Series(("a",), TIME, one, one, values, values)
    drop = DropValidation(0.01, 0.02, None, 0.01, 1.0, None, None, 0.0, None, over_noise=over_noise)
    picture = motion_picture("drop", series, drop, FULL)
    assert [panel.note for panel in picture.panels][::2] == ["error 1.0 %", "error 2.0 %", said]
