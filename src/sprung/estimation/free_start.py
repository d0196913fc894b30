"""The beginning of free vibration after a push or a bump: from when on the fitted vehicle moves freely.

The recordings show roughly when the last force has ended. A fitted vehicle shows it to some samples: as the start of a decay
goes back in time, the cost of the samples that it gains is that of noise as long as the motion is free, and more from where a
force acts. That is the sequential test of E. S. Page (Biometrika 41 (1954) 100), with the initial state free at every start and
the parameters as uncertain as all other drops leave them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.estimation.identifiability import identifiable_equations
from sprung.preprocess import FreeDecay

Real = NDArray[np.float64]

_ALLOWED = 1.25
"""Cost of each value that is allowed, where that of noise is 1."""

_CLEAR = 60.0
"""Excess of the cost from which a force acts. Noise has such a run with a probability of exp(-0.2 excess) at a start."""

_TWICE_AS_FAR = 8.0
"""By which the excess grows where it is twice as far from the end of a force that ends like a half sine: F² adds up as t³."""

_MARGIN = 1.5
"""Samples between a clear force and its end, over those from where it is twice as far to where it is clear: 1 is the mean, and
what is left of a force a sample before its end passes for a rubber mount."""

_MODEL_ERROR = 0.2
"""Variance beyond the sensors' noise at rest, as a part of it, from which the model has errors: 0.14 is the standard error of
the variance of 100 samples."""

_FAR, _LONGEST = 0.05, 1.0
"""Step of a coordinate, a logarithm mostly, beyond which no quadratic model of the likelihood is relied on; and at the most."""

_ROUNDING = 1e-12
"""Part of the squares of the records that rounding makes of a residual sum of squares."""

_LATER = 0.1
"""s after the start that the recording alone shows from where on the test begins."""

_STEP = 0.01
"""s between the starts that are compared at first."""

_TOGETHER = 16
"""Starts that are evaluated together."""


def find_free_start(fit: FitResult, drop: int) -> int:
    """Find from when on the motion of a drop is free.

    Parameters
    ----------
    fit
        Of the present decays.
    drop
        Position of the drop.

    Returns
    -------
    int
        Samples by which its decay may start later, though not later than the recording alone shows, or where negative earlier.
    """
    decay = fit.decays[drop]
    costs = _Costs(fit, drop)
    clear = _CLEAR * costs.overdispersion + costs.rounding
    every = max(round(_STEP * decay.rate), 1)
    shown = 0 if decay.events.start is None else max(round((decay.events.start - decay.start) * decay.rate), 0)
    last = shown + min(round(_LATER * decay.rate), (decay.samples - shown) // 2)
    earliest = -int(decay.earlier.shape[1])
    found: dict[int, float] = {}
    coarse = [*range(last, earliest, -every), earliest]
    lowest, detected, far = np.inf, None, earliest
    for first in range(0, len(coarse), _TOGETHER):
        found |= costs.excess(coarse[first : first + _TOGETHER])
        # Page's test: by how much the excess has risen above its lowest value so far.
        for shift in coarse[first : first + _TOGETHER]:
            lowest = min(lowest, found[shift])
            rise = found[shift] - lowest
            if detected is None and rise > clear:
                detected = shift
            if rise > _TWICE_AS_FAR * clear:
                far = shift
                break
        else:
            continue
        break
    if detected is None:
        return earliest
    near = _crossing(costs, detected, every, lowest + clear)
    further = _crossing(costs, far, every, lowest + _TWICE_AS_FAR * clear) if far != earliest else earliest
    return min(near + max(round(_MARGIN * (near - further)), 1), shown)


def _crossing(costs: _Costs, earlier: int, every: int, level: float) -> int:
    """Return the latest start whose excess is above a level, by bisection between one that is and a step later."""
    low, high = earlier, earlier + every
    while high - low > 1:
        middle = (low + high) // 2
        if costs.excess([middle])[middle] > level:
            low = middle
        else:
            high = middle
    return low


class _Costs:
    """The cost of other starts of one decay, the parameters being as uncertain as the other drops leave them.

    A model with errors leaves more where the motion is larger: what it leaves now beside the noise at rest, as a part of the
    motion, is allowed for.
    """

    def __init__(self, fit: FitResult, drop: int) -> None:
        self._fit, self._decay = fit, fit.decays[drop]
        self._weights = 1 / fit.noise**2
        problem, iterate = fit.problem, fit.iterate
        whole, slope, _ = problem.system(iterate)
        gradients, informations = problem.by_drop(iterate)
        self._gradient, self._information = slope - gradients[drop], whole - informations[drop]
        record = np.nan_to_num(np.concatenate([self._decay.earlier, self._decay.values], axis=1))
        self._squares = (record - record[:, self._decay.earlier.shape[1] :].mean(axis=1, keepdims=True)) ** 2
        motion = problem.objective.energy / np.maximum(problem.objective.observations.sum(axis=0), 1.0)
        at_rest = _variance_at_rest(fit)
        self._errs = fit.noise**2 > (1 + _MODEL_ERROR) * at_rest
        at_rest = np.where(self._errs, at_rest, fit.noise**2)
        error = (fit.noise**2 - at_rest) / np.maximum(motion, np.finfo(float).tiny)
        expected = (at_rest[:, None] + error[:, None] * self._squares) * self._weights[:, None]
        used = np.asarray(self._decay.usable, dtype=float)
        # From each sample on.
        self._expected = np.cumsum((used @ expected)[::-1])[::-1]

    @property
    def rounding(self) -> float:
        """What rounding makes of the cost."""
        return _ROUNDING * float(self._squares.sum(axis=1) @ self._weights)

    @property
    def overdispersion(self) -> float:
        """Of a model with errors: what it leaves is correlated, so that fewer values count."""
        return float(np.max(self._fit.autocorrelation_inflation[self._errs], initial=1.0))

    def excess(self, shifts: Sequence[int]) -> dict[int, float]:
        """Return the cost of starts, less what is allowed for the samples; up to a constant."""
        problem, iterate, decay = self._fit.problem, self._fit.iterate, self._decay
        decays: list[FreeDecay] = [decay.shifted(shift) for shift in shifts]
        objective = problem.objective.with_decays(decays)
        at = objective.at(self._fit.values, self._weights).with_optimal_states()
        sums = at.residual_sums
        if not np.isfinite(sums).all():
            return dict.fromkeys(shifts, math.inf)
        null_space = problem.priors.null_space(iterate.u)
        gradients, informations = problem.in_null_space(iterate, *at.by_drop)
        costs = {}
        for row, shift in enumerate(shifts):
            gradient, information = self._gradient + gradients[row], self._information + informations[row]
            move, gain = identifiable_equations(information, gradient, null_space).step(longest=_LONGEST)
            cost = float(sums[row] @ self._weights)
            # Without noise the gain is a difference of large numbers, and no cost is less than nothing.
            least = max(cost - gain, 0.0)
            if np.abs(move).max(initial=0.0) > _FAR:
                least = min(max(self._cost_after(decays[row], move, null_space), least), cost)
            costs[shift] = least - _ALLOWED * float(self._expected[decay.earlier.shape[1] + shift])
        return costs

    def _cost_after(self, decay: FreeDecay, move: Real, null_space: Real) -> float:
        """Return the cost of a decay and of what the other drops lose after a step of the coordinates."""
        problem, iterate = self._fit.problem, self._fit.iterate
        values = problem.priors.coordinates.values(problem.priors.project(iterate.u + move))
        sums = problem.objective.with_decays([decay]).at(values, self._weights).with_optimal_states().residual_sums
        along = null_space.T @ move
        return float(sums[0] @ self._weights + along @ (self._information @ along - 2 * self._gradient))


def _variance_at_rest(fit: FitResult) -> Real:
    """Return the variance of each channel at rest, (m/s²)², shape (channel,); infinite where no recording shows any."""
    recorded = [decay.rest.noise for decay in fit.decays if decay.rest.noise.shape[1]]
    if not recorded:
        return np.full(len(fit.noise), np.inf)
    variances = np.array([np.mean(noise**2, axis=1) for noise in recorded])
    pooled: Real = np.nanmedian(np.where(np.isfinite(variances).any(axis=0), variances, np.inf), axis=0)
    return pooled
