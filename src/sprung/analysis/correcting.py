"""The way back: a restart with what is wrong corrected or left out, and named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.campaign import Campaign
from sprung.faults import Hypothesis


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
    campaign: Campaign = run.campaign
    for hypothesis in hypotheses:
        if hypothesis.recording is None:  # a drop that is left out stays in the campaign, with its reason
            campaign = hypothesis.correction.of_campaign(campaign)
            campaign = replace(campaign, faults=(*campaign.faults, hypothesis.fault))
    why = "; ".join(f"{one.fault.where}: {one.fault.what}" for one in hypotheses)
    return run.restart(campaign, hypotheses, stage, why)
