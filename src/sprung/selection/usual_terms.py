"""Fits of vehicles whose terms have their usual sizes at first, to the beginnings of the decays.

A fit of everything at once from there may lose a term, friction above all, which then is tried once more.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from sprung.estimation import fit_linear
from sprung.selection.linear_terms import FLEXIBLE_BODIES
from sprung.selection.ordinary_vehicle import FIRST_ITERATIONS, ITERATIONS, held_sizes, ordinary_vehicle, usual_sizes
from sprung.selection.search import ModelSearch
from sprung.selection.structure import ModelStructure
from sprung.selection.terms import TERMS


def open_usual_terms(structure: ModelStructure) -> tuple[str, ...]:
    """Return the terms about which the recordings decide that most vehicles have.

    Parameters
    ----------
    structure
        The model, which does not have them.
    """
    return tuple(term for term in structure.open_terms if TERMS[term].usual is not None and term not in structure.terms)


def open_usual_linear_terms(structure: ModelStructure) -> tuple[str, ...]:
    """Return those of `open_usual_terms` that are linear and need no other term: rubber, and tyres that damp.

    Parameters
    ----------
    structure
        The model, which does not have them.
    """
    terms = open_usual_terms(structure)
    return tuple(term for term in terms if TERMS[term].is_linear and not TERMS[term].refines)


def begin_with_usual_terms(search: ModelSearch, rich: ModelStructure) -> ModelSearch:
    """Take the first steps of `fit_usual_terms`, which show how much of the misfit it may explain.

    Parameters
    ----------
    search
        The present model and its fit.
    rich
        What is fitted.

    Returns
    -------
    ModelSearch
    """
    start, _ = _at_usual_values(search, rich)
    return _refit_beginnings(search, start, start.structure, FIRST_ITERATIONS)


def fit_usual_terms(
    search: ModelSearch, rich: ModelStructure, *, first: ModelSearch | None = None, with_lost: bool = True
) -> ModelSearch | None:
    """Fit a structure from an ordinary vehicle whose terms have their usual sizes, to the beginnings of the decays.

    A fit of everything at once may lose friction, of one axle even, and what resembles it then makes up for it: it begins
    without friction then.

    Parameters
    ----------
    search
        The present model and its fit.
    rich
        What is fitted.
    first
        Its first steps, if they are taken already.
    with_lost
        Whether terms that were lost are tried once more.

    Returns
    -------
    ModelSearch or None
        With usual values as priors of the terms. None where it leaves too much of the misfit at first.
    """
    start, values = _at_usual_values(search, rich)
    rich = start.structure
    best = _fit_beginnings(search, start, rich, first and replace(first, steps=search.steps))
    lost = {term for term in rich.terms if TERMS[term].resembles_others and (best is None or best.is_lost(term))}
    if lost and with_lost:
        without = start.without(*lost)
        other = _fit_beginnings(search, start, without) if best is None else _refit_beginnings(search, best, without)
        again = None if other is None else _fit_again(search, other, rich, lost)
        best = max(
            (end for end in (best, again) if end is not None), key=lambda end: end.fit.loglikelihood, default=None
        )
    return None if best is None else replace(best, structure=replace(rich, usual=usual_sizes(rich, values)))


def _at_usual_values(search: ModelSearch, rich: ModelStructure) -> tuple[ModelSearch, dict[str, float]]:
    """Return a structure at the ordinary vehicle that has its terms, held where they mean little; and that one's values."""
    values, usual = ordinary_vehicle(rich)
    # No size is usual for a body that is flexible: it is as the present fit has it.
    of_body = [name for term in FLEXIBLE_BODIES for name in TERMS[term].parameters(rich.tracks, rich.layout)]
    values |= {name: search.fit.parameters[name] for name in of_body if name in search.fit.names and name in rich.names}
    fit = fit_linear(search.decays, rich.linear_models, rich.sensors, rich.known, start=values, usual=usual, most=0)
    return replace(search, structure=replace(rich, usual=usual | held_sizes(rich, values)), fit=fit), values


def _fit_beginnings(
    search: ModelSearch, start: ModelSearch, structure: ModelStructure, first: ModelSearch | None = None
) -> ModelSearch | None:
    """Fit a structure from a start; None where much of the misfit is left after some steps."""
    found = first or _refit_beginnings(search, start, structure, FIRST_ITERATIONS)
    if search.leaves_most(found.fit):
        return None
    return found if found.fit.converged else _refit_beginnings(search, found, structure)


def _fit_again(
    search: ModelSearch, start: ModelSearch, structure: ModelStructure, lost: Collection[str]
) -> ModelSearch:
    """Fit a structure from a fit without terms that were lost; not to the end where they are lost once more."""
    found = _refit_beginnings(search, start, structure, FIRST_ITERATIONS)
    if found.fit.converged or any(found.is_lost(term) for term in lost):
        return found
    return _refit_beginnings(search, found, structure)


def _refit_beginnings(
    search: ModelSearch, start: ModelSearch, structure: ModelStructure, most: int = ITERATIONS
) -> ModelSearch:
    """Fit a structure until what is left to gain is less than any term needs."""
    return start.refit(structure, most, beginning_only=True, enough=search.required_of_switch)


def likeliest_or_ordinary(search: ModelSearch, ends: Sequence[ModelSearch], structure: ModelStructure) -> ModelSearch:
    """Return the likeliest of some fits of a nonlinear structure and of that from an ordinary vehicle with its terms.

    A linear vehicle that had to make up for what is missing may be one from which no step leads back.

    Parameters
    ----------
    search
        The model so far and its fit.
    ends
        Fits that began from it.
    structure
        Their model.

    Returns
    -------
    ModelSearch
    """
    ordinary = fit_usual_terms(search, structure)
    return max(ends if ordinary is None else [*ends, ordinary], key=lambda end: end.fit.loglikelihood)
