"""Recordings that are spliced from two parts which passed different filters, and recordings with too many samples."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt

import sprung
from sprung.campaign import Recording
from sprung.preprocess.splice import find_splice, join_splices
from sprung.vehicle import TABLE_1_CAR

RATE, CORNER = 5000.0, 50.0
DELAY = 2.6131 / (2 * np.pi * CORNER)
"""s: of slow motion behind a Butterworth low-pass of fourth order (sum of its first-order coefficients over its corner)."""


def motion(seed: int) -> NDArray[np.float64]:
    """Four displacements of a rig that is let go after 0.3 s, m: two of the body at 1.4 Hz, two of wheels at 10 Hz."""
    random = np.random.default_rng(seed)
    time = np.maximum(np.arange(20000) / RATE - 0.3, 0.0)
    moved = 0.03 * np.exp(-0.8 * time) * np.cos(2 * np.pi * 1.4 * time)
    hops = [0.002 * np.exp(-3 * time) * np.cos(2 * np.pi * f * time + random.uniform(0, 6)) for f in (9.7, 10.3)]
    return np.array([moved, 0.8 * moved, *hops])


def spliced(seed: int, at: int) -> Recording:
    values = motion(seed)
    noise = np.array([1e-4, 1e-4, 1e-5, 1e-5])[:, None]
    raw = values + noise * np.random.default_rng(seed + 100).standard_normal(values.shape)
    filters = butter(4, CORNER, fs=RATE, output="sos")
    late = values[:, :1] + sosfilt(filters, raw - values[:, :1], axis=1)
    joined = np.concatenate([late[:, :at], raw[:, at:]], axis=1)
    return Recording(name=f"lift {seed}", channels=("a", "b", "c", "d"), values=joined, start=0.0, rate=RATE)


PLACES = (2600, 3100, 3800, 4400, 4850)


def test_the_first_part_is_advanced_by_its_delay() -> None:
    recordings = [spliced(seed, at) for seed, at in enumerate(PLACES)]
    assert [find_splice(one.values, RATE) for one in recordings] == pytest.approx(PLACES, abs=3)
    for seed, one in enumerate(join_splices(recordings)):
        (fault,) = one.faults
        assert fault.code == "splice"
        assert "was advanced" in fault.what
        delay, std = (float(text) for text in re.findall(r"are ([\d.]+) ± ([\d.]+) ms", fault.what)[0])
        assert abs(delay - 1e3 * DELAY) < 4 * std < 1.0
        # Behind the first second the low-pass is all that is left between the recording and the motion.
        moved = motion(seed)[:, 1800:5000]
        off = np.sqrt(np.mean((one.values[:, 1800:5000] - moved) ** 2, axis=1))
        assert np.all(off < [2e-4, 2e-4, 1e-4, 1e-4])
        late = np.sqrt(np.mean((spliced(seed, PLACES[seed]).values[:, 1800:2500] - moved[:, :700]) ** 2, axis=1))
        assert np.all(late > [1e-3, 1e-3, 3e-4, 3e-4])


def test_what_is_of_one_piece_is_left_alone() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1, rate=1000)
    assert join_splices(campaign.recordings) == list(campaign.recordings)
    quiet = sprung.simulate(TABLE_1_CAR, noise=0.0, duration=1.0)
    assert all(find_splice(one.values, one.rate) is None for one in quiet.recordings)


def test_a_lost_channel_does_not_hide_a_splice() -> None:
    recording = spliced(0, PLACES[0])
    values = recording.values.copy()
    values[2] = np.nan
    assert find_splice(values, RATE) == pytest.approx(PLACES[0], abs=3)
    joined = join_splices([replace(recording, values=values)])[0]
    assert np.isnan(joined.values[2]).all()
    assert not np.isnan(joined.values[[0, 1, 3]]).any()
