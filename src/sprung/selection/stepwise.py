"""The stepwise search for the model: score the open terms, fit the best few, keep what the recordings support.

Linear and nonlinear terms go through the same steps: score tests rank what is open, the most promising are fitted, and
whatever is not missed by a Wald test, is not physical or has no effect in practice is left out again. Linear terms come first,
one by one, as their fits are quick; nonlinear ones together, as their fits are slow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sprung.estimation import NEAR, FitResult, fit_linear
from sprung.progress import Step
from sprung.selection.error_budget import MISFIT_LEFT, MISFIT_LEFT_AT_FIRST, MISFIT_LEFT_BY_ALL
from sprung.selection.scoring import Scores, score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.starts import fit_structure, has_positive_masses, start_values
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import ENGINE, TERMS

_LINEAR = tuple(name for name, term in TERMS.items() if term.is_linear)

_WORTH_A_FIT = 4.0
"""Factor on the expected gain of a linear term before it is compared with the required one: a score test understates the
gain of terms that are far from neutral. After one step towards the term, only what is still expected counts so much."""

_RESEMBLES = 0.05
"""Score of a term that resembles others, as a part of the best one, from which it is tried first."""

_FIRST_ITERATIONS = 8
"""Iterations after which a nonlinear fit has to have explained some of the misfit."""

_ITERATIONS_OF_SWITCH = 1
"""Iterations after a change without a parameter, which hardly moves the optimum: one Newton step tells what it gains."""

_ROUNDS = 2 * len(TERMS)
"""How many linear terms may be accepted one after the other; some are left out again."""

_EXPLAINED = 0.7
"""Part of a small misfit's overdispersion that a term may leave: any term seems to explain some of an error of another kind."""

_FURTHER_ROUNDS, _TRIED_BESIDE = 4, 2
"""How many times terms are looked for beside nonlinear ones, and how many are fitted each time until one is accepted."""


def select_linear_terms(search: ModelSearch, among: Sequence[str] = _LINEAR) -> ModelSearch:
    """Return the search after every linear term that the recordings support has been taken.

    Parameters
    ----------
    search
        A linear model.
    among
        Terms to try.

    Returns
    -------
    ModelSearch
    """
    for _ in range(_ROUNDS):
        terms = search.open_terms(among)
        search, scores = score_terms(search, terms)
        search, ranked = rank_terms(search, scores, _WORTH_A_FIT / search.fit.disagreement)
        search, accepted = accept_first(search, ranked, among)
        if not accepted:
            break
    return search


def select_further_terms(search: ModelSearch) -> ModelSearch:
    """Return the search after terms of any kind have been tried beside the nonlinear ones that it has.

    Parameters
    ----------
    search
        The present model and its fit.

    Returns
    -------
    ModelSearch
    """
    tried: set[str] = set()
    for _ in range(_FURTHER_ROUNDS):
        if not search.structure.is_nonlinear or not search.is_overdispersed:
            break
        terms = [term for term in search.open_terms(tuple(TERMS)) if term not in tried]
        _, scores = score_terms(search, terms)
        ratios = {
            # Where a term that refines another is neutral it does nothing to first order: its score says nothing.
            term: np.inf
            if TERMS[term].refines in search.structure.terms
            else scores[term][0] / (search.required(term) * search.overdispersion)
            for term in terms
        }
        best = sorted((term for term in terms if ratios[term] > 1), key=lambda term: -ratios[term])[:_TRIED_BESIDE]
        tried |= set(best)
        search, accepted = accept_first(search, best)
        if not accepted:
            break
    return search


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
    other = search.refit(replace(search.structure, gravity_leakage=True), most=_ITERATIONS_OF_SWITCH)
    return other.refit(other.structure) if other.gain_over(search) > search.required_of_switch else search


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
    """
    return select_gravity_leakage(search.refit(search.structure.with_terms(requested.terms)))


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
    return _fit_linear(score_terms(search, [term])[0], term)


def needed_terms(search: ModelSearch) -> dict[str, float]:
    """Return the terms that the recordings brought into a model and that its fit needs.

    Parameters
    ----------
    search
        A model and its fit.

    Returns
    -------
    dict
        By term, what twice the log-likelihood would lose without it (Wald test), divided by the overdispersion.
    """
    gains = {term: search.wald_gain(term) for term in search.selected if not search.veto(term)}
    return {term: gain for term, gain in gains.items() if gain > search.required(term)}


def leave_out_refused(search: ModelSearch) -> ModelSearch:
    """Return the search without terms that its fit speaks against, once it has moved.

    Parameters
    ----------
    search
        A model and its fit.

    Returns
    -------
    ModelSearch
    """
    for term in search.selected:
        if against := search.veto(term):
            search = search.recorded({term: search.wald_gain(term)}, True, False, against)
            search = search.refit(search.without(term))
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


def accept_first(search: ModelSearch, terms: Sequence[str], among: Sequence[str] = _LINEAR) -> tuple[ModelSearch, bool]:
    """Fit terms one after the other until one is accepted; and say whether one was."""
    for term in terms:
        tried = try_term(search, term, among)
        if tried.structure.names != search.structure.names:
            return tried, True
        search = tried
    return search, False


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
        tried = _fit_nonlinear(search, larger, first or begin_nonlinear_fit(search, larger))
    else:
        stepped, expected = _first_step(search, term)
        if expected < search.significant(term):
            return search.recorded({term: expected}, False, False)
        tried = _fit_linear(stepped, term)
    if tried is None:
        return search.recorded({term: 0.0}, True, False)
    gain = tried.gain_over(search)
    enough, against = gain > search.required(term), ""
    if enough and not tried.fit.converged:
        against = "the fit with it did not converge"
    elif enough and search.is_misfit_small and tried.overdispersion > _EXPLAINED * search.overdispersion:
        against = "what is left is no more like noise with it"
    if against or not enough:
        return search.recorded({term: gain}, True, False, against)
    if larger.is_nonlinear:
        tried, gains = _without_unneeded(tried, search)
        return tried.recorded(gains, True, True) if gains else replace(search, steps=tried.steps)
    against = tried.veto(term)
    tried = tried.recorded({term: gain}, True, True)
    if not against and TERMS[term].explains_all and search.leaves_misfit(tried.fit, MISFIT_LEFT_BY_ALL):
        # Beside it a second one of its kind is looked for, a bending body beside people on seats, say; beside both, none.
        is_second = len(among) < len(_LINEAR)
        others = [other for other in among if other != term and not (is_second and TERMS[other].explains_all)]
        tried = select_linear_terms(tried, others)
        against = "it does not explain the whole misfit" if search.leaves_misfit(tried.fit, MISFIT_LEFT_BY_ALL) else ""
    if against:
        return search.recorded({term: gain}, True, False, against)
    return _without_unneeded(tried, search, keep=term)[0]


def _without_unneeded(
    tried: ModelSearch, before: ModelSearch, keep: str | None = None
) -> tuple[ModelSearch, dict[str, float]]:
    """Leave out terms, the least missed first, until every one that is left is needed.

    Parameters
    ----------
    tried
        A larger model.
    before
        The model that it was made from.
    keep
        A term whose gain was measured by a fit without it.

    Returns
    -------
    search
        With what is left.
    gains
        What would be lost without each of the terms that are left; empty where that is the model before.
    """
    gains: dict[str, float] = {}
    while tried.structure.names != before.structure.names:
        against = {term: tried.veto(term) for term in tried.selected if term != keep}
        if not against:
            break
        gains = {term: 0.0 if reason else tried.wald_gain(term) for term, reason in against.items()}
        least = min(gains, key=lambda term: gains[term] / tried.required(term))
        if gains[least] > tried.required(least):
            return tried, gains
        tried = tried.recorded({least: gains[least]}, True, False, against[least])
        smaller = _with_counterpart(tried, least)
        tried = replace(before, steps=tried.steps) if smaller.names == before.structure.names else tried.refit(smaller)
    return tried, {}


def _with_counterpart(search: ModelSearch, term: str) -> ModelStructure:
    """Return the structure without a term; with its counterpart, where that is what the term has been taken for."""
    smaller, row = search.without(term), TERMS[term]
    if row.counterpart in search.open_terms(tuple(TERMS)) and row.is_something_else(search.fit.parameters):
        return smaller.with_terms((*smaller.terms, row.counterpart))
    return smaller


def _first_step(search: ModelSearch, term: str) -> tuple[ModelSearch, float]:
    """Take the first Newton step towards one more linear term, and return what the whole fit may gain at the most.

    Near the neutral values twice the log-likelihood is quadratic: the step gains what the score test says, and no more is
    expected after it. A new engine is far from anything: nothing follows from one step.
    """
    if term == ENGINE:
        return search, np.inf
    first = search.refit(search.with_terms([term]), most=1)
    gain = 2 * (first.fit.loglikelihood - search.fit.loglikelihood) + _WORTH_A_FIT * first.fit.remaining_gain
    return first, gain / first.fit.disagreement


def _fit_linear(search: ModelSearch, term: str) -> ModelSearch:
    """Fit a model with one more linear term; with an engine, without which all may be wrong, from nothing as well.

    Where nothing but noise is left, nothing is wrong without an engine.
    """
    search.progress(Step(f"fitting with {term}"))
    larger = search.with_terms([term])
    begins = term != ENGINE or has_positive_masses(larger.linear_models, start_values(larger, search.fit.parameters))
    ends = [search.refit(larger)] if begins else []
    if term == ENGINE and not larger.needs_start and (search.has_model_error or not ends):
        sensors, known = larger.sensors, larger.known
        anew = fit_linear(search.decays, larger.linear_models, sensors, known, enough=NEAR, progress=search.progress)
        ends.append(replace(search, structure=larger, fit=anew.after(search.fit)))
    return max(ends, key=lambda end: (end.fit.converged, end.fit.loglikelihood))


def begin_nonlinear_fit(search: ModelSearch, larger: ModelStructure) -> FitResult:
    """Take the first steps of the fit of a nonlinear model to the beginnings of the decays."""
    return fit_structure(
        larger, search.decays, search.fit, NEAR, search.progress, beginning_only=True, most=_FIRST_ITERATIONS
    )


def _fit_nonlinear(search: ModelSearch, larger: ModelStructure, first: FitResult) -> ModelSearch | None:
    """Fit a nonlinear model whose fit has begun; None where it leaves too much of the misfit."""
    if search.leaves_misfit(first, MISFIT_LEFT_AT_FIRST):
        return None
    if not first.converged:
        first = fit_structure(larger, search.decays, first, NEAR, search.progress, beginning_only=True)
    if not search.structure.is_nonlinear and search.leaves_misfit(first, MISFIT_LEFT):
        return None
    return replace(search, fit=first).refit(larger)
