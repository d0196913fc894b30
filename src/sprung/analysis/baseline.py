"""The baseline: the requested model without any further term, fitted to the decays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.analysis.analysis import Analysis
from sprung.estimation import CONVERGED, NEAR, FitResult, fit_from_contact, fit_linear
from sprung.preprocess import FreeDecay
from sprung.progress import Progress
from sprung.selection import (
    ENGINE,
    ModelSearch,
    ModelStructure,
    choose_structure,
    fit_requested_terms,
    fit_structure,
    select_roll_axis_height,
)


def fit_baseline(run: Analysis, progress: Progress) -> Analysis:
    """Fit the requested model as far as it is linear, and let it tell from where on all tyres are on the ground."""
    requested, structure = structures(run)
    fit = fit_baseline_model(run, run.prepared.decays, progress)
    search = select_roll_axis_height(ModelSearch(structure, fit, run.prepared.decays, (), progress))
    search = fit_requested_terms(search, [term for term in requested.linear_terms if term not in structure.terms])
    converged = from_contact(search)
    is_moved = any(decay.start != before.start for decay, before in zip(converged.decays, search.decays, strict=True))
    run = replace(run, requested=requested, search=converged, fits=run.fits + 1 + is_moved)
    return run.noted(
        "fit_baseline", described(run.model), f"{run.fit.starts_agreeing} of {run.fit.starts} starts agree"
    )


def structures(run: Analysis) -> tuple[ModelStructure, ModelStructure]:
    """Return the model that is requested, and the one to begin with.

    An engine that no sensor measures is put into a vehicle that is fitted already: nothing determines it before.
    """
    requested = choose_structure(run.campaign, run.options.tracks, run.options.terms)
    baseline = requested.with_terms(tuple(term for term in requested.linear_terms if term != ENGINE))
    return requested, baseline


def fit_baseline_model(run: Analysis, decays: Sequence[FreeDecay], progress: Progress) -> FitResult:
    """Fit the model to begin with, from the fit that set the clocks where there is one."""
    _, structure = structures(run)
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


def from_contact(search: ModelSearch) -> ModelSearch:
    """Let every decay begin where all tyres of the fitted vehicle stay on the ground, and fit to convergence."""
    decays, fit = fit_from_contact(
        search.decays,
        search.structure.linear_models,
        search.fit,
        lambda decays, fit, states: fit_structure(search.structure, decays, fit, CONVERGED, search.progress, states),
    )
    return replace(search, decays=decays, fit=fit)


def described(search: ModelSearch) -> str:
    """Return the model and how well it fits, in words."""
    terms = ", ".join(search.structure.terms) or "springs and dampers"
    return f"{terms}, half-distances {search.structure.tracks}: log-likelihood {search.fit.loglikelihood:.1f}"
