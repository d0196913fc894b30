"""The search from the likeliest beginning: the part and the nonlinear law that explain most together after some steps.

Springs that are no springs hide a body that is not rigid or people on its seats, and these hide them: neither explains alone
what both of them leave, and no score of one shows the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from sprung.selection.contact import from_contact, is_likelier
from sprung.selection.error_budget import MISFIT_LEFT
from sprung.selection.flexible_body import fit_flexible_bodies
from sprung.selection.further_terms import select_further_terms, select_terms_in_whole
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.scoring import of_first_parts, score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.stepwise import rank_terms
from sprung.selection.term_fits import begin_nonlinear_fit, fit_term
from sprung.selection.terms import TERMS
from sprung.selection.usual_terms import fit_usual_terms, likeliest_or_ordinary, open_usual_linear_terms

_BASES = 2
"""Models from which the search goes on, until one leaves little."""


class Beginning(NamedTuple):
    """The first steps of a fit with one nonlinear term, to the beginnings of the decays.

    Attributes
    ----------
    base
        The model without the term.
    first
        The model with it.
    others
        Terms that promise less beside the same base.
    """

    base: ModelSearch
    first: ModelSearch
    others: Sequence[str]


def refused_parts(search: ModelSearch) -> list[str]:
    """Return the terms that have to explain everything and gained more than chance does, but were refused.

    Parts that vibrate by themselves, a rigid axle: beside what else is missing they may explain but a small part of it.

    Parameters
    ----------
    search
        A model, and what was tried before.
    """
    refused = {
        step.extra
        for step in search.steps
        if step.fitted and not step.taken and step.gain > search.significant(step.extra)
    }
    return [term for term in search.open_terms([*refused]) if TERMS[term].explains_all]


def likeliest_beginnings(bases: Sequence[ModelSearch], terms: Sequence[str]) -> list[Beginning]:
    """Take the first steps with what promises most beside each base, each part that was refused, and rubber.

    Parameters
    ----------
    bases
        Linear models and their fits to the same decays, the simplest last.
    terms
        Nonlinear ones.

    Returns
    -------
    list of Beginning
        The likeliest first.
    """
    found = []
    for base in (*bases, *_with_another_part(bases[-1])):
        scored, scores = score_terms(base, terms)
        _, promising = rank_terms(scored, scores, 1.0)
        if promising:
            first = _with_first_steps(scored, promising[0])
            found.append(Beginning(scored, first, of_first_parts(promising)[1:]))
    return sorted(found, key=lambda one: -one.first.fit.loglikelihood)[:_BASES]


def select_from_beginnings(search: ModelSearch, beginnings: Sequence[Beginning]) -> ModelSearch:
    """Go on from the likeliest of some beginnings, though they may leave much to further terms.

    Only the beginnings of the decays are fitted until these explain the misfit.

    Parameters
    ----------
    search
        The present model and its fit, linear.
    beginnings
        The likeliest first.

    Returns
    -------
    ModelSearch
        Model and fit as given where they leave much of the misfit.
    """
    best = search
    for beginning in beginnings:
        # What part there is makes more of a difference than which law a spring or damper has.
        ends = [beginning.first, *(_with_first_steps(beginning.base, term) for term in beginning.others)]
        start = max(ends, key=lambda one: one.fit.loglikelihood)
        start = likeliest_or_ordinary(search, [start], start.structure)
        if search.leaves_most(start.fit):
            break
        found = _select_from_start(replace(search, steps=best.steps), start)
        best = found if is_likelier(found, best) else replace(best, steps=found.steps)
        # A part that means nothing may stand for another one: for an engine a body that bends around points far outside it.
        if best.structure.is_nonlinear and not best.lacks_something and all(map(best.needs, best.selected)):
            break
    return best


def _with_another_part(search: ModelSearch) -> list[ModelSearch]:
    """Fit each part that was refused, and each linear term that most vehicles have, beside nothing."""
    parts = [*refused_parts(search), *open_usual_linear_terms(search.structure)]
    flexible = [term for term in FLEXIBLE_BODIES if term in parts]
    found = fit_flexible_bodies(search, flexible)
    found |= {term: fit_term(search, term) for term in parts if term not in flexible}
    # One that explains less than no part does ended astray.
    return [
        base
        for term, base in found.items()
        if base.gain_over(search) > 0 and not TERMS[term].is_something_else(base.fit.parameters)
    ]


def _with_first_steps(search: ModelSearch, term: str) -> ModelSearch:
    """Return the search with a term, after the first steps of its fit to the beginnings of the decays."""
    larger = search.with_terms([term])
    return replace(search, structure=larger, fit=begin_nonlinear_fit(search, larger))


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
