"""The fit of a vehicle with nonlinear forces, and the score test of more of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.estimation.joint_scores import score_directions
from sprung.estimation.linear_fit import NEAR, expected_nuisances
from sprung.estimation.low_pass import LowPass
from sprung.estimation.priors import Coordinates, PriorsAndConstraints, UsualValue
from sprung.estimation.problem import CLOSE_BY, EstimationProblem
from sprung.estimation.statements import readout_of, statements_of
from sprung.estimation.stuck_drops import go_on_with_likelier_states
from sprung.estimation.time_stepping import TimeSteppingObjective
from sprung.preprocess import FreeDecay
from sprung.progress import Progress, Step, silent
from sprung.uncertainty import KnownValue
from sprung.vehicle import LOW_PASS_CORNER, NonlinearModel, Sensor

Real = NDArray[np.float64]

_COARSE, _FINE, _FINEST = 0.0025, 0.00201, 0.00101
"""s of a step at most: on the way, and where its error must not be taken for anything else; the last where it is of second
order, as friction turns round within a step, or rates behind mounts jump.
"""

_PER_DECAY, _SHORTEST = 0.5, 0.000251
"""s of a step at most over the time in which a damper behind a mount follows where it is softest; and s that are enough."""

CONVERGED_IN_STEPS = 4e-3
"""Expected gain in log-likelihood at which a fit by time stepping has converged: a tenth of a standard error, of which the
last step leaves less. Forces are solved for to a part of their size, and a friction turns round between two steps in time, so
the likelihood is no smoother."""

_MOST_STEPS = 100

_ON_THE_WAY = 1.0
"""Expected gain in log-likelihood at which a fit to the beginnings ends that is followed by one to the whole decays."""

_FAR = 0.1
"""Damping of the first step from usual values: far from the recordings forces that are not linear lead longer steps astray."""

_HORIZON = 1.0
"""s of each decay that are fitted first: the shorter, the straighter the way from a start that is far away."""


def fit_nonlinear(
    decays: Sequence[FreeDecay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    *,
    start: Mapping[str, float],
    states: Real,
    enough: float = CONVERGED_IN_STEPS,
    near: bool = False,
    beginning_only: bool = False,
    most: int = _MOST_STEPS,
    tilting: bool = False,
    low_pass: LowPass | None = None,
    usual: Mapping[str, UsualValue] = MappingProxyType({}),
    step_part: float = 1.0,
    progress: Progress = silent,
) -> FitResult:
    """Fit one vehicle with nonlinear forces to all decays by maximum likelihood.

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
        Whether the start is near the optimum.
    beginning_only
        Whether the first second of each decay will do.
    most
        Steps at the most, of each fit on the way.
    tilting
        Whether the sensors turn with the body, and measure the less of gravity.
    low_pass
        Of the loggers, which all channels passed; None for none. Its corner is an unknown of the fit.
    usual
        Usual values of parameters, as weak priors.
    step_part
        Part of the usual length of a step in time that is taken.
    progress
        Called with each step that begins.

    Returns
    -------
    FitResult
    """
    laws = ", ".join(law.name for law, *_ in next(iter(models.values())).forces.laws)
    progress(Step(f"fitting with {laws}, step by step through all drops"))
    known = _statements(known, sensors, models, low_pass)
    steps, values = 0, expected_nuisances(known) | dict(start)
    fine = step_part * _longest_step(models, values)
    beginnings = [beginning_of(decay) for decay in decays]
    # What a low-pass makes of a friction that turns round depends on when it does: its corner is found by fits to beginnings.
    stages = (
        [
            (
                beginnings,
                max(enough, NEAR if beginning_only else _ON_THE_WAY),
                _COARSE if low_pass is None or not beginning_only else fine,
                bool(usual),
            )
        ]
        if beginning_only or not near
        else []
    )
    if not beginning_only:
        stages.append((list(decays), enough, fine, False))
    for part, tolerance, longest_step, is_far in stages:
        objective = _objective(part, models, sensors, known, states, tilting, low_pass, longest_step)
        problem = _problem(objective, known, values, usual)
        damping = _FAR if is_far else CLOSE_BY
        found = problem.maximise(problem.priors.nearest(values), None, tolerance, damping, most, cautious=is_far)
        if most > 1:  # a single step only compares models
            found = go_on_with_likelier_states(problem, objective, found, tolerance, most)
        states, steps = found.point.at.states, steps + found.steps
        values = dict(zip(problem.priors.coordinates.names, found.point.at.values.tolist(), strict=True))
    # Whoever goes on from here starts with the initial states that were found.
    return FitResult(
        replace(problem, objective=objective.with_states(states)), found.point, steps, found.converged, 1, 1
    )


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
    longest_step: float,
    tilting: bool = False,
    low_pass: LowPass | None = None,
) -> dict[str, float]:
    """Return what larger models would gain over one that is fitted already, by score tests from one evaluation.

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
    longest_step
        s: that of the fit, if it is short. A longer one's error would be taken for what larger models gain.
    tilting, low_pass
        As for `fit_nonlinear`.

    Returns
    -------
    dict
        In twice the log-likelihood, to second order.
    """
    known = _statements(known, sensors, models, low_pass)
    values = expected_nuisances(known) | dict(values)
    objective = _objective(
        decays,
        models,
        sensors,
        known,
        states,
        tilting,
        low_pass,
        min(_COARSE, longest_step) if low_pass is None else _longest_step(models, values),
    )
    problem = _problem(objective, known, values)
    return score_directions(problem, problem.start(problem.priors.nearest(values)), together, candidates)


def _statements(
    known: Mapping[str, KnownValue],
    sensors: Sequence[Sensor],
    models: Mapping[str, NonlinearModel],
    low_pass: LowPass | None,
) -> dict[str, KnownValue]:
    """Return everything that is known beforehand, SI, by name; of the corner of a low-pass hardly anything."""
    stated = statements_of(known, sensors, next(iter(models.values())).names)
    if low_pass is None or not low_pass.has_effect:
        return stated
    return stated | {LOW_PASS_CORNER: KnownValue(low_pass.corner, low_pass.corner)}


def _longest_step(models: Mapping[str, NonlinearModel], values: Mapping[str, float]) -> float:
    """Return how long a step may be, s, so that its error is not taken for anything else."""
    model = next(iter(models.values()))
    longest = _FINEST if model.forces.memories or model.linear.massive < model.linear.size else _FINE
    decay = model.fastest_decay(np.array([values[name] for name in model.names]))
    return max(longest / max(1.0, longest * decay / _PER_DECAY), _SHORTEST)


def _objective(
    decays: Sequence[FreeDecay],
    models: Mapping[str, NonlinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    states: Real,
    tilting: bool,
    low_pass: LowPass | None,
    longest_step: float,
) -> TimeSteppingObjective:
    readout = readout_of(sensors, next(iter(models.values())).names, known)
    return TimeSteppingObjective(tuple(decays), models, readout, states, tilting, longest_step, low_pass)


def _problem(
    objective: TimeSteppingObjective,
    known: Mapping[str, KnownValue],
    typical: Mapping[str, float],
    usual: Mapping[str, UsualValue] = MappingProxyType({}),
) -> EstimationProblem:
    coordinates = Coordinates.scaled_by(objective.sensors.names, typical)
    return EstimationProblem(objective, PriorsAndConstraints(coordinates, known, usual))


def beginning_of(decay: FreeDecay) -> FreeDecay:
    """Return the beginning of a decay, which is fitted first.

    Parameters
    ----------
    decay
        The whole.

    Returns
    -------
    FreeDecay
    """
    return replace(decay, values=decay.values[:, : int(_HORIZON * decay.rate)])
