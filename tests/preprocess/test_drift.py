"""Levels that walk, against the same campaign without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import sprung
from sprung.campaign import Campaign
from sprung.preprocess import prepare
from sprung.simulation import simulate
from sprung.vehicle import TABLE_1_CAR, Vehicle
from strategies import vehicles

KNOWN = {"total_mass": TABLE_1_CAR.total_mass}


def drifting(clean: Campaign, size: float) -> Campaign:
    """Let every channel walk up or down by so much through each record, m/s²."""
    random = np.random.default_rng(1)
    walks = [size * random.choice([-1, 1], (8, 1)) for _ in clean.recordings]
    recordings = [
        replace(one, values=one.values + walk * np.linspace(0, 1, one.values.shape[1]))
        for one, walk in zip(clean.recordings, walks, strict=True)
    ]
    return clean.with_recordings(recordings)


@pytest.mark.parametrize(("duration", "rest", "size"), [(3.2, 0.4, 0.2), (6.0, 0.5, 0.5)])
@pytest.mark.slow
def test_an_even_drift_is_taken_off_and_the_result_is_the_better_for_it(
    duration: float, rest: float, size: float
) -> None:
    clean = simulate(TABLE_1_CAR, noise=0.02, seed=1, known=KNOWN, duration=duration, rest=rest)
    mended, plain = sprung.identify(drifting(clean, size)), sprung.identify(clean)
    assert {fault.code for fault in mended.faults} == {"drift"}
    assert len(mended.faults) == 40
    assert all("removed as a straight line" in fault.what for fault in mended.faults)
    # As it is, such a campaign is rejected.
    assert mended.verdict.state == "accept"
    for name, one in plain.parameters.items():
        value = mended.parameters[name].value
        assert value is not None
        assert one.value is not None
        assert abs(value - one.value) <= (one.std or 0.0)


def test_a_level_that_settles_elsewhere_is_named_and_left_alone() -> None:
    clean = simulate(TABLE_1_CAR, noise=0.02, seed=1, known=KNOWN, duration=6.0, rest=1.0)
    values = clean.recordings[0].values.copy()
    values[2, 520:] += 0.3  # 40 ms after the release
    settled = replace(clean.recordings[0], values=values)
    prepared = prepare(clean.with_recordings((settled, *clean.recordings[1:])))
    (fault,) = prepared.decays[0].faults
    assert (fault.code, fault.where) == ("drift", "empty_bounce.csv: body_rl")
    assert "baseline drift of +0.3 m/s²" in fault.what
    assert "nothing was changed" in fault.what
    assert np.isin(prepared.decays[0].values[2], values[2]).all()


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(vehicle=vehicles, noise=st.floats(0.002, 0.2), duration=st.sampled_from([2.0, 3.2, 6.0]))
@pytest.mark.slow
def test_what_still_moves_is_no_drift(vehicle: Vehicle, noise: float, duration: float) -> None:
    campaign = simulate(vehicle, noise=noise, duration=duration, offset=0.1, seed=1)
    assert all(decay.faults == () for decay in prepare(campaign).decays)
