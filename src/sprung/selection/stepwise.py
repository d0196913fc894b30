"""The stepwise search for the model: score the open terms, fit the best few, keep what the recordings support.

Linear and nonlinear terms go through the same steps: score tests rank what is open, the most promising are fitted, and
whatever is not missed by a Wald test, is not physical or has no effect in practice is left out again. Linear terms come first,
one by one, as their fits are quick; nonlinear ones together, as their fits are slow.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from math import inf, isfinite

from sprung.estimation import NEAR, FitResult
from sprung.selection.backward_elimination import counterpart_of, leave_out_unneeded
from sprung.selection.contact import from_contact
from sprung.selection.error_budget import MISFIT_LEFT, MISFIT_LEFT_BY_ALL, MISFIT_LEFT_TO_OTHERS
from sprung.selection.evident_faults import with_evident_fault
from sprung.selection.ordinary_vehicle import may_be_astray, or_from_ordinary_vehicle
from sprung.selection.scoring import WORTH_A_FIT, Scores, most_promising, score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.term_fits import (
    begin_nonlinear_fit,
    fit_linear_term,
    fit_nonlinear_term,
    take_first_step,
)
from sprung.selection.terms import TERMS

_LINEAR = tuple(name for name, term in TERMS.items() if term.is_linear)

_RESEMBLES = 0.05
"""Score of a term that resembles others, as a part of the best one, from which it is tried first."""

_ROUNDS = 2 * len(TERMS)
"""How many linear terms may be accepted one after the other; some are left out again."""

_EXPLAINED = 0.7
"""Part of a small misfit's overdispersion that a term may leave: any term seems to explain some of an error of another kind."""

_RIVALS, _RIVAL_SCORE = 2, 0.5
"""How many terms are fitted beside one that leaves a misfit, and their scores at the least, as a part of its score."""

_CONTINUED = 3
"""How many times a fit is continued that has not converged and explains nearly all."""


def select_linear_terms(
    search: ModelSearch, among: Sequence[str] = _LINEAR, refused: Collection[str] = ()
) -> ModelSearch:
    """Return the search after every linear term that the recordings support has been taken.

    Parameters
    ----------
    search
        A linear model.
    among
        Terms to try.
    refused
        Those of them that were fitted already and not included, and are tried again only beside another one.

    Returns
    -------
    ModelSearch
    """
    for _ in range(_ROUNDS):
        terms = [term for term in search.open_terms(among) if term not in refused]
        search, scores = score_terms(search, terms)
        search, ranked = rank_terms(search, scores, WORTH_A_FIT / search.discount_of(search.fit))
        search, accepted = accept_likeliest(search, ranked, scores, among)
        if not accepted:
            break
        if may_be_astray(search) and len(among) == len(_LINEAR):
            # The model before did not show where a wheel last touched: samples before that would accept any further term.
            search = from_contact(or_from_ordinary_vehicle(search))
        refused = ()
    return search


def rank_terms(search: ModelSearch, scores: Scores, weight: float) -> tuple[ModelSearch, list[str]]:
    """Rank the terms that are worth a fit, and record the others.

    Parameters
    ----------
    search
        The present model.
    scores
        Of terms.
    weight
        Factor on the expected gains, before they are compared with the required ones.

    Returns
    -------
    search
        With a step for each term that is not worth a fit: it gains too little, or its expected size is negligible. The size is
        believed for nonlinear terms only: the score test understates no size by as much as a fit of them takes.
    terms
        Best first, by gain and plausibility of the size; what resembles other terms before them.
    """
    priority: dict[str, float] = {}
    for term, (gain, size) in scores.items():
        row, required = TERMS[term], search.significant(term)
        promising = gain * weight > required
        if promising and (row.is_linear or size >= row.negligible):
            priority[term] = (gain - row.implausibility(size) * search.fit.disagreement) / required
            continue
        against = f"its effect of {100 * size:.2g} % is negligible" if promising else ""
        search = search.recorded({term: gain / search.fit.disagreement}, False, False, against)
    best = max(priority.values(), default=0.0)
    first = {term: TERMS[term].resembles_others and priority[term] > _RESEMBLES * best for term in priority}
    return search, sorted(priority, key=lambda term: (first[term], priority[term]), reverse=True)


def accept_likeliest(
    search: ModelSearch, terms: Sequence[str], scores: Scores, among: Sequence[str] = _LINEAR
) -> tuple[ModelSearch, bool]:
    """Fit linear terms one after the other until one is accepted, and those instead of it that may explain more.

    Where much is left to explain, a term gains by what another one would explain wholly: scores that differ little do not
    tell which. So where the first one that is accepted leaves more than noise, the next ones are fitted as well. One that moves
    alike is fitted in any case: noise may hide that the first one does not explain everything.

    Parameters
    ----------
    search
        The present model.
    terms
        Best first.
    scores
        Of these terms.
    among
        As for `try_term`.

    Returns
    -------
    search
        With the likeliest of the terms that are accepted, by the Bayesian information criterion.
    accepted
        Whether one was.
    """
    for number, term in enumerate(terms):
        tried = try_term(search, term, among)
        if tried.structure.names == search.structure.names:
            search = tried
            continue
        least = _RIVAL_SCORE * scores[term][0] if tried.overdispersion > 1 else inf
        rivals = [other for other in terms[number + 1 :] if scores[other][0] > least or _move_alike(term, other)]
        best = term
        for other in rivals[:_RIVALS]:
            rival, before = try_term(search, other, among), search
            if rival.structure.names != search.structure.names and rival.delta_bic(tried) > 0:
                best, worse, tried, beaten = other, best, rival, tried
            else:
                worse, beaten = other, rival
            against = f"{best} explains more"
            search = search.recorded({worse: beaten.gain_over(search)}, True, False, against)
            tried = replace(tried, steps=(*search.steps, *tried.steps[len(before.steps) :]))
        return tried, True
    return search, False


def _move_alike(term: str, other: str) -> bool:
    """Whether one of two terms may be taken for the other."""
    return TERMS[term].counterpart == other or TERMS[other].counterpart == term


def try_likeliest(search: ModelSearch, terms: Sequence[str], least: float = 0.0) -> ModelSearch:
    """Try the one of several terms that explains the beginnings of the decays best after some steps.

    Scores tell terms apart that act at different places, not laws of the same part.

    Parameters
    ----------
    search
        The present model, a nonlinear one where anything is asked of the first steps.
    terms
        Nonlinear ones.
    least
        Gain in twice the log-likelihood that the first steps have to reach, where a low-pass of the loggers explains the
        records as well.

    Returns
    -------
    ModelSearch
    """
    first = {term: begin_nonlinear_fit(search, search.with_terms([term])) for term in terms}
    # A rate below zero may gain more than the part does that is really there.
    physical = [term for term in terms if _is_physical(search, term, first[term])]
    likeliest = max(physical or terms, key=lambda term: first[term].loglikelihood)
    if least > 0 and first[likeliest].converged:
        # The first steps are coarse in time, which a model without the term has to be as well.
        present = begin_nonlinear_fit(search, search.structure)
        gain = 2 * (first[likeliest].loglikelihood - present.loglikelihood)
        if gain < least:
            return search.recorded(dict.fromkeys(terms, 0.0), True, False, "a low-pass of the loggers explains more")
    against = f"{likeliest} explains the beginnings of the decays better"
    if not search.structure.is_nonlinear and isfinite(first[likeliest].loglikelihood):
        tried = replace(search, structure=search.with_terms([likeliest]), fit=first[likeliest])
        if (fault := with_evident_fault(tried).fault) is not None:
            return replace(search, fault=fault)
    others = dict.fromkeys((term for term in terms if term != likeliest), 0.0)
    tried = try_term(search.recorded(others, True, False, against), likeliest, first=first[likeliest])
    # What explains no less than before after some steps may beat what is still on its way to explain more.
    onward = [term for term in others if not first[term].converged]
    if tried.structure.names != search.structure.names or not onward or not search.structure.is_nonlinear:
        return tried
    likeliest = max(onward, key=lambda term: first[term].loglikelihood)
    return try_term(tried, likeliest, first=first[likeliest])


def _is_physical(search: ModelSearch, term: str, fit: FitResult) -> bool:
    """Whether a fit does not end where a parameter of a term has a value below zero that has none."""
    names = TERMS[term].not_negative(search.structure.tracks, search.structure.layout)
    return not fit.converged or all(fit.parameters[name] >= 0 for name in names)


def try_term(
    search: ModelSearch, term: str, among: Sequence[str] = _LINEAR, first: FitResult | None = None
) -> ModelSearch:
    """Fit a term, and leave out again what is not needed; without it where it gains too little.

    Parameters
    ----------
    search
        The present model.
    term
        To be tried.
    among
        Linear terms beside which one that resembles many a fault may explain the whole misfit, as it has to.
    first
        The first steps of the fit of a nonlinear one, if they are taken already.

    Returns
    -------
    ModelSearch
    """
    larger = search.with_terms([term])
    if larger.is_nonlinear:
        tried = fit_nonlinear_term(search, larger, first or begin_nonlinear_fit(search, larger))
    else:
        stepped, expected = take_first_step(search, term)
        if expected < search.required(term):
            return search.recorded({term: expected}, False, False)
        tried = fit_linear_term(stepped, term)
    if tried is None:
        return search.recorded({term: 0.0}, True, False)
    tried, against = _settled(search, tried, term)
    gain = tried.gain_over(search)
    enough = gain > search.required(term)
    if against or not enough:
        return search.recorded({term: gain}, True, False, against)
    if larger.is_nonlinear:
        tried, gains = leave_out_unneeded(tried, search)
        return tried.recorded(gains, True, True)
    against, counterpart = tried.veto(term, search), counterpart_of(tried, term)
    tried = tried.recorded({term: gain}, True, True)
    if TERMS[term].explains_all:
        tried, against = _completed(search, tried, term, among, against)
    if against:
        refused = search.recorded({term: gain}, True, False, against)
        return try_term(refused, counterpart, among) if counterpart in refused.open_terms(among) else refused
    return leave_out_unneeded(tried, search, keep=term)[0]


def _settled(search: ModelSearch, tried: ModelSearch, term: str) -> tuple[ModelSearch, str]:
    """Fit a model on that explains nearly all with a term, as long as it gains more than chance does; tell what is against it.

    Parts of which little is known, people on their seats above all, are a long way off.
    """
    for _ in range(_CONTINUED):
        if tried.gain_over(search) <= search.required(term):
            return tried, ""
        if tried.fit.converged or search.leaves_misfit(tried.fit, MISFIT_LEFT):
            break
        before, tried = tried, tried.refit(tried.structure)
        if tried.gain_over(before) < search.required_of_switch:
            tried = replace(tried, fit=replace(tried.fit, converged=True))
    if not tried.fit.converged:
        return tried, "the fit with it did not converge"
    if not _is_more_like_noise(search, tried) and tried.structure.is_nonlinear:
        # A fit that ends a little beside its optimum leaves what is no noise.
        tried = tried.refit(tried.structure, enough=NEAR)
        if not _is_more_like_noise(search, tried):
            tried = _with_one_more(search, tried)
    return tried, "" if _is_more_like_noise(search, tried) else "what is left is no more like noise with it"


def _is_more_like_noise(search: ModelSearch, tried: ModelSearch) -> bool:
    """Whether a larger model leaves what is more like noise, where what is left is small."""
    return not search.is_misfit_small or tried.overdispersion <= _EXPLAINED * search.overdispersion


def _with_one_more(search: ModelSearch, tried: ModelSearch) -> ModelSearch:
    """Return a nonlinear model with the likeliest term beside the one that was tried, if both together leave noise.

    Of two properties that are both missing, neither alone leaves what is more like noise.
    """
    for other in most_promising(tried, tried.open_terms(tuple(TERMS)), 1):
        larger = tried.with_terms([other])
        both = fit_nonlinear_term(tried, larger, begin_nonlinear_fit(tried, larger))
        if both is not None and both.fit.converged and _is_more_like_noise(search, both):
            return both
    return tried


def _completed(
    search: ModelSearch, tried: ModelSearch, term: str, among: Sequence[str], against: str
) -> tuple[ModelSearch, str]:
    """Return a model with further terms beside one that has to explain the whole misfit, and what is against it then.

    What the recordings do not determine by that term alone they may beside what the rest is: where one of two people sits.
    """
    is_incomplete = tried.is_overdispersed and bool(tried.undetermined(term))
    leaves_much = not against and search.leaves_misfit(tried.fit, MISFIT_LEFT_BY_ALL)
    if not (is_incomplete or leaves_much):
        return tried, against
    if search.leaves_misfit(tried.fit, MISFIT_LEFT_TO_OTHERS):
        return tried, "it explains less than half of the misfit"
    # Beside it a second one of its kind is looked for, a bending body beside people on seats, say; beside both, none.
    is_second = len(among) < len(_LINEAR)
    others = [other for other in among if other != term and not (is_second and TERMS[other].explains_all)]
    tried = select_linear_terms(tried, others)
    if search.leaves_misfit(tried.fit, MISFIT_LEFT_BY_ALL):
        return tried, "it does not explain the whole misfit"
    return tried, tried.veto(term) if term in tried.selected else ""
