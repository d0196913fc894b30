"""Thresholds: quantiles of tables, and what grows with what."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.selection import FALSE_ALARM_SHARE, required_gain


@pytest.mark.parametrize(("parameters", "quantile"), [(1, 10.828), (2, 13.816), (4, 18.467), (7, 24.322)])
def test_one_hypothesis_and_few_samples_ask_for_the_tabulated_quantile(parameters: int, quantile: float) -> None:
    """Upper quantiles of chi-square at 0.001 as Abramowitz and Stegun, table 26.8, print them."""
    assert FALSE_ALARM_SHARE == 0.001
    assert required_gain(parameters, 1, 1.0) == pytest.approx(quantile, abs=5e-4)


def test_many_samples_ask_for_the_information_criterion() -> None:
    """Schwarz: the logarithm of the number of samples for each parameter."""
    assert required_gain(4, 12, 1e6) == pytest.approx(4 * np.log(1e6))


def test_more_hypotheses_and_overdispersion_ask_for_more() -> None:
    """Bonferroni divides the share; overdispersion multiplies the threshold and never lowers it."""
    assert required_gain(2, 20, 10.0) > required_gain(2, 2, 10.0)
    assert required_gain(2, 12, 1e4, 3.0) == pytest.approx(3 * required_gain(2, 12, 1e4))
    assert required_gain(2, 12, 1e4, 0.5) == required_gain(2, 12, 1e4)
    assert required_gain(0, 12, 1e4) == required_gain(1, 12, 1e4)


def test_all_hypotheses_together_use_up_the_share_and_no_more() -> None:
    """Independent false hypotheses, each with a gain of chi-square: the share of campaigns in which any is accepted."""
    random, tries = np.random.default_rng(5), 200_000
    gains = random.chisquare(2, size=(tries, 12)).max(axis=1)
    share = float(np.mean(gains > required_gain(2, 12, 1.0)))
    # Three standard errors of the share of so many tries.
    assert share == pytest.approx(FALSE_ALARM_SHARE, abs=3 * np.sqrt(FALSE_ALARM_SHARE / tries))
