"""The search for nonlinear terms, from the plain end and from the rich end.

Which base shows a nonlinear term depends on what else the vehicle has: beside nothing, where linear terms only took up some of
the nonlinear motion; beside every usual term, where it lacks several; or beside the linear terms that it really has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

from sprung.progress import Step
from sprung.selection.contact import from_contact, is_likelier
from sprung.selection.error_budget import MISFIT_LEFT
from sprung.selection.from_ordinary_vehicle import (
    fit_flexible_bodies,
    select_beside_usual_terms,
    select_from_ordinary_vehicle,
)
from sprung.selection.further_terms import (
    laws_of_part,
    select_further_terms,
    select_terms_beside,
    select_terms_in_whole,
)
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.nonlinear_terms import DAMPER_LAW
from sprung.selection.ordinary_vehicle import fit_usual_terms, is_ordinary, likeliest_or_ordinary
from sprung.selection.scoring import score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.stepwise import rank_terms, try_likeliest
from sprung.selection.structure import ModelStructure
from sprung.selection.term_fits import begin_nonlinear_fit, fit_term, select_gravity_leakage
from sprung.selection.terms import TERMS

_TRIED_FIRST, _BASES = 3, 2
"""Parts whose laws are compared first, as scores do not tell laws of one part apart; and bases from which the search goes on,
until one leaves little."""

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
    for select in _searches(search, plain, terms, _of_first_parts(ranked)):
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


def _of_first_parts(ranked: Sequence[str]) -> list[str]:
    """Return those of some nonlinear terms, best first, that are laws of the first few parts."""
    first = [*dict.fromkeys(TERMS[term].part or term for term in ranked)][:_TRIED_FIRST]
    return [term for term in ranked if (TERMS[term].part or term) in first]


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
    # Of a vehicle that nobody would recognise unlikely gains of its sensors may hide how much is left.
    is_of_no_use = search.is_doubtful or not is_ordinary(search)
    if is_of_no_use:
        yield partial(_with_law_of_dampers, search, plain)
        yield partial(_with_usual_terms, search, plain)
        # Beside linear terms that are no usual ones, an anti-roll bar say, and without rubber that may lead astray.
        friction = [term for term in found.open_terms if TERMS[term].resembles_others and term not in found.terms]
        yield partial(_with_law_of_dampers, search, found.with_terms((*found.terms, *friction)))
    if ranked and not (is_plain or has_part):
        yield partial(_from_base, search, ranked)
    # A linear fit that has gone astray for the sake of friction, small motions' friction above all, shows no score of it.
    hidden = [term for term in search.open_terms(tuple(TERMS)) if TERMS[term].resembles_others and term not in ranked]
    bases = [simplest] if is_plain else [search, simplest]
    for base in bases if is_of_no_use and hidden else ():
        yield partial(_from_base, base, hidden)
    refused = _refused_parts(search)
    flexible = [term for term in FLEXIBLE_BODIES if term in refused]
    for body in fit_flexible_bodies(simplest, flexible).values() if is_of_no_use else ():
        yield partial(_with_usual_terms, body, plain)
    if is_of_no_use or search.lacks_something:
        yield partial(_from_likeliest_beginning, bases, terms)


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


def _with_usual_terms(base: ModelSearch, plain: ModelStructure, so_far: ModelSearch) -> ModelSearch:
    """Add every usual term, to a body that is not rigid as well if the base has one, and leave out what is not needed."""
    return select_from_ordinary_vehicle(replace(base, steps=so_far.steps), plain)


def _with_law_of_dampers(base: ModelSearch, beside: ModelStructure, so_far: ModelSearch) -> ModelSearch:
    """Add the whole law of the dampers: each part of it alone shows little of what the others make."""
    law = [term for term in beside.open_terms if term in DAMPER_LAW and term not in beside.terms]
    if len(law) < len(DAMPER_LAW):
        return so_far
    return select_beside_usual_terms(replace(base, steps=so_far.steps), beside.with_terms((*beside.terms, *law)))


def _refused_parts(search: ModelSearch) -> list[str]:
    """Return the terms that have to explain everything and gained more than chance does, but were refused.

    Parts that vibrate by themselves, a rigid axle: beside what else is missing they may explain but a small part of it.
    """
    refused = {
        step.extra
        for step in search.steps
        if step.fitted and not step.taken and step.gain > search.significant(step.extra)
    }
    return [term for term in search.open_terms([*refused]) if TERMS[term].explains_all]


def _with_refused_parts(search: ModelSearch) -> list[ModelSearch]:
    """Fit each part that was refused, beside nothing.

    Springs that are no springs hide a body that is not rigid or people on its seats, and these hide them: neither explains
    alone what both of them leave.
    """
    parts = _refused_parts(search)
    flexible = [term for term in FLEXIBLE_BODIES if term in parts]
    found = fit_flexible_bodies(search, flexible)
    found |= {term: fit_term(search, term) for term in parts if term not in flexible}
    # One that explains less than no part does ended astray.
    return [
        base
        for term, base in found.items()
        if base.gain_over(search) > 0 and not TERMS[term].is_something_else(base.fit.parameters)
    ]


def _from_likeliest_beginning(bases: Sequence[ModelSearch], terms: Sequence[str], so_far: ModelSearch) -> ModelSearch:
    """Go on from the part and the nonlinear term that explain most together, though they may leave much to further terms.

    Only the beginnings of the decays are fitted until these explain the misfit.
    """
    search = replace(bases[0], steps=so_far.steps)
    ranked: list[tuple[ModelSearch, list[str]]] = []
    for base in (*bases, *_with_refused_parts(replace(bases[-1], steps=so_far.steps))):
        scored, scores = score_terms(base, terms)
        _, promising = rank_terms(scored, scores, 1.0)
        ranked += [(scored, promising)] if promising else []
    if not ranked:
        return search
    # What part there is makes more of a difference than which law a spring or damper has.
    first = [
        (_with_first_steps(base, promising[0]), base, _of_first_parts(promising)[1:]) for base, promising in ranked
    ]
    best = search
    for likeliest, base, others in sorted(first, key=lambda one: -one[0].fit.loglikelihood)[:_BASES]:
        ends = [likeliest, *(_with_first_steps(base, term) for term in others)]
        start = max(ends, key=lambda one: one.fit.loglikelihood)
        start = likeliest_or_ordinary(search, [start], start.structure)
        if search.leaves_most(start.fit):
            break
        found = _select_from_start(replace(search, steps=best.steps), start)
        best = found if is_likelier(found, best) else replace(best, steps=found.steps)
        if best.structure.is_nonlinear and not best.lacks_something:
            break
    return best


def _select_from_start(search: ModelSearch, start: ModelSearch) -> ModelSearch:
    """Go on from the beginnings of the decays, to further terms and to the whole decays; as given where much is left."""
    early = replace(start, steps=search.steps, decays=start.fit.decays)
    found = select_further_terms(from_contact(early, on_the_way=True), whole=False)
    if search.leaves_misfit(found.fit, MISFIT_LEFT):
        return replace(search, steps=found.steps)
    # Term after term led it through models that lacked the others, to where friction holds with what they make, say.
    anew = fit_usual_terms(replace(search, steps=found.steps), found.structure)
    if anew is not None and anew.fit.loglikelihood > found.fit.loglikelihood:
        found = replace(anew, decays=found.decays)
    found = found.recorded({term: found.wald_gain(term) for term in found.selected}, True, True)
    return select_terms_in_whole(found, search.decays)


def _with_first_steps(search: ModelSearch, term: str) -> ModelSearch:
    """Return the search with a term, after the first steps of its fit to the beginnings of the decays."""
    larger = search.with_terms([term])
    return replace(search, structure=larger, fit=begin_nonlinear_fit(search, larger))


def _from_base(base: ModelSearch, terms: Sequence[str], so_far: ModelSearch) -> ModelSearch:
    """Add the likeliest of some nonlinear terms, and further ones beside it."""
    base = replace(base, steps=so_far.steps)
    found = try_likeliest(base, terms)
    if found.fault is not None or found.structure.names == base.structure.names:
        return found
    return select_terms_beside(found)
