"""The loggers' low-pass: against its analytic response, free decays of a filter, and recordings that passed one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter, lfilter_zi

from sprung.estimation import LowPass, SampledLowPass, unexplained_squares

RATE = 500.0
LOGGER = LowPass(80.0, 4)


@pytest.mark.parametrize(("order", "frequency"), [(1, 2.0), (2, 12.0), (4, 1.5), (4, 30.0), (4, 80.0), (4, 150.0)])
def test_signals_pass_it_as_its_response_says(order: int, frequency: float) -> None:
    low_pass = LowPass(80.0, order)
    sampled = SampledLowPass.of(low_pass, 1000.0)
    time = np.arange(2000) / 1000
    found = sampled.filtered(np.sin(2 * np.pi * frequency * time)[None])[0]
    response = low_pass.response(np.array([2j * np.pi * frequency]))[0]
    expected = abs(response) * np.sin(2 * np.pi * frequency * (time + sampled.lag / 1000) + np.angle(response))
    # The numerator has one coefficient more than the order, by least squares up to 400 Hz: what is left falls with the order.
    np.testing.assert_allclose(found[300:-50], expected[300:-50], atol={1: 5e-3, 2: 1e-3, 4: 2e-4}[order])
    assert sampled.lag == round(low_pass.delay * 1000)


@pytest.mark.parametrize("corner", [60.0, 90.0, 100.0, 125.0, 160.0, 250.0])
def test_slow_motions_come_later_by_what_is_left_of_its_delay(corner: float) -> None:
    """Of 1 Hz; the delay of a fourth order at 60 Hz is 3.47 samples: 0.47 beyond the lag of 3 are left.

    The numerator is fitted to 3e-4 of its response.
    """
    sampled, time = SampledLowPass.of(LowPass(corner, 4), RATE), np.arange(1000) / RATE
    found = sampled.filtered(np.sin(2 * np.pi * time)[None])[0]
    np.testing.assert_allclose(found[200:-20], np.sin(2 * np.pi * (time - sampled.remaining_delay))[200:-20], atol=5e-4)
    assert abs(sampled.remaining_delay) <= 0.5 / RATE


@pytest.mark.parametrize(("finer", "samples"), [(1, 200), (3, 20), (4, 129)])
def test_samples_of_what_is_sampled_faster_are_those_behind_the_filter(finer: int, samples: int) -> None:
    """Against SciPy's filter at the higher rate; blocks of samples that the signal fills and that it does not."""
    sampled, fast = SampledLowPass.of(LOGGER, RATE), SampledLowPass.of(LOGGER, finer * RATE)
    signals = np.random.default_rng(2).standard_normal((2, 3, finer * (samples - 1) + 1)).cumsum(axis=-1)
    numerator, denominator = fast.coefficients
    at_rest = lfilter_zi(numerator, denominator) * signals[..., :1]
    expected = lfilter(numerator, denominator, signals, axis=-1, zi=at_rest)[0][..., ::finer]
    found = sampled.filtered(signals, finer)
    np.testing.assert_allclose(found[..., : -sampled.lag], expected[..., sampled.lag :], atol=1e-11)
    np.testing.assert_array_equal(found[..., -sampled.lag :], 0.0)


def test_what_it_remembers_of_earlier_motions_is_free() -> None:
    """Whatever state a filter begins with, its decay is a sum of the free signals, and so is an offset."""
    sampled = SampledLowPass.of(LOGGER, RATE)
    state = np.random.default_rng(3).standard_normal(4)
    decay = lfilter(*sampled.coefficients, np.zeros(300 + sampled.lag), zi=state)[0][sampled.lag :] + 0.7
    free = sampled.free_signals(300 + sampled.lag)
    np.testing.assert_allclose(free.T @ free, np.eye(free.shape[1]), atol=1e-12)
    np.testing.assert_array_equal(free[300:], 0.0)
    np.testing.assert_allclose(free[:300] @ (free[:300].T @ decay), decay, atol=1e-9)


def test_a_signal_that_did_not_pass_it_may_be_given_the_same_freedom() -> None:
    passed, free = (SampledLowPass.of(LowPass(80.0, 4, passes_all), RATE) for passes_all in (False, True))
    signal = np.random.default_rng(5).standard_normal((2, 60))
    np.testing.assert_array_equal(free.filtered(signal)[:, : -free.lag], signal[:, : -free.lag])
    np.testing.assert_array_equal(free.filtered(signal)[:, -free.lag :], 0.0)
    np.testing.assert_array_equal(free.free_signals(60), passed.free_signals(60))
    assert (free.lag, free.remaining_delay) == (passed.lag, 0.0)


def test_above_the_samples_it_does_nothing() -> None:
    signals = np.random.default_rng(1).standard_normal((2, 50))
    for low_pass in (None, LowPass(410.0, 4)):
        sampled = SampledLowPass.of(low_pass, RATE)
        assert sampled.filtered(signals) is signals
        np.testing.assert_allclose(sampled.free_signals(50), np.full((50, 1), 50**-0.5))


def test_left_out_channels_have_no_squares() -> None:
    residual = np.vstack([np.ones(100) + np.eye(1, 100, 50)[0], np.full(100, np.nan)])
    squares, samples = unexplained_squares([residual, residual], [RATE, RATE], None)
    np.testing.assert_allclose(squares, [2 * 0.99, 0.0])
    np.testing.assert_array_equal(samples, [200, 0])
