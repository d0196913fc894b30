"""Score tests of the terms that the model has not: what each would gain, and how plausible that is, without any fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sprung.estimation import (
    readout_of,
    score_linear_term,
    score_linear_terms,
    score_nonlinear_terms,
    score_stepped_terms,
)
from sprung.preprocess import FreeDecay
from sprung.selection.linear_terms import DAMPER_MOUNT
from sprung.selection.nonlinear_terms import BUMP_STOP, DAMPER_CURVE
from sprung.selection.search import ModelSearch
from sprung.selection.starts import (
    neutral_values,
    start_variants,
    states_by_coordinates,
    stop_gaps,
    thinned,
    usual_variants,
)
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS
from sprung.vehicle import separate_track_names

WORTH_A_FIT = 4.0
"""Factor on the expected gain of a linear term before it is compared with the required one: a score test understates the
gain of terms that are far from neutral. After one step towards the term, only what is still expected counts so much."""

_PARTS = 3
"""Parts whose laws are compared by their first steps."""

_RATE, _DURATION = 250.0, 3.0
"""Hz and s of the thinned decays that are stepped for a score: enough for wheel hop and for all of a usual decay."""

_BEHIND_LOW_PASS = 1.0
"""s of the decays likewise, where all samples count."""

_SAMPLE = 1.005
"""Of the recordings' samples: the longest step of a score, rounding aside."""

Scores = dict[str, tuple[float, float]]
"""By term: the expected gain in twice the log-likelihood, and the expected size."""


def score_terms(search: ModelSearch, terms: Sequence[str]) -> tuple[ModelSearch, Scores]:
    """Score terms at the present fit.

    Parameters
    ----------
    search
        The present model.
    terms
        Open terms.

    Returns
    -------
    search
        With the structure's starts where the terms gain most: mounting of an engine, gap of bump stops, and whether the curves
        of dampers flatten beyond their knee or steepen.
    scores
        Of every term.
    """
    if not terms:
        return search, {}
    if search.structure.is_nonlinear:
        return search, _stepped(search, terms)
    search, scores = _linear(search, [term for term in terms if TERMS[term].is_linear])
    nonlinear = [term for term in terms if not TERMS[term].is_linear]
    if nonlinear:
        search, more = _nonlinear_with_stops(search, nonlinear)
        scores |= more
    return search, scores


def most_promising(search: ModelSearch, terms: Sequence[str], most: int) -> dict[str, float]:
    """Return the terms whose scores promise what is required of them, and how many times that.

    Parameters
    ----------
    search
        The present model.
    terms
        Open terms.
    most
        How many at the most.

    Returns
    -------
    dict
        Best first. Where what is left is no noise also those that promise a part of it: drops, or large and small motions, may
        disagree for want of the term itself, which a step or a fit shows.
    """
    least = 1 / WORTH_A_FIT if search.is_overdispersed else 1.0
    _, scores = score_terms(search, terms)
    ratios = {term: scores[term][0] / (search.required(term) * search.overdispersion) for term in terms}
    best = sorted((term for term in terms if ratios[term] > least), key=lambda term: -ratios[term])[:most]
    return {term: ratios[term] for term in best}


def _linear(search: ModelSearch, terms: Sequence[str]) -> tuple[ModelSearch, Scores]:
    """Score linear terms: all in one evaluation, and those of larger models that are worth a fit once more in their own."""
    scores = _of_fitted_model(search, terms)
    for term in terms:
        gain, _ = scores.get(term, (np.inf, 0.0))
        if term not in scores or (TERMS[term].adds_coordinates and gain * WORTH_A_FIT > search.significant(term)):
            search, scores[term] = _of_larger_model(search, term)
    return search, {term: scores[term] for term in terms}


def _of_fitted_model(search: ModelSearch, terms: Sequence[str]) -> Scores:
    """Score linear terms by what they would force on the fitted model; empty where changes of the response have no closed form.

    Each term with its best start.
    """
    if not terms:
        return {}
    larger, own = search.with_terms(terms), search.fit.parameters
    brought = {term: TERMS[term].parameters(search.with_terms([term]).tracks, larger.layout) for term in terms}
    variants = {term: usual_variants(term, larger, own) for term in terms}
    neutral, ways = neutral_values(larger, own), []
    for number in range(max(map(len, variants.values()))):
        there = {term: ones[number] for term, ones in variants.items() if number < len(ones)}
        values = {**neutral}
        for term, variant in there.items():
            undefined = TERMS[term].undefined
            values |= {} if undefined is None else undefined(own, variant)
        ways.append((values, {term: brought[term] for term in there}))
    sensors = readout_of(larger.sensors, larger.names, larger.known)
    scores = Scores()
    for tests in score_linear_terms(search.fit, larger.linear_models, sensors, ways) or ():
        for term, (gain, estimates) in tests.items():
            if term not in scores or gain > scores[term][0]:
                scores[term] = gain, abs(TERMS[term].size(neutral | own | estimates))
    return scores


def _directions(search: ModelSearch, larger: ModelStructure) -> list[tuple[str, ...]]:
    """Return the parameters of a larger model that move together in the fitted one."""
    separated = larger.tracks != search.structure.tracks
    return [separate_track_names(name) if separated else (name,) for name in search.fit.parameters]


def _brought(larger: ModelStructure, terms: Sequence[str]) -> dict[str, list[tuple[str, ...]]]:
    """Return what each term adds to a model as directions."""
    return {term: [(name,) for name in TERMS[term].parameters(larger.tracks, larger.layout)] for term in terms}


def with_best_start(search: ModelSearch, term: str) -> ModelSearch:
    """Return the search with the start of its structure from which a linear term gains most: the mounting of an engine, say."""
    is_open = TERMS[term].adds_coordinates and not search.structure.is_nonlinear
    return _of_larger_model(search, term)[0] if is_open else search


def _of_larger_model(search: ModelSearch, term: str) -> tuple[ModelSearch, tuple[float, float]]:
    own, sensors = search.fit.parameters, search.structure.sensors
    best, score, larger = search.structure, (0.0, 0.0), search.with_terms([term])
    variants = start_variants(term, larger, own)
    starts = [neutral_values(variant, own) for variant in variants]
    tests = score_linear_term(search.fit, larger.linear_models, sensors, larger.known, starts)
    for variant, (gain, estimates) in zip(variants, tests, strict=True):
        if gain >= score[0]:
            score = gain, abs(TERMS[term].size(estimates))
            best = replace(
                search.structure,
                engine_frequency=variant.engine_frequency,
                engine_place=variant.engine_place,
                body_frequency=variant.body_frequency,
                seat_place=variant.seat_place,
            )
    return replace(search, structure=best), score


def _nonlinear(search: ModelSearch, terms: Sequence[str]) -> tuple[ModelSearch, Scores]:
    """Score nonlinear terms; a curve of dampers tells by the way whether they flatten beyond their knee or steepen."""
    larger, own = search.with_terms(terms), search.fit.parameters
    candidates = {term: TERMS[term].parameters(larger.tracks, larger.layout) for term in terms}
    tests = score_nonlinear_terms(search.fit, larger.nonlinear_models, neutral_values(larger, own), candidates)
    ratios = [value for name, value in tests.get(DAMPER_CURVE, (0.0, {}))[1].items() if name.startswith("q")]
    if ratios:
        search = replace(search, structure=replace(search.structure, dampers_steepen=sum(ratios) > len(ratios)))
    return search, {term: (gain, abs(TERMS[term].size(own | estimates))) for term, (gain, estimates) in tests.items()}


def _nonlinear_with_stops(search: ModelSearch, terms: Sequence[str]) -> tuple[ModelSearch, Scores]:
    """Score nonlinear terms; bump stops where they gain most, if they gain enough anywhere."""
    gaps = stop_gaps(search.structure, search.fit, search.decays) if BUMP_STOP in terms else []
    variants = [replace(search, structure=replace(search.structure, stop_gap=gap)) for gap in gaps] or [search]
    first, scores = _nonlinear(variants[0], terms)
    if scores.get(BUMP_STOP, (0.0, 0.0))[0] < search.required(BUMP_STOP):
        return first, scores
    stops = [scores[BUMP_STOP], *(_nonlinear(variant, [BUMP_STOP])[1][BUMP_STOP] for variant in variants[1:])]
    best = max(range(len(stops)), key=lambda i: stops[i][0])
    structure = replace(first.structure, stop_gap=variants[best].structure.stop_gap)
    return replace(first, structure=structure), scores | {BUMP_STOP: stops[best]}


def _stepped(search: ModelSearch, terms: Sequence[str]) -> Scores:
    """Score any terms at a nonlinear fit, in one evaluation of the model that has them all; but for mounts.

    The sizes to expect are not computed, and the typical ones are returned.
    """
    # A mount that is nearly rigid follows faster than any step, which the scores of all terms beside it show.
    groups = [[term for term in terms if term != DAMPER_MOUNT], [term for term in terms if term == DAMPER_MOUNT]]
    # Behind a low-pass the motion between the samples that are left would be missed.
    rate, duration = (_RATE, _DURATION) if search.structure.low_pass is None else (np.inf, _BEHIND_LOW_PASS)
    decays, part = thinned(search.decays, rate, duration)
    gains = {term: gain for group in groups if group for term, gain in _score_together(search, decays, group).items()}
    # What a parameter gains by chance, its share of the noise, is as much in a part of the samples as in all of them.
    chance = {term: float(len(brought)) for term, brought in _brought(search.with_terms(terms), terms).items()}
    whole = {term: chance[term] + max(gain - chance[term], 0.0) / part for term, gain in gains.items()}
    return {term: (gain, TERMS[term].typical) for term, gain in whole.items()}


def _score_together(search: ModelSearch, decays: Sequence[FreeDecay], terms: Sequence[str]) -> dict[str, float]:
    """Score terms at a nonlinear fit in one evaluation of the model that has them all."""
    largest = search.with_terms(terms)
    return score_stepped_terms(
        decays,
        largest.nonlinear_models,
        search.structure.sensors,
        largest.known,
        values=neutral_values(largest, search.fit.parameters),
        states=states_by_coordinates(search.fit.states, search.fit.names, largest.names),
        together=_directions(search, largest),
        candidates=_brought(largest, terms),
        longest_step=_SAMPLE / min(decay.rate for decay in search.decays),
        tilting=search.structure.gravity_leakage,
        low_pass=search.structure.low_pass,
    )


def of_first_parts(ranked: Sequence[str]) -> list[str]:
    """Return those of some terms that are laws of the first few parts: scores do not tell laws of one part apart.

    Parameters
    ----------
    ranked
        Nonlinear terms, best first.
    """
    first = [*dict.fromkeys(TERMS[term].part or term for term in ranked)][:_PARTS]
    return [term for term in ranked if (TERMS[term].part or term) in first]
