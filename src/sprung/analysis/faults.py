"""The stages in which faults are isolated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.analysis.analysis import MOST_RESTARTS, Analysis
from sprung.campaign import Campaign
from sprung.faults import (
    FaultIsolation,
    Hypothesis,
    Isolated,
    consistency_of,
    decays_without_wheel_sensors,
    isolate,
)
from sprung.progress import Progress, Step


def isolate_evident_faults(run: Analysis, progress: Progress) -> Analysis:
    """Correct what explains the recordings wholly, before any further model term is tried."""
    run = _with_isolated(run, progress)
    found = _found(run)
    if found is None or not found.is_explained or any(one.remedy == "named" for one in found.hypotheses):
        return run
    return _corrected(run, found.hypotheses, "isolate_evident_faults")


def isolate_faults(run: Analysis, progress: Progress) -> Analysis:
    """Correct what explains much of what no model term explains; what is ambiguous is only named."""
    run = _with_isolated(run, progress)
    found = _found(run)
    if found is None or not found.hypotheses:
        return run
    named = tuple(one.fault for one in found.hypotheses if one.remedy == "named")
    run = replace(run, suspected=tuple(dict.fromkeys((*run.suspected, *named))))
    for fault in named:
        run = run.noted("isolate_faults", f"suspected {fault.code} of {fault.where}", fault.what)
    corrected = [one for one in found.hypotheses if one.remedy != "named"]
    return _corrected(run, corrected, "isolate_faults") if corrected else run


def _found(run: Analysis) -> Isolated | None:
    """Return what was isolated in the present fit."""
    return run.isolated[1] if run.isolated is not None and run.isolated[0] is run.fit else None


def _with_isolated(run: Analysis, progress: Progress) -> Analysis:
    """Look for faults in the present fit, unless that was done, or corrected often enough."""
    if len(run.corrected) >= MOST_RESTARTS or (run.isolated is not None and run.isolated[0] is run.fit):
        return run
    consistency = consistency_of(run.campaign, run.decays, run.fit)
    if consistency == "consistent":
        checked = replace(run, isolated=(run.fit, None))
        return checked.noted("isolate_faults", "no fault is indicated", "the residuals are consistent with the model")
    progress(Step("isolating faults"))
    found, fits = isolate(_isolation(run), progress), 1
    fits += found.fits
    if consistency == "misfit" and not found.is_explained:
        # A wheel sensor at fault may have shown a wrong landing, and the decays begin too early.
        decays = decays_without_wheel_sensors(run.campaign, run.prepared.decays)
        run = replace(run, preparations=run.preparations + 1)
        starts = [decay.start for decay in run.decays]
        if [decay.start for decay in decays] != starts:
            later = isolate(FaultIsolation.of(run.campaign, decays, None, *_model(run)), progress)
            fits += later.fits + 1
            found = later if later.is_explained or not found.hypotheses else found
    run = replace(run, isolated=(run.fit, found), fits=run.fits + fits)
    faults = ", ".join(f"{one.fault.code} of {one.fault.where}" for one in found.hypotheses) or "nothing"
    explained = "explains the recordings" if found.is_explained else "does not explain the recordings wholly"
    return run.noted("isolate_faults", f"{consistency}: {faults} {explained}", f"{fits} fits")


def _isolation(run: Analysis) -> FaultIsolation:
    tracks, terms = _model(run)
    structure = run.model.structure
    is_same = not structure.is_time_stepped and tracks == structure.tracks
    return FaultIsolation.of(run.campaign, run.decays, run.fit if is_same else None, tracks, terms)


def _model(run: Analysis):  # type: ignore[no-untyped-def]
    """Return tracks and terms with which faults are isolated: the larger of the models that are open."""
    structure = run.model.structure
    return ("separate" if structure.tracks_open else structure.tracks), structure.linear_terms


def _corrected(run: Analysis, hypotheses: Sequence[Hypothesis], stage: str) -> Analysis:
    """Restart with what is wrong corrected or left out, and named."""
    campaign: Campaign = run.campaign
    for hypothesis in hypotheses:
        if hypothesis.recording is None:  # a drop that is left out stays in the campaign, with its reason
            campaign = hypothesis.correction.of_campaign(campaign)
            campaign = replace(campaign, faults=(*campaign.faults, hypothesis.fault))
    why = "; ".join(f"{one.fault.where}: {one.fault.what}" for one in hypotheses)
    return run.restart(campaign, hypotheses, stage, why)
