"""How much less than white and agreeing records: against processes whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.estimation.overdispersion import (
    autocorrelation_inflation,
    birge_ratio,
    drop_corrections,
    independent_records,
)


def test_white_residuals_are_left_alone() -> None:
    random = np.random.default_rng(1)
    alarms = 0
    for _ in range(50):
        records = [0.02 * random.standard_normal((8, 1500)) for _ in range(10)]
        alarms += int(np.sum(autocorrelation_inflation(records, [500.0] * 10) > 1))
    assert alarms <= 4  # of 400 channels, at three standard errors one-sided: 0.13 %, 0.5 expected


@pytest.mark.parametrize("time_constant", [0.004, 0.02])
def test_coloured_residuals_are_found_out(time_constant: float) -> None:
    """A first-order process with ρ = exp(-Δt/τ) has a mean with (1 + ρ)/(1 - ρ) times the variance of a white one's."""
    random = np.random.default_rng(2)
    rho = np.exp(-0.002 / time_constant)
    records = []
    for _ in range(10):
        noise = random.standard_normal((2, 1700))
        record = np.zeros_like(noise)
        for k in range(1, 1700):
            record[:, k] = rho * record[:, k - 1] + noise[:, k]
        records.append(record[:, 200:])
    expected = (1 + rho) / (1 - rho)
    # Bartlett's weights over 0.1 s see at least 70 % of it at the longer time constant.
    assert np.all(autocorrelation_inflation(records, [500.0] * 10) == pytest.approx(expected, rel=0.35))


def test_a_channel_left_out_counts_nothing() -> None:
    random = np.random.default_rng(3)
    record = np.repeat(random.standard_normal((2, 300)), 5, axis=1)
    record[1] = np.nan
    colour = autocorrelation_inflation([record], [500.0])
    assert colour[0] > 3
    assert colour[1] == 1.0


def repeated(part: float, mirrored: bool = False, alike: bool = True) -> float:
    """Six drops, three of each of two motions, that repeat a part of the variance of what the model leaves."""
    random = np.random.default_rng(4)
    motions, errors = random.standard_normal((2, 2, 4, 1500))
    sign = [1.0, -1.0 if mirrored else 1.0, 1.0]
    residuals, modelled = [], []
    for motion, error in zip(motions, errors, strict=True):
        for one in sign:
            own = random.standard_normal((4, 1500))
            residuals.append(one * np.sqrt(part) * error + np.sqrt(1 - part) * own)
            modelled.append(one * motion if alike else random.standard_normal((4, 1500)))
    return independent_records(residuals, modelled, np.ones(4), 1.0)


@pytest.mark.parametrize("mirrored", [False, True])
def test_drops_that_repeat_each_other_count_as_one(mirrored: bool) -> None:
    """An error common to n of N drops adds up: their mean has (1 + (n - 1) ρ) times the variance of independent ones'."""
    assert repeated(1.0, mirrored) == pytest.approx(2.0)
    assert repeated(0.5, mirrored) == pytest.approx(6 / (1 + 2 * 0.5), rel=0.03)


def test_drops_that_repeat_nothing_count_each() -> None:
    assert repeated(0.0) == pytest.approx(6.0, rel=0.01)
    assert repeated(1.0, alike=False) == pytest.approx(6.0, rel=0.2)  # motions alike by chance, to 1/√6000


def simulated(drops: int, excess: float, seed: int, repeats: int = 1) -> float:
    """Scores of drops whose own estimates scatter with `excess` times their information's variance, centred jointly.

    Each is there so many times.
    """
    random = np.random.default_rng(seed)
    informations = []
    for _ in range(drops):
        root = random.standard_normal((6, 6))
        informations.append(root @ root.T)
    own = [random.multivariate_normal(np.zeros(6), excess * np.linalg.inv(F)) for F in informations]
    informations, own = repeats * informations, repeats * own
    joint = np.linalg.solve(sum(informations), sum(F @ x for F, x in zip(informations, own, strict=True)))
    scores = np.array([F @ (x - joint) for F, x in zip(informations, own, strict=True)])
    return birge_ratio(scores, np.array(informations), 1 / repeats)


def test_agreeing_drops_are_left_alone() -> None:
    assert sum(simulated(10, 1.0, seed) > 1 for seed in range(100)) <= 3


def test_drops_that_disagree_give_their_ratio_away() -> None:
    assert np.mean([simulated(10, 4.0, seed) for seed in range(50)]) == pytest.approx(4.0, rel=0.1)


def test_drops_that_are_there_three_times_disagree_three_times_as_much() -> None:
    """The mean of n drops that were each counted m times has m times the variance that it seems to have."""
    assert np.mean([simulated(10, 4.0, seed, 3) for seed in range(50)]) == pytest.approx(3 * 4.0, rel=0.1)


def test_one_drop_cannot_disagree() -> None:
    assert simulated(1, 9.0, 1) == 1.0


def test_a_drop_whose_motion_runs_away_determines_nothing() -> None:
    """Derivatives overflow: of the other drops the corrections are what they are without it."""
    scores, informations = np.array([[3.0, 0.0], [np.nan, np.nan]]), np.array([np.eye(2), np.full((2, 2), np.nan)])
    squares, directions = drop_corrections(scores, informations)
    assert squares.tolist() == [9.0, 0.0]
    assert directions.tolist() == [2, 0]
