"""What was fitted as a test: what planning adds further drops to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sprung.analysis.analysis import Analysis
from sprung.preprocess import FreeDecay
from sprung.vehicle import LOAD_MASS, parameter_names

if TYPE_CHECKING:
    from sprung.planning import PlannedTest

_BEFORE_DECAY = 0.1
"""s from the release to the decay in a usual drop, for planning further ones."""

_USUAL = 3.0
"""s that a drop is recorded where none was."""


def to_design(run: Analysis) -> PlannedTest:
    """Return what was fitted as a test to which further drops may be added, of the vehicle as far as it is linear.

    Parameters
    ----------
    run
        A complete analysis.

    Returns
    -------
    PlannedTest
    """
    from sprung.planning import (  # noqa: PLC0415 (only a plan needs it)
        PlannedDrop,
        completed_test,
        setup_from_fit,
    )

    campaign, decays, fitted = run.campaign, run.decays, run.model.structure
    structure = fitted.with_terms(fitted.linear_terms)
    own = parameter_names(structure.tracks, structure.terms, structure.layout)
    fit = run.uncertainty.only((*own, *(name for one in structure.sensors for name in one.uncertainties)))
    setup = setup_from_fit(
        fit,
        structure.tracks,
        structure.terms,
        {name: one for name, one in structure.known.items() if not name.startswith(LOAD_MASS)},
        structure.sensors,
        rate=float(np.median([decay.rate for decay in decays])),
        duration=_duration(decays),
        heights=structure.heights,
        name=campaign.name,
    )
    used = {decay.file for decay in decays}
    dropped = [
        PlannedDrop.of(seen.drop, campaign.load(seen.drop.load), seen.wheels)
        for seen in run.prepared.observations
        if seen.recording.name in used and seen.drop.excitation != "pads"
    ]
    return completed_test(setup, fit, dropped)


def _duration(decays: Sequence[FreeDecay]) -> float:
    """Return how long further drops are to be recorded, s: as long as those before, records on pads left out."""
    lengths = [decay.samples / decay.rate for decay in decays if not decay.pads]
    return _BEFORE_DECAY + float(np.median(lengths or [_USUAL]))


def recommend_next_step(run: Analysis) -> str:
    """Recommend what to measure next, in one sentence."""
    from sprung.planning import next_step  # noqa: PLC0415 (only a plan needs it)

    return next_step(to_design(run)).text
