"""Fits of one more model term, linear or nonlinear, and of structures that the user requests.

Linear fits are quick and are taken to the end; a nonlinear one ends early where its term does not explain the misfit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sprung.estimation import NEAR, FitResult, fit_linear
from sprung.progress import Step
from sprung.selection.error_budget import MISFIT_LEFT, MISFIT_LEFT_BESIDE
from sprung.selection.linear_terms import ENGINE
from sprung.selection.ordinary_vehicle import (
    ITERATIONS,
    fit_from_ordinary_vehicle,
    is_ordinary,
    ordinary_vehicle,
    with_usual_scale,
)
from sprung.selection.scoring import WORTH_A_FIT, with_best_start
from sprung.selection.search import ModelSearch
from sprung.selection.starts import fit_structure, has_positive_masses, neutral_values, start_values
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.selection.usual_terms import likeliest_or_ordinary
from sprung.uncertainty import KnownValue

_STEPS_FROM_BELOW = 3
"""Iterations after which the gain of a term is expected whose first step ended below the fit without it."""

_FIRST_ITERATIONS = 8
"""Iterations after which a nonlinear fit has to have explained some of the misfit."""

_ITERATIONS_OF_SWITCH = 1
"""Iterations after a change without a parameter, which hardly moves the optimum: one Newton step tells what it gains."""


def fit_requested_terms(search: ModelSearch, terms: Sequence[str]) -> ModelSearch:
    """Fit linear terms that the user requests, whatever they gain.

    Parameters
    ----------
    search
        The present model and its fit.
    terms
        To be fitted, one after the other.

    Returns
    -------
    ModelSearch
    """
    for term in terms:
        search = fit_term(search, term)
    return search


def fit_forced_terms(search: ModelSearch, requested: ModelStructure) -> ModelSearch:
    """Fit the structure that the user requests, whatever it gains.

    Parameters
    ----------
    search
        The present model and its fit.
    requested
        The structure.

    Returns
    -------
    ModelSearch

    Notes
    -----
    Where a linear vehicle does not explain the records, its fit has shifted mass between body and wheels, and a fit with
    nonlinear terms does not come back from there. It therefore begins also from one whose wheels have kept their masses, and
    from an ordinary vehicle.
    """
    larger = search.structure.with_terms(requested.terms)
    if search.has_model_error:
        begins = (search, _begin_with_held_wheels(search, larger))
        tried = [begin.refit(larger, _FIRST_ITERATIONS, beginning_only=True) for begin in begins]
        search = likeliest_or_ordinary(search, tried, larger)
    return select_gravity_leakage(search.refit(larger))


def _begin_with_held_wheels(search: ModelSearch, larger: ModelStructure) -> ModelSearch:
    """Fit a larger structure from an ordinary vehicle, with the wheels' masses held at their stated or usual values.

    The linear vehicle is fitted first, and then the larger structure to the beginnings of the decays.
    """
    values, _ = ordinary_vehicle(larger)
    wheels = {name: KnownValue(values[name]) for name in larger.names if name.startswith("m_u")}
    linear, held = (replace(one, known={**one.known, **wheels}) for one in (search.structure, larger))
    fit = fit_linear(
        search.decays, linear.linear_models, linear.sensors, linear.known, start=values, enough=NEAR, most=ITERATIONS
    )
    begin = replace(search, structure=linear, fit=fit.after(search.fit))
    return begin.refit(held, _FIRST_ITERATIONS, beginning_only=True)


def fit_term(search: ModelSearch, term: str) -> ModelSearch:
    """Fit a linear term, from where it is expected to gain most.

    Parameters
    ----------
    search
        The present model and its fit.
    term
        To be fitted.

    Returns
    -------
    ModelSearch
    """
    return fit_linear_term(with_best_start(search, term), term)


def take_first_step(search: ModelSearch, term: str) -> tuple[ModelSearch, float]:
    """Take the first Newton step towards one more linear term, and return what the whole fit may gain at the most.

    Near the neutral values twice the log-likelihood is quadratic: the step gains what the score test says, and no more is
    expected after it. What begins at a usual value may begin below the fit without it: some more steps then tell. A new
    engine is far from anything: nothing follows from a few steps.
    """
    if term == ENGINE:
        return search, np.inf
    larger = search.with_terms([term])
    if search.structure.is_nonlinear and TERMS[term].vibrates_by_itself:
        # It begins at a usual size, and the beginnings of the decays show sooner whether that leads anywhere.
        early = begin_nonlinear_fit(search, larger)
        if search.is_better_than(early):
            return replace(search, structure=larger, fit=early), -np.inf
    first = search.refit(larger, most=1)
    # A motion without bounds, or so far from the records that all of it would have to be found anew.
    is_far_off = search.structure.is_nonlinear and search.is_better_than(first.fit)
    if is_far_off or not np.isfinite(first.fit.loglikelihood):
        return first, -np.inf
    if first.fit.loglikelihood < search.fit.loglikelihood:
        first = first.refit(first.structure, most=_STEPS_FROM_BELOW)
    gain = 2 * (first.fit.loglikelihood - search.fit.loglikelihood) + WORTH_A_FIT * first.fit.remaining_gain
    # What the fit so far would still gain by itself is not gained by the term.
    return first, (gain - search.fit.remaining_gain) / search.discount_of(first.fit)


def fit_linear_term(search: ModelSearch, term: str) -> ModelSearch:
    """Fit a model with one more linear term, from where the fit without it ended.

    An engine, without which all may be wrong, is fitted from nothing as well, unless nothing but noise is left; and where much
    is left and the fit without it is a vehicle that nobody would recognise, any term from an ordinary one. What refines a term
    without which that one was led astray begins from other values of it as well.
    """
    search.progress(Step(f"fitting with {term}"))
    larger = search.with_terms([term])
    begins = term != ENGINE or has_positive_masses(larger.linear_models, start_values(larger, search.fit.parameters))
    ends = [search.refit(larger)] if begins else []
    if term == ENGINE and not larger.needs_start and (search.has_model_error or not ends):
        sensors, known = larger.sensors, larger.known
        anew = fit_linear(search.decays, larger.linear_models, sensors, known, enough=NEAR, progress=search.progress)
        ends.append(replace(search, structure=larger, fit=anew.after(search.fit)))
    if (of_refined := TERMS[term].of_refined) is not None:
        own = start_values(larger, search.fit.parameters)
        start = own | {name: value for name, value in of_refined(own, larger).items() if name in own}
        fit = fit_structure(larger, search.decays, search.fit, NEAR, search.progress, start=start)
        ends.append(replace(search, structure=larger, fit=fit))
    if search.is_misfit_large and not is_ordinary(search):
        ends.append(fit_from_ordinary_vehicle(search, larger))
    return max(ends, key=lambda end: (end.fit.converged, end.fit.loglikelihood))


def with_neutral_terms(search: ModelSearch, terms: Sequence[str]) -> ModelSearch:
    """Return the model with more terms where its fit has ended, these doing nothing.

    Parameters
    ----------
    search
        A model and its fit.
    terms
        What it has not.

    Returns
    -------
    ModelSearch
    """
    larger = search.with_terms(terms)
    neutral = neutral_values(larger, search.fit.parameters)
    fit = fit_structure(larger, search.decays, search.fit, NEAR, search.progress, most=0, start=neutral)
    return replace(search, structure=larger, fit=fit)


def begin_nonlinear_fit(search: ModelSearch, larger: ModelStructure) -> FitResult:
    """Take the first steps of the fit of a nonlinear model to the beginnings of the decays, until they tell models apart."""
    return fit_structure(
        larger,
        search.decays,
        search.fit,
        _enough_to_compare(search),
        search.progress,
        beginning_only=True,
        most=_FIRST_ITERATIONS,
        start=start_values(larger, with_usual_scale(search)),
    )


def _enough_to_compare(search: ModelSearch) -> float:
    """Return the expected gain in log-likelihood at which a fit to beginnings ends: what is left tells no models apart."""
    return max(NEAR, search.overdispersion)


def fit_nonlinear_term(search: ModelSearch, larger: ModelStructure, first: FitResult) -> ModelSearch | None:
    """Fit a nonlinear model whose fit has begun; None where it leaves too much of the misfit.

    Where it does, the linear fit may have gone too far astray to begin from: the wheels then keep their masses at first.
    """
    if search.is_misfit_large and not search.structure.is_nonlinear and search.leaves_most(first):
        held = begin_nonlinear_fit(_begin_with_held_wheels(search, larger), larger)
        first = max(first, held, key=lambda fit: fit.loglikelihood)
    if search.leaves_most(first):
        return None
    if not (first.converged or search.lacks_something) and search.is_better_than(first):
        return None  # on the way from a usual size to none
    if not first.converged:
        enough = _enough_to_compare(search)
        first = fit_structure(larger, search.decays, first, enough, search.progress, beginning_only=True)
    if search.is_better_than(first):
        return None
    if not search.structure.is_nonlinear and search.leaves_misfit(first, MISFIT_LEFT):
        larger, first = _refined(search, larger, first)
        if search.leaves_misfit(first, MISFIT_LEFT):
            return None
    if not search.structure.is_nonlinear:
        found = replace(search, fit=first).refit(larger)
        # A motion that stays within bounds for a while may not do so in whole decays.
        return found if np.isfinite(found.fit.loglikelihood) else None
    early = replace(search, fit=first).refit(larger, most=_STEPS_FROM_BELOW)
    # What helped the beginnings a little may grow without bounds later, as a branch with a rate below zero does.
    return None if search.is_better_than(early.fit) else early.refit(larger)


def _refined(search: ModelSearch, larger: ModelStructure, first: FitResult) -> tuple[ModelStructure, FitResult]:
    """Return a nonlinear model that explains most of the misfit with what refines it: the likeliest, fitted to beginnings."""
    if search.leaves_misfit(first, MISFIT_LEFT_BESIDE):
        return larger, first
    added = {*larger.terms} - {*search.structure.terms}
    beside = replace(search, structure=larger)
    refining = [term for term in beside.open_terms(tuple(TERMS)) if TERMS[term].refines in added]
    models = [beside.with_terms([term]) for term in refining]
    fits = [
        fit_structure(one, search.decays, first, NEAR, search.progress, beginning_only=True, most=_FIRST_ITERATIONS)
        for one in models
    ]
    return max([(larger, first), *zip(models, fits, strict=True)], key=lambda pair: pair[1].loglikelihood)


def select_roll_axis_height(search: ModelSearch) -> ModelSearch:
    """Return the search with the body carried at the height that fits better, where two heights are known.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    ModelSearch
    """
    if not search.structure.heights.is_ambiguous:
        return search
    other = search.refit(replace(search.structure, carried_at="roll axis"))
    return other if other.fit.loglikelihood > search.fit.loglikelihood else search


def select_gravity_leakage(search: ModelSearch) -> ModelSearch:
    """Return the search with sensors that feel less of gravity where the body turns, if the recordings support it.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    ModelSearch
    """
    # The body turns most in the beginnings. Any step gains in them, with leakage or without.
    same, other = (
        search.refit(
            replace(search.structure, gravity_leakage=leaks), _ITERATIONS_OF_SWITCH, beginning_only=True, enough=NEAR
        )
        for leaks in (False, True)
    )
    return other.refit(other.structure) if other.gain_over(same) > search.required_of_switch else search
