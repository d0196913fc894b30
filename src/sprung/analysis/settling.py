"""The numbers of corrections, a gain or a place, where a better fit has them than the one that confirmed them."""

from __future__ import annotations

from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.faults import score_faults_of


def settle_corrections(run: Analysis) -> Analysis:
    """Correct the numbers of earlier corrections to where the scores of the present fit have them.

    They were estimated with a larger model and shorter decays. The decays are corrected as they are; the fit is still that of
    the decays before.
    """
    scores = score_faults_of(run.campaign, run.decays, run.fit) if run.corrected else ()
    settled = {index: found for index, one in enumerate(run.corrected) if (found := one.settled(scores)) is not None}
    if not settled:
        return run
    campaign, decays = run.campaign, run.decays
    corrected = list(run.corrected)
    for index, (better, change) in settled.items():
        campaign = change.of_campaign(campaign)
        decays = change.of_decays(campaign, decays)
        faults = (better.fault if fault == corrected[index].fault else fault for fault in campaign.faults)
        campaign, corrected[index] = replace(campaign, faults=tuple(faults)), better
    search = replace(run.model, structure=replace(run.model.structure, campaign=campaign), decays=decays)
    run = replace(run, campaign=campaign, corrected=tuple(corrected), search=search)
    what = "; ".join(f"{better.fault.where}: {better.fault.what}" for better, _ in settled.values())
    return run.noted("isolate_faults", "the numbers of corrections are settled in the fit of all drops", what)
