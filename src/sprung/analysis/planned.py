"""What was fitted as a test: what planning adds further drops to."""

from __future__ import annotations

import numpy as np

from sprung.analysis.stand import Fitted
from sprung.planning import PlannedDrop, PlannedTest, campaign_of_fit, subject_of_fit
from sprung.simulation import DEFAULT_HEIGHT
from sprung.vehicle import LOAD_MASS, parameter_names

_BEFORE_DECAY = 0.1
"""s from the release to the decay in a usual drop, for planning further ones."""


def to_design(fitted: Fitted) -> PlannedTest:
    """Take what was fitted as a test to which others may be added, of the vehicle that was found as far as it is linear."""
    campaign, decays = fitted.campaign, fitted.prepared.decays
    choice = fitted.choice.with_terms(fitted.choice.linear_terms)
    fit = fitted.fit.only(parameter_names(choice.tracks, choice.terms))
    subject = subject_of_fit(
        fit,
        choice.tracks,
        choice.terms,
        {name: one for name, one in choice.known.items() if not name.startswith(LOAD_MASS)},
        campaign.sensors,
        rate=float(np.median([decay.rate for decay in decays])),
        duration=_BEFORE_DECAY + float(np.median([decay.samples / decay.rate for decay in decays])),
        heights=choice.heights,
        name=campaign.name,
    )
    used = {decay.file for decay in decays}
    dropped = [
        PlannedDrop(campaign.load(seen.drop.load), seen.wheels, seen.drop.height or DEFAULT_HEIGHT)
        for seen in fitted.prepared.seen
        if seen.recording.name in used
    ]
    return campaign_of_fit(subject, fit, dropped)
