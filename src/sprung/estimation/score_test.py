"""Tests of hypotheses from one place: the score test of more unknowns, and Wald's test of fewer.

Both follow from information and gradient where a model was fitted, without any further fit (Rao, Proc. Camb. Phil. Soc. 44
(1948) 50; Wald, Trans. Am. Math. Soc. 54 (1943) 426).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.elimination import eliminate
from sprung.estimation.fit_result import FitResult
from sprung.estimation.identifiability import RANK, identifiable_equations, identifiable_subspace
from sprung.estimation.priors import scaling_direction
from sprung.vehicle import evaluate_quantity, is_of_sensor

Real = NDArray[np.float64]

_DETERMINED = 1e-9
"""Part of an unknown's own information, above rounding, that nuisance parameters must leave for it to be tested."""


@dataclass(frozen=True, eq=False)
class ScoreTest:
    """Score test of unknowns that a fitted model does not have, its own parameters being nuisance parameters.

    Attributes
    ----------
    score
        Gradient of the log-likelihood by the unknowns, the parameters eliminated, shape (unknown,).
    information
        Fisher information of them, 1 over the squares of their units, likewise; shape (unknown, unknown).
    own_information
        Information of each if the parameters were known, in the same units, shape (unknown,).
    shifts
        Change of each direction of the parameters with each unknown, in standard errors of that direction; shape (direction,
        unknown).
    """

    score: Real
    information: Real
    own_information: Real
    shifts: Real

    @cached_property
    def determined(self) -> NDArray[np.bool_]:
        """Of which unknowns the records have information beside the parameters, shape (unknown,)."""
        least = _DETERMINED * np.maximum(self.own_information, np.finfo(float).tiny)
        return np.asarray((self.own_information > 0) & (np.diag(self.information) > least))

    @property
    def values(self) -> Real:
        """Estimate of each unknown if it were the only one, shape (unknown,); NaN where it is not determined."""
        return np.where(self.determined, self.score, np.nan) / np.where(self.determined, np.diag(self.information), 1.0)

    @property
    def stds(self) -> Real:
        """Standard uncertainty of these in white noise, shape (unknown,); NaN where it is not determined."""
        return np.where(self.determined, np.where(self.determined, np.diag(self.information), 1.0) ** -0.5, np.nan)

    @property
    def max_shifts(self) -> Real:
        """Largest change of a parameter with one standard uncertainty of each unknown, in its own; shape (unknown,)."""
        return np.asarray(np.abs(self.shifts).max(axis=0, initial=0.0) * self.stds)

    def gain(self, chosen: Sequence[int] | slice = slice(None)) -> float:
        """Return what twice the log-likelihood would gain with some of the unknowns together, to second order.

        Parameters
        ----------
        chosen
            Which; all unless given. Those that are not determined add nothing.
        """
        return float(self.score @ self.joint_values(chosen))

    def joint_values(self, chosen: Sequence[int] | slice = slice(None)) -> Real:
        """Return the estimates of some of the unknowns together, by one Newton step.

        Parameters
        ----------
        chosen
            Which; all unless given.

        Returns
        -------
        ndarray
            Shape (unknown,); 0 for those that are not chosen or not determined.
        """
        own = np.arange(len(self.score))[chosen]
        own = own[self.determined[own]]
        scale = self.own_information[own] ** -0.5
        eigenvalues, vectors = np.linalg.eigh(self.information[np.ix_(own, own)] * np.outer(scale, scale))
        kept = eigenvalues > _DETERMINED
        along = (vectors.T @ (scale * self.score[own]))[kept] / eigenvalues[kept]
        values = np.zeros(len(self.score))
        values[own] = scale * (vectors[:, kept] @ along)
        return values


def score_test(information: Real, gradient: Real, nuisance: int) -> ScoreTest:
    """Test unknowns beside nuisance parameters.

    Parameters
    ----------
    information, gradient
        Of the nuisance parameters in their coordinates and then of the unknowns, priors included; shapes (all, all) and (all,).
    nuisance
        How many of them are nuisance parameters.

    Returns
    -------
    ScoreTest
    """
    # The unknowns first, and of the nuisance parameters only the directions that are identifiable.
    subspace = identifiable_subspace(information[:nuisance, :nuisance])
    tested = len(gradient) - nuisance
    basis = np.zeros((len(gradient), tested + subspace.shape[1]))
    basis[nuisance:, :tested], basis[:nuisance, tested:] = np.eye(tested), subspace
    system = basis.T @ information @ basis
    reduced, score, response = eliminate(system, basis.T @ gradient, tested)
    covariance = subspace @ np.linalg.solve(system[tested:, tested:], subspace.T)
    stds = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
    return ScoreTest(score, reduced, np.diag(system)[:tested].copy(), subspace @ response / stds[:, None])


def score_added(fit: FitResult, gradient: Real, information: Real) -> ScoreTest:
    """Test unknowns beside the parameters of a fit.

    Parameters
    ----------
    fit
        The fitted model.
    gradient, information
        Of the records, by the parameters of the fit in SI and then by the unknowns; shapes (all,) and (all, all).

    Returns
    -------
    ScoreTest
        What is known of the parameters beforehand is taken into account.
    """
    system, slope, null_space = fit.problem.joint_system(fit.iterate, information, gradient)
    return score_test(system, slope, null_space.shape[1])


def lift_priors(fit: FitResult, names: Sequence[str]) -> dict[str, tuple[float, float, float]]:
    """Return what each of some parameters would be if nothing were known of it beforehand, all others as they are known.

    Parameters
    ----------
    fit
        The fitted model.
    names
        Parameters that are stated with an uncertainty, and fitted by their values.

    Returns
    -------
    dict
        By name: how far the estimate without the statement is from what is stated, SI; the standard uncertainty of that
        distance; and by how many of its standard errors a parameter of the vehicle moves, the most of all, with one of the
        estimate. Without parameters of which the recordings say nothing.

    Notes
    -----
    With the variance v of the fit and the stated one s², the variance without the statement is v s² / (s² - v).
    """
    information, gradient, null_space = fit.problem.system(fit.iterate, fit.overdispersion)
    equations = identifiable_equations(information, gradient, null_space)
    covariance = equations.directions @ np.linalg.solve(equations.information, equations.directions.T)
    estimate = fit.iterate.u + equations.directions @ np.linalg.solve(equations.information, equations.gradient)
    own = [i for i, name in enumerate(fit.names) if not is_of_sensor(name)]
    lifted = {}
    for i, name in ((i, name) for i, name in enumerate(fit.names) if name in names):
        stated, variance = fit.problem.priors.statements[name], float(covariance[i, i])
        # Where a motion runs away no direction is determined, and none varies.
        if not 0 < variance < (1 - _DETERMINED) * stated.std**2:
            continue
        free = variance * stated.std**2 / (stated.std**2 - variance)
        distance = (float(estimate[i]) - stated.value) * free / variance
        others = np.diag(covariance)[own] - covariance[own, i] ** 2 / variance
        moves = np.abs(covariance[own, i]) / variance * free**0.5
        shift = float((moves / np.sqrt(np.maximum(others, np.finfo(float).tiny))).max(initial=0.0))
        lifted[name] = (distance, (free + stated.std**2) ** 0.5, shift)
    return lifted


def wald_test(fit: FitResult, constraints: Sequence[tuple[str, str | float]]) -> float:
    """:term:`Wald test`: what twice the log-likelihood would lose, to second order, if parameters had certain values.

    Parameters
    ----------
    fit
        The fitted model.
    constraints
        Parameters, and what each would be: a value, SI, or another parameter.

    Returns
    -------
    float

    Notes
    -----
    That a force vanishes, a spring in series is rigid or two parameters are equal holds at any scale of the vehicle: what is
    tested there is the ratio to the total mass. Where the scale is hardly known, a friction of which all records speak would
    otherwise be as uncertain as the scale, and seem to be nothing.
    """
    coordinates, u, names = fit.problem.priors.coordinates, fit.iterate.u, fit.names
    rows, away = np.zeros((len(constraints), len(names))), np.zeros(len(constraints))
    for row, (i, (name, value)) in zip(rows, enumerate(constraints), strict=True):
        own = names.index(name)
        row[own] = 1.0
        if isinstance(value, str):
            row[names.index(value)] = -1.0
            away[i] = row @ u
        else:
            away[i] = coordinates.distance(u, name, value)
    at_any_scale = np.array([isinstance(value, str) or value == 0 or np.isinf(value) for _, value in constraints])
    rows = np.where(at_any_scale[:, None], per_total_mass(fit, rows), rows)
    information, _, null_space = fit.problem.system(fit.iterate)
    eigenvalues, vectors = np.linalg.eigh(information)
    along = rows @ null_space @ vectors
    # What records and priors do not determine may have any value without a loss.
    covariance = along / np.maximum(eigenvalues, RANK * float(eigenvalues.max(initial=0.0))) @ along.T
    return float(away @ np.linalg.pinv(covariance) @ away)


def per_total_mass(fit: FitResult, gradients: Real) -> Real:
    """Return gradients of quantities over the total mass, as a part of what is tested, from those of the quantities.

    No acceleration shows the scale of a vehicle, which multiplies every mass and rate alike; statements and usual values may
    know it badly. Ratios do not depend on it.

    Parameters
    ----------
    fit
        The fitted model.
    gradients
        By the coordinates, dimensionless, shape (quantity, coordinate).

    Returns
    -------
    ndarray
        Dimensionless, shape (quantity, coordinate); as given for quantities that do not change with the scale.
    """
    slopes = fit.problem.priors.coordinates.derivatives(fit.iterate.u)
    total, of_mass = evaluate_quantity("total_mass", fit.names, fit.values)
    growth = gradients @ scaling_direction(fit.names, fit.values, slopes)
    return gradients - np.outer(growth, of_mass * slopes / total)
