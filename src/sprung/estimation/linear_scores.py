"""Score tests of linear terms beside a fitted linear vehicle, without any fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.estimation.joint_objective import linear_objective
from sprung.estimation.linear_fit import problem_of
from sprung.estimation.priors import Coordinates
from sprung.estimation.problem import Iterate
from sprung.estimation.score_test import score_added, score_test
from sprung.estimation.statements import readout_of, statements_of
from sprung.uncertainty import KnownValue
from sprung.vehicle import LinearModel, Sensor, separate_track_names

Real = NDArray[np.float64]

Score = tuple[float, dict[str, float]]
"""The gain in twice the log-likelihood, to second order; and estimates by one Newton step, SI, by name."""


def score_linear_terms(
    fit: FitResult,
    models: Mapping[str, LinearModel],
    values: Mapping[str, float],
    candidates: Mapping[str, Mapping[str, float]],
) -> dict[str, Score] | None:
    """Return what terms of M, C and K would gain in a fitted linear vehicle, by :term:`score tests <score test>`.

    Parameters
    ----------
    fit
        Of the linear vehicle.
    models
        Equations of motion by load name with all the terms, over the same coordinates.
    values
        Their parameters where they equal the fitted ones, SI, by name.
    candidates
        By name the parameters that each term brings, with their values there, SI; names of half-distances that springs and
        dampers share stand for both.

    Returns
    -------
    dict or None
        By candidate: the gain in twice the log-likelihood, and the estimates of its parameters, SI, by name. None where modal
        coordinates do not exist.
    """
    at = fit.iterate.at.modal
    if at is None:
        return None
    brought = {name: value for parameters in candidates.values() for name, value in parameters.items()}
    larger = LinearModel.stack([models[load] for load in at.loads])
    changed = np.array([_changed(name, larger.names) for name in brought])
    slopes = np.concatenate(larger.slopes(np.array([values[name] for name in larger.names])), axis=-1)
    modes = at.modes
    motions = np.concatenate([modes.accelerations, modes.velocities, modes.displacements], axis=-2)
    forces = np.moveaxis(np.tensordot(changed, slopes, 1) @ motions, 0, -2)
    gradient, information = at.with_changes(at.differentiate_response(forces))
    test = score_added(fit, gradient, information)
    coordinates = Coordinates.scaled_by(tuple(brought), {**values, **brought})
    u = coordinates.from_parameters(brought)
    scores = {}
    for term, parameters in candidates.items():
        own = [list(brought).index(name) for name in parameters]
        estimates = coordinates.extrapolated(u, test.joint_values(own) / coordinates.derivatives(u))
        scores[term] = (
            test.gain(own),
            {name: float(estimates[i]) for name, i in zip(parameters, own, strict=True)},
        )
    return scores


def _changed(name: str, names: Sequence[str]) -> Real:
    """Return 1 for each of the names that changes with a parameter, shape (name,)."""
    own = (name,) if name in names else separate_track_names(name)
    return np.array([float(other in own) for other in names])


def score_linear_term(
    fit: FitResult,
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    starts: Sequence[Mapping[str, float]],
) -> tuple[Score, ...]:
    """Return what a model with more parameters would gain over one that is fitted already, by the :term:`score test`.

    This also holds for a model with more coordinates.

    Parameters
    ----------
    fit
        Of the smaller model.
    models, sensors, known
        As for `fit_linear`, of the larger one.
    starts
        Its parameters, SI, where it equals the fitted smaller one, or nearly so, in each of several ways.

    Returns
    -------
    tuple
        For each of the starts the gain in twice the log-likelihood, to second order, and the parameters of the larger model
        after one Newton step, SI, by name. The gain is -inf for a start from which the motion has no bounds.
    """
    names = next(iter(models.values())).names
    at, readout = fit.iterate.at.modal, readout_of(sensors, names, known)
    objective = (
        linear_objective(fit.decays, models, readout, sensors)
        if at is None
        else at.objective.with_models(models, readout)
    )
    known = statements_of(known, sensors, names)
    scores = []
    for values in starts:
        problem = problem_of(objective, known, values)
        u = problem.priors.project(problem.priors.coordinates.from_parameters(values))
        # Where the models are equal, so are their residuals, and the noise that these show.
        iterate = Iterate(u, objective.at(problem.priors.coordinates.values(u), fit.weights))
        if not np.isfinite(iterate.at.residual_sums).all():  # a motion without bounds
            scores.append((-np.inf, dict(values)))
            continue
        information, gradient, null_space = problem.system(iterate)
        test = score_test(information, gradient, 0)
        estimates = problem.priors.coordinates.extrapolated(u, null_space @ test.joint_values())
        # A term whose parameters have no meaning without it is there a little, which the fitted model has not to bear.
        lost = max(problem.cost(iterate) + 2 * fit.loglikelihood, 0.0)
        named = dict(zip(problem.priors.coordinates.names, estimates.tolist(), strict=True))
        scores.append((test.gain() - lost, named))
    return tuple(scores)
