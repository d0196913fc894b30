"""Backward elimination: terms that a fit does not need, or speaks against, are left out, the least missed first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sprung.estimation import FitStatistics, UsualValue
from sprung.selection.search import ModelSearch
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.vehicle import NEUTRAL, PARAMETERS

_HELD = 1.3
"""Factor within which a part of a term is held near its usual value that the recordings do not determine."""


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
    return {term: search.wald_gain(term) for term in search.selected if search.needs(term)}


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
        # What refines a term goes with it.
        if term not in search.selected or not search.veto(term):
            continue
        smaller = search.refit(search.without(term))
        if against := search.veto(term, smaller):
            search = smaller.recorded({term: search.wald_gain(term)}, True, False, against)
    return search


def leave_out_undetermined(search: ModelSearch, statistics: FitStatistics) -> ModelSearch:
    """Return the search without the least missed term of which a parameter is as uncertain as itself.

    All disagreement of the records is counted.

    Parameters
    ----------
    search
        A model and its fit.
    statistics
        Its uncertainty.

    Returns
    -------
    ModelSearch
        As given where the records determine every term, or miss those that they do not.
    """
    structure = search.structure
    # Where nothing was weighed the scale is unknown, which speaks against no term.
    scaling = statistics.scaling / np.linalg.norm(statistics.scaling)
    within = np.eye(len(scaling)) - np.outer(scaling, scaling)
    variances = np.diag(within @ statistics.relative_covariance @ within)
    spreads = np.sqrt(np.maximum(variances, 0.0)) * np.abs(statistics.slopes)
    uncertain = {
        name
        for name, std, value in zip(statistics.names, spreads.tolist(), statistics.values.tolist(), strict=True)
        if name in PARAMETERS and PARAMETERS[name].positive and std > abs(value)
    }
    missing = {
        term: [name for name in TERMS[term].parameters(structure.tracks, structure.layout) if name in uncertain]
        for term in search.selected
    }
    gains = {term: search.wald_gain(term) for term, names in missing.items() if names}
    for term in sorted(gains, key=gains.__getitem__):
        smaller = search.refit(search.without(term))
        if not search.explains_much(term, smaller):
            against = f"the recordings do not determine {', '.join(missing[term])}"
            return smaller.recorded({term: gains[term]}, True, False, against)
    return search


def leave_out_unneeded(
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
        With what is left. The model before has its own fit, or a better one to which the larger model has led.
    gains
        What would be lost without each of the terms that are left; empty where that is the model before.
    """
    gains: dict[str, float] = {}
    kept = {keep}
    while tried.structure.names != before.structure.names:
        against = {term: tried.veto(term) for term in tried.selected if term not in kept}
        if not against:
            break
        # What is not determined beside a term that is not needed may be so without it: its turn comes last.
        undetermined = {term: tried.undetermined(term) for term, reason in against.items() if reason}
        last = [term for term, names in undetermined.items() if names]
        gains = {
            term: 0.0 if reason and term not in last else tried.wald_gain(term) for term, reason in against.items()
        }
        missed = {term: gain / tried.required(term) for term, gain in gains.items()}
        least = min(missed, key=missed.__getitem__)
        if missed[least] > 1:
            if not last:
                return tried, gains
            least = min(last, key=missed.__getitem__)
            held = hold_undetermined(tried, least, undetermined[least])
            again = tried if held is None else tried.refit(held)
            if again is not tried and np.isfinite(again.fit.loglikelihood):
                tried = again
                continue
        larger, tried = tried, tried.recorded({least: gains[least]}, True, False, against[least])
        smaller = _with_counterpart(tried, least)
        tried = _back_to(before, tried, least) if smaller.names == before.structure.names else tried.refit(smaller)
        if not np.isfinite(tried.fit.loglikelihood):
            tried, kept = larger, {*kept, least}
            continue
        if least in before.selected and tried.delta_bic(before) < 0:
            if not against[least] and larger.gain_over(tried) > larger.required(least):
                # A Wald test says little of what a fit without the term loses where the term is not known well.
                tried, kept = larger, {*kept, least}
                continue
            # A new term beside which an old one means nothing does not replace it unless it explains as much.
            return replace(before, steps=tried.steps), {}
    return tried, {}


def _back_to(before: ModelSearch, tried: ModelSearch, term: str) -> ModelSearch:
    """Return the model before, without a term of a larger one; at the optimum to which that one has led, if it is better.

    Where a larger model explains far more than it would lose without its term, the one before had ended elsewhere.
    """
    back = replace(before, steps=tried.steps)
    if not before.lacks_something or tried.gain_over(before) < tried.wald_gain(term) + before.required_of_switch:
        return back
    again = tried.refit(before.structure)
    return again if again.gain_over(back) > before.required_of_switch else back


def hold_undetermined(search: ModelSearch, term: str, undetermined: Sequence[str]) -> ModelStructure | None:
    """Return the structure with what the recordings do not determine of a term held near where it is nothing.

    They may show it at one of the axles only: at the other one dampers may never reach their knee.

    Parameters
    ----------
    search
        A model and its fit.
    term
        Of the model.
    undetermined
        Its parameters that are not determined.

    Returns
    -------
    ModelStructure or None
        None where these are all parameters of the term, or one of them is neither a factor nor without a value where the term
        is nothing. None also where they are held already: in a fit that leaves much, all that is known counts little beside it.
    """
    structure, row = search.structure, TERMS[term]
    values = {name: 1.0 for name in undetermined if NEUTRAL.get(name) == 1.0}
    if row.undefined is not None:
        values |= row.undefined(search.fit.parameters, structure)
    is_whole = {*undetermined} == {*row.parameters(structure.tracks, structure.layout)}
    is_held = all(name in structure.usual and not structure.usual[name].is_knowledge for name in undetermined)
    if is_whole or is_held or not {*undetermined} <= {*values}:
        return None
    held = {name: UsualValue(values[name], _HELD, is_knowledge=False) for name in undetermined}
    return replace(structure, usual={**structure.usual, **held})


def counterpart_of(search: ModelSearch, term: str) -> str:
    """Return what a term of the model has been taken for; empty where it is of its kind, or nothing moves alike."""
    row = TERMS[term]
    return row.counterpart if row.is_something_else(search.fit.parameters) else ""


def _with_counterpart(search: ModelSearch, term: str) -> ModelStructure:
    """Return the structure without a term; with its counterpart, where that is what the term has been taken for."""
    smaller, counterpart = search.without(term), counterpart_of(search, term)
    if counterpart in search.open_terms(tuple(TERMS)):
        return smaller.with_terms((*smaller.terms, counterpart))
    return smaller
