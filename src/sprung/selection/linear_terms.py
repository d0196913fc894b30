"""Extras that matrices carry: fitted and weighed one by one, as that is quick, the most promising first.

An extra is taken if it gains more than the Bayesian information criterion asks for its parameters (Schwarz, Ann. Stat. 6 (1978)
461), the residuals' colour and the drops' disagreement allowed for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.estimation import NEAR, fit_linear, score_linear_term
from sprung.progress import Step
from sprung.selection.search import ModelSearch
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import ENGINE, SEPARATE, has_masses, neutral_start, variants
from sprung.vehicle import LINEAR_EXTRAS

_WHOLLY = frozenset({"asymmetry", "rigid-axle", "engine"})
"""Extras that look like many a mistake with sensors and loads: they explain the records wholly, or they are not there."""

_UNLIKELY = 0.25
"""Part of the gain that is asked of a larger model below which it is not even fitted."""


def select_roll_axis_height(way: ModelSearch) -> ModelSearch:
    """Let the records decide at which of two heights the body is carried, where they may."""
    if not way.structure.heights.is_ambiguous:
        return way
    other = way.refit(replace(way.structure, carried_at="roll axis"))
    return other if other.fit.loglikelihood > way.fit.loglikelihood else way


def select_linear_terms(way: ModelSearch, among: Sequence[str] = (SEPARATE, *LINEAR_EXTRAS)) -> ModelSearch:
    """Try the extras that matrices carry, or some of them, the most promising first, until none gains what is asked."""
    refused: set[str] = set()
    while True:
        still = [extra for extra in way.open_among(among) if extra not in refused]
        found = {extra: _promised(way, extra) for extra in still}
        promised = {extra: gain for extra, (gain, _) in found.items()}
        hopeful = [extra for extra, gain in promised.items() if gain > _UNLIKELY * way.asked(extra)]
        way = way.noted({extra: gain for extra, gain in promised.items() if extra not in hopeful}, False, False)
        if not hopeful:
            return way
        extra = max(hopeful, key=promised.__getitem__)
        refused |= (promised.keys() - set(hopeful)) | {extra}
        tried = _fitted(way, found[extra][1], extra)
        gain = 2 * (tried.fit.loglikelihood - way.fit.loglikelihood) / tried.fit.disagreement
        against = tried.against(extra, tried.inflation) if tried.fit.converged else "the fit with it did not settle"
        enough = gain > way.asked(extra)
        larger = tried.noted({extra: gain}, True, True)
        if enough and not against and extra in _WHOLLY and tried.errs:
            larger = select_linear_terms(larger, [one for one in among if one not in _WHOLLY])
            against = "it does not explain the whole misfit" if larger.errs else ""
        if enough and not against:
            way = larger
            refused.clear()
        else:
            way = way.noted({extra: gain}, True, False, against if enough else "")
            way = replace(way, structure=replace(way.structure, engine_mounting=tried.structure.engine_mounting))


def fit_requested_terms(way: ModelSearch, extras: Sequence[str]) -> ModelSearch:
    """Fit linear extras that are wanted, whatever they gain."""
    for extra in extras:
        way = fit_term(way, extra)
    return way


def score_linear_terms(search: ModelSearch) -> dict[str, float]:
    """Return what each open linear term would gain, in twice the log-likelihood over the overdispersion, by its score test."""
    return {term: _promised(search, term)[0] for term in search.open_among((SEPARATE, *LINEAR_EXTRAS))}


def _promised(way: ModelSearch, extra: str) -> tuple[float, ModelStructure]:
    """Give what a linear extra would gain, and the model that has it, begun where it would gain most."""
    sensors, own = way.structure.campaign.sensors, way.fit.parameters
    larger = way.larger([extra])
    gains = [
        (score_linear_term(way.decays, one.linear_models, sensors, one.known, neutral_start(one, own)), one)
        for one in variants(extra, larger, own)
    ]
    gain, best = max(gains, key=lambda each: each[0], default=(0.0, larger))
    return gain / way.fit.disagreement, best


def fit_term(way: ModelSearch, extra: str) -> ModelSearch:
    """Fit a linear extra, begun where it promises most."""
    return _fitted(way, _promised(way, extra)[1], extra)


def _fitted(way: ModelSearch, larger: ModelStructure, extra: str) -> ModelSearch:
    """Fit a model with one more extra; with an engine, without which all may be wrong, from nothing as well."""
    way.progress(Step(f"fitting with {extra}"))
    begins = extra != ENGINE or has_masses(larger, way.fit.parameters)
    ends = [way.refit(larger)] if begins else []
    if extra == ENGINE:
        sensors, known = larger.campaign.sensors, larger.known
        anew = fit_linear(way.decays, larger.linear_models, sensors, known, enough=NEAR, progress=way.progress)
        ends.append(replace(way, structure=larger, fit=anew.after(way.fit)))
    return max(ends, key=lambda end: (end.fit.converged, end.fit.loglikelihood))
