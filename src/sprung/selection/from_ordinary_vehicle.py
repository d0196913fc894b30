"""The search from the rich end: an ordinary vehicle that has every usual term, of which what is not needed is left out.

A forward search from a model that lacks several terms goes astray: each term that it tries takes up some of what the others
would explain. From a vehicle in which every usual term has its usual size the way to the optimum is short. Usual sizes are weak
priors, so that a term of which the records say little keeps the size that it usually has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sprung.progress import Step
from sprung.selection.backward_elimination import hold_undetermined, leave_out_unneeded
from sprung.selection.contact import from_contact, is_likelier
from sprung.selection.error_budget import MISFIT_LEFT
from sprung.selection.evident_faults import with_evident_fault
from sprung.selection.further_terms import laws_of_part, select_terms_beside
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.ordinary_vehicle import (
    ITERATIONS,
    fit_from_ordinary_vehicle,
    fit_usual_terms,
    is_ordinary,
)
from sprung.selection.scoring import most_promising
from sprung.selection.search import ModelSearch
from sprung.selection.several_vehicles import divide_drops, of_group
from sprung.selection.starts import start_variants
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.selection.unlike_drops import UnlikeDrops


def select_flexible_body(search: ModelSearch) -> ModelSearch:
    """Return the search with a body that twists or bends, if that explains what a rigid one leaves.

    A rigid body that has to explain a flexible one ends anywhere: no score test there shows what is missing. From an ordinary
    vehicle with it the way is short.

    Parameters
    ----------
    search
        The present model and its fit, linear.

    Returns
    -------
    ModelSearch
        Model and fit as given where neither explains it.
    """
    # A fit to little but what the body itself does may leave little, by a vehicle that nobody has seen.
    is_astray = search.is_overdispersed and not is_ordinary(search)
    if not search.is_misfit_large and not is_astray:
        return search
    # Where rubber is missing as well, a flexible body explains a part of the misfit alone.
    bodies: Sequence[str] = FLEXIBLE_BODIES
    rubber = tuple(term for term in _usual_terms(search.structure) if TERMS[term].is_linear)
    for beside in dict.fromkeys(((), rubber)):
        partly = []
        for term, tried in fit_flexible_bodies(search, bodies, beside).items():
            gain = tried.gain_over(search)
            if (
                gain > search.required(term)
                and not search.leaves_misfit(tried.fit, MISFIT_LEFT)
                and not tried.veto(term)
            ):
                # A rigid body did not show where a wheel last touched: samples before that would accept any further term.
                needed, gains = leave_out_unneeded(replace(tried, steps=search.steps), search, keep=term)
                return from_contact(needed.recorded({term: gain, **gains}, True, True))
            partly += [term] if gain > search.required(term) else []
            search = search.recorded({term: gain}, True, False, "an ordinary vehicle with it explains no more")
        bodies = partly
    return search


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
    usual = [term for term in _usual_terms(search.structure) if TERMS[term].is_linear and not TERMS[term].refines]
    if not usual:
        return search
    search.progress(Step(f"fitting an ordinary vehicle with {', '.join(usual)}"))
    return fit_from_ordinary_vehicle(search, search.with_terms(usual))


def _usual_terms(structure: ModelStructure) -> tuple[str, ...]:
    """Return the terms about which the recordings decide that most vehicles have."""
    return tuple(term for term in structure.open_terms if TERMS[term].usual is not None and term not in structure.terms)


def fit_flexible_bodies(
    search: ModelSearch, terms: Sequence[str], beside: Sequence[str] = ()
) -> dict[str, ModelSearch]:
    """Fit a body that twists, or one that bends, from an ordinary vehicle that has it.

    Parameters
    ----------
    search
        The present model and its fit, linear.
    terms
        Which of them.
    beside
        Other linear terms that the vehicle has.

    Returns
    -------
    dict
        By term, the likeliest first.
    """
    found: dict[str, ModelSearch] = {}
    for term in search.open_terms(terms):
        search.progress(Step(f"fitting an ordinary vehicle with {', '.join((term, *beside))}"))
        larger = search.with_terms([*beside, term])
        ends = [
            fit_from_ordinary_vehicle(search, variant)
            for variant in start_variants(term, larger, search.fit.parameters)
        ]
        found[term] = max(ends, key=lambda end: end.fit.loglikelihood)
    return dict(sorted(found.items(), key=lambda item: -item[1].fit.loglikelihood))


def select_from_ordinary_vehicle(search: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Return the search from an ordinary vehicle with every usual term, without those that are not needed.

    Parameters
    ----------
    search
        The present model and its fit.
    plain
        The structure without anything that the recordings brought into it. A body that they show to be flexible stays so.

    Returns
    -------
    ModelSearch
        Model and fit as given where the ordinary vehicle explains no more.
    """
    terms = _usual_terms(plain)
    if not terms:
        return search
    search.progress(Step("fitting an ordinary vehicle with every usual term"))
    flexible = tuple(name for name in search.selected if name in FLEXIBLE_BODIES)
    rich = plain.with_terms((*plain.terms, *flexible, *terms))
    found = select_beside_usual_terms(search, rich)
    if flexible or not search.seeks_faults or found.fault is not None or found.structure is not search.structure:
        return found
    return replace(found, fault=_two_vehicles(search, rich))


def _two_vehicles(search: ModelSearch, rich: ModelStructure) -> UnlikeDrops | None:
    """Return the drops of another vehicle, where two with every usual term explain what one does not."""
    search.progress(Step("dividing the drops between two vehicles"))
    groups = divide_drops(search, partly=True)
    for group in groups or ():
        own = of_group(search, group)
        found = fit_usual_terms(own, rich, with_lost=False)
        if found is None or own.leaves_misfit(found.fit, MISFIT_LEFT):
            return None
    return None if groups is None else UnlikeDrops(groups[1], {}, groups[0])


def select_beside_usual_terms(search: ModelSearch, rich: ModelStructure) -> ModelSearch:
    """Return the search from an ordinary vehicle with some terms, without those not needed, and with further ones beside them.

    Parameters
    ----------
    search
        The present model and its fit.
    rich
        Nonlinear, with all these terms.

    Returns
    -------
    ModelSearch
        Model and fit as given where that vehicle explains no more.
    """
    found = fit_usual_terms(search, rich)
    if found is not None and (found := with_evident_fault(found)).fault is not None:
        return found
    if found is not None and search.leaves_misfit(found.fit, MISFIT_LEFT):
        found = _with_likeliest_law(found)
    if found is None or search.leaves_misfit(found.fit, MISFIT_LEFT):
        against = "together they do not explain what the model so far leaves"
        terms = [term for term in rich.terms if TERMS[term].usual is not None]
        return search.recorded(dict.fromkeys(terms, 0.0), True, False, against)
    found = _without_unneeded(found)
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
    """Leave out all terms that are not missed together, and fit what is left to the beginnings of the decays."""
    while True:
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


def _with_held_parts(search: ModelSearch, gains: Mapping[str, float]) -> ModelStructure | None:
    """Return the structure with parts held that the recordings do not determine of terms that are missed; None without any."""
    for term, gain in gains.items():
        undetermined = search.undetermined(term) if gain > search.required(term) else []
        held = hold_undetermined(search, term, undetermined) if undetermined else None
        if held is not None:
            return held
    return None
