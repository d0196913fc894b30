"""The search from the rich end: an ordinary vehicle that has every usual term, of which what is not needed is left out.

A forward search from a model that lacks several terms goes astray: each term that it tries takes up some of what the others
would explain. From a vehicle in which every usual term has its usual size the way to the optimum is short. Usual sizes are weak
priors, so that a term of which the records say little keeps the size that it usually has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sprung.progress import Step
from sprung.selection.backward_elimination import hold_undetermined, leave_out_unneeded
from sprung.selection.contact import from_contact, is_likelier
from sprung.selection.error_budget import MISFIT_LEFT
from sprung.selection.evident_faults import with_evident_fault
from sprung.selection.further_terms import laws_of_part, select_terms_beside
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.ordinary_vehicle import ITERATIONS, fit_from_ordinary_vehicle
from sprung.selection.scoring import most_promising
from sprung.selection.search import ModelSearch
from sprung.selection.several_vehicles import divide_drops, of_group
from sprung.selection.starts import fit_structure
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.selection.unlike_drops import UnlikeDrops
from sprung.selection.usual_terms import (
    begin_with_usual_terms,
    fit_usual_terms,
    open_usual_linear_terms,
    open_usual_terms,
)


def or_with_usual_linear_terms(search: ModelSearch) -> ModelSearch:
    """Return the search with the usual linear terms that are needed, where all of them together explain what it leaves.

    Rubber in different places and tyres that damp hide each other: each alone leaves what is no more like noise than before.

    Parameters
    ----------
    search
        Once the linear terms are decided one after the other.

    Returns
    -------
    ModelSearch
        As given where it leaves noise alone, or they leave more.
    """
    tried = fit_usual_linear_terms(search) if search.is_overdispersed else search
    if tried is search:
        return search
    if search.leaves_misfit(tried.fit, MISFIT_LEFT):
        return search
    tried = from_contact(tried)
    if tried.is_overdispersed or not is_likelier(tried, search):
        return search
    needed, gains = leave_out_unneeded(tried, search)
    return from_contact(needed.recorded(gains, True, True)) if gains else search


def fit_usual_linear_terms(search: ModelSearch) -> ModelSearch:
    """Fit an ordinary vehicle with every usual linear term about which the recordings decide.

    Parameters
    ----------
    search
        The present model and its fit, linear.

    Returns
    -------
    ModelSearch
        As given where there is none.
    """
    usual = open_usual_linear_terms(search.structure)
    if not usual:
        return search
    search.progress(Step(f"fitting an ordinary vehicle with {', '.join(usual)}"))
    return fit_from_ordinary_vehicle(search, search.with_terms(usual))


def begin_from_ordinary_vehicle(search: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Take the first steps of `select_from_ordinary_vehicle`, which show how much of the misfit it may explain.

    Parameters
    ----------
    search
        The present model and its fit.
    plain
        The structure without anything that the recordings brought into it.

    Returns
    -------
    ModelSearch
        As given where no usual term is open.
    """
    rich = _with_usual_terms(search, plain)
    if rich is plain:
        return search
    search.progress(Step("fitting an ordinary vehicle with every usual term"))
    return begin_with_usual_terms(search, rich)


def select_from_ordinary_vehicle(
    search: ModelSearch, plain: ModelStructure, first: ModelSearch | None = None
) -> ModelSearch:
    """Return the search from an ordinary vehicle with every usual term, without those that are not needed.

    Parameters
    ----------
    search
        The present model and its fit.
    plain
        The structure without anything that the recordings brought into it. A body that they show to be flexible stays so.
    first
        The first steps, if they are taken already.

    Returns
    -------
    ModelSearch
        Model and fit as given where the ordinary vehicle explains no more.
    """
    rich = _with_usual_terms(search, plain)
    if rich is plain:
        return search
    first = first or begin_from_ordinary_vehicle(search, plain)
    found = select_beside_usual_terms(search, rich, first)
    is_flexible = not {*search.selected}.isdisjoint(FLEXIBLE_BODIES)
    if is_flexible or not search.seeks_faults or found.fault is not None or found.structure is not search.structure:
        return found
    vehicles = _two_vehicles(search, rich)
    if (one := _one_of_them(search, vehicles)) is not None:
        return _select_beside(found, replace(one, steps=found.steps))
    fault = UnlikeDrops(vehicles[1][0], {}, vehicles[0][0]) if vehicles else None
    return replace(found, fault=fault)


def _with_usual_terms(search: ModelSearch, plain: ModelStructure) -> ModelStructure:
    """Return a structure with every usual term, and the flexible body of the search; as given where none is open."""
    terms = open_usual_terms(plain)
    flexible = tuple(name for name in search.selected if name in FLEXIBLE_BODIES)
    return plain.with_terms((*plain.terms, *flexible, *terms)) if terms else plain


def _two_vehicles(search: ModelSearch, rich: ModelStructure) -> list[tuple[tuple[str, ...], ModelSearch]]:
    """Return two groups of drops with a vehicle for each, where two with every usual term explain what one does not."""
    search.progress(Step("dividing the drops between two vehicles"))
    vehicles = []
    for group in divide_drops(search, partly=True) or ():
        own = of_group(search, group)
        found = fit_usual_terms(own, rich, with_lost=False)
        if found is None or own.leaves_misfit(found.fit, MISFIT_LEFT):
            return []
        vehicles.append((group, found))
    return vehicles


def _one_of_them(search: ModelSearch, vehicles: Sequence[tuple[tuple[str, ...], ModelSearch]]) -> ModelSearch | None:
    """Return one vehicle for all drops, where that of a part of them leads to it: all together may have hidden it."""
    for _, vehicle in vehicles:
        fit = fit_structure(
            vehicle.structure,
            search.decays,
            search.fit,
            search.required_of_switch,
            search.progress,
            beginning_only=True,
            most=ITERATIONS,
            start=vehicle.fit.parameters,
        )
        if not search.leaves_misfit(fit, MISFIT_LEFT):
            return replace(search, structure=vehicle.structure, fit=fit)
    return None


def select_beside_usual_terms(
    search: ModelSearch, rich: ModelStructure, first: ModelSearch | None = None
) -> ModelSearch:
    """Return the search from an ordinary vehicle with some terms, without those not needed, and with further ones beside them.

    Parameters
    ----------
    search
        The present model and its fit.
    rich
        Nonlinear, with all these terms.
    first
        The first steps of its fit, if they are taken already.

    Returns
    -------
    ModelSearch
        Model and fit as given where that vehicle explains no more.
    """
    found = fit_usual_terms(search, rich, first=first)
    if found is not None and (found := with_evident_fault(found)).fault is not None:
        return found
    if found is not None and search.leaves_misfit(found.fit, MISFIT_LEFT):
        found = _with_likeliest_law(found)
    if found is None or search.leaves_misfit(found.fit, MISFIT_LEFT):
        against = "together they do not explain what the model so far leaves"
        terms = [term for term in rich.terms if TERMS[term].usual is not None]
        return search.recorded(dict.fromkeys(terms, 0.0), True, False, against)
    return _select_beside(search, found)


def _select_beside(search: ModelSearch, found: ModelSearch) -> ModelSearch:
    """Return a model that explains the recordings without terms that are not needed, and with further ones beside it."""
    found = _without_unneeded(found)
    if not np.isfinite(found.fit.loglikelihood):
        against = "without the terms that are not needed beside it the motion has no bounds"
        return replace(search, steps=found.steps).recorded(dict.fromkeys(found.selected, 0.0), True, False, against)
    return select_terms_beside(found)


def _with_likeliest_law(search: ModelSearch) -> ModelSearch:
    """Add the nonlinear law that promises most beside all usual terms: of a spring, say, of which no size is usual."""
    laws = search.open_terms([term for term, row in TERMS.items() if not row.is_linear])
    ends = [
        search.refit(search.with_terms([law]), ITERATIONS, beginning_only=True)
        for term in most_promising(search, laws, 1)
        for law in laws_of_part(term, laws)
    ]
    return max([search, *ends], key=lambda end: end.fit.loglikelihood)


def _without_unneeded(search: ModelSearch) -> ModelSearch:
    """Leave out all terms that are not missed together, and fit what is left to the beginnings of the decays.

    Ends where what is left moves without bounds: nothing can be said of its terms.
    """
    while np.isfinite(search.fit.loglikelihood):
        against = {term: search.veto(term) for term in search.selected}
        gains = {term: search.wald_gain(term) for term in search.selected}
        if (held := _with_held_parts(search, gains)) is not None:
            search = search.refit(held, ITERATIONS, beginning_only=True)
            continue
        unneeded = [term for term in search.selected if against[term]]
        little: list[str] = []
        for term in sorted(gains, key=lambda term: gains[term] / search.required(term)):
            together = [*little, term]
            is_little = not against[term] and gains[term] < search.required(term)
            if is_little and search.wald_gain(*together) < sum(map(search.required, together)):
                little = together
        unneeded += little
        if not unneeded:
            return search.recorded(gains, True, True)
        for term in unneeded:
            search = search.recorded({term: gains[term]}, True, False, against[term])
        search = search.refit(search.without(*unneeded), ITERATIONS, beginning_only=True)
    return search


def _with_held_parts(search: ModelSearch, gains: Mapping[str, float]) -> ModelStructure | None:
    """Return the structure with parts held that the recordings do not determine of terms that are missed; None without any."""
    for term, gain in gains.items():
        undetermined = search.undetermined(term) if gain > search.required(term) else []
        held = hold_undetermined(search, term, undetermined) if undetermined else None
        if held is not None:
            return held
    return None
