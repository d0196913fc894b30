"""Profile likelihood: how far one quantity may move while everything else makes up for it.

Where the records bend the likelihood of a quantity differently to either side, no one standard uncertainty describes it:
its 95 % interval reaches to where twice the log-likelihood, maximised over everything else, has fallen by χ²(1) at 95 %
(Venzon and Moolgavkar, Applied Statistics 37 (1988) 87).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.estimation.problem import CLOSE_BY, EstimationProblem, Iterate
from sprung.estimation.statistics import FitStatistics
from sprung.uncertainty import NORMAL_95, Estimate, KnownValue
from sprung.vehicle import PARAMETERS, evaluate_quantity

Real = NDArray[np.float64]

FARTHEST = float(np.log(100.0))
"""Distance in the fit's coordinate beyond which an interval is open: a rate a hundred times smaller is as good as none."""

_TOLERANCE = 1e-3  # expected gain in log-likelihood at which a fit with the quantity held ends
_PRECISE = 2e-3  # relative error that the distance to an end of the interval may have
_STRIDE = 3.0  # times as far as before, at the most, ...
_LONGEST = 1.0  # ... or by a factor of e: others follow along a curve, which is extrapolated as a straight line
_EVALUATIONS = 30
_FULFILLED = 1e-9  # relative error with which exact statements hold where a vehicle can fulfil them all


class ProfilePoint(NamedTuple):
    """The profile at one distance from the optimum.

    Attributes
    ----------
    move
        Change of the quantity in its own coordinate.
    u
        Coordinates of the parameters there, everything else at its best, shape (parameter,).
    excess
        Root of the fall of twice the log-likelihood less that at an end of the interval: nearly linear in `move`.
    """

    move: float
    u: Real
    excess: float


def profiled(fit: FitResult, statistics: FitStatistics, name: str, estimate: Estimate) -> Estimate:
    """Return an estimate with the interval from the :term:`profile likelihood`.

    Parameters
    ----------
    fit
        Where the fit ended.
    statistics
        Its covariance.
    name
        Of the quantity: a parameter, or a derived one of `sprung.vehicle.DERIVED`.
    estimate
        Of it, from the curvature.

    Returns
    -------
    Estimate
        As it was where the quantity is known exactly or not determined: then there is no profile.
    """
    if estimate.status != "estimated":
        return estimate
    low, high = (_interval_end(fit, statistics, name, side) for side in (-1.0, 1.0))
    return replace(estimate, interval95=(low, high), interval_from="profile")


def _interval_end(fit: FitResult, statistics: FitStatistics, name: str, side: float) -> float | None:
    """Find one end: outward until the likelihood has fallen enough, then between, by the Illinois algorithm.

    None where the likelihood never falls enough, however far the quantity moves that way.
    """
    problem, scale = replace(fit.problem, overdispersion=statistics.inflation), _scale(fit, name)
    direction, std = _direction(statistics, name, scale)
    inner = ProfilePoint(0.0, fit.iterate.u, -NORMAL_95)
    outer: ProfilePoint | None = None
    slope, move, before = direction, side * min(NORMAL_95 * std, _LONGEST), 0.0
    for _ in range(_EVALUATIONS):
        near = inner.u + np.clip(slope * (move - inner.move), -_LONGEST, _LONGEST)
        held = _maximise_holding(problem, name, _moved(fit, name, scale, move), near)
        fall = np.inf if held is None else _fall(problem, fit, held)
        point = ProfilePoint(move, inner.u if held is None else held.u, max(fall, 0.0) ** 0.5 - NORMAL_95)
        if abs(point.excess) < _PRECISE * NORMAL_95:
            return _moved(fit, name, scale, move)
        if point.excess < 0 and outer is None and abs(move) >= FARTHEST:
            return None
        # Where one side of the bracket stays twice it counts half, so that the next guess falls beyond the crossing.
        again, before = point.excess * before > 0, point.excess
        if point.excess < 0:
            slope = (point.u - inner.u) / (move - inner.move)
            outer = outer._replace(excess=outer.excess / 2) if outer is not None and again else outer
            inner = point
        else:
            inner = inner._replace(excess=inner.excess / 2) if again else inner
            outer = point
        if outer is None:
            move = side * _next_outward(abs(move), NORMAL_95 + point.excess)
            continue
        if abs(outer.move - inner.move) < _PRECISE * abs(inner.move):
            break
        width, exists = outer.move - inner.move, np.isfinite(outer.excess)
        slope = (outer.u - inner.u) / width if exists else slope
        move = inner.move + width * (inner.excess / (inner.excess - outer.excess) if exists else 0.5)
    return _moved(fit, name, scale, inner.move)  # beyond it no vehicle is, or the likelihood jumps


def _next_outward(distance: float, root: float) -> float:
    """Return the next distance to try, from one at which the root of the fall is too small."""
    farther = distance * min(NORMAL_95 / max(root, 0.1), _STRIDE)
    return min(max(farther, 1.05 * distance), distance + _LONGEST, FARTHEST)


def _is_logarithmic(name: str) -> bool:
    return name not in PARAMETERS or PARAMETERS[name].positive


def _scale(fit: FitResult, name: str) -> float:
    """SI of one of the quantity's own coordinate, at the optimum."""
    if _is_logarithmic(name):
        return evaluate_quantity(name, fit.names, fit.values)[0]
    return float(fit.problem.priors.coordinates.references[fit.names.index(name)])


def _moved(fit: FitResult, name: str, scale: float, move: float) -> float:
    value = evaluate_quantity(name, fit.names, fit.values)[0]
    return value * float(np.exp(move)) if _is_logarithmic(name) else value + scale * move


def _direction(statistics: FitStatistics, name: str, scale: float) -> tuple[Real, float]:
    """Return how the coordinates move with the quantity, to first order, and its standard uncertainty."""
    _, gradient = evaluate_quantity(name, statistics.names, statistics.values)
    derivative = gradient * statistics.slopes / scale
    together = statistics.relative_covariance @ derivative
    variance = float(derivative @ together)
    return together / variance, variance**0.5


def _maximise_holding(problem: EstimationProblem, name: str, value: float, near: Real) -> Iterate | None:
    """Maximise the likelihood where the quantity has one value exactly; None where no vehicle has it."""
    priors = problem.priors
    held = replace(priors, statements={**priors.statements, name: KnownValue(value)})
    with np.errstate(all="ignore"):  # out of all bounds it goes where nothing fulfils everything
        u = held.project(near)
        values = held.coordinates.values(u)
        found = [(evaluate_quantity(known, held.coordinates.names, values)[0], known) for known in held.statements]
    for quantity, known in found:
        statement = held.statements[known]
        if statement.is_exact and not abs(quantity - statement.value) <= _FULFILLED * abs(statement.value):
            return None
    return replace(problem, priors=held).maximise(u, tolerance=_TOLERANCE, damping=CLOSE_BY).point


def _fall(problem: EstimationProblem, fit: FitResult, point: Iterate) -> float:
    """Fall of twice the log-likelihood from the optimum to a point."""
    return -problem.gain(fit.iterate, point)
