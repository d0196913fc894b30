"""Suspicion: whether there is reason to look for what is wrong; all that a sound campaign pays for the diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from sprung.campaign import Campaign
from sprung.estimation import FitResult
from sprung.faults.bench import colour_left
from sprung.faults.corners import MATTERS as CORNER_MATTERS
from sprung.faults.corners import Corners, corners
from sprung.faults.fault_scores import FaultScore, score_faults
from sprung.faults.tally import noise_of, tally_of
from sprung.preprocess import FreeDecay

Suspicion = Literal["none", "contradicted", "senseless"]
"""Nothing is wrong; a channel, a place or a drop being otherwise would explain the records better; they are not explained."""

SURE = 25.0
"""Gain in twice the log-likelihood, in units of the inflation, from which chance is no explanation: five standard errors."""

MOST_OF_IT = 0.5
"""Part of what is unexplained that has to be explained."""

MATTERS = {"gain": 0.003, "late": 0.0003, "position": 0.01, "load-position": 0.02, "corner": CORNER_MATTERS}
"""Below this nobody needs to be told: a part, s, m, m and Hz."""

_DISAGREEMENT = 1.3
"""Birge's ratio, squared, from which drops contradict each other."""

_CHANCE = 4.0
"""Standard errors by which a drop may contradict the others by chance."""

_FAR = 4.0
"""Times the others' contradiction from which one drop stands out."""


def suspicious(campaign: Campaign, decays: Sequence[FreeDecay], optimum: FitResult) -> Suspicion:
    """Say whether there is reason to look for what is wrong.

    Parameters
    ----------
    campaign
        The campaign.
    decays
        What was fitted.
    summit
        Where the fit ended.
    """
    noise, tally = noise_of(decays, optimum), tally_of([decay.file for decay in decays], decays, optimum)
    if not tally.explained(noise):
        return "senseless"
    listed, found = _listed(campaign, decays, optimum)
    gain = max((one.gain for one in listed if abs(one.value) > MATTERS[one.kind]), default=0.0)
    colour, enough = max(colour_left(optimum), 1.0), max(SURE, MOST_OF_IT * tally.unexplained(noise))
    # That drops differ has been allowed for in what all corners gain together.
    together = found is not None and found.matter and found.gain > SURE and found.worth > enough
    if (gain > enough and gain > SURE * colour) or together:
        return "contradicted"
    stands_out = optimum.disagreement > _DISAGREEMENT and _stands_out(optimum, colour)
    return "contradicted" if stands_out else "none"


def scores(campaign: Campaign, decays: Sequence[FreeDecay], optimum: FitResult) -> tuple[FaultScore, ...]:
    """List everything that may be a little otherwise, what would gain most first.

    Parameters
    ----------
    campaign, decays, summit
        As for `suspicious`.
    """
    return tuple(sorted(_listed(campaign, decays, optimum)[0], key=lambda one: one.gain, reverse=True))


def _listed(
    campaign: Campaign, decays: Sequence[FreeDecay], optimum: FitResult
) -> tuple[tuple[FaultScore, ...], Corners | None]:
    """List the same, and give the corners of all channels together."""
    loads = {load.name: load for load in campaign.loads}
    listed, found = (
        score_faults(optimum, campaign.sensors, loads, campaign.heights),
        corners(decays, optimum, campaign.sensors),
    )
    return (listed if found is None else (*listed, *found.each())), found


def _stands_out(optimum: FitResult, colour: float) -> bool:
    """Say whether one drop contradicts the others by far more than these each other, and than coloured noise does."""
    squares, directions = optimum.drop_corrections
    *others, most = np.sort(squares).tolist()
    chance = colour * float(np.max(directions + _CHANCE * np.sqrt(2 * directions)))
    return most > chance and bool(others) and most > _FAR * max(float(np.mean(others)), 1.0)
