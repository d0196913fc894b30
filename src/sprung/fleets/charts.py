"""Control charts of a fleet: a rig that drifts moves all vehicles, a vehicle that deviates only itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.fleets.estimates import FleetEstimates, quantity_of
from sprung.fleets.population import FEWEST, Population, fit_population
from sprung.fleets.run_length import RUN_LENGTH, WEIGHT, alarm_limit
from sprung.fleets.scores import Scores, hypothesis_scores, largest_component, score_vehicles

Real = NDArray[np.float64]

RIG_FAULTS: Mapping[str, Mapping[str, float]] = {
    "scale": {"kg": 1, "kg m^2": 1, "N/m": 1, "N s/m": 1, "N": 1, "N m": 1, "N m s": 1},
    "time base": {
        "N/m": -2,
        "N s/m": -1,
        "N": -2,
        "N m": -2,
        "N m s": -1,
        "1/s^2": -2,
        "1/s": -1,
        "m/s^2": -2,
        "m^2/s^2": -2,
        "m^2/s": -1,
    },
}
"""Faults of a rig that change several parameters at once: exponents by unit. A scale that reads too much changes every mass,
inertia and rate alike; seconds that are too long make rates too small."""

_ROUNDS = 8
"""Most repetitions of charts and population."""

_SUSPICIOUS = 3.5
"""Robust score of a parameter above which a vehicle is left out of the population that it is first judged by."""

_ALIKE = 4.0
"""Difference of twice the log-likelihood below which two explanations are both stated."""

_NORMAL_MAD = 1.4826
"""Standard deviation of a normal distribution in units of its median absolute deviation."""


@shown
@dataclass(frozen=True, slots=True)
class Deviation:
    """Deviation of one parameter, or of what a fault of the rig changes.

    Attributes
    ----------
    name
        The parameter, or one of `RIG_FAULTS`.
    percent, percent_std
        Difference from the vehicles before, and its standard uncertainty with the spread between vehicles, % of the value.
    score
        Difference in standard deviations, dimensionless.
    """

    name: str
    percent: float
    percent_std: float
    score: float


@shown
@dataclass(frozen=True, slots=True)
class VehicleAlarm:
    """A vehicle that deviates from the others.

    Attributes
    ----------
    campaign, label
        Its campaign, and its name for people.
    number
        In the order of the tests, from 1.
    deviations
        The parameters that explain it, the most significant first.
    """

    campaign: str
    label: str
    number: int
    deviations: tuple[Deviation, ...]


@shown
@dataclass(frozen=True, slots=True)
class RigAlarm:
    """A shift of all vehicles, which the rig causes rather than a vehicle.

    Attributes
    ----------
    number, label
        Vehicle at which the chart raised the alarm, in the order of the tests, from 1.
    since, since_label
        The vehicle with which the shift most probably began. From the alarm on, vehicles are compared with those since then.
    deviation
        What explains it best, and by how much it has changed.
    alternatives
        What explains it nearly as well: twice the log-likelihood is less than 4 smaller.
    """

    number: int
    label: str
    since: int
    since_label: str
    deviation: Deviation
    alternatives: tuple[Deviation, ...] = ()


@shown
@dataclass(frozen=True, eq=False)
class ControlChart:
    """Both charts of the vehicles of one type, in the order of their tests.

    Attributes
    ----------
    vehicle_scores
        Largest score of a single parameter of each vehicle, dimensionless, shape (vehicle,); NaN before the chart begins.
    vehicle_limit
        Alarm if it is exceeded, dimensionless.
    rig_average
        Length of the moving average of the scores, dimensionless, shape (vehicle,).
    rig_limit
        Alarm if it is exceeded, dimensionless.
    run_length
        Average number of vehicles between two false alarms of each chart, dimensionless.
    vehicle_alarms, rig_alarms
        In the order of the tests.
    offsets
        What moves the coordinates of a vehicle to the rig as it is at the end, dimensionless, shape (vehicle, parameter): 0
        since the last shift.
    """

    vehicle_scores: Real
    vehicle_limit: float
    rig_average: Real
    rig_limit: float
    run_length: float
    vehicle_alarms: tuple[VehicleAlarm, ...]
    rig_alarms: tuple[RigAlarm, ...]
    offsets: Real


def chart_vehicles(estimates: FleetEstimates) -> tuple[ControlChart, Population]:
    """Return the control charts of vehicles of one type, and the population of those in control.

    The chart of the vehicles compares the score of each single parameter with a limit. The chart of the rig is a multivariate
    exponentially weighted moving average (MEWMA; C. Lowry et al., Technometrics 34 (1992) 46) of clipped scores, which one
    vehicle cannot move over its limit. Vehicles that deviate are left out of the population and shifts of the rig removed;
    then the charts are drawn again, until no alarm changes.

    Parameters
    ----------
    estimates
        Of at least `FEWEST` vehicles, in the order of the tests.

    Returns
    -------
    ControlChart
        Of all vehicles.
    Population
        Its mean is that of the vehicles since the last shift of the rig.
    """
    width = len(estimates.names)
    rig_limit = alarm_limit(width)
    # A vehicle that deviates widens the spread that it is judged by: the suspicious ones are left out to begin with.
    in_control, positions = ~_suspicious(estimates), estimates.positions
    alarms: set[object] | None = None
    population: Population | None = None
    for _ in range(_ROUNDS):
        population = fit_population(positions[in_control], estimates.covariances[in_control], population)
        limit = largest_component(population.spread + _typical(estimates.covariances), RUN_LENGTH)
        scores = score_vehicles(estimates.positions, estimates.covariances, population, limit, rig_limit, WEIGHT)
        found = {*scores.shifts, *np.flatnonzero(scores.deviating).tolist()}
        in_control = ~scores.deviating if (~scores.deviating).sum() >= FEWEST else in_control
        means = _period_means(estimates, scores, population, in_control)
        positions = _without_shifts(estimates, scores, means)
        if found == alarms:
            break
        alarms = found
    charted = np.isfinite(scores.values[:, 0])
    chart = ControlChart(
        vehicle_scores=np.where(charted, np.abs(scores.components).max(axis=1), np.nan),
        vehicle_limit=limit,
        rig_average=np.where(charted, np.linalg.norm(scores.averages, axis=1), np.nan),
        rig_limit=rig_limit,
        run_length=RUN_LENGTH,
        vehicle_alarms=tuple(_vehicle_alarms(estimates, scores, limit)),
        rig_alarms=tuple(_rig_alarms(estimates, scores, means)),
        offsets=positions - estimates.positions,
    )
    return chart, fit_population(positions[in_control], estimates.covariances[in_control], population)


def _suspicious(estimates: FleetEstimates) -> NDArray[np.bool_]:
    """Return which vehicles are far from the median in units of the median absolute deviation; at most a third of them."""
    variances = np.diagonal(estimates.covariances, axis1=1, axis2=2)
    distances = np.abs(estimates.positions - np.median(estimates.positions, axis=0))
    usual = np.median(variances, axis=0)
    spread = np.maximum((_NORMAL_MAD * np.median(distances, axis=0)) ** 2, usual)
    # A test that is less accurate than most may be further away.
    scores = (distances / np.sqrt(spread + np.maximum(variances - usual, 0.0))).max(axis=1)
    return np.asarray(scores > max(_SUSPICIOUS, float(np.quantile(scores, 2 / 3))))


def _typical(covariances: Real) -> Real:
    """Return the covariance matrix of the vehicle in the middle of all, by the volume of its ellipsoid."""
    volumes = np.linalg.slogdet(covariances)[1]
    return np.asarray(covariances[np.argsort(volumes)[len(volumes) // 2]])


class _PeriodMean(NamedTuple):
    """Mean of the vehicles in control between two shifts of the rig, and its covariance."""

    mean: Real
    covariance: Real


def _period_means(
    estimates: FleetEstimates, scores: Scores, population: Population, in_control: NDArray[np.bool_]
) -> list[_PeriodMean]:
    weights = np.linalg.inv(estimates.covariances + population.spread)
    means = []
    for period in scores.periods:
        own = np.arange(estimates.count)[period]
        own = own[in_control[own]] if in_control[own].any() else own
        covariance = np.linalg.inv(weights[own].sum(axis=0))
        means.append(
            _PeriodMean(covariance @ np.einsum("nij,nj->i", weights[own], estimates.positions[own]), covariance)
        )
    return means


def _without_shifts(estimates: FleetEstimates, scores: Scores, means: Sequence[_PeriodMean]) -> Real:
    """Return the coordinates with the mean of every period moved to that of the last one."""
    moved = estimates.positions.copy()
    for period, own in zip(scores.periods, means, strict=True):
        moved[period] += means[-1].mean - own.mean
    return moved


def _vehicle_alarms(estimates: FleetEstimates, scores: Scores, limit: float) -> Iterator[VehicleAlarm]:
    for i in np.flatnonzero(scores.deviating):
        chosen = _explanation(scores.values[i], scores.directions[i], limit)
        found = tuple(
            _deviation(estimates.names[j], shift, std, estimates.positive[j])
            for j, shift, std in zip(*chosen, strict=True)
        )
        yield VehicleAlarm(estimates.campaigns[i], estimates.labels[i], int(i) + 1, found)


def _explanation(value: Real, directions: Real, limit: float) -> tuple[list[int], Real, Real]:
    """Return the fewest parameters whose deviation explains a score, chosen one after the other, with size and uncertainty."""
    chosen: list[int] = []
    rest = value
    while True:
        scores = np.abs(hypothesis_scores(rest, directions))
        scores[chosen] = 0
        if chosen and (scores.max() <= limit or len(chosen) == value.size):
            break
        chosen.append(int(scores.argmax()))
        own = directions[:, chosen]
        shifts = np.asarray(np.linalg.lstsq(own, value, rcond=None)[0], dtype=float)
        rest = value - own @ shifts
    stds: Real = np.sqrt(np.diag(np.linalg.inv(own.T @ own)))
    order = np.argsort(-np.abs(shifts / stds))
    return [chosen[k] for k in order], shifts[order], stds[order]


def _deviation(name: str, shift: float, std: float, positive: bool) -> Deviation:
    """Return a shift of a coordinate in percent: of the value where that is a logarithm, else of the usual size."""
    percent = 100 * float(np.expm1(shift)) if positive else 100 * float(shift)
    return Deviation(name, percent, 100 * float(std) * (1 + percent / 100 if positive else 1), float(shift / std))


def _rig_alarms(estimates: FleetEstimates, scores: Scores, means: Sequence[_PeriodMean]) -> Iterator[RigAlarm]:
    """Yield the shifts of the rig; each is explained by the difference between the vehicles since then and those before."""
    for (alarm, since), (before, after) in zip(scores.shifts, pairwise(means), strict=True):
        whiten = np.linalg.inv(np.linalg.cholesky(before.covariance + after.covariance))
        difference = whiten @ (after.mean - before.mean)
        names, directions, positive = _hypotheses(estimates, whiten)
        scored = np.abs(hypothesis_scores(difference, directions))
        lengths = np.linalg.norm(directions, axis=0)
        shifts = directions.T @ difference / lengths**2
        found = [
            _deviation(names[j], float(shifts[j]), float(1 / lengths[j]), positive[j])
            for j in np.argsort(-scored)
            if scored[j] ** 2 > scored.max() ** 2 - _ALIKE
        ]
        labels = estimates.labels
        yield RigAlarm(alarm + 1, labels[alarm], since + 1, labels[since], found[0], tuple(found[1:]))


def _hypotheses(estimates: FleetEstimates, directions: Real) -> tuple[list[str], Real, list[bool]]:
    """Return what may have changed: single parameters and faults of the rig, with the change of the score by each."""
    names = list(estimates.names)
    exponents = np.array(
        [[fault.get(quantity_of(name).unit, 0.0) for name in names] for fault in RIG_FAULTS.values()]
    ).T
    possible = np.flatnonzero(np.abs(exponents).sum(axis=0) > 1)
    everything = np.concatenate([directions, directions @ exponents[:, possible]], axis=1)
    faults = [list(RIG_FAULTS)[k] for k in possible]
    return [*names, *faults], everything, [*map(bool, estimates.positive), *([True] * len(faults))]
