"""The baseline: the requested model without any further term, fitted to the decays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.analysis.analysis import Analysis
from sprung.analysis.first_term import explaining_term
from sprung.analysis.settling import settle_corrections
from sprung.estimation import CONVERGED, NEAR, FitResult, fit_linear
from sprung.faults import is_explained
from sprung.preprocess import FreeDecay
from sprung.progress import Progress
from sprung.selection import (
    STARTED_LATER,
    ModelSearch,
    ModelStructure,
    choose_structure,
    fit_requested_terms,
    fit_structure,
    from_contact,
    is_ordinary,
    needed_terms,
    or_from_ordinary_vehicle,
    select_roll_axis_height,
)

Real = NDArray[np.float64]


def fit_baseline(run: Analysis, progress: Progress) -> Analysis:
    """Fit the requested model as far as it is linear, and let it tell from where on all tyres are on the ground."""
    requested, structure = structures(run)
    run = replace(run, requested=requested)
    if run.clock_fit is None and run.corrected and run.corrected[-1].candidate.is_explained:
        run = _fit_corrected(run, structure, progress)
    else:
        fit = fit_baseline_model(run, structure, run.prepared.decays, progress)
        search = ModelSearch(structure, fit, run.prepared.decays, (), progress)
        if not (is_ordinary(search) or run.options.start):
            search = or_from_ordinary_vehicle(search)
        search = select_roll_axis_height(search)
        search = fit_requested_terms(search, [term for term in requested.linear_terms if term not in structure.terms])
        last = _best_start(run, from_contact(search), progress)
        is_moved = any(decay.start != before.start for decay, before in zip(last.decays, search.decays, strict=True))
        run = replace(run, search=last, fits=run.fits + 1 + is_moved)
    return run.noted(
        "fit_baseline", described(run.model), f"{run.fit.starts_agreeing} of {run.fit.starts} starts agree"
    )


def _best_start(run: Analysis, search: ModelSearch, progress: Progress) -> ModelSearch:
    """Fit once more from all starts where a push or a bump drove the vehicle.

    The first fit was one of what the recordings alone show to be free: little of it, in which the highest optimum may be
    another one.
    """
    if search.structure.names != structures(run)[1].names or not any(decay.is_driven for decay in search.decays):
        return search
    other = fit_baseline_model(run, search.structure, search.decays, progress)
    return from_contact(replace(search, fit=other)) if other.loglikelihood > search.fit.loglikelihood + NEAR else search


def _fit_corrected(run: Analysis, structure: ModelStructure, progress: Progress) -> Analysis:
    """Fit the corrected campaign with the model and from the fit by which its correction was confirmed."""
    found = run
    # Where a tyre seems to be on the ground too early, the decays begin where the correction explained them; but where a term
    # explains what is left, it shows in the samples before.
    for decays in (run.prepared.decays, begun_no_earlier(run.corrected[-1].candidate.decays, run.prepared.decays)):
        found = replace(run, search=_near_confirmed(run, structure, decays, progress), fits=found.fits)
        # What a model leaves that lacks something says nothing of the numbers of a correction.
        is_noise = is_explained(found.decays, found.fit)
        found = converged(settle_corrections(found) if is_noise else found, progress)
        if _is_explained_but_for_a_term(found):
            break
    return found


def explains_beginnings(run: Analysis, progress: Progress) -> bool:
    """Return whether corrections explain the decays from where they begin in the corrected recordings, but for a linear term.

    Parameters
    ----------
    run
        Restarted with the corrections and preprocessed.
    progress
        Called with each step that begins.
    """
    _, structure = structures(run)
    return _is_explained_but_for_a_term(
        replace(run, search=_near_confirmed(run, structure, run.prepared.decays, progress))
    )


def _is_explained_but_for_a_term(run: Analysis) -> bool:
    """Whether the present fit leaves noise alone, or something that a linear term explains."""
    return is_explained(run.decays, run.fit) or explaining_term(run, "misfit") is not None


def _near_confirmed(
    run: Analysis, structure: ModelStructure, decays: Sequence[FreeDecay], progress: Progress
) -> ModelSearch:
    """Fit decays of the corrected campaign by one step from the fit by which its correction was confirmed.

    Terms that were in that model stay if its fit needs them. One Gauss-Newton step tells from where on the tyres are on the
    ground, and which numbers the corrections then have.
    """
    candidate = run.corrected[-1].candidate
    structure = replace(structure, carried_at=candidate.structure.carried_at)
    terms, tracks = candidate.structure.terms, candidate.structure.tracks
    larger = ModelSearch(structure.with_terms(terms, tracks), candidate.fit, candidate.decays)
    needed = needed_terms(larger)
    smaller = larger
    for term in larger.selected:
        smaller = smaller if term in needed else replace(smaller, structure=smaller.without(term))
    fit = fit_structure(smaller.structure, decays, candidate.fit, NEAR, progress, most=1)
    near = from_contact(ModelSearch(smaller.structure, fit, decays, (), progress), most=1)
    return near.recorded(needed, fitted=True, taken=True)


def begun_no_earlier(others: Sequence[FreeDecay], decays: Sequence[FreeDecay]) -> tuple[FreeDecay, ...]:
    """Let decays begin no earlier than others of the same recordings, those that a correction explains say.

    Parameters
    ----------
    others
        Of some of the recordings.
    decays
        Of them and of further ones, which stay.

    Returns
    -------
    tuple of FreeDecay
    """
    starts = {decay.file: decay.start for decay in others}
    return tuple(decay.shifted(max(decay.samples_to(starts.get(decay.file, decay.start)), 0)) for decay in decays)


def converged(run: Analysis, progress: Progress) -> Analysis:
    """Fit the present model to the present decays until it has converged."""
    search = run.model
    fit = fit_structure(search.structure, search.decays, search.fit, CONVERGED, progress)
    return replace(run, search=replace(search, fit=fit), fits=run.fits + 1)


def structures(run: Analysis) -> tuple[ModelStructure, ModelStructure]:
    """Return the model that is requested, and the one to begin with.

    An engine, say, that no sensor measures is put into a vehicle that is fitted already: nothing determines it before.
    """
    requested = choose_structure(run.campaign, run.options.tracks, run.options.terms)
    baseline = requested.with_terms(tuple(term for term in requested.linear_terms if term not in STARTED_LATER))
    return requested, baseline


def fit_baseline_model(
    run: Analysis, structure: ModelStructure, decays: Sequence[FreeDecay], progress: Progress
) -> FitResult:
    """Fit the model to begin with, from the fit that set the clocks where there is one."""
    return fit_linear(
        decays,
        structure.linear_models,
        structure.sensors,
        structure.known,
        start=None if run.clock_fit is None else run.clock_fit.parameters,
        guess=run.options.start,
        enough=NEAR,
        progress=progress,
    )


def described(search: ModelSearch) -> str:
    """Return the model and how well it fits, in words."""
    terms = ", ".join(search.structure.terms) or "springs and dampers"
    return f"{terms}, half-distances {search.structure.tracks}: log-likelihood {search.fit.loglikelihood:.1f}"
