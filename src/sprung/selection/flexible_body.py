"""The search for a body that twists or bends, from an ordinary vehicle that has it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.progress import Step
from sprung.selection.backward_elimination import leave_out_unneeded
from sprung.selection.contact import from_contact
from sprung.selection.error_budget import MISFIT_LEFT
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.ordinary_vehicle import fit_from_ordinary_vehicle, is_astray
from sprung.selection.search import ModelSearch
from sprung.selection.starts import start_variants
from sprung.selection.terms import TERMS
from sprung.selection.usual_terms import open_usual_terms


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
    if not (search.is_misfit_large or is_astray(search)):
        return search
    # Where rubber is missing as well, a flexible body explains a part of the misfit alone.
    bodies: Sequence[str] = FLEXIBLE_BODIES
    rubber = tuple(term for term in open_usual_terms(search.structure) if TERMS[term].is_linear)
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
