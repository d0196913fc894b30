"""The low-pass of the loggers: whether the recordings show one that all channels passed, and where its corner is.

It moves no mode, but harmonics of knees and friction come later behind it than the wheels' motion. Nobody states it: the
recordings decide by their likelihood, once the vehicle has forces that are not linear.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import HIGHEST_CORNER, LowPass, SampledLowPass
from sprung.progress import Step
from sprung.selection.search import ModelSearch

Real = NDArray[np.float64]

_ORDER = 4
"""Of the anti-alias filters of loggers."""

_CORNER, _RATIO = 100.0, 1.25
"""Corner that is tried first, Hz, and how far apart others are; half as far around one that was found."""

_COLOURED = 1.1
"""Overdispersion from which a low-pass is looked for: it moves what is left by little."""

_SAME = 0.05
"""Relative difference of corners that is none in practice."""

_NARROW, _FINE = 0.25, 0.02
"""Logarithm of the ratio of corners between which the gain is a parabola, and of one from the best to be compared as well."""

_LOWEST = 25.0
"""Hz below which no logger cuts off the motion of wheels."""

_ITERATIONS, _MOST = 3, 100
"""Iterations at the most before corners are compared, as a low-pass moves the optimum by little; and of a whole fit."""


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
    if not structure.is_nonlinear or structure.low_pass is not None or search.overdispersion < _COLOURED:
        return search
    likeliest = _likeliest(search, _CORNER, _RATIO)
    if likeliest is None:
        return search
    near, corner = likeliest
    found = _refit_behind(near, LowPass(corner, _ORDER))
    return found if found.gain_over(search) > search.required_of_switch else search


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
    present = search.structure.low_pass
    if present is None:
        return search
    likeliest = _likeliest(search, present.corner, _RATIO**0.5)
    if likeliest is None:
        return _refit_behind(search, None)
    near, corner = likeliest
    return search if abs(np.log(corner / present.corner)) < _SAME else _refit_behind(near, LowPass(corner, _ORDER))


def _likeliest(search: ModelSearch, first: float, ratio: float) -> tuple[ModelSearch, float] | None:
    """Return the corner that explains the beginnings of the decays best, climbed to from a first one, and a fit near to it.

    Hz; None where none explains enough.
    """
    highest = HIGHEST_CORNER * min(decay.rate for decay in search.decays)
    search.progress(Step("looking for a low-pass of the loggers"))
    # From behind a low-pass to none it may be far.
    most = _ITERATIONS if search.structure.low_pass is None else _MOST
    without = _refit_behind(search, LowPass(np.inf, _ORDER), most, beginning_only=True)
    fits: dict[float, ModelSearch] = {}
    gains: dict[float, float] = {}
    waiting = [min(first, 0.9 * highest)]
    while waiting := [corner for corner in waiting if _LOWEST < corner < highest]:
        for corner in waiting:
            fits[corner] = _begin_behind(_nearest(fits, corner, search), corner)
            gains[corner] = fits[corner].gain_over(without)
        best = max(gains, key=lambda corner: gains[corner])
        # Where one that is too low only loses, a much higher one is tried, and then none.
        lower = [best / ratio] * (best == min(gains) and gains[best] > 0)
        higher = [best * (ratio if gains[best] > 0 else ratio**2)]
        waiting = lower + higher * (best == max(gains) and (gains[best] > 0 or len(gains) == 1))
    if not max(gains.values(), default=0.0) > search.required_of_switch:
        return None
    while (between := _between(gains)) is not None:
        fits[between] = _begin_behind(_nearest(fits, between, search), between)
        gains[between] = fits[between].gain_over(without)
    best = max(gains, key=lambda corner: gains[corner])
    # What records may show behind it is free, as nothing tells what it remembers: without it a fit has to be as free.
    fits[best], free = (
        _refit_behind(near, LowPass(best, _ORDER, passes_all), beginning_only=True)
        for near, passes_all in ((fits[best], False), (without, True))
    )
    # Where more is missing, the freedom explains some of that: it is enough to explain more, until all else is found.
    if not fits[best].gain_over(free) > (0.0 if search.is_overdispersed else search.required_of_switch):
        return None
    corner = _vertex(gains)
    return _nearest(fits, corner, search), corner


def _nearest(fits: Mapping[float, ModelSearch], corner: float, first: ModelSearch) -> ModelSearch:
    """Return the fit behind the low-pass whose corner is nearest to another one; the first one where there is none yet."""
    return fits[min(fits, key=lambda other: abs(np.log(other / corner)))] if fits else first


def _begin_behind(search: ModelSearch, corner: float) -> ModelSearch:
    """Fit the model behind a low-pass to the beginnings of the decays.

    One at infinity does nothing, but motions before it are stepped as finely as those before another one.
    """
    return _refit_behind(search, LowPass(corner, _ORDER), _ITERATIONS, beginning_only=True)


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
    states = []
    for drop, decay in enumerate(search.fit.decays):
        before, after = (
            SampledLowPass.of(one, decay.rate).remaining_delay for one in (search.structure.low_pass, low_pass)
        )
        later = (after - before) * decay.rate
        # The parabola through the first three samples.
        weights = (1 - later) * (2 - later) / 2, later * (2 - later), later * (later - 1) / 2
        states.append(search.fit.motion(drop, 0, 3) @ np.array(weights))
    return np.array(states)


def _between(gains: Mapping[float, float]) -> float | None:
    """Return the corner that is compared next, between the neighbours of the best one; None where these are near to it."""
    corners = sorted(gains)
    at = corners.index(max(corners, key=lambda corner: gains[corner]))
    if not 0 < at < len(corners) - 1:
        return None
    below, best, above = corners[at - 1 : at + 2]
    if np.log(above / below) < _NARROW:
        return None
    corner = _vertex(gains)
    if abs(np.log(corner / best)) > _FINE:
        return corner
    return float(np.sqrt(best * (below if best**2 > above * below else above)))


def _vertex(gains: Mapping[float, float]) -> float:
    """Return the corner at which the gain is largest: the vertex of the parabola through the best one and its neighbours."""
    corners = sorted(gains)
    best = max(corners, key=lambda corner: gains[corner])
    at = corners.index(best)
    if not 0 < at < len(corners) - 1:
        return best
    near = corners[at - 1 : at + 2]
    curvature, slope, _ = np.polyfit(np.log(near) - np.log(best), [gains[corner] for corner in near], 2)
    return best * float(np.exp(-slope / (2 * curvature)))
