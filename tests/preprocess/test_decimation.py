"""Recordings that were sampled very fast: means of neighbouring samples are used, and nothing else changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.preprocess import prepare
from sprung.preprocess.decimation import decimate
from sprung.vehicle import TABLE_1_CAR

TOTAL_MASS = TABLE_1_CAR.m_s + 2 * (TABLE_1_CAR.m_uf + TABLE_1_CAR.m_ur)


def test_means_of_neighbours_stand_at_the_middle_of_their_time() -> None:
    recording = sprung.simulate(TABLE_1_CAR, rate=5000, noise=0.02, seed=1).recordings[0]
    thin = decimate(recording)
    assert (thin.rate, thin.history[-1]) == (1000.0, "mean of every 5 samples used")
    assert thin.time == pytest.approx(recording.time[2::5][: len(thin.time)], abs=1e-12)
    assert thin.values[:, 7] == pytest.approx(recording.values[:, 35:40].mean(axis=1), abs=1e-12)
    # A decay is what it was: a mean over 1 ms of what hops at 10 Hz is 0.02 % of its amplitude off.
    smooth = sprung.simulate(TABLE_1_CAR, rate=5000, noise=0.0).recordings[0]
    late = decimate(smooth).time > 2.0
    there = smooth.values[:, 2::5][:, : len(late)]
    assert decimate(smooth).values[:, late] == pytest.approx(there[:, late], abs=1e-3)


def test_a_usual_rate_is_left_alone() -> None:
    slow = sprung.simulate(TABLE_1_CAR, rate=1600).recordings[0]
    assert decimate(slow) is slow
    few = sprung.simulate(TABLE_1_CAR, rate=5000).recordings[0]
    assert decimate(replace(few, values=few.values[:, :400])).rate == 5000.0


def test_a_lost_channel_stays_lost() -> None:
    recording = sprung.simulate(TABLE_1_CAR, rate=5000).recordings[0]
    values = recording.values.copy()
    values[2] = np.nan
    thin = decimate(replace(recording, values=values))
    assert np.isnan(thin.values[2]).all()
    assert not np.isnan(np.delete(thin.values, 2, axis=0)).any()


def test_a_release_is_no_noise_of_the_rest_before_it() -> None:
    """A steep low-pass rings around a release: the rest seemed twice as noisy as it was, and neighbours contrary.

    The standard error of a variance of 2000 samples is 3 %, that of a correlation 0.02.
    """
    for decay in prepare(sprung.simulate(TABLE_1_CAR, rate=4000, noise=0.04, seed=2)).decays:
        rest = decay.rest.noise
        assert rest.var() == pytest.approx(0.02**2, rel=0.15)
        assert abs(np.sum(rest[:, 1:] * rest[:, :-1]) / np.sum(rest**2)) < 0.1


def test_a_campaign_that_is_sampled_fast_gives_what_it_gives_at_a_usual_rate() -> None:
    slow, fast = (
        sprung.identify(
            sprung.simulate(TABLE_1_CAR, rate=rate, noise=noise, seed=1, known={"total_mass": TOTAL_MASS}), extras=[]
        )
        for rate, noise in ((1000, 0.02), (5000, 0.02 * np.sqrt(5)))
    )
    assert fast.drops[0].rate == 1000.0
    assert (slow.verdict.state, fast.verdict.state) == ("accept", "accept")
    assert fast.fit.inflation == 1.0
    for name, truth in TABLE_1_CAR.parameters.items():
        one, other = fast.parameters[name], slow.parameters[name]
        assert one.std == pytest.approx(other.std, rel=0.1)
        assert abs((one.value or 0.0) - truth) < 4 * (one.std or 0.0)
