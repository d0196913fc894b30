"""Contact in the search for the model: a model with more terms shows better where the last tyre touched for good.

Samples in which a wheel is still off the ground are explained by no model of one that is not. As long as they are fitted, every
gain is small beside what they leave.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import (
    CONVERGED,
    CONVERGED_IN_STEPS,
    MOST_STEPS,
    NEAR,
    FitResult,
    fit_from_contact,
    fit_from_start,
)
from sprung.preprocess import FreeDecay
from sprung.selection.search import ModelSearch
from sprung.selection.starts import fit_structure

Real = NDArray[np.float64]

_SETTLED = 0.03
"""Expected gain in log-likelihood at which a fit by time stepping has converged, as a part of the overdispersion of a model
with errors: a sixth of a standard error."""

_RINGS = 0.03
"""s for which the filter of a logger rings from what was before a landing: one of 100 Hz to less than a thousandth."""

_ON_THE_WAY = 1.0
"""Expected gain in log-likelihood, as a part of the overdispersion, at which a fit ends beside which further terms are tried:
each has to gain many times it."""


def from_contact(search: ModelSearch, most: int = MOST_STEPS, on_the_way: bool = False) -> ModelSearch:
    """Let every decay begin where all tyres of the fitted vehicle stay on the ground, and fit again.

    Parameters
    ----------
    search
        The present model and its fit, of the decays or of their beginnings.
    most
        Largest number of iterations.
    on_the_way
        Whether further terms are to be tried beside the fit, so that it need not end where a result may be taken from it.

    Returns
    -------
    ModelSearch
    """
    enough = _ON_THE_WAY * search.overdispersion if on_the_way else final_tolerance(search)
    moved = _moved_to_contact(search, enough, most)
    if moved is not search:
        return moved
    fit = _refit(search, enough, most, search.decays, search.fit, search.fit.states)
    return replace(search, decays=tuple(search.decays), fit=fit)


def without_landings(search: ModelSearch) -> ModelSearch:
    """Let decays begin later in which a model that explains more shows the rest of a landing, and fit again.

    Parameters
    ----------
    search
        The present model and its fit, on the way to one with further terms.

    Returns
    -------
    ModelSearch
        As given where no decay begins elsewhere.
    """
    return _moved_to_contact(search, _ON_THE_WAY * search.overdispersion, MOST_STEPS)


def _moved_to_contact(search: ModelSearch, enough: float, most: int) -> ModelSearch:
    """Return the search with decays that begin at the last contact, fitted; as given where none moves."""
    decays, fit = fit_from_contact(
        search.decays, search.structure.linear_models, search.fit, lambda *start: _refit(search, enough, most, *start)
    )
    return search if fit is search.fit else replace(search, decays=decays, fit=fit)


def final_tolerance(search: ModelSearch) -> float:
    """Return the expected gain in log-likelihood at which a fit has converged from which a result may be taken.

    Parameters
    ----------
    search
        The model that is fitted, and a fit that shows its overdispersion.

    Returns
    -------
    float
        Dimensionless.
    """
    if not search.structure.is_time_stepped:
        return CONVERGED
    # Where the model has errors, statements about the vehicle move the fit again, once its overdispersion is known.
    return CONVERGED_IN_STEPS if search.overdispersion == 1 else _SETTLED * search.overdispersion


def is_likelier(search: ModelSearch, other: ModelSearch) -> bool:
    """Whether a model explains the decays better than another one, by the Bayesian information criterion.

    Parameters
    ----------
    search, other
        Of the same drops. Where their decays begin at different samples, the later ones count: in those before, one of the
        models has a wheel off the ground.

    Returns
    -------
    bool
    """
    if search.decays is not other.decays:
        starts = [max(decay.start, another.start) for decay, another in zip(search.decays, other.decays, strict=True)]
        search, other = _begun_at(search, starts), _begun_at(other, starts)
    return search.delta_bic(other) > 0


def begin_no_later(search: ModelSearch, decays: Sequence[FreeDecay]) -> ModelSearch:
    """Let decays begin not much later than other decays of the same drops do, and fit the model to them.

    Parameters
    ----------
    search
        The present model and its fit.
    decays
        As the accelerometers show them: all tyres are on the ground. To a model that lacks something they may seem to hop for
        longer, and what it lacks shows best in the samples that it gave up, but for those in which the filter of a logger may
        still ring. After a push or a bump only the fitted vehicle shows from when on it moves freely.

    Returns
    -------
    ModelSearch
        As given where none begins later.
    """
    latest = {decay.file: decay.start + _RINGS for decay in decays if not decay.is_driven}
    starts = [min(decay.start, latest.get(decay.file, decay.start)) for decay in search.decays]
    return _begun_at(search, starts)


def _begun_at(search: ModelSearch, starts: Sequence[float]) -> ModelSearch:
    """Return the search with decays that begin at later times, s, and its model fitted to them."""
    shifts = [decay.samples_to(start) for start, decay in zip(starts, search.decays, strict=True)]
    if not any(shifts):
        return search
    enough = search.overdispersion if search.structure.is_time_stepped else NEAR
    decays, fit = fit_from_start(
        search.decays, shifts, search.fit, lambda *start: _refit(search, enough, MOST_STEPS, *start)
    )
    return replace(search, decays=decays, fit=fit)


def _refit(
    search: ModelSearch, enough: float, most: int, decays: Sequence[FreeDecay], fit: FitResult, states: Real
) -> FitResult:
    return fit_structure(search.structure, decays, fit, enough, search.progress, states, most=most)
