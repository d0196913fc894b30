"""The search for nonlinear terms, from the plain end and from the rich end.

Which base shows a nonlinear term depends on what else the vehicle has: beside nothing, where linear terms only took up some of
the nonlinear motion; beside every usual term, where it lacks several; or beside the linear terms that it really has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

from sprung.progress import Step
from sprung.selection.contact import is_likelier
from sprung.selection.error_budget import MISFIT_LEFT
from sprung.selection.flexible_body import fit_flexible_bodies
from sprung.selection.from_ordinary_vehicle import (
    begin_from_ordinary_vehicle,
    select_beside_usual_terms,
    select_from_ordinary_vehicle,
)
from sprung.selection.further_terms import laws_of_part, select_terms_beside
from sprung.selection.likeliest_beginning import (
    Beginning,
    likeliest_beginnings,
    refused_parts,
    select_from_beginnings,
)
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.nonlinear_terms import DAMPER_LAW
from sprung.selection.ordinary_vehicle import is_astray
from sprung.selection.scoring import of_first_parts, score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.stepwise import rank_terms, try_likeliest
from sprung.selection.structure import ModelStructure
from sprung.selection.term_fits import select_gravity_leakage
from sprung.selection.terms import TERMS

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
        On its way, where faults are looked for and one was found.
    """
    terms = search.open_terms([term for term, row in TERMS.items() if not row.is_linear])
    if not terms or any(decay.clocks for decay in search.decays):
        return search
    search.progress(Step(f"scoring {', '.join(terms)}"))
    search, scores = score_terms(search, terms)
    search, ranked = rank_terms(search, scores, 1.0)
    best, steps = search, search.steps
    for select in _searches(search, plain, terms, of_first_parts(ranked)):
        found = select(replace(search, steps=steps))
        steps = found.steps
        if found.fault is not None:
            return found
        # On the way through nonlinear terms linear ones may show that explain everything without them.
        is_result = found.structure.is_nonlinear or not found.lacks_something
        best = found if is_result and is_likelier(found, best) else best
        if best is not search and not (best.lacks_something or best.is_doubtful):
            break
    for structure in _other_structures(best, plain) if best is not search else ():
        if not best.is_overdispersed or best.is_misfit_large:
            break
        found = select_beside_usual_terms(replace(search, steps=steps), structure)
        steps = found.steps
        best = found if is_likelier(found, best) else best
    if best is search:
        return replace(search, steps=steps)
    beside = ", ".join(term for term in best.selected if not TERMS[term].is_linear or term not in search.selected)
    gains = {step.extra: step.gain for step in search.steps if step.taken}
    # What took the place of another term that moves alike has no step of its own.
    gone = {term: gains.get(term, 0.0) for term in search.selected if term not in best.selected}
    best = replace(best, steps=steps).recorded(gone, True, False, f"it is not needed beside {beside}")
    return select_gravity_leakage(best) if best.structure.is_nonlinear else best


def _searches(
    search: ModelSearch, plain: ModelStructure, terms: Sequence[str], ranked: Sequence[str]
) -> Iterator[SearchFromBase]:
    """Yield the searches from every base, the simplest first."""
    # A part that vibrates by itself is nothing that only took up some of a nonlinear motion.
    has_part = any(TERMS[term].explains_all for term in search.selected)
    if ranked and has_part:
        yield partial(_from_base, search, ranked)
    found = search.structure
    plain = replace(
        plain,
        stop_gap=found.stop_gap,
        dampers_steepen=found.dampers_steepen,
        engine_frequency=found.engine_frequency,
        engine_place=found.engine_place,
    )
    is_plain = plain.names == found.names
    simplest = search if is_plain else search.refit(plain)
    if ranked:
        yield partial(_from_base, simplest, ranked)
    is_of_no_use = search.is_doubtful or is_astray(search)
    bases = [simplest] if is_plain else [search, simplest]
    beginnings: list[Beginning] = []
    if is_of_no_use:
        yield partial(_with_law_of_dampers, search, plain)
        usual = begin_from_ordinary_vehicle(search, plain)
        beginnings = _likelier_beginnings(search, usual, bases, terms)
        if beginnings:
            yield partial(_from_beginnings, search, beginnings)
        yield partial(_with_usual_terms, search, plain, usual)
        # Beside linear terms that are no usual ones, an anti-roll bar say, and without rubber that may lead astray.
        friction = [term for term in found.open_terms if TERMS[term].resembles_others and term not in found.terms]
        yield partial(_with_law_of_dampers, search, found.with_terms((*found.terms, *friction)))
    if ranked and not (is_plain or has_part):
        yield partial(_from_base, search, ranked)
    # A linear fit that has gone astray for the sake of friction, small motions' friction above all, shows no score of it.
    hidden = [term for term in search.open_terms(tuple(TERMS)) if TERMS[term].resembles_others and term not in ranked]
    for base in bases if is_of_no_use and hidden else ():
        yield partial(_from_base, base, hidden)
    refused = refused_parts(search)
    flexible = [term for term in FLEXIBLE_BODIES if term in refused]
    for body in fit_flexible_bodies(simplest, flexible).values() if is_of_no_use else ():
        yield partial(_with_usual_terms, body, plain, None)
    if not beginnings and (is_of_no_use or search.lacks_something):
        yield partial(_from_likeliest_beginning, bases, terms)


def _likelier_beginnings(
    search: ModelSearch, usual: ModelSearch, bases: Sequence[ModelSearch], terms: Sequence[str]
) -> list[Beginning]:
    """Return what goes before all usual terms: the beginnings that explain more than these at first, where they leave much."""
    if usual is search:
        return likeliest_beginnings(bases, terms)
    if not search.leaves_misfit(usual.fit, MISFIT_LEFT):
        return []
    found = likeliest_beginnings(bases, terms)
    return found if found and found[0].first.fit.loglikelihood > usual.fit.loglikelihood else []


def _other_structures(search: ModelSearch, plain: ModelStructure) -> list[ModelStructure]:
    """Return what else a nonlinear model may be: with other laws of its parts, and with less.

    Of two laws of a spring the wrong one may explain more as long as a further term is missing, which does not show beside it.
    Several terms may have taken the place of one that resembles them, but for a little: friction alone. Beside each other two
    kinds of rubber lead to second optima: one of them may be one too many.
    """
    opened = search.open_terms(tuple(TERMS))
    laws = [
        replace(search, structure=search.without(term)).with_terms([law])
        for term in search.selected
        for law in laws_of_part(term, opened)[1:]
    ]
    alone = [term for term in search.structure.terms if TERMS[term].resembles_others and term not in plain.terms]
    more = {*search.selected} - {*alone}
    rubber = {term: TERMS[term].counterpart for term in search.selected if TERMS[term].is_linear}
    alike = {one for term, other in rubber.items() if other in rubber for one in (term, other)}
    others = [*laws, *(search.without(term) for term in search.selected if term in alike)]
    from_plain = [
        plain.with_terms((*plain.terms, *(term for term in one.terms if term not in plain.terms)))
        for one in others
        if one.is_nonlinear
    ]
    return [plain.with_terms((*plain.terms, *alone)), *from_plain] if alone and more else from_plain


def _with_usual_terms(
    base: ModelSearch, plain: ModelStructure, first: ModelSearch | None, so_far: ModelSearch
) -> ModelSearch:
    """Add every usual term, to a body that is not rigid as well if the base has one, and leave out what is not needed."""
    return select_from_ordinary_vehicle(replace(base, steps=so_far.steps), plain, first)


def _with_law_of_dampers(base: ModelSearch, beside: ModelStructure, so_far: ModelSearch) -> ModelSearch:
    """Add the whole law of the dampers: each part of it alone shows little of what the others make."""
    law = [term for term in beside.open_terms if term in DAMPER_LAW and term not in beside.terms]
    if len(law) < len(DAMPER_LAW):
        return so_far
    return select_beside_usual_terms(replace(base, steps=so_far.steps), beside.with_terms((*beside.terms, *law)))


def _from_beginnings(base: ModelSearch, beginnings: Sequence[Beginning], so_far: ModelSearch) -> ModelSearch:
    """Go on from the likeliest of some parts with a nonlinear term each."""
    return select_from_beginnings(replace(base, steps=so_far.steps), beginnings)


def _from_likeliest_beginning(bases: Sequence[ModelSearch], terms: Sequence[str], so_far: ModelSearch) -> ModelSearch:
    """Go on from the part and the nonlinear term that explain most together, those included that were refused meanwhile."""
    known = [replace(base, steps=so_far.steps) for base in bases]
    return select_from_beginnings(known[0], likeliest_beginnings(known, terms))


def _from_base(base: ModelSearch, terms: Sequence[str], so_far: ModelSearch) -> ModelSearch:
    """Add the likeliest of some nonlinear terms, and further ones beside it."""
    base = replace(base, steps=so_far.steps)
    found = try_likeliest(base, terms)
    if found.fault is not None or found.structure.names == base.structure.names:
        return found
    return select_terms_beside(found)
