"""Consistency test: whether a fit gives reason to look for faults. All that a sound campaign pays for the isolation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from sprung.campaign import Campaign
from sprung.estimation import FitResult
from sprung.faults.fault_scores import HYPOTHESES, FaultScore, score_faults
from sprung.faults.high_pass import NEGLIGIBLE as NEGLIGIBLE_CORNER
from sprung.faults.high_pass import CornerScores, score_corners
from sprung.faults.residual_table import reference_noise, residual_table
from sprung.preprocess import FreeDecay
from sprung.selection import required_gain

Consistency = Literal["consistent", "inconsistent", "misfit"]
"""The fit agrees with the recordings; a fault of small size would improve it significantly; it does not describe them."""

SIGNIFICANT = required_gain(1, HYPOTHESES, 1.0)
"""Gain in twice the log-likelihood, in units of the overdispersion, that a fault needs by the error budget: 24.7."""

SHARE = 0.5
"""Share of a misfit that a hypothesis has to explain."""

NEGLIGIBLE = {"gain": 0.003, "late": 0.0003, "position": 0.01, "load-position": 0.02, "corner": NEGLIGIBLE_CORNER}
"""Size below which a fault is not reported: a relative gain, s, m, m and Hz."""

_DISAGREEMENT = 1.3
"""Birge ratio, squared, from which drops contradict each other."""

_CHANCE = 4.0
"""Standard errors by which a drop may contradict the others by chance."""

_OUTSTANDING = 4.0
"""Ratio to the contradiction of the other drops from which one drop stands out."""


def consistency_of(campaign: Campaign, decays: Sequence[FreeDecay], fit: FitResult) -> Consistency:
    """Test whether a fit gives reason to look for faults.

    Parameters
    ----------
    campaign
        The campaign.
    decays
        What was fitted.
    fit
        Where that ended.

    Returns
    -------
    Consistency
    """
    noise, table = reference_noise(decays, fit), residual_table([decay.file for decay in decays], decays, fit)
    if not table.is_explained(noise):
        return "misfit"
    scores, corners = _scores(campaign, decays, fit)
    relevant = [score for score in scores if abs(score.value) > NEGLIGIBLE[score.kind]]
    gain = max((score.gain for score in relevant if not score.is_beyond_prior), default=0.0)
    # What the residuals would gain says nothing of a sensor that is further off than is stated.
    is_far_off = any(score.is_beyond_prior and score.gain > score.required for score in relevant)
    correlation = float(fit.autocorrelation_inflation.max())
    required = max(SIGNIFICANT, SHARE * table.misfit(noise))
    # That drops differ has been allowed for in what all corners gain together.
    together = (
        corners is not None and corners.is_relevant and corners.gain > SIGNIFICANT and corners.raw_gain > required
    )
    if (gain > required and gain > SIGNIFICANT * correlation) or together or is_far_off or _is_statement_missed(fit):
        return "inconsistent"
    stands_out = fit.disagreement > _DISAGREEMENT and _one_drop_stands_out(fit, correlation)
    return "inconsistent" if stands_out else "consistent"


def score_faults_of(campaign: Campaign, decays: Sequence[FreeDecay], fit: FitResult) -> tuple[FaultScore, ...]:
    """Return the scores of all faults of small size, the largest gain first.

    Parameters
    ----------
    campaign, decays, fit
        As for `consistency_of`.

    Returns
    -------
    tuple of FaultScore
    """
    return tuple(sorted(_scores(campaign, decays, fit)[0], key=lambda score: score.gain, reverse=True))


def largest_expected_gain(campaign: Campaign, decays: Sequence[FreeDecay], fit: FitResult) -> float:
    """Return the gain in twice the log-likelihood by the likeliest fault of small size, all corners together being one.

    Parameters
    ----------
    campaign, decays, fit
        As for `consistency_of`.

    Returns
    -------
    float
        0 where nothing is indicated.
    """
    scores, corners = _scores(campaign, decays, fit)
    return max([0.0 if corners is None else corners.raw_gain, *(score.gain for score in scores)])


def _scores(
    campaign: Campaign, decays: Sequence[FreeDecay], fit: FitResult
) -> tuple[tuple[FaultScore, ...], CornerScores | None]:
    """Return the scores of all faults, and those of all corners together."""
    loads = {load.name: load for load in campaign.loads}
    scores, corners = (
        score_faults(fit, campaign.sensors, loads, campaign.heights),
        score_corners(decays, fit, campaign.sensors),
    )
    return (scores if corners is None else (*scores, *corners.single())), corners


def _is_statement_missed(fit: FitResult) -> bool:
    """Whether the fit misses a known quantity by more than chance, however little that leaves in the residuals."""
    missed = fit.problem.conflicts(fit.iterate, fit.overdispersion)
    return max((size**2 for size in missed.values()), default=0.0) > SIGNIFICANT


def _one_drop_stands_out(fit: FitResult, correlation: float) -> bool:
    """Whether one drop contradicts the others by far more than these each other, and than autocorrelated noise does."""
    squares, directions = fit.drop_corrections
    *others, largest = np.sort(squares).tolist()
    chance = correlation * float(np.max(directions + _CHANCE * np.sqrt(2 * directions)))
    return largest > chance and bool(others) and largest > _OUTSTANDING * max(float(np.mean(others)), 1.0)
