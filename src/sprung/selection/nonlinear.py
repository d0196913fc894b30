"""The search for nonlinear terms, from the plain end and from the rich end.

Which base shows a nonlinear term depends on what else the vehicle has: beside nothing, where linear terms only took up some of
the nonlinear motion; beside every usual term, where it lacks several; or beside the linear terms that it really has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from sprung.progress import Step
from sprung.selection.contact import is_likelier
from sprung.selection.from_ordinary_vehicle import select_from_ordinary_vehicle
from sprung.selection.linear_terms import ENGINE
from sprung.selection.scoring import score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.stepwise import rank_terms, select_terms_beside, try_likeliest
from sprung.selection.structure import ModelStructure
from sprung.selection.term_fits import fit_term, select_gravity_leakage
from sprung.selection.terms import TERMS

_TRIED_FIRST = 3
"""Nonlinear terms of which the likeliest is fitted first."""

SearchFromBase = Callable[[ModelSearch], ModelSearch]
"""A search for nonlinear terms, given the search so far for what it has tried."""


def select_nonlinear_terms(search: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Return the search after nonlinear terms have been tried.

    Parameters
    ----------
    search
        Once the linear terms are decided.
    plain
        The structure without anything that the recordings brought into it: linear terms that took up some of a nonlinear
        motion are no base to start from.

    Returns
    -------
    ModelSearch
    """
    terms = search.open_terms([term for term, row in TERMS.items() if not row.is_linear])
    if not terms or any(decay.clocks for decay in search.decays):
        return search
    search.progress(Step(f"scoring {', '.join(terms)}"))
    search, scores = score_terms(search, terms)
    search, ranked = rank_terms(search, scores, 1.0)
    best, steps = search, search.steps
    for select in _searches(search, plain, ranked[:_TRIED_FIRST]):
        found = select(replace(search, steps=steps))
        steps = found.steps
        best = found if is_likelier(found, best) else best
        if best.structure.is_nonlinear and not best.is_misfit_large:
            break
    if not best.structure.is_nonlinear:
        return replace(search, steps=steps)
    beside = ", ".join(term for term in best.selected if not TERMS[term].is_linear)
    gains = {step.extra: step.gain for step in search.steps if step.taken}
    gone = {term: gains[term] for term in search.selected if term not in best.selected}
    best = replace(best, steps=steps).recorded(gone, True, False, f"it is not needed beside {beside}")
    return select_gravity_leakage(best)


def _searches(search: ModelSearch, plain: ModelStructure, ranked: Sequence[str]) -> Iterator[SearchFromBase]:
    """Yield the searches from every base, the simplest first."""
    found = search.structure
    plain = replace(
        plain, stop_gap=found.stop_gap, engine_frequency=found.engine_frequency, engine_place=found.engine_place
    )
    is_plain = plain.names == search.structure.names
    simplest = search if is_plain else search.refit(plain)
    if ranked:
        yield lambda so_far: _from_base(replace(simplest, steps=so_far.steps), ranked)
    if search.is_misfit_large:
        yield lambda so_far: select_from_ordinary_vehicle(so_far, plain)
    if ranked and not is_plain:
        yield lambda so_far: _from_base(so_far, ranked)
    gains = [step.gain > step.asked for step in search.steps if step.extra == ENGINE and step.fitted and not step.taken]
    if ranked and any(gains):
        yield lambda so_far: _from_base(fit_term(replace(simplest, steps=so_far.steps), ENGINE), ranked)
    # A linear fit that has gone astray for the sake of friction, small motions' friction above all, shows no score of it.
    hidden = [term for term in search.open_terms(tuple(TERMS)) if TERMS[term].resembles_others and term not in ranked]
    if search.is_misfit_large and hidden:
        yield lambda so_far: _from_base(replace(simplest, steps=so_far.steps), hidden)


def _from_base(base: ModelSearch, terms: Sequence[str]) -> ModelSearch:
    """Add the likeliest of some nonlinear terms, and further ones beside it."""
    found = try_likeliest(base, terms)
    if found.structure.names == base.structure.names:
        return found
    return select_terms_beside(found)
