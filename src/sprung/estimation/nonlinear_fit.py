"""Beyond the linear vehicle: what each extra would gain, told from one place, and the fit with those that were chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit import NEAR, FitResult
from sprung.estimation.priors import Coordinates, PriorsAndConstraints
from sprung.estimation.problem import CLOSE_BY, CONVERGED, EstimationProblem, Iterate, identifiable_subspace
from sprung.estimation.time_stepping import SteppedLikelihood, SteppedLikelihoodAt
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.uncertainty import KnownValue
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


def fit_nonlinear(
    decays: Sequence[FreeDecay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    *,
    start: Mapping[str, float],
    states: Real,
    enough: float = CONVERGED,
    near: bool = False,
    begun: bool = False,
    most: int = _MOST,
    tilting: bool = False,
    progress: Progress = silent,
) -> FitResult:
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
        problem = _climb(part, models, sensors, known, values, states, tilting, longest)
        point = _to_the_top(problem, values, gain, most)
        states, steps = point.place.states(point.weights), steps + point.steps
        # Whoever climbs on starts with the initial states that were found.
        problem = replace(problem, likelihood=problem.likelihood.beginning(states))
        values = dict(zip(problem.priors.coordinates.names, point.place.values.tolist(), strict=True))
    return FitResult(problem, point, steps, 1, 1)


def score_stepped_terms(
    decays: Sequence[FreeDecay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
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
        As for `fit_nonlinear`, of a model that has everything.
    values
        Its parameters where it equals the fitted one, SI, by name.
    states
        {X, Ẋ} of each drop there, SI, shape (drop, state).
    together
        The directions of the fitted model: parameters that move together in it.
    candidates
        The further directions of each larger one.
    tilting
        As for `fit_nonlinear`.

    Returns
    -------
    dict
        What each would gain in twice the log-likelihood, to second order: score tests, all from one evaluation
        (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50).
    """
    problem = _climb(decays, models, sensors, known, values, states, tilting, _COARSE)
    names = problem.priors.coordinates.names
    u = _bound(problem, values)
    point = problem.at(u)
    slopes, prior = problem.priors.coordinates.slopes(u), problem.priors.prior(u)
    free = problem.priors.free(u)
    information = point.evaluation.information * np.outer(slopes, slopes) + prior.slopes.T @ prior.slopes
    gradient = point.evaluation.gradient * slopes + prior.slopes.T @ prior.residual

    def gain(directions: Sequence[Sequence[str]]) -> float:
        basis = np.array([[float(name in direction) for name in names] for direction in directions]).T
        # Of these, what exact knowledge leaves free.
        _, bound, ways = np.linalg.svd(basis - free @ (free.T @ basis))
        basis = basis @ ways[int(np.sum(bound > _BOUND)) :].T
        system, slope = basis.T @ information @ basis, basis.T @ gradient
        told = identifiable_subspace(system)
        return float(slope @ told @ np.linalg.solve(told.T @ system @ told, told.T @ slope))

    before = gain(together)
    return {name: gain([*together, *more]) - before for name, more in candidates.items()}


def wald_test(optimum: FitResult, constraints: Sequence[tuple[str, str | float]]) -> float:
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
    coordinates, u, names = optimum.problem.priors.coordinates, optimum.point.u, optimum.names
    rows, away = np.zeros((len(constraints), len(names))), np.zeros(len(constraints))
    for row, (i, (name, other)) in zip(rows, enumerate(constraints), strict=True):
        own = names.index(name)
        row[own] = 1.0
        if isinstance(other, str):
            row[names.index(other)] = -1.0
            away[i] = row @ u
        else:
            there = np.where(np.arange(len(names)) == own, other, optimum.values)
            away[i] = u[own] - coordinates.of(there)[own]
    information, _, free = optimum.problem.system(optimum.point)
    told = identifiable_subspace(information)
    seen = rows @ free @ told
    spread = seen @ np.linalg.solve(told.T @ information @ told, seen.T)
    return float(away @ np.linalg.pinv(spread) @ away)


def _climb(
    decays: Sequence[FreeDecay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    typical: Mapping[str, float],
    states: Real,
    tilting: bool,
    longest: float,
) -> EstimationProblem:
    names = next(iter(models.values())).names
    rows = Rows.of([sensor.row for sensor in sensors], names)
    likelihood = SteppedLikelihood.of(decays, models, rows, states, tilting, longest)
    return EstimationProblem(likelihood, PriorsAndConstraints(Coordinates.beside(names, typical), known))


def _to_the_top(problem: EstimationProblem, values: Mapping[str, float], enough: float, most: int) -> Iterate:
    """Climb, and once more from where no friction remembers what it cannot, as long as that leads higher."""
    names = problem.priors.coordinates.names
    point = problem.maximise(_bound(problem, values), None, enough, CLOSE_BY, most)
    for _ in range(_ANEW):
        begin = point.place.believable() if isinstance(point.place, SteppedLikelihoodAt) else None
        if begin is None:
            break
        anew = replace(problem, likelihood=point.place.likelihood.beginning(begin))
        there = dict(zip(names, point.place.values.tolist(), strict=True))
        found = anew.maximise(_bound(problem, there), None, enough, CLOSE_BY, most)
        if problem.cost(found) >= problem.cost(point):
            break
        point = replace(found, steps=point.steps + found.steps)
    return point


def _bound(problem: EstimationProblem, values: Mapping[str, float]) -> Real:
    return problem.priors.bind(problem.priors.coordinates.by_name(values))


def _begun(decay: FreeDecay) -> FreeDecay:
    """Give the beginning of a decay."""
    return replace(decay, values=decay.values[:, : int(_HORIZON * decay.rate)])
