"""Scores of vehicles in the order of their tests: how far each is from those before it, independent and standard normal.

A vehicle is compared with the weighted mean of those before it; the covariance of the difference is that between
vehicles, that of
the vehicle's own estimate and that of the mean. Such differences, the recursive residuals, are independent (R.
Brown, J. Durbin,
J. Evans, J. R. Stat. Soc. B 37 (1975) 149), and the chart needs no vehicles that are known to be good (a self-starting chart:
D. Hawkins, J. Qual. Technol. 19 (1987) 195).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, t

from sprung.display import shown
from sprung.fleets.population import Population
from sprung.fleets.run_length import clipping_radius

Real = NDArray[np.float64]

_KNOWN = 1e3
"""Ratio of the own error's variance to that of the spread above which the total counts as known."""


@shown
@dataclass(frozen=True, eq=False)
class Scores:
    """Scores of the vehicles of one type.

    Attributes
    ----------
    values
        Independent and standard normal for vehicles in control, dimensionless, shape (vehicle, parameter); NaN for
        the first one.
    components
        Score of each single parameter: of the hypothesis that it alone deviates. Standard normal for vehicles in control,
        also where the spread is known from few vehicles; dimensionless, shape (vehicle, parameter).
    directions
        Change of a vehicle's score by each coordinate, dimensionless, shape (vehicle, component of the score, parameter).
    deviating
        Whether a vehicle deviates; such a vehicle is not among those that later ones are compared with. Shape (vehicle,).
    averages
        Moving average of the clipped scores, dimensionless, shape (vehicle, parameter).
    shifts
        Index of the vehicle at which the average exceeded its limit, and of that with which the shift probably began. From
        there on vehicles are compared with those since the shift.
    """

    values: Real
    components: Real
    directions: Real
    deviating: NDArray[np.bool_]
    averages: Real
    shifts: tuple[tuple[int, int], ...]

    @property
    def periods(self) -> tuple[slice, ...]:
        """Vehicles between two shifts of the rig, in the order of the tests."""
        ends = [0, *(since for _, since in self.shifts), len(self.values)]
        return tuple(slice(first, last) for first, last in pairwise(ends))


def score_vehicles(
    positions: Real, covariances: Real, population: Population, vehicle_limit: float, rig_limit: float, weight: float
) -> Scores:
    """Return the scores of vehicles, in the order of their tests.

    Parameters
    ----------
    positions, covariances
        Estimates and their covariance matrices, dimensionless, shapes (vehicle, parameter) and (vehicle, parameter, parameter).
    population
        Spread between vehicles, and how well it is known.
    vehicle_limit
        Largest score of a single parameter in control, dimensionless: see `largest_component`.
    rig_limit, weight
        Largest length of the moving average in control, and weight of the newest vehicle in it, dimensionless.

    Returns
    -------
    Scores
    """
    count, width = positions.shape
    totals = covariances + population.spread
    freedom = _freedom(covariances, population)
    weights = np.linalg.inv(totals)
    weighted = np.einsum("nij,nj->ni", weights, positions)
    values, components = np.full((count, width), np.nan), np.full((count, width), np.nan)
    directions, averages = np.full((count, width, width), np.nan), np.zeros((count, width))
    clipped, radius = np.zeros((count, width)), clipping_radius(width)
    deviating = np.zeros(count, dtype=bool)
    shifts: list[tuple[int, int]] = []
    average, charted_since, period = np.zeros(width), 0, 0
    information, weighted_sum = np.zeros((width, width)), np.zeros(width)
    for i in range(count):
        if information.any():
            mean_covariance = np.linalg.inv(information)
            difference = positions[i] - mean_covariance @ weighted_sum
            directions[i] = np.linalg.inv(np.linalg.cholesky(totals[i] + mean_covariance))
            values[i] = directions[i] @ difference
            components[i] = _normal(hypothesis_scores(values[i], directions[i]), freedom[i])
            deviating[i] = np.abs(components[i]).max() > vehicle_limit
            clipped[i] = values[i] * (radius / max(float(np.linalg.norm(values[i])), radius))
            average = (1 - weight) * average + weight * clipped[i]
        averages[i] = average
        if not deviating[i]:
            information, weighted_sum = information + weights[i], weighted_sum + weighted[i]
        if np.linalg.norm(average) > rig_limit:
            since = max(charted_since + _change_point(clipped[charted_since : i + 1]), period + 1)
            shifts.append((i, since))
            own = np.arange(since, i + 1)[~deviating[since : i + 1]]
            information, weighted_sum = weights[own].sum(axis=0), weighted[own].sum(axis=0)
            average, charted_since, period = np.zeros(width), i + 1, since
    return Scores(values, components, directions, deviating, averages, tuple(shifts))


def _freedom(covariances: Real, population: Population) -> Real:
    """Return the degrees of freedom of each variance about the mean, shape (vehicle, parameter), by Welch and Satterthwaite.

    The part of the vehicle's own error is known; that of the spread is as uncertain as its standard error says.
    """
    variances = np.diag(population.spread)
    of_spread = 1 / (2 * population.std_error**2) - population.correlated * (len(variances) - 1)
    ratio = np.diagonal(covariances, axis1=1, axis2=2) / np.maximum(variances, np.finfo(float).tiny)
    return np.asarray(np.maximum(of_spread, 1) * (1 + np.minimum(ratio, _KNOWN)) ** 2)


def _normal(values: Real, freedom: Real) -> Real:
    """Transform Student's t to a standard normal variable."""
    tails = norm.isf(np.maximum(t.sf(np.abs(values), freedom), np.finfo(float).tiny))
    return np.asarray(np.sign(values) * np.maximum(tails, 0.0))


def _change_point(values: Real) -> int:
    """Return the index from which on the mean differs most significantly from zero, to the end."""
    sums = np.cumsum(values[::-1], axis=0)[::-1]
    counts = np.arange(len(values), 0, -1)
    return int(np.argmax((sums**2).sum(axis=1) / counts))


def hypothesis_scores(value: Real, directions: Real) -> Real:
    """Return how well each hypothesis explains a score: its size in standard deviations.

    Parameters
    ----------
    value
        Score of a vehicle, or mean of several, dimensionless, shape (component,).
    directions
        Its change by each hypothesis, dimensionless, shape (component, hypothesis).

    Returns
    -------
    ndarray
        Dimensionless, shape (hypothesis,).
    """
    return np.asarray(directions.T @ value / np.linalg.norm(directions, axis=0))


def largest_component(spread: Real, run_length: float, draws: int = 200_000) -> float:
    """Return the limit of the largest component score: exceeded by one vehicle in control out of so many.

    Parameters
    ----------
    spread
        Covariance of the estimates of a vehicle about the mean of all, dimensionless, shape (parameter, parameter).
    run_length
        Average number of vehicles between two false alarms, dimensionless.
    draws
        Number of random vehicles, always the same, from which the quantile is taken.

    Returns
    -------
    float
        Dimensionless.
    """
    directions = np.linalg.inv(np.linalg.cholesky(spread))
    directions = directions / np.linalg.norm(directions, axis=0)
    random = np.random.default_rng(0)
    parts = [random.standard_normal((20_000, len(spread))) @ directions for _ in range(draws // 20_000)]
    return float(np.quantile(np.concatenate([np.abs(part).max(axis=1) for part in parts]), 1 - 1 / run_length))
