"""What a high-pass took away, and what a corner otherwise would change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sprung.campaign import Campaign
from sprung.preprocess import FreeDecay, differentiate_by_cutoff, is_ac_coupled, prepare, unknown_release
from sprung.simulation import simulate
from sprung.vehicle import TABLE_1_CAR

CLEAN = simulate(TABLE_1_CAR, noise=0.0, seed=1)


def with_corners(campaign: Campaign, corner: float | None) -> Campaign:
    sensors = [replace(one, high_pass=corner) for one in campaign.sensors]
    return replace(campaign, sensors=tuple(sensors))


COUPLED = simulate(TABLE_1_CAR, sensors=with_corners(CLEAN, 0.3).sensors, noise=0.01, seed=1)


def decays(corner: float | None, within: tuple[FreeDecay, ...] = ()) -> tuple[FreeDecay, ...]:
    """Undo a corner, in the samples of other decays where some are given."""
    campaign = with_corners(COUPLED, corner)
    if within:
        spans = [replace(one, start=d.start, end=d.end) for one, d in zip(COUPLED.drops, within, strict=True)]
        campaign = replace(campaign, drops=tuple(spans))
    return prepare(campaign).decays


@pytest.mark.parametrize("corner", [None, 0.1, 0.5])
def test_what_a_corner_changes_is_its_derivative(corner: float | None) -> None:
    """x = y + ω ∫ y dt is linear in ω, so that a difference over any step is the derivative, rounding apart."""
    here = decays(corner)
    step = 0.01
    there = decays((corner or 0.0) + step, here)
    for one, other in zip(here, there, strict=True):
        expected = (other.values - one.values) / (2 * np.pi * step)
        # The integral that forgets is the other one in steps of a trapezoid: to the second order of a step of time.
        np.testing.assert_allclose(differentiate_by_cutoff(one), expected, atol=2e-4 * np.abs(expected).max())


def test_a_sensor_that_feels_gravity_is_not_coupled() -> None:
    (first, *_) = prepare(CLEAN).decays
    assert not is_ac_coupled(first).any()
    assert not differentiate_by_cutoff(first).any()
    assert all(is_ac_coupled(one).all() for one in decays(None))


def test_without_a_rest_nobody_knows() -> None:
    for one in decays(None):
        blind = replace(one, rest=unknown_release(len(one.values)))
        assert not is_ac_coupled(blind).any()
        assert not differentiate_by_cutoff(blind).any()
