"""The search from the rich end: an ordinary vehicle that has every usual term, of which what is not needed is left out.

A forward search from a model that lacks several terms goes astray: each term that it tries takes up some of what the others
would explain. From a vehicle in which every usual term has its usual size the way to the optimum is short. Usual sizes are weak
priors, so that a term of which the records say little keeps the size that it usually has.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sprung.estimation import NEAR, UsualValue, VehicleSize, fit_linear, usual_vehicle
from sprung.progress import Step
from sprung.selection.error_budget import MISFIT_LEFT, MISFIT_LEFT_AT_FIRST
from sprung.selection.linear_terms import BENDING, TWIST
from sprung.selection.search import ModelSearch
from sprung.selection.starts import start_values, start_variants
from sprung.selection.stepwise import select_further_terms
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS

_SPREADS: Mapping[str, float] = {
    "m_s": 1.15,
    "I_yy": 1.4,
    "I_xx": 1.7,
    "m_u": 1.5,
    "k_s": 1.8,
    "k_t": 1.7,
    "c_s": 2.0,
    "a": 1.25,
    "b": 1.25,
    "t_": 1.2,
}
"""Factors within which a parameter of an ordinary vehicle usually is, where only its size is known, by the first letters of its
name (Gillespie, Fundamentals of Vehicle Dynamics, 1992; Heydinger and others, SAE 1999-01-1336)."""

_FIRST_ITERATIONS, _ITERATIONS = 8, 22
"""Of the fit of the ordinary vehicle: after the first it has to have explained some of the misfit, and then at the most."""

_HELD = 1.1
"""Factor within which a parameter is held that means little where its term is small."""


def ordinary_vehicle(structure: ModelStructure) -> tuple[dict[str, float], dict[str, UsualValue]]:
    """Return an ordinary vehicle with the terms of a structure, each of its usual size.

    Parameters
    ----------
    structure
        The model.

    Returns
    -------
    values
        Parameters by name, SI.
    usual
        Usual values of all parameters that are not those of a load, with their spread.
    """
    own = usual_vehicle(VehicleSize.of(structure.known, structure.campaign.sensors))
    plain = structure.with_terms(())
    masses = {name: known.value for name, known in structure.known.items() if name in structure.names}
    own = {name: own[name] for name in plain.names if name in own} | masses
    values = start_values(structure, own)
    for term in structure.terms:
        usual_of = TERMS[term].usual
        if usual_of is not None:
            values |= {name: value for name, value in usual_of(own, structure).items() if name in values}
    usual = {
        name: UsualValue(values[name], spread)
        for name in plain.names
        for start, spread in _SPREADS.items()
        if name.startswith(start)
    }
    return values, usual | usual_sizes(structure, values)


def usual_sizes(structure: ModelStructure, values: Mapping[str, float]) -> dict[str, UsualValue]:
    """Return the usual values of the parameters of a structure's terms, where they are those of a vehicle's.

    Parameters
    ----------
    structure
        The model.
    values
        Parameters of a vehicle with terms of usual size, SI, by name.
    """
    return {
        name: UsualValue(values[name], TERMS[term].spread)
        for term in structure.terms
        for name in TERMS[term].parameters(structure.tracks)
        if values[name] > 0
    }


def held_sizes(structure: ModelStructure, values: Mapping[str, float]) -> dict[str, UsualValue]:
    """Return the usual values of parameters that mean little where their term is small, with a narrow spread.

    Parameters
    ----------
    structure, values
        As for `usual_sizes`.
    """
    held = tuple(TERMS[term].held for term in structure.terms if TERMS[term].held)
    usual = usual_sizes(structure, values)
    return {name: UsualValue(value, _HELD) for name, (value, _) in usual.items() if name.startswith(held)}


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
    if not search.is_misfit_large:
        return search
    found: dict[str, ModelSearch] = {}
    for term in search.open_terms((TWIST, BENDING)):
        search.progress(Step(f"fitting an ordinary vehicle with {term}"))
        larger = search.with_terms([term])
        ends = [_fit_from_ordinary(search, variant) for variant in start_variants(term, larger, search.fit.parameters)]
        found[term] = max(ends, key=lambda end: end.fit.loglikelihood)
    for term, tried in sorted(found.items(), key=lambda item: -item[1].fit.loglikelihood):
        gain = tried.gain_over(search)
        if search.leaves_misfit(tried.fit, MISFIT_LEFT) or tried.veto(term) or gain < search.required(term):
            search = search.recorded({term: gain}, True, False, "an ordinary vehicle with it explains no more")
        else:
            return replace(tried, steps=search.steps).recorded({term: gain}, True, True)
    return search


def _fit_from_ordinary(search: ModelSearch, structure: ModelStructure) -> ModelSearch:
    """Fit a linear structure from an ordinary vehicle that has it."""
    values, _ = ordinary_vehicle(structure)
    models, sensors, known = structure.linear_models, structure.sensors, structure.known
    fit = fit_linear(search.decays, models, sensors, known, start=values, enough=NEAR, most=_ITERATIONS)
    return replace(search, structure=structure, fit=fit.after(search.fit))


def select_from_ordinary_vehicle(search: ModelSearch, plain: ModelStructure) -> ModelSearch:
    """Return the search from an ordinary vehicle with every usual term, without those that are not needed.

    Parameters
    ----------
    search
        The present model and its fit.
    plain
        The structure without anything that the recordings brought into it.

    Returns
    -------
    ModelSearch
        Model and fit as given where the ordinary vehicle explains no more.
    """
    terms = tuple(name for name in plain.open_terms if TERMS[name].usual is not None)
    if not terms:
        return search
    search.progress(Step("fitting an ordinary vehicle with every usual term"))
    found = _fit_ordinary(search, plain.with_terms((*plain.terms, *terms)))
    if found is None or search.leaves_misfit(found.fit, MISFIT_LEFT):
        against = "together they do not explain what the model so far leaves"
        return search.recorded(dict.fromkeys(terms, 0.0), True, False, against)
    found = _without_unneeded(found)
    return select_further_terms(found.refit(found.structure))


def _fit_ordinary(search: ModelSearch, rich: ModelStructure) -> ModelSearch | None:
    """Fit the ordinary vehicle to the beginnings of the decays; None where it leaves too much of the misfit at first.

    Usual values stay as priors of the terms alone. What no term would need to gain does not matter yet.
    """
    values, usual = ordinary_vehicle(rich)
    at_start = fit_linear(
        search.decays, rich.linear_models, rich.sensors, rich.known, start=values, usual=usual, most=0
    )
    held = replace(rich, usual=usual | held_sizes(rich, values))
    found = replace(search, structure=held, fit=at_start)
    found = found.refit(held, _FIRST_ITERATIONS, beginning_only=True, enough=search.required_of_switch)
    if search.leaves_misfit(found.fit, MISFIT_LEFT_AT_FIRST):
        return None
    if not found.fit.converged:
        found = found.refit(held, _ITERATIONS, beginning_only=True, enough=search.required_of_switch)
    return replace(found, structure=replace(rich, usual=usual_sizes(rich, values)))


def _without_unneeded(search: ModelSearch) -> ModelSearch:
    """Leave out all terms that are not missed together, and fit what is left to the beginnings of the decays."""
    while True:
        against = {term: search.veto(term) for term in search.selected}
        gains = {term: search.wald_gain(term) for term in search.selected}
        unneeded: list[str] = []
        for term in sorted(gains, key=lambda term: gains[term] / search.required(term)):
            together = [*unneeded, term]
            if against[term] or search.wald_gain(*together) < sum(map(search.required, together)):
                unneeded = together
        if not unneeded:
            return search.recorded(gains, True, True)
        for term in unneeded:
            search = search.recorded({term: gains[term]}, True, False, against[term])
        kept = tuple(term for term in search.structure.terms if term not in unneeded)
        search = search.refit(search.structure.with_terms(kept), _ITERATIONS, beginning_only=True)
