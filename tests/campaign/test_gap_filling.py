"""Missing samples and other clocks against signals that are known at every time: rest, and from 0.5 s on free vibration."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sprung.campaign.gap_filling import fill_gaps, fill_short_gaps, find_rest
from sprung.formats import interpolate

Real = NDArray[np.float64]

RATE = 500.0
TIME = np.arange(1800) / RATE


def vibration(time: Real) -> Real:
    """Return a body and a wheel channel, m/s²: bounce at 1.3 Hz, hop at 11 Hz, from 0.5 s on."""
    since = np.maximum(time - 0.5, 0.0)
    body = np.exp(-2.0 * since) * np.sin(2 * np.pi * 1.3 * since)
    hop = np.exp(-12.0 * since) * np.sin(2 * np.pi * 11.0 * since)
    return 9.81 + np.array([8 * body + 0.5 * hop, body + 40 * hop])


def mended(values: Real) -> tuple[Real, int, list[str], list[bool]]:
    filled, first, faults, _ = fill_gaps(
        values, np.zeros(values.shape[1], dtype=bool), RATE, ["a.csv: body", "a.csv: wheel"], "sample {}".format
    )
    out = [bool(np.isnan(row).any()) for row in filled]
    return filled, first, [fault.what for fault in faults], out


@settings(max_examples=40, deadline=None)
@given(
    faster=st.sampled_from([200.0, 256.0, 500.0, 1000.0, 2000.0]),
    other=st.sampled_from([200.0, 333.0, 500.0, 1024.0, 2000.0]),
    frequency=st.floats(1.0, 15.0),
    decay=st.floats(0.0, 6.0),
    phase=st.floats(0.0, 1.0),
)
def test_exponentials_come_over_to_another_clock(
    faster: float, other: float, frequency: float, decay: float, phase: float
) -> None:
    time_from = np.arange(int(3 * faster)) / faster
    time_to = 0.05 + phase / other + np.arange(int(2.9 * other)) / other
    exponent = -decay + 2j * np.pi * frequency
    found = interpolate(np.exp(exponent * time_from).real[None], time_from, time_to)[0]
    inside = time_to <= time_from[-1]
    error = np.abs(found - np.exp(exponent * time_to).real) / np.exp(-decay * time_to)
    assert error[inside].max() < 1e-3
    assert np.isnan(found[~inside]).all()


def test_a_faster_clock_is_averaged_and_nothing_of_it_is_folded() -> None:
    time_from, time_to = np.arange(6000) / 2000, np.arange(600) / 200
    noise = np.random.default_rng(1).standard_normal(6000)
    # Of white noise a tenth of the band is left, and so about √0.1 of its size.
    assert interpolate(noise, time_from, time_to).std() == pytest.approx(np.sqrt(0.1), rel=0.15)
    hum = np.sin(2 * np.pi * 450 * time_from)  # at 200 Hz it would pass for 50 Hz
    assert np.abs(interpolate(hum, time_from, time_to)[10:-10]).max() < 0.03


@pytest.mark.parametrize(("lost", "error"), [(1, 2e-4), (4, 5e-3), (9, 0.1)])
def test_short_gaps_are_filled_to_a_small_part_of_the_motion(lost: int, error: float) -> None:
    """Hop of 40 m/s² that would be off by (2π 11 Hz)⁴ gap⁴/384, the error of cubic interpolation (de Boor, 1978, II)."""
    truth = vibration(TIME)
    for begin in range(270, 340, 7):
        values = truth.copy()
        values[1, begin : begin + lost] = np.nan
        found, first, said, out = mended(values)
        assert first == 0
        assert not any(out)
        assert f"{lost} of 1800 samples" in said[0]
        assert "filled in" in said[0]
        np.testing.assert_allclose(found, truth, atol=error * 10)
        np.testing.assert_array_equal(found[np.isfinite(values)], truth[np.isfinite(values)])


@pytest.mark.parametrize(("begin", "end"), [(300, 310), (240, 262)])
def test_longer_gaps_in_the_motion_leave_the_channel_out(begin: int, end: int) -> None:
    values = vibration(TIME)
    values[1, begin:end] = np.nan
    found, _, said, out = mended(values)
    assert out == [False, True]
    assert "the channel is left out" in said[0]
    assert found.shape == values.shape


def test_too_many_short_gaps_leave_the_channel_out() -> None:
    values = vibration(TIME)
    values[0, ::15] = np.nan
    assert mended(values)[3] == [True, False]


@pytest.mark.parametrize(
    ("gap", "kept"),
    [(slice(0, 40), slice(40, None)), (slice(20, 60), slice(60, None)), (slice(1600, None), slice(0, 1600))],
)
def test_where_nothing_moves_the_recording_is_cut(gap: slice, kept: slice) -> None:
    values = vibration(TIME)
    values[0, gap] = np.nan
    found, first, said, out = mended(values)
    assert not any(out)
    assert first == (kept.start or 0)
    np.testing.assert_array_equal(found, vibration(TIME)[:, kept])
    assert "the recording is cut off there, as nothing moves" in said[0]


def test_the_rest_before_the_release_is_not_cut_away() -> None:
    values = vibration(TIME)
    values[0, 100:150] = np.nan  # 0.2 s of rest would be left
    assert mended(values)[3] == [True, False]


def test_whole_recordings_are_given_back_as_they_are() -> None:
    truth = vibration(TIME)
    found, first, said, out = mended(truth)
    assert found is truth
    assert (first, said, out) == (0, [], [False, False])
    assert fill_short_gaps(truth[0], RATE) is truth[0] or np.array_equal(fill_short_gaps(truth[0], RATE), truth[0])


def test_both_ends_of_the_motion() -> None:
    until, since = find_rest(vibration(TIME), RATE)
    assert 250 <= until < 265  # the release is at 0.5 s
    # The body falls below 3 % of its peak at about 0.5 + ln(33) / 2 = 2.25 s, the wheel, which it also moves, earlier.
    assert 2.0 * RATE < since < 2.5 * RATE
