"""A campaign and its fit: what is wrong with it looked for and put right, its model chosen, its drops fitted jointly."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from sprung.analysis.clocks import told_by_flights
from sprung.analysis.flight import fly, is_needed
from sprung.analysis.stand import Fitted, Stand, begun
from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.estimation import CONVERGED, uncertainty_of
from sprung.faults import (
    Bench,
    Hypothesis,
    diagnose,
    examine,
    scores,
    walking_slowly,
    without_looking_at_wheels,
    wrong_statement,
)
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.selection import fit_structure
from sprung.vehicle import Tracks

_DIAGNOSES = 3
"""How many times what is wrong is looked for, each time in what was put right before."""

_SOUND = 10.0
"""Inflation above which a model errs by so much that nothing is to be gained from more samples."""


def fit_campaign(
    campaign: Campaign,
    *,
    tracks: Tracks | None = None,
    extras: Sequence[str] | None = None,
    fall: bool | None = None,
    start: Mapping[str, float] = MappingProxyType({}),
    progress: Progress = silent,
) -> Fitted:
    """Fit a campaign, as `identify` does before it judges; what is wrong with it is put right or left out, and named."""
    progress(Step("comparing the drops with the campaign file"))
    campaign, prepared, undeclared = examine(campaign, progress)

    def begin(mended: Sequence[Hypothesis]) -> Stand:
        return begun(campaign, prepared, tracks, extras, mended, progress, undeclared, start)

    stand, mended = _with_statement(begin(()), begin)
    accused = tuple[Fault, ...]()
    told = _looked_at(stand) if stand.open_to_forces else None
    if told and all(one.remedy != "named" for one in told):
        # Where what is put right leaves nothing to explain, no forces are looked for in what is spoilt.
        other = begin((*mended, *told))
        if other.suspicion == "none":
            stand, mended = other, (*mended, *told)
    stand = stand.with_forces()
    for turn in range(_DIAGNOSES):
        same = turn == 0 and not mended and not stand.way.structure.is_nonlinear
        taken = told if same and told is not None else _looked_at(stand)
        if not taken:
            break
        mended = (*mended, *(one for one in taken if one.remedy != "named"))
        accused = tuple(one.fault for one in taken if one.remedy == "named")
        if len(taken) > len(accused):
            stand = begin(mended).with_forces()
        if accused:
            break
    if any(one.settle is not None for one in mended):
        listed = scores(stand.campaign, stand.way.decays, stand.way.fit)
        mended = tuple(one if one.settle is None else one.settle(listed) for one in mended)
        stand = begin(mended).with_forces()
    accused = (*dict.fromkeys(undeclared.values()), *accused)
    fitted = _with_flights(_with_drifts(stand.judged()._replace(accused=accused)), progress)
    return _with_the_fall(fitted, campaign.model.fall if fall is None else fall, progress)


def _is_sound(fitted: Fitted) -> bool:
    """Say whether more of the same model is worth trying."""
    return fitted.fit.converged and not fitted.accused and fitted.fit.inflation < _SOUND


def _with_flights(fitted: Fitted, progress: Progress) -> Fitted:
    """Use what flights tell of the vehicle that had to tell the clocks of several loggers."""
    if not _is_sound(fitted) or fitted.choice.is_time_stepped:
        return fitted
    told = told_by_flights(
        fitted.campaign,
        fitted.prepared,
        fitted.optimum,
        lambda decays: fit_structure(fitted.choice, decays, fitted.optimum, CONVERGED, progress),
    )
    if told is None:
        return fitted
    decays, optimum = told
    return fitted._replace(
        why=f"{fitted.why}; the flights that determined the clock offsets are fitted too",
        prepared=fitted.prepared._replace(decays=decays),
        optimum=optimum,
        fit=uncertainty_of(optimum),
    )


def _with_the_fall(fitted: Fitted, wanted: bool | None, progress: Progress) -> Fitted:
    """Use the drops from their releases on, where that is wanted or needed, and where it says more."""
    if wanted is False or (wanted is None and not (_is_sound(fitted) and is_needed(fitted.fit))):
        return fitted
    flown = fly(fitted.campaign, fitted.choice, fitted.prepared, fitted.optimum, fitted.fit, progress)
    if flown is None:
        return fitted._replace(why=f"{fitted.why}; the fall before the landing was tried and says nothing more")
    return fitted._replace(
        choice=flown.choice,
        why=f"{fitted.why}; the fall is used too, which makes uncertainties {flown.sharper:.2f} times what they were",
        prepared=fitted.prepared._replace(decays=flown.decays),
        optimum=flown.optimum,
        fit=flown.fit,
    )


def _with_drifts(fitted: Fitted) -> Fitted:
    """Name the channels whose level walks too little to spoil the fit, as far as nobody has."""
    campaign, decays = fitted.campaign, fitted.prepared.decays
    faults = [*campaign.faults, *(fault for decay in decays for fault in decay.faults)]
    said = {fault.where for fault in faults if fault.code == "drift"}
    named = {one.channel for one in campaign.sensors if any(one.channel in where for where in said)}
    more = tuple(one for one in walking_slowly(decays, fitted.optimum, campaign.sensors) if one.where not in named)
    return fitted._replace(campaign=replace(campaign, faults=(*campaign.faults, *more)))


def _with_statement(
    stand: Stand, begin: Callable[[Sequence[Hypothesis]], Stand]
) -> tuple[Stand, tuple[Hypothesis, ...]]:
    """Correct the one statement about loads or masses that leaves nothing suspicious, being otherwise."""
    statement = _wrong_statement(stand)
    if statement is not None and (corrected := begin((statement,))).suspicion == "none":
        return corrected, (statement,)
    return stand, ()


def _wrong_statement(stand: Stand) -> Hypothesis | None:
    """Look for one statement about loads or masses that explains what is not explained, before anything else is tried."""
    if stand.suspicion == "none":
        return None
    stand.way.progress(Step("looking for a wrong statement about loads and masses"))
    return wrong_statement(_bench(stand, stand.prepared.decays))


def _looked_at(stand: Stand) -> tuple[Hypothesis, ...]:
    """Look for what is wrong, where there is reason to, with the larger of the models that are open."""
    suspicion, progress = stand.suspicion, stand.way.progress
    if suspicion == "none":
        return ()
    progress(Step("looking for what is wrong"))
    if suspicion == "contradicted":
        return diagnose(_bench(stand, stand.way.decays), progress)
    # A sensor that tells something wrong may have told the landing wrong. Without any, what is left may be too little.
    safe = _bench(stand, without_looking_at_wheels(stand.campaign, stand.prepared.decays))
    taken = diagnose(safe, progress)
    if safe.base.explained or any(not one.specific and one.fault.code != "drift" for one in taken):
        return diagnose(_bench(stand, stand.prepared.decays), progress) or taken
    return taken


def _bench(stand: Stand, decays: Sequence[FreeDecay]) -> Bench:
    """Return the fit against which faults are looked for, with the larger of the models that are open."""
    choice = stand.way.structure
    return Bench.of(stand.campaign, decays, "separate" if choice.tracks_open else choice.tracks, choice.linear_terms)
