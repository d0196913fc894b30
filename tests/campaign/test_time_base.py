"""Time stamps of loggers against samples whose times are known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from sprung.campaign.time_base import RegularTimeBase, regularise_time_base

Real = NDArray[np.float64]

STEP = 0.002
COUNT = 1800
EVEN: Real = np.linspace(0.0, (COUNT - 1) * STEP, COUNT, dtype=np.float64)


def vibration(time: Real) -> Real:
    """Return a body and a wheel channel, m/s²: bounce at 1.3 Hz, hop at 11 Hz, from 0.5 s on."""
    since = np.maximum(time - 0.5, 0.0)
    body = np.exp(-2.0 * since) * np.sin(2 * np.pi * 1.3 * since)
    hop = np.exp(-12.0 * since) * np.sin(2 * np.pi * 11.0 * since)
    return 9.81 + np.array([8 * body + 0.5 * hop, body + 40 * hop])


def understood(stamps: Real, taken: Real, noise: float = 0.02) -> tuple[RegularTimeBase, Real]:
    """Return what is made of samples, and what they are off, m/s² rms, beside their noise."""
    values = vibration(taken) + noise * np.random.default_rng(1).standard_normal((2, taken.size))
    found = regularise_time_base(stamps, values, "sample {}".format, "a.csv")
    error = found.values - vibration(found.start + np.arange(found.values.shape[1]) / found.rate)
    return found, np.sqrt((error[:, ~found.lost] ** 2).mean(axis=1))


def jitter(part: float) -> Real:
    return np.random.default_rng(2).uniform(-part * STEP, part * STEP, COUNT)


@pytest.mark.parametrize("part", [0.03, 0.15, 0.45])
def test_samples_taken_at_uneven_times_are_interpolated(part: float) -> None:
    times = EVEN + 0.01 + jitter(part)
    found, error = understood(times, times)
    (fault,) = found.faults
    assert fault.code == "clock"
    assert "were interpolated to 500" in fault.what
    assert f"{1e3 * part * STEP:.2g} ms from regular" in fault.what
    assert found.rate == pytest.approx(1 / STEP, rel=1e-4)
    # Taken as even, the wheel would be off by its slope, up to 40 m/s² times 2π 11 Hz, times some ten microseconds to 1 ms.
    assert error.max() < 0.03


@pytest.mark.parametrize("part", [0.03, 0.15, 0.45])
def test_samples_stamped_late_are_even(part: float) -> None:
    found, error = understood(EVEN + jitter(part), EVEN)
    # Stamps that are off by less than a fifth of a step are nobody's business.
    assert len(found.faults) == (part > 0.1)
    assert all("taken as regular, 500" in fault.what for fault in found.faults)
    assert found.values.shape == (2, COUNT)
    assert error.max() < 0.03


def test_what_does_not_move_tells_nothing_and_is_taken_as_even() -> None:
    stamps = EVEN + jitter(0.45)
    values = 9.81 + 0.02 * np.random.default_rng(3).standard_normal((2, COUNT))
    found = regularise_time_base(stamps, values, "sample {}".format, "a.csv")
    np.testing.assert_array_equal(found.values, values)


def packets(size: int) -> Callable[[Real], Real]:
    def stamp(even: Real) -> Real:
        order = np.arange(even.size)
        return (order // size + 1) * size * STEP + (order % size) * 1e-5

    return stamp


def hiccups(even: Real) -> Real:
    """Stamp every tenth sample late by up to nine tenths of a step."""
    random = np.random.default_rng(4)
    late = np.where(random.random(even.size) < 0.1, random.uniform(0, 0.9, even.size), 0.0)
    return even + STEP * late


@pytest.mark.parametrize("stamp", [packets(5), packets(20), hiccups])
def test_stamps_given_packet_by_packet_or_late_now_and_then(stamp: Callable[[Real], Real]) -> None:
    found, error = understood(stamp(EVEN), EVEN)
    assert found.values.shape == (2, COUNT)
    assert found.rate == pytest.approx(1 / STEP, rel=1e-3)
    assert [fault.code for fault in found.faults] == ["clock"]
    np.testing.assert_array_equal(found.values, understood(EVEN, EVEN)[0].values)
    assert np.isfinite(error).all()


@pytest.mark.parametrize("digits", [3, 9])
def test_lost_lines_leave_gaps_of_their_own(digits: int) -> None:
    kept = np.ones(COUNT, dtype=bool)
    kept[[200, 300, 301, 302, 900]] = False
    found, error = understood(EVEN[kept].round(digits), EVEN[kept])
    assert found.values.shape == (2, COUNT)
    np.testing.assert_array_equal(found.lost, ~kept)
    np.testing.assert_array_equal(np.isnan(found.values).all(axis=0), ~kept)
    np.testing.assert_array_equal(found.origin[kept], np.arange(kept.sum()))
    assert "5 of 1800 lines are missing, the first before sample 200" in found.faults[0].what
    assert error.max() < 0.03


@pytest.mark.parametrize(
    ("begin", "end", "start", "last"),
    [(0.1, 0.2, 0.202, 3.598), (1.5, 4.2, 0.0, 1.5), (3.0, 3.1, 0.0, 3.0)],
)
def test_of_two_stretches_the_one_with_the_landing_is_used(begin: float, end: float, start: float, last: float) -> None:
    times = EVEN[(begin >= EVEN) | (end < EVEN)] if end < 3.6 else np.concatenate([EVEN[begin >= EVEN], EVEN + end])
    found, error = understood(times, np.minimum(times, 3.6))
    assert found.start == pytest.approx(start)
    assert found.start + (found.values.shape[1] - 1) / found.rate == pytest.approx(last)
    assert "the logger paused 1 time" in found.faults[0].what
    assert error.max() < 0.03


def test_a_pause_between_release_and_landing_leaves_the_drop_out() -> None:
    kept = (EVEN < 0.502) | (EVEN > 0.53)
    found, _ = understood(EVEN[kept], EVEN[kept])
    assert np.isnan(found.values).all()
    assert "between the release and the landing; the drop is left out" in found.faults[0].what


def test_even_clocks_are_left_alone() -> None:
    values = vibration(EVEN)
    for times in (EVEN, EVEN + 1.7e9, EVEN.round(4), (np.arange(COUNT) / 640).round(3)):
        found = regularise_time_base(times, values, "sample {}".format, "a.csv")
        assert found.values is values
        assert found.faults == ()


def test_lines_lost_are_seen_though_a_step_is_the_last_digit() -> None:
    """A thousand samples a second, stamped in ms: a lost line makes a step as long as one rounded up would be."""
    even = np.arange(COUNT) / 1000.0
    kept = np.delete(np.arange(COUNT), [700, 951, 1702])
    found = regularise_time_base(even[kept], vibration(even[kept]), "sample {}".format, "a.csv")
    assert found.values.shape[1] == COUNT
    assert found.rate == pytest.approx(1000.0)
    assert "3 of 1800 lines are missing, the first before sample 700" in found.faults[0].what
    # Three steps at even distances are what rounding makes of 998.5 samples a second.
    rounded = (np.arange(COUNT) / 998.5).round(3)
    assert regularise_time_base(rounded, vibration(rounded), "sample {}".format, "a.csv").faults == ()
