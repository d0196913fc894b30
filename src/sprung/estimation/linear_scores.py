"""Score tests of linear terms beside a fitted linear vehicle, without any fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import linear_objective
from sprung.estimation.fit_result import FitResult
from sprung.estimation.linear_fit import problem_of
from sprung.estimation.priors import Coordinates
from sprung.estimation.problem import Iterate
from sprung.estimation.score_test import ScoreTest, score_added, score_test
from sprung.estimation.statements import readout_of, statements_of
from sprung.uncertainty import KnownValue
from sprung.vehicle import LinearModel, Readout, Sensor, parameter_of, separate_track_names

Real = NDArray[np.float64]

Score = tuple[float, dict[str, float]]
"""The gain in twice the log-likelihood, to second order; and estimates by one Newton step, SI, by name."""


def score_linear_terms(
    fit: FitResult,
    models: Mapping[str, LinearModel],
    sensors: Readout,
    ways: Sequence[tuple[Mapping[str, float], Mapping[str, Sequence[str]]]],
) -> list[dict[str, Score]] | None:
    """Return what terms of M, C and K would gain in a fitted linear vehicle, by :term:`score tests <score test>`.

    All of them follow from one evaluation of the fitted model; see `ObjectiveAt.with_larger_model`.

    Parameters
    ----------
    fit
        Of the linear vehicle.
    models
        Equations of motion by load name with all the terms.
    sensors
        The sensors over their parameters.
    ways
        Several ways in which these models equal the fitted one, or nearly so: their parameters, SI, by name, and by term the
        names of the parameters that it brings; a half-distance that springs and dampers share stands for both.

    Returns
    -------
    list of dict or None
        For each of the ways, by term: the gain in twice the log-likelihood, and the estimates of its parameters, SI, by name.
        None where changes of the response have no closed form.
    """
    all_names, known = next(iter(models.values())).names, fit.parameters
    brought = [list(dict.fromkeys(name for names in terms.values() for name in names)) for _, terms in ways]
    every = [{**known, **values} for values, _ in ways]
    numbers = [np.array([values[name] for name in sensors.names]) for values in every]
    changes = [np.array([_changed(name, all_names) for name in names]) for names in brought]
    tested = fit.iterate.at.with_larger_model(models, sensors, list(zip(numbers, changes, strict=True)))
    if tested is None:
        return None
    gradient, information = tested
    # Some parameters are about the same in every vehicle, and here.
    stds = np.array([parameter_of(name).usual_std for names in brought for name in names])
    at_unknown = len(fit.names) + np.flatnonzero(stds)
    information[at_unknown, at_unknown] += stds[stds > 0] ** -2
    test = score_added(fit, gradient, information)
    found, end = [], 0
    for (values, terms), names in zip(ways, brought, strict=True):
        begin, end = end, end + len(names)
        found.append(_scores(test, range(begin, end), names, values, terms))
    return found


def _scores(
    test: ScoreTest, columns: range, names: list[str], values: Mapping[str, float], terms: Mapping[str, Sequence[str]]
) -> dict[str, Score]:
    """Return the scores of terms, whose parameters are the unknowns of a test in some columns."""
    here = {name: values[name if name in values else separate_track_names(name)[0]] for name in names}
    coordinates = Coordinates.scaled_by(tuple(names), {**values, **here})
    u = coordinates.from_parameters(here)
    scores = {}
    for term, brought in terms.items():
        own = [columns[names.index(name)] for name in brought]
        step = test.joint_values(own)
        estimates = coordinates.extrapolated(u, step[columns.start : columns.stop] / coordinates.derivatives(u))
        named = dict(zip(names, estimates.tolist(), strict=True))
        scores[term] = (float(test.score @ step), {name: named[name] for name in brought})
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
        u = problem.priors.nearest(values)
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
