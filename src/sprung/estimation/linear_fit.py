"""The fit of a linear vehicle, from starts of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import linear_objective
from sprung.estimation.fit_result import FitResult
from sprung.estimation.identifiability import least_information
from sprung.estimation.objective import LinearObjective
from sprung.estimation.priors import Coordinates, PriorsAndConstraints, UsualValue, scaling_direction
from sprung.estimation.problem import (
    CLOSE_BY,
    CONVERGED,
    FAR,
    MOST_STEPS,
    NEARER,
    NOISE_FLOOR,
    EstimationProblem,
    Iterate,
)
from sprung.estimation.starts import VehicleSize, start_grid
from sprung.estimation.statements import readout_of, statements_of
from sprung.optimisation import Maximum, maximise
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.uncertainty import KnownValue
from sprung.vehicle import (
    AXLES,
    LinearModel,
    Sensor,
    is_nuisance,
    layout_of,
    parameter_name,
    parameter_of,
    separate_track_names,
)

Real = NDArray[np.float64]

NEAR = 0.01
"""Expected gain in log-likelihood that is near enough while the decays may still change: a tenth of a standard error."""

STARTS = 3
"""How many starts are refined at the most, where the first one does not end at an optimum that leaves white noise."""

_WHITE = 0.15
"""Correlation of neighbouring residuals up to which nothing but noise is left; a motion makes it nearly one."""

_DETERMINED = 1e3
"""Information of a logarithm from which the first optimum along a direction is the only one: three percent of uncertainty."""

_IS_SCALE = 0.999
"""Cosine of the angle to the direction of the absolute scale from which a direction is that."""

_STEPS_ASIDE = 2
"""At the most, from where the records count by their samples to where they count by their overdispersion: it is not far."""

_WELL_KNOWN = 1e4
"""Information of a logarithm from which a direction has no second optimum nearby: one percent of uncertainty."""

_DISTANCES, _FARTHEST, _PROBED = (4.0, 8.0), 0.5, 2
"""How far to probe, in standard errors and in logarithms, and along how many directions."""

_LIGHTEST = 1e-4
"""Mass of a part with a motion of its own, as a part of the sprung mass, where another fit found it below zero."""

_SHALLOW = 0.5
"""Part of the fall that the curvature says, below which another fit starts there."""


def fit_linear(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    *,
    start: Mapping[str, float] | None = None,
    weights: Real | None = None,
    guess: Mapping[str, float] = MappingProxyType({}),
    usual: Mapping[str, UsualValue] = MappingProxyType({}),
    starts: int = STARTS,
    enough: float = CONVERGED,
    most: int = MOST_STEPS,
    progress: Progress = silent,
) -> FitResult:
    """Fit one linear vehicle to all decays by :term:`maximum likelihood <maximum likelihood estimate>`.

    Parameters
    ----------
    decays
        The decays, their channels in the order of `sensors`.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors.
    known
        Quantities measured beforehand: parameters, or derived ones as ``total_mass`` and ``wheelbase``.
    start
        Parameter values, SI, to start from; where it is left out, a direct start and a grid of usual vehicles.
    weights
        1/σ² of each channel, SI, shape (channel,), where another fit has found them near the `start`.
    guess
        Values of some parameters, SI, where `start` is left out: the vehicle with them competes with those of the grid.
    usual
        Usual values of parameters, as weak priors beside a `start`.
    starts
        How many are refined at the most: the direct one, by modulating functions, and those of the grid that explain the
        records best as they are. The best end wins. Where the direct one ends at an optimum that determines the vehicle and
        whose residuals are white noise, no other is refined: a wrong optimum leaves a motion, and a motion is not white.
    enough
        Expected gain in log-likelihood at which to stop.
    most
        Steps at the most, from each start.
    progress
        Called with each step that begins.

    Returns
    -------
    FitResult
    """
    if start is None and any(decay.clocks for decay in decays):
        # As far as the release shows, all clocks agree: near enough for a start.
        together = [replace(decay, clocks=()) for decay in decays]
        first = fit_linear(together, models, sensors, known, guess=guess, starts=starts, enough=NEAR, progress=progress)
        progress(Step("setting the loggers' clocks"))
        apart = fit_linear(decays, models, sensors, known, start=first.parameters, enough=enough, progress=progress)
        return apart.after(first)
    objective = objective_of(decays, models, sensors, known)
    known = statements_of(known, sensors, next(iter(models.values())).names)
    nuisance = expected_nuisances(known)
    if start is not None:
        values = nuisance | dict(start)
        problem = problem_of(objective, known, values, usual)
        return _fit_from(problem, values, weights, enough, most)
    names = next(iter(models.values())).names
    size = VehicleSize.of(known, sensors, layout_of(names))
    grid = (vehicle | nuisance for vehicle in start_grid(size, known, "m_e" in names))
    typical = next(grid)
    problem = problem_of(objective, known, typical)
    coordinates = problem.priors.coordinates
    direct = objective.estimate_start(sensors, size, nuisance)
    ends: list[Maximum[Iterate]] = []
    if direct is not None:
        progress(Step("fitting from a direct start"))
        u = problem.priors.nearest(direct | nuisance)
        ends.append(problem.maximise(u, None, enough, NEARER, most))
        fit = _best(problem, ends, enough)
        if len(ends) == starts or (fit.converged and _leaves_white_noise(fit) and _is_determined(fit)):
            return fit
    guesses = [_completed(guess, {**typical, **(direct or {})})] if guess else []
    vehicles = [*guesses, typical, *grid]
    progress(Step(f"rating {len(vehicles)} usual vehicles as starts"))
    more = [coordinates.from_parameters(vehicle) for vehicle in vehicles]
    order = np.argsort(_costs_as_they_are(problem, objective, more), kind="stable")[: starts - len(ends)]
    few = objective.of_fewer_lines()
    rough = problem if few is None else replace(problem, objective=few)
    for number, which in enumerate(order.tolist(), start=len(ends) + 1):
        progress(Step("fitting from a start", number, starts))
        best = min(ends, key=lambda end: rough.cost(end.point), default=None)
        ends.append(
            rough.maximise(problem.priors.project(more[which]), best, enough if few is None else NEAR, FAR, most)
        )
    return _best(problem, ends if few is None else _ends_in_all_lines(problem, ends, enough, most), enough)


def expected_nuisances(known: Mapping[str, KnownValue]) -> dict[str, float]:
    """Return the values of masses of loads and of unknowns of sensors that are known beforehand, SI, by name."""
    return {name: one.value for name, one in known.items() if is_nuisance(name)}


def objective_of(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
) -> LinearObjective:
    """Return the likelihood of decays as a function of the parameters of linear models."""
    names = next(iter(models.values())).names
    return linear_objective(decays, models, readout_of(sensors, names, known), sensors)


def problem_of(
    objective: LinearObjective,
    known: Mapping[str, KnownValue],
    typical: Mapping[str, float],
    usual: Mapping[str, UsualValue] = MappingProxyType({}),
) -> EstimationProblem:
    """Return the problem of fitting them, its coordinates scaled by a typical vehicle's parameters, SI by name."""
    coordinates = Coordinates.scaled_by(objective.sensors.names, typical)
    return EstimationProblem(objective, PriorsAndConstraints(coordinates, known, usual))


def _fit_from(
    problem: EstimationProblem, values: Mapping[str, float], weights: Real | None, enough: float, most: int
) -> FitResult:
    end = problem.maximise(problem.priors.nearest(values), None, enough, CLOSE_BY, most, weights=weights)
    if not np.isfinite(problem.cost(end.point)):
        # A rate that another fit found below zero may make a motion that grows beyond all bounds in this one.
        bounded = {name: _possible(name, value, values["m_s"]) for name, value in values.items()}
        end = problem.maximise(problem.priors.nearest(bounded), None, enough, CLOSE_BY, most)
    return _best(problem, [end], enough)


def _possible(name: str, value: float, mass: float) -> float:
    """Return the nearest value that a part of a vehicle with a sprung mass, kg, can have: without any mass it has no motion."""
    parameter = parameter_of(name)
    if parameter.signed:
        return value
    return max(value, _LIGHTEST * mass if parameter.unit == "kg" else 0.0)


def _best(problem: EstimationProblem, ends: Sequence[Maximum[Iterate]], enough: float) -> FitResult:
    costs = [problem.cost(end.point) for end in ends]
    best = ends[int(np.argmin(costs))]
    agreeing = sum(cost - min(costs) < max(1e-3, 4 * enough) for cost in costs)
    return FitResult(problem, best.point, best.steps, best.converged, len(ends), agreeing)


def _ends_in_all_lines(
    problem: EstimationProblem, ends: Sequence[Maximum[Iterate]], enough: float, most: int
) -> list[Maximum[Iterate]]:
    """Return where fits lead from their ends in part of the records; those that ended in one point lead to one."""
    found: dict[int, Maximum[Iterate]] = {}
    for end in ends:
        if id(end) not in found:
            best = min(found.values(), key=lambda other: problem.cost(other.point), default=None)
            at = end.point
            onward = problem.maximise(at.u, best, enough, NEARER, most, weights=at.at.weights)
            found[id(end)] = onward._replace(steps=end.steps + onward.steps)
    return [found[id(end)] for end in ends]


def _is_determined(fit: FitResult) -> bool:
    """Whether records and statements determine everything but the scale: at a wrong optimum a part of a vehicle vanishes.

    Where they hardly determine a direction, there may be several optima along it.
    """
    information, _, null_space = fit.problem.system(fit.iterate)
    eigenvalues, vectors = np.linalg.eigh(information)
    missing = null_space @ vectors[:, eigenvalues < max(_DETERMINED, least_information(eigenvalues))]
    # Every mass and rate times a number is one vehicle where nothing was weighed.
    slopes = fit.problem.priors.coordinates.derivatives(fit.iterate.u)
    of_scale = scaling_direction(fit.names, fit.values, slopes)
    of_scale /= np.linalg.norm(of_scale)
    is_scale = float(np.linalg.norm(missing.T @ of_scale)) > _IS_SCALE
    return int(missing.shape[1]) <= int(is_scale)


def _leaves_white_noise(fit: FitResult) -> bool:
    """Whether the residuals of every channel are white noise, or rounding."""
    variance = fit.noise**2
    rounding = variance < 2 * fit.problem.least_variance
    total, neighbours, _ = fit.residual_moments
    return bool(np.all(rounding | (np.abs(neighbours) <= _WHITE * total)))


def _costs_as_they_are(problem: EstimationProblem, objective: LinearObjective, starts: Sequence[Real]) -> Real:
    """Cost of starts on decimated records, channels weighted by their energy; shape (start,)."""
    values = np.array([problem.priors.coordinates.values(u) for u in starts])
    # In two halves, for the sake of memory.
    halves = np.array_split(values, 2)
    parts = np.concatenate([objective.unexplained(half, problem.signal_weights) for half in halves])
    costs: Real = np.log(parts + NOISE_FLOOR**2) @ objective.observations.sum(axis=0)
    return costs


def _completed(guess: Mapping[str, float], usual: Mapping[str, float]) -> dict[str, float]:
    """Return a guess completed by a usual vehicle; half-distances that it shares hold for springs and dampers apart too."""
    shared = {own: value for name, value in guess.items() for own in separate_track_names(name)}
    springs = {
        axle: [(parameter_name(place, axle), parameter_name(place, axle, "2")) for place in "tn"] for axle in AXLES
    }
    apart = {both: guess[own] for pairs in springs.values() for both, own in pairs if own in guess}
    return {**usual, **shared, **apart, **guess}


def weigh_statements(fit: FitResult) -> FitResult:
    """Move a fit to where it is once the records count by their overdispersion, as statements about a vehicle do not.

    Where the model has errors, the records seem to say more than they do: they would turn statements, the gains of sensors
    say, further than what is left of them can justify.

    Parameters
    ----------
    fit
        Where the fit has ended, every sample of the records counted.

    Returns
    -------
    FitResult
        Of the same problem, at the optimum of the one in which the records count less.
    """
    if fit.overdispersion == 1:
        return fit
    counted = replace(fit.problem, overdispersion=fit.overdispersion)
    found = maximise(counted, fit.iterate, tolerance=NEAR, damping=CLOSE_BY, most_steps=_STEPS_ASIDE)
    return replace(fit, iterate=found.point, steps=fit.steps + found.steps)


def escape_local_optimum(fit: FitResult) -> FitResult:
    """Fit once more from both sides of an optimum, along the directions that are known least.

    Where the records say little of a direction, the likelihood may have two optima a few standard errors apart, and every
    start may have ended at the lower one. It shows in a likelihood that falls less on that side than its curvature says.

    Parameters
    ----------
    fit
        Where the fit has ended.

    Returns
    -------
    FitResult
        The best that was found.
    """
    problem, optimum = fit.problem, fit.iterate
    information, _, null_space = problem.system(optimum)
    eigenvalues, vectors = np.linalg.eigh(information)
    weak = np.flatnonzero((eigenvalues > least_information(eigenvalues)) & (eigenvalues < _WELL_KNOWN))[:_PROBED]
    found: list[Maximum[Iterate]] = []
    for which in weak:
        direction = null_space @ vectors[:, which]
        for distance in _DISTANCES:
            step = min(distance / eigenvalues[which] ** 0.5, _FARTHEST / np.abs(direction).max())
            for side in (-step, step):
                u = problem.priors.project(optimum.u + side * direction)
                fall = problem.cost(problem.start(u)) - problem.cost(optimum)
                if fall < _SHALLOW * eigenvalues[which] * step**2:
                    found.append(problem.maximise(u, None, CONVERGED, NEARER))
    best = min(found, key=lambda end: problem.cost(end.point), default=None)
    if best is None or problem.cost(best.point) >= problem.cost(optimum):
        return fit
    return replace(fit, iterate=best.point, steps=fit.steps + best.steps, converged=best.converged)
