"""The way back: a restart with what is wrong corrected or left out, and named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.campaign import Campaign
from sprung.faults import Hypothesis


def corrected_campaign(campaign: Campaign, hypotheses: Sequence[Hypothesis]) -> Campaign:
    """Return a campaign with what is wrong corrected, and named; a drop that is left out stays in it, with its reason."""
    for one in hypotheses:
        if one.recording is None:
            campaign = one.correction.of_campaign(campaign)
            campaign = replace(campaign, faults=(*campaign.faults, one.fault))
    return campaign


def restart_corrected(run: Analysis, hypotheses: Sequence[Hypothesis], stage: str) -> Analysis:
    """Restart with what is wrong corrected or left out, and named.

    Parameters
    ----------
    run
        The analysis so far.
    hypotheses
        What is wrong.
    stage
        Which stage returns.

    Returns
    -------
    Analysis
        At its first stage.
    """
    campaign = corrected_campaign(run.campaign, hypotheses)
    why = "; ".join(f"{one.fault.where}: {one.fault.what}" for one in hypotheses)
    return run.restart(campaign, hypotheses, stage, why)
