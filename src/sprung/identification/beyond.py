"""Beyond the linear vehicle: what each extra would gain, told from one place, and the fit with those that were chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimate import Known
from sprung.identification.climb import CLOSE_BY, CONVERGED, Climb, Point, told_directions
from sprung.identification.knowledge import Coordinates, Knowledge
from sprung.identification.stepped import SteppedLikelihood, SteppedPlace
from sprung.identification.summit import NEAR, Summit
from sprung.prepare import Decay
from sprung.progress import Progress, Step, silent
from sprung.vehicle import NonlinearModel, Rows, Sensor

Real = NDArray[np.float64]

_COARSE, _FINE = 0.0025, 0.00101
"""s of a step at most: on the way, and where what it errs by must not be taken for anything else."""

_MOST = 100
"""Steps at the most."""

_ANEW = 2
"""Times that a climb begins anew where a friction has gone astray."""

_HORIZON = 1.0
"""s of each decay that are fitted first: the shorter, the straighter the way from a start that is far away."""

_BOUND = 1e-9
"""Part of a direction, of length one, that exact knowledge forbids, from which it does."""


def ascend_stepped(
    decays: Sequence[Decay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, Known],
    *,
    start: Mapping[str, float],
    states: Real,
    enough: float = CONVERGED,
    near: bool = False,
    begun: bool = False,
    most: int = _MOST,
    tilting: bool = False,
    progress: Progress = silent,
) -> Summit:
    """Maximise the likelihood of all decays under a vehicle with nonlinear forces.

    Parameters
    ----------
    decays
        The decays, their channels in the order of `sensors`.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors.
    known
        Quantities measured beforehand.
    start
        Parameter values, SI, by name.
    states
        {X, Ẋ} of each drop at its first sample, near to what the start would have, and memories where they are known;
        shape (drop, state) or (drop, state + memory).
    enough
        Expected gain in log-likelihood at which to stop.
    near
        Whether the start is near the summit.
    begun
        Whether the beginnings of the decays will do.
    most
        Steps at the most, of each fit on the way.
    tilting
        Whether the sensors turn with the body, and feel the less of gravity.
    progress
        Called with each step that begins.

    Returns
    -------
    Summit
    """
    laws = ", ".join(law.name for law, _, _ in next(iter(models.values())).forces.laws)
    progress(Step(f"fitting with {laws}, step by step through all drops"))
    steps, values = 0, dict(start)
    near_it = max(enough, NEAR)
    stages = [([_begun(decay) for decay in decays], near_it, _COARSE)] if begun or not near else []
    if not begun:
        stages.append((list(decays), enough, _FINE))
    for part, gain, longest in stages:
        climb = _climb(part, models, sensors, known, values, states, tilting, longest)
        point = _to_the_top(climb, values, gain, most)
        states, steps = point.place.states(point.weights), steps + point.steps
        # Whoever climbs on starts with the initial states that were found.
        climb = replace(climb, likelihood=climb.likelihood.beginning(states))
        values = dict(zip(climb.knowledge.coordinates.names, point.place.values.tolist(), strict=True))
    return Summit(climb, point, steps, 1, 1)


def prospects(
    decays: Sequence[Decay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, Known],
    *,
    values: Mapping[str, float],
    states: Real,
    together: Sequence[Sequence[str]],
    candidates: Mapping[str, Sequence[Sequence[str]]],
    tilting: bool = False,
) -> dict[str, float]:
    """Score larger models against a smaller one that is fitted already.

    Parameters
    ----------
    decays, models, sensors, known
        As for `ascend_stepped`, of a model that has everything.
    values
        Its parameters where it equals the fitted one, SI, by name.
    states
        {X, Ẋ} of each drop there, SI, shape (drop, state).
    together
        The directions of the fitted model: parameters that move together in it.
    candidates
        The further directions of each larger one.
    tilting
        As for `ascend_stepped`.

    Returns
    -------
    dict
        What each would gain in twice the log-likelihood, to second order: score tests, all from one evaluation
        (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50).
    """
    climb = _climb(decays, models, sensors, known, values, states, tilting, _COARSE)
    names = climb.knowledge.coordinates.names
    u = _bound(climb, values)
    point = climb.at(u)
    slopes, prior = climb.knowledge.coordinates.slopes(u), climb.knowledge.prior(u)
    free = climb.knowledge.free(u)
    information = point.evaluation.information * np.outer(slopes, slopes) + prior.slopes.T @ prior.slopes
    gradient = point.evaluation.gradient * slopes + prior.slopes.T @ prior.residual

    def gain(directions: Sequence[Sequence[str]]) -> float:
        basis = np.array([[float(name in direction) for name in names] for direction in directions]).T
        # Of these, what exact knowledge leaves free.
        _, bound, ways = np.linalg.svd(basis - free @ (free.T @ basis))
        basis = basis @ ways[int(np.sum(bound > _BOUND)) :].T
        system, slope = basis.T @ information @ basis, basis.T @ gradient
        told = told_directions(system)
        return float(slope @ told @ np.linalg.solve(told.T @ system @ told, told.T @ slope))

    before = gain(together)
    return {name: gain([*together, *more]) - before for name, more in candidates.items()}


def lost_without(summit: Summit, constraints: Sequence[tuple[str, str | float]]) -> float:
    """Say what the likelihood would lose, to second order, if parameters had certain values.

    Parameters
    ----------
    summit
        Where a fit ended.
    constraints
        Parameters, and what each would be: a value, SI, or another parameter.

    Returns
    -------
    float
        Of twice the log-likelihood: the test of Wald, Trans. Am. Math. Soc. 54 (1943) 426.
    """
    coordinates, u, names = summit.climb.knowledge.coordinates, summit.point.u, summit.names
    rows, away = np.zeros((len(constraints), len(names))), np.zeros(len(constraints))
    for row, (i, (name, other)) in zip(rows, enumerate(constraints), strict=True):
        own = names.index(name)
        row[own] = 1.0
        if isinstance(other, str):
            row[names.index(other)] = -1.0
            away[i] = row @ u
        else:
            there = np.where(np.arange(len(names)) == own, other, summit.values)
            away[i] = u[own] - coordinates.of(there)[own]
    information, _, free = summit.climb.system(summit.point)
    told = told_directions(information)
    seen = rows @ free @ told
    spread = seen @ np.linalg.solve(told.T @ information @ told, seen.T)
    return float(away @ np.linalg.pinv(spread) @ away)


def _climb(
    decays: Sequence[Decay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, Known],
    typical: Mapping[str, float],
    states: Real,
    tilting: bool,
    longest: float,
) -> Climb:
    names = next(iter(models.values())).names
    rows = Rows.of([sensor.row for sensor in sensors], names)
    likelihood = SteppedLikelihood.of(decays, models, rows, states, tilting, longest)
    return Climb(likelihood, Knowledge(Coordinates.beside(names, typical), known))


def _to_the_top(climb: Climb, values: Mapping[str, float], enough: float, most: int) -> Point:
    """Climb, and once more from where no friction remembers what it cannot, as long as that leads higher."""
    names = climb.knowledge.coordinates.names
    point = climb.to_the_top(_bound(climb, values), None, enough, CLOSE_BY, most)
    for _ in range(_ANEW):
        begin = point.place.believable() if isinstance(point.place, SteppedPlace) else None
        if begin is None:
            break
        anew = replace(climb, likelihood=point.place.likelihood.beginning(begin))
        there = dict(zip(names, point.place.values.tolist(), strict=True))
        found = anew.to_the_top(_bound(climb, there), None, enough, CLOSE_BY, most)
        if climb.cost(found) >= climb.cost(point):
            break
        point = replace(found, steps=point.steps + found.steps)
    return point


def _bound(climb: Climb, values: Mapping[str, float]) -> Real:
    return climb.knowledge.bind(climb.knowledge.coordinates.by_name(values))


def _begun(decay: Decay) -> Decay:
    """Give the beginning of a decay."""
    return replace(decay, values=decay.values[:, : int(_HORIZON * decay.rate)])
