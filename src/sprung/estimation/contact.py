"""Contact: which samples the tyres were on the ground for, told by the fitted vehicle.

Before a fit, the accelerometers say roughly when the last tyre has come down for good. A fitted vehicle says it exactly:
carried backward and forward from its state at the start of a decay, it shows how far each tyre is compressed, and free
vibration begins where the last one last touched. What lies between is where wheel hop is largest and tells most.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import LikelihoodAt
from sprung.estimation.fit import FitResult
from sprung.preprocess import FreeDecay
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS_AT, LinearModel

Real = NDArray[np.float64]

_COMPRESSED = 0.01
"""Part of its static compression below which a tyre may have left the ground, the fit being what it is."""

_PASSES = 4

_NO_WORSE = 1.1
"""Noise after moving the starts over noise before, above which the records say that they were not to be moved."""

_SHOCK, _FAR = 0.03, 5.0
"""s for which a landing may last at most, and times the noise from which a residual is not noise."""

_LONGEST = 2.0
"""s after the start of a decay for which wheels may still hop."""

_NEIGHBOURS = 4
"""Samples on each side of which a spline makes a new one."""

_MOST = 0.5
"""Part of a decay that may be given up: a model to which tyres seem to hop for longer is not to be trusted in this."""


def fit_from_contact(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    first: FitResult,
    again: Callable[[Sequence[FreeDecay], FitResult, Real], FitResult],
) -> tuple[tuple[FreeDecay, ...], FitResult]:
    """Let the fitted vehicle say where each decay begins, and fit again, until it stays with what it said.

    Parameters
    ----------
    decays
        With starts that are certain rather than early.
    models
        Equations of motion by load name.
    first
        Where the fit of these decays ended.
    again
        Fits decays that begin elsewhere: from a summit and the {X, Ẋ} that it has where they begin, (drop, state).

    Returns
    -------
    decays
        With starts where the last tyre last touched.
    summit
        Where the fit of these decays ends.
    """
    best, found = tuple(decays), first
    settled = False
    for _ in range(_PASSES if isinstance(first.point.place, LikelihoodAt) else 1):
        shifts, states = _shifts(best, models, found)
        if not any(shifts):
            break
        moved = tuple(decay.shifted(shift) for decay, shift in zip(best, shifts, strict=True))
        next_one = again(moved, found, states).after(found)
        if np.any(next_one.noise > _NO_WORSE * found.noise):
            break
        best, found, settled = moved, next_one, True
    return best, found if settled else again(best, found, found.states).after(found)


def _shifts(decays: Sequence[FreeDecay], models: Mapping[str, LinearModel], found: FitResult) -> tuple[list[int], Real]:
    """Give by how many samples the start of each decay has to be moved, and {X, Ẋ} there, shape (drop, state)."""
    shifts, states = [], found.states.copy()
    for i, decay in enumerate(decays):
        matrices = models[decay.load].matrices(found.values)
        sag = np.linalg.solve(matrices.K, matrices.weight * STANDARD_GRAVITY)
        static = sag[WHEELS_AT, None]  # how far the standing vehicle compresses its tyres
        # Friction cannot be followed backward.
        earlier, samples = decay.earlier.shape[1] if isinstance(found.point.place, LikelihoodAt) else 0, decay.samples
        motion = found.point.place.motion(found.point.weights, i, earlier, min(samples, int(_LONGEST * decay.rate)))
        loose = np.flatnonzero((static - motion[WHEELS_AT] < _COMPRESSED * static).any(axis=0))
        first = int(loose[-1]) + 1 + _wary(decay) if loose.size else 0
        shocked = _shocked(decay, found, i)
        first = max(first, earlier + shocked) if shocked else first
        shift = first - earlier if first - earlier < _MOST * samples else 0
        shifts.append(shift)
        states[i] = motion[:, min(earlier + shift, motion.shape[1] - 1)]
    return shifts, states


def _shocked(decay: FreeDecay, found: FitResult, position: int) -> int:
    """Give the samples at the start of a decay in which the landing is not yet over.

    Friction turns round within a millisecond then, and no sampling follows it. Only what is stepped is held to that: elsewhere
    nothing turns so fast.
    """
    place = found.point.place
    if isinstance(place, LikelihoodAt):
        return 0
    left = place.left(position)[:, : int(_SHOCK * decay.rate)]
    return int(np.max(np.flatnonzero((np.abs(left) > _FAR * found.noise[:, None]).any(axis=0)) + 1, initial=0))


def _wary(decay: FreeDecay) -> int:
    """Give samples by which to stay away from the last contact where a logger interpolated: they have something of it."""
    slowest = min(decay.rate_ratios, default=1.0)
    return round(_NEIGHBOURS / slowest) if slowest < 1 else 0


def clear_of_splines(decay: FreeDecay) -> FreeDecay:
    """Let the channels of slower loggers begin later, by as much as their interpolated samples have of earlier ones.

    Parameters
    ----------
    decay
        Of several loggers.

    Returns
    -------
    Decay
        In which these loggers are late by that.
    """
    skips = [round(_NEIGHBOURS / clock.rate_ratio) if clock.rate_ratio < 1 else 0 for clock in decay.clocks]
    whole = np.concatenate([decay.earlier, decay.values], axis=1)
    length, before = whole.shape[1] - max(skips, default=0), decay.earlier.shape[1]
    values = whole[:, :length].copy()
    for clock, skip in zip(decay.clocks, skips, strict=True):
        values[list(clock.channels)] = whole[list(clock.channels), skip : skip + length]
    clocks = tuple(
        replace(clock, offset=clock.offset + skip / decay.rate, delay=clock.delay + skip / decay.rate)
        for clock, skip in zip(decay.clocks, skips, strict=True)
    )
    return replace(decay, earlier=values[:, :before], values=values[:, before:], clocks=clocks)
