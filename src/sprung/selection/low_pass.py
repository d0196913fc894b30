"""The low-pass of the loggers: whether the recordings show one that all channels passed, and where its corner is.

It moves no mode, but harmonics of knees and friction come later behind it than the wheels' motion. Nobody states it: once the
vehicle has forces that are not linear, its corner is one more unknown of their fit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import HIGHEST_CORNER, LowPass, SampledLowPass, wald_test
from sprung.progress import Step
from sprung.selection.search import ModelSearch
from sprung.vehicle import LOW_PASS_CORNER

Real = NDArray[np.float64]

_ORDER = 4
"""Of the anti-alias filters of loggers."""

_MILD, _USUAL = 160.0, 100.0
"""Corners near which a fit begins, Hz: if there is any low-pass, one that does little explains more than none."""

_COLOURED = 1.1
"""Overdispersion from which a low-pass is looked for: it moves what is left by little."""

_BELOW = 0.8
"""Part of a corner that was found from which another fit begins."""

_LOWEST = 25.0
"""Hz below which no logger cuts off the motion of wheels."""

_FIRST, _ITERATIONS, _MOST = 1, 12, 100
"""Iterations after which a low-pass that is there explains more, as it moves the optimum by little; at the most until its
corner is found; and of a whole fit."""

_TELLS, _CERTAINLY = 2, 10.0
"""Iterations after which a fit that is as free tells what it may reach, and by how many times what it is expected to gain still
the one behind a low-pass is ahead of it then."""


def select_low_pass(search: ModelSearch) -> ModelSearch:
    """Return the search with a low-pass of the loggers before the recordings, if they support it.

    Parameters
    ----------
    search
        A model whose motion is computed by time stepping, and its fit.

    Returns
    -------
    ModelSearch
    """
    structure = search.structure
    if not structure.is_nonlinear or structure.low_pass is not None:
        return search
    # Where every usual term was fitted at once, what the low-pass does may be made up for by knees and mounts.
    if search.overdispersion < _COLOURED and not structure.usual:
        return search
    search.progress(Step("looking for a low-pass of the loggers"))
    # Motions before a low-pass are stepped more finely: one at infinity does nothing else.
    without = _refit_behind(search, LowPass(np.inf, _ORDER), _FIRST, beginning_only=True)
    mild_corner, usual_corner = (_with_whole_delay(search, corner) for corner in (_MILD, _USUAL))
    mild = _begin_behind(search, mild_corner)
    usual = _begin_behind(search, usual_corner) if usual_corner < mild_corner else mild
    found = max(mild, usual, key=lambda one: one.fit.loglikelihood)
    if not found.gain_over(without) > 0:
        return search
    found = found.refit(found.structure, _ITERATIONS, beginning_only=True)
    if not _is_possible(found) or not _gains_enough(found, without):
        return search
    if found.is_overdispersed:
        # Steps of time in which friction turns round make the likelihood rough: it is climbed from below as well.
        lower = _refit_behind(search, LowPass(_BELOW * corner_of(found), _ORDER), beginning_only=True)
        found = max(found, lower, key=lambda one: one.fit.loglikelihood)
    found = _refit_behind(found, LowPass(corner_of(found), _ORDER), beginning_only=True)
    # What records may show behind it is free, as nothing tells what it remembers: without it a fit has to be as free.
    free = _as_free(without, found)
    # Where more is missing, the freedom explains some of that: it is enough to explain more, until all else is found.
    if not found.gain_over(free) > (0.0 if search.is_overdispersed else search.required_of_switch):
        return search
    is_whole = sum(decay.samples for decay in found.fit.decays) == sum(decay.samples for decay in search.decays)
    whole = found if is_whole else found.refit(found.structure)
    return whole if _gains_enough(whole, search) else search


def confirm_low_pass(search: ModelSearch) -> ModelSearch:
    """Return the search with the low-pass that its larger model has, or none: a term may explain now what it explained.

    Parameters
    ----------
    search
        A model and its fit.

    Returns
    -------
    ModelSearch
    """
    if search.structure.low_pass is None:
        return search
    lost = wald_test(search.fit, [(LOW_PASS_CORNER, _highest(search))]) / search.overdispersion
    is_there = _is_possible(search) and lost > search.required_of_switch
    if is_there and search.is_overdispersed:
        # Where more is missing, the likelihood may rise nowhere from one to none.
        without = _refit_behind(search, LowPass(np.inf, _ORDER), beginning_only=True)
        is_there = _gains_enough(search.refit(search.structure, beginning_only=True), without)
    return search if is_there else _refit_behind(search, None)


def corner_of(search: ModelSearch) -> float:
    """Return the corner of the low-pass of the loggers as the recordings show it, Hz; infinite without any.

    Parameters
    ----------
    search
        A model and its fit.

    Returns
    -------
    float
    """
    return search.fit.parameters.get(LOW_PASS_CORNER, np.inf)


def _highest(search: ModelSearch) -> float:
    """Return the corner in Hz from which a low-pass does nothing to any recording."""
    return HIGHEST_CORNER * min(decay.rate for decay in search.decays)


def _as_free(without: ModelSearch, found: ModelSearch) -> ModelSearch:
    """Fit a model without a low-pass with the same freedom; not to the end where it cannot become likelier than with it."""
    free = LowPass(corner_of(found), _ORDER, passes_all=True)
    first = _refit_behind(without, free, _TELLS, beginning_only=True)
    may_gain = _CERTAINLY * first.fit.remaining_gain / first.overdispersion
    is_certain = found.gain_over(first) > first.required_of_switch + may_gain
    return first if first.fit.converged or is_certain else first.refit(first.structure, beginning_only=True)


def _with_whole_delay(search: ModelSearch, corner: float) -> float:
    """Return the corner near one in Hz at which slow motions come later by whole samples: a part of one is no mild change."""
    rate = min(decay.rate for decay in search.decays)
    samples = LowPass(corner, _ORDER).delay * rate
    return corner * samples / max(round(samples), 1)


def _is_possible(search: ModelSearch) -> bool:
    """Whether a logger may have the corner that was found, and the recordings show it."""
    return _LOWEST < corner_of(search) < _highest(search)


def _gains_enough(search: ModelSearch, without: ModelSearch) -> bool:
    return search.gain_over(without) > search.required_of_switch


def _begin_behind(search: ModelSearch, corner: float) -> ModelSearch:
    """Take the first steps of a fit behind a low-pass with a corner in Hz to the beginnings of the decays."""
    return _refit_behind(search, LowPass(corner, _ORDER), _FIRST, beginning_only=True)


def _refit_behind(
    search: ModelSearch, low_pass: LowPass | None, most: int = _MOST, beginning_only: bool = False
) -> ModelSearch:
    """Fit the model behind a low-pass, or behind none."""
    structure = replace(search.structure, low_pass=low_pass)
    return search.refit(structure, most, beginning_only, states=states_behind(search, low_pass))


def states_behind(search: ModelSearch, low_pass: LowPass | None) -> Real:
    """Return states and memories of each drop with which slow motions come behind another low-pass when they came.

    Part of a sample is enough to lead a fit astray: wheels move by many times the noise in it.

    Returns
    -------
    ndarray
        SI, shape (drop, state + memory).
    """
    states, corner = [], corner_of(search)
    for drop, decay in enumerate(search.fit.decays):
        before, after = (SampledLowPass.of(one, decay.rate) for one in (search.structure.low_pass, low_pass))
        present = before.with_corner(corner) if np.isfinite(corner) else before
        later = (after.remaining_delay - present.remaining_delay) * decay.rate
        # The parabola through the first three samples.
        weights = (1 - later) * (2 - later) / 2, later * (2 - later), later * (later - 1) / 2
        states.append(search.fit.motion(drop, 0, 3) @ np.array(weights))
    return np.array(states)
