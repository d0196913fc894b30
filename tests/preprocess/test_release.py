"""The release against recordings whose release is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sprung.preprocess import prepare
from sprung.preprocess.release import detect_release
from sprung.simulation import free_decays, simulate
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS])
@pytest.mark.parametrize("noise", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("rest", [0.15, 0.4, 2.0])
def test_release_is_found_to_the_sample(vehicle: Vehicle, noise: float, rest: float) -> None:
    campaign = simulate(vehicle, noise=noise, rest=rest, seed=1)
    for recording in campaign.recordings:
        found = detect_release(recording.values, recording.rate)
        assert found is not None
        assert found.sample / recording.rate == pytest.approx(rest, abs=1.5 / recording.rate)
        np.testing.assert_allclose(found.level, 9.80665, atol=0.02 + noise)
        np.testing.assert_allclose(found.noise.std(axis=1), noise, atol=0.25 * noise + 1e-9)


def test_creep_on_the_blocks_is_not_noise() -> None:
    recording = simulate(TABLE_1_CAR, noise=0.02, seed=2).recordings[0]
    creeping = recording.values + 0.5 * recording.time
    found = detect_release(creeping, recording.rate)
    assert found is not None
    np.testing.assert_allclose(found.noise.std(axis=1), 0.02, rtol=0.25)


def test_a_recording_that_begins_in_the_decay_shows_no_rest() -> None:
    for recording in free_decays(TABLE_1_CAR, states=6, noise=0.02, seed=3).recordings:
        assert detect_release(recording.values, recording.rate) is None


def test_a_drop_without_rest_is_told_and_used() -> None:
    campaign = free_decays(TABLE_1_CAR, states=1, noise=0.02, seed=4)
    unknown = replace(campaign.drops[0], start=None)
    decay = prepare(type(campaign)(**{**vars(campaign), "drops": (unknown,)})).decays[0]
    assert [fault.code for fault in decay.faults] == ["no-release"]
    assert decay.start == campaign.recordings[0].start
    assert decay.rest.noise.shape[1] == 0
