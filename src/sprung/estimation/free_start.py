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
from sprung.estimation.problem import identifiable_equations
from sprung.preprocess import FreeDecay

Real = NDArray[np.float64]

_ALLOWED = 1.25
"""Cost of each value that is allowed, where that of noise is 1: a model with errors leaves a little more, too."""

_CLEAR = 60.0
"""Excess of the cost from which a force acts. Noise has such a run with a probability of exp(-0.2 excess) at a start."""

_TWICE_AS_FAR = 8.0
"""By which the excess grows where it is twice as far from the end of a force that ends like a half sine: F² adds up as t³."""

_ROUNDING = 1e-12
"""Part of the squares of the records that rounding makes of a residual sum of squares."""

_LATER = 0.5
"""s within the decay from where on the test begins: a part of what is fitted may not be free."""

_LONGEST_SHARE = 0.5
"""Part of a decay within which it does at the most."""

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
        Samples by which its decay may start later, or where negative earlier.
    """
    decay = fit.decays[drop]
    costs = _Costs(fit, drop)
    clear = _CLEAR + costs.rounding
    every = max(round(_STEP * decay.rate), 1)
    last = min(round(_LATER * decay.rate), int(_LONGEST_SHARE * decay.samples))
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
    return min(near + max(near - further, 1), last)


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
    """The cost of other starts of one decay, the parameters being as uncertain as the other drops leave them."""

    def __init__(self, fit: FitResult, drop: int) -> None:
        self._fit, self._decay = fit, fit.decays[drop]
        self._weights = 1 / fit.noise**2
        problem, iterate = fit.problem, fit.iterate
        whole, slope, _ = problem.system(iterate)
        gradients, informations = problem.by_drop(iterate)
        self._gradient, self._information = slope - gradients[drop], whole - informations[drop]

    @property
    def rounding(self) -> float:
        """What rounding makes of the cost."""
        whole = np.nan_to_num(np.concatenate([self._decay.earlier, self._decay.values], axis=1))
        return _ROUNDING * float(((whole - whole.mean(axis=1, keepdims=True)) ** 2).sum(axis=1) @ self._weights)

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
            _, gain = identifiable_equations(information, gradient, null_space).step()
            counted, cost = float(objective.observations[row].sum()), float(sums[row] @ self._weights)
            # Without noise the gain is a difference of large numbers, and no cost is less than nothing.
            costs[shift] = max(cost - gain, 0.0) - _ALLOWED * counted
        return costs
