"""Profile likelihood: how far one quantity may move while everything else makes up for it as well as it can.

Where the records bend the likelihood of a quantity differently to either side, no one standard uncertainty describes it:
its 95 % interval reaches to where twice the log-likelihood, maximised over everything else, has fallen by χ²(1) at 95 %
(Venzon and Moolgavkar, Applied Statistics 37 (1988) 87).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit import FitResult
from sprung.estimation.priors import PriorsAndConstraints
from sprung.estimation.problem import CLOSE_BY, EstimationProblem, Iterate
from sprung.estimation.statistics import FitStatistics
from sprung.uncertainty import NORMAL_95, Estimate, KnownValue
from sprung.vehicle import PARAMETERS, evaluate_quantity

Real = NDArray[np.float64]

FARTHEST = float(np.log(100.0))
"""Way in the fit's coordinate beyond which an interval is open: a rate a hundred times smaller is as good as none."""

_ENOUGH = 1e-3  # expected gain in log-likelihood at which a climb that holds the quantity has ended
_PRECISE = 2e-3  # relative error that the distance to an end of the interval may have
_STRIDE = 3.0  # times as far as before, at the most, ...
_LONGEST = 1.0  # ... or by a factor of e: others follow along a curve, which is extrapolated as a straight line
_EVALUATIONS = 30
_FULFILLED = 1e-9  # relative error with which exact statements hold where a vehicle can fulfil them all


class _Stand(NamedTuple):
    """How far the quantity was moved, the coordinates that make up for it best, and what the likelihood lost by that.

    `miss` is the root of the fall, less that at an end of the interval: nearly linear in `move`, 0 at the end.
    """

    move: float
    u: Real
    miss: float


@dataclass(frozen=True, eq=False)
class Profile:
    """The likelihood as a function of one quantity, everything else at its best.

    Attributes
    ----------
    summit
        Where the fit ended.
    fit
        How sure it is.
    name
        A parameter, or a derived quantity of `sprung.vehicle.DERIVED`.
    """

    optimum: FitResult
    fit: FitStatistics
    name: str

    @cached_property
    def value(self) -> float:
        """At the summit, SI."""
        return evaluate_quantity(self.name, self.fit.names, self.fit.values)[0]

    def interval(self) -> tuple[float | None, float | None]:
        """Give the 95 % interval, SI.

        Returns
        -------
        low, high
            None where the likelihood never falls enough, however far the quantity moves that way. What coloured residuals
            and drops that disagree do not tell is taken off the fall, as from the fit's covariance.
        """
        low, high = (self._end(side) for side in (-1.0, 1.0))
        return low, high

    @cached_property
    def _logarithmic(self) -> bool:
        return self.name not in PARAMETERS or PARAMETERS[self.name].positive

    @cached_property
    def _scale(self) -> float:
        """SI of one of the quantity's own coordinate, at the summit."""
        coordinates = self.optimum.problem.priors.coordinates
        return self.value if self._logarithmic else float(coordinates.references[coordinates.names.index(self.name)])

    def _moved(self, move: float) -> float:
        return self.value * float(np.exp(move)) if self._logarithmic else self.value + self._scale * move

    @cached_property
    def _climb(self) -> EstimationProblem:
        """The likelihood, where what was known weighs as much beside the records as in the fit's covariance.

        There the records count for less by the inflation; here, where they count whole, statements count for more. They
        are moved nearer to the summit by as much, so that it stays the summit.
        """
        priors, u, inflation = self.optimum.problem.priors, self.optimum.point.u, self.fit.inflation

        def weighed(name: str, known: KnownValue) -> KnownValue:
            found, _ = evaluate_quantity(name, self.fit.names, priors.coordinates.values(u))
            return KnownValue(found + (known.value - found) / inflation, known.std / inflation**0.5)

        statements = {
            name: known if known.is_exact or inflation == 1 else weighed(name, known)
            for name, known in priors.statements.items()
        }
        return EstimationProblem(self.optimum.problem.likelihood, PriorsAndConstraints(priors.coordinates, statements))

    def _held(self, value: float, near: Real) -> Iterate | None:
        """Climb as high as it goes where the quantity has one value exactly; give None where no vehicle has it."""
        priors = self._climb.priors
        held = replace(priors, statements={**priors.statements, self.name: KnownValue(value)})
        with np.errstate(all="ignore"):  # out of all bounds it goes where nothing fulfils everything
            u = held.bind(near)
            values = held.coordinates.values(u)
            found = [(evaluate_quantity(name, self.fit.names, values)[0], one) for name, one in held.statements.items()]
        if not all(abs(there - one.value) <= _FULFILLED * abs(one.value) for there, one in found if one.is_exact):
            return None
        return replace(self._climb, priors=held).maximise(u, enough=_ENOUGH, damping=CLOSE_BY)

    def _fallen(self, point: Iterate) -> float:
        """Give by how much twice the log-likelihood has fallen, over the fit's inflation."""
        # How the unknowns are shared out among the channels is no observation, and stays as it is at the summit.
        leverage = self.optimum.point.evaluation.leverage
        there = replace(point, evaluation=point.evaluation._replace(leverage=leverage))
        return (self._climb.cost(there) - self._climb.cost(self.optimum.point)) / self.fit.inflation

    @cached_property
    def _direction(self) -> tuple[Real, float]:
        """Give where everything goes when the quantity moves by one, to first order, and its standard uncertainty."""
        _, gradient = evaluate_quantity(self.name, self.fit.names, self.fit.values)
        slope = gradient * self.fit.slopes / self._scale
        together = self.fit.relative_covariance @ slope
        variance = float(slope @ together)
        return together / variance, variance**0.5

    def _end(self, side: float) -> float | None:
        """Find one end: outward until the likelihood has fallen enough, then between, after the Illinois algorithm."""
        direction, std = self._direction
        inner = _Stand(0.0, self.optimum.point.u, -NORMAL_95)
        outer: _Stand | None = None
        start, move, before = direction, side * min(NORMAL_95 * std, _LONGEST), 0.0
        for _ in range(_EVALUATIONS):
            near = inner.u + np.clip(start * (move - inner.move), -_LONGEST, _LONGEST)
            point = self._held(self._moved(move), near)
            u, fallen = (inner.u, np.inf) if point is None else (point.u, self._fallen(point))
            stand = _Stand(move, u, max(fallen, 0.0) ** 0.5 - NORMAL_95)
            if abs(stand.miss) < _PRECISE * NORMAL_95:
                return self._moved(move)
            if stand.miss < 0 and outer is None and abs(move) >= FARTHEST:
                return None
            # Where one side of the bracket stays twice it counts half, so that the next guess falls beyond the crossing.
            again, before = stand.miss * before > 0, stand.miss
            if stand.miss < 0:
                start = (u - inner.u) / (move - inner.move)
                outer = outer._replace(miss=outer.miss / 2) if outer is not None and again else outer
                inner = stand
            else:
                inner = inner._replace(miss=inner.miss / 2) if again else inner
                outer = stand
            if outer is not None and abs(outer.move - inner.move) < _PRECISE * abs(inner.move):
                break
            if outer is None:
                root = NORMAL_95 + stand.miss
                reach = abs(move) * min(NORMAL_95 / max(root, 0.1), _STRIDE)
                move = side * min(max(reach, 1.05 * abs(move)), abs(move) + _LONGEST, FARTHEST)
            else:
                width, possible = outer.move - inner.move, np.isfinite(outer.miss)
                start = (outer.u - inner.u) / width if possible else start
                move = inner.move + width * (inner.miss / (inner.miss - outer.miss) if possible else 0.5)
        return self._moved(inner.move)  # beyond it no vehicle is, or the likelihood jumps


def profiled(optimum: FitResult, fit: FitStatistics, name: str, estimate: Estimate) -> Estimate:
    """Give an estimate its interval from the profile of the likelihood.

    Parameters
    ----------
    summit
        Where the fit ended.
    fit
        How sure it is.
    name
        Of the quantity: a parameter, or a derived one of `sprung.vehicle.DERIVED`.
    estimate
        What the fit says of it.

    Returns
    -------
    Estimate
        As it was where the quantity is known exactly or not determined: then there is nothing to ask the likelihood.
    """
    if estimate.status != "estimated":
        return estimate
    return replace(estimate, interval95=Profile(optimum, fit, name).interval(), interval_from="profile")
