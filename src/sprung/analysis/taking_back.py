"""Corrections that are taken back: the model with all its terms explains the recordings without them.

What is wrong is isolated beside the model so far. A drop in which most of a missing term shows, or a sensor that feels most of
it, may stand out there from all others, and be healthy.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.analysis.baseline import begun_no_earlier, structures
from sprung.analysis.correcting import corrected_campaign
from sprung.estimation import NEAR
from sprung.faults import Hypothesis, consistency_of
from sprung.preprocess import exclude_drops, prepare
from sprung.progress import Progress, Step, silent
from sprung.selection import fit_structure, from_contact


def take_back_corrections(run: Analysis, progress: Progress) -> Analysis:
    """Use as recorded what was corrected or left out beside a model that lacked what the present one has, and is sound."""
    terms = {*run.model.structure.terms}
    lacked = any(not terms <= {*one.candidate.structure.terms} for one in run.corrected)
    if not lacked or run.model.is_overdispersed or run.refuting or any(decay.clocks for decay in run.decays):
        return run
    progress(Step("fitting the recordings without the corrections"))
    for kept in _fewer(run.corrected):
        again = _with_corrections(run, kept, progress)
        run = replace(run, fits=again.fits, preparations=again.preparations)
        if consistency_of(again.campaign, again.decays, again.fit) == "consistent":
            gone = [one.fault for one in run.corrected if one not in kept]
            what = "; ".join(f"{fault.where}: {fault.what}" for fault in gone)
            return again.noted("take_back_corrections", "the model explains the recordings without", what)
    return run


def _fewer(corrected: Sequence[Hypothesis]) -> Iterator[tuple[Hypothesis, ...]]:
    """Yield fewer corrections: none, as one may have made up for another; then all but those of each place."""
    yield ()
    places = {one.fault.where: None for one in corrected}
    if len(places) > 1:
        yield from (tuple(one for one in corrected if one.fault.where != place) for place in places)


def _with_corrections(run: Analysis, kept: Sequence[Hypothesis], progress: Progress) -> Analysis:
    """Fit the model to the campaign as it is stated, with some corrections."""
    campaign = corrected_campaign(run.stated, kept)
    gone = {one.recording for one in run.corrected if one not in kept}
    excluded = {name: fault for name, fault in run.excluded.items() if name not in gone}
    prepared = exclude_drops(campaign, prepare(campaign, silent), excluded)
    decays = begun_no_earlier(run.decays, prepared.decays)
    _, stated = structures(replace(run, campaign=campaign))
    structure = replace(run.model.structure, campaign=stated.campaign, known=stated.known)
    # Of a drop that was left out nothing is known yet: where it begins follows from the linear vehicle.
    linear = fit_structure(structure.with_terms(structure.linear_terms), decays, run.fit, NEAR, silent, most=0)
    search = replace(run.model, structure=structure, decays=decays, progress=progress)
    return replace(
        run,
        campaign=campaign,
        corrected=tuple(kept),
        excluded=excluded,
        preparation=prepared,
        search=from_contact(search.refit(structure, states=linear.states)),
        isolated=None,
        fits=run.fits + 1,
        preparations=run.preparations + 1,
    )
