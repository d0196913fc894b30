"""Mean and spread of a population of vehicles whose estimates have errors of their own: multivariate random effects.

Vehicle i of a type has parameters θ_i ~ N(μ, T), and its test yields x_i ~ N(θ_i, V_i) with a known covariance V_i. Mean μ and
between-vehicle covariance T are estimated by restricted maximum likelihood (REML; D. Harville, J. Am. Stat. Assoc.
72 (1977) 320)
with the EM algorithm (N. Laird, J. Ware, Biometrics 38 (1982) 963). Given them, the best estimate of each vehicle is its
conditional mean, the empirical Bayes estimate (C. Morris, J. Am. Stat. Assoc. 78 (1983) 47). Of few vehicles the likelihood may
be largest without any spread, which would make all estimates equal and too certain: the prior |T|^(1/2) avoids that boundary
(Y. Chung et al., Psychometrika 78 (2013) 685) and has no effect on many.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown

Real = NDArray[np.float64]

_STEPS, _TOLERANCE = 2000, 1e-4
"""Most iterations, and gain of log-likelihood per iteration at which they end."""

FEWEST = 3
"""Smallest number of vehicles of which a spread is estimated."""


@shown
@dataclass(frozen=True, eq=False)
class Population:
    """A population of vehicles.

    Attributes
    ----------
    mean
        Dimensionless, as the coordinates, shape (parameter,).
    mean_covariance
        Of the mean, shape (parameter, parameter), dimensionless.
    spread
        Covariance between vehicles T, shape (parameter, parameter), dimensionless.
    correlated
        Whether correlations between parameters are part of the model.
    loglikelihood
        Restricted, up to a constant.
    std_error
        Relative standard error of the standard deviation between vehicles, shape (parameter,); dimensionless.
    iterations
        Of the EM algorithm.
    """

    mean: Real
    mean_covariance: Real
    spread: Real
    correlated: bool
    loglikelihood: float
    std_error: Real
    iterations: int

    @property
    def std(self) -> Real:
        """Standard deviation between vehicles, dimensionless, shape (parameter,)."""
        return np.sqrt(np.diag(self.spread))


@shown
@dataclass(frozen=True, eq=False)
class VehicleEstimates:
    """Estimates of the vehicles of a population.

    Attributes
    ----------
    positions
        Coordinates, dimensionless, shape (vehicle, parameter).
    covariances
        Their covariance matrices, dimensionless, shape (vehicle, parameter, parameter).
    """

    positions: Real
    covariances: Real

    @property
    def stds(self) -> Real:
        """Standard uncertainties, dimensionless, shape (vehicle, parameter)."""
        return np.sqrt(np.maximum(np.diagonal(self.covariances, axis1=1, axis2=2), 0.0))


def fit_population(positions: Real, covariances: Real, start: Population | None = None) -> Population:
    """Fit mean and covariance of a population; correlations between parameters only if the data support them (BIC).

    Parameters
    ----------
    positions
        Estimates, dimensionless, shape (vehicle, parameter).
    covariances
        Their covariance matrices, positive definite, dimensionless, shape (vehicle, parameter, parameter).
    start
        Population of nearly the same vehicles, with which the iteration begins.

    Returns
    -------
    Population
    """
    width = positions.shape[1]
    begin = None if start is None else start.spread
    separate = _fit(positions, covariances, False, begin)
    if len(positions) <= width:
        return separate
    joint = _fit(positions, covariances, True, begin)
    gain = 2 * (joint.loglikelihood - separate.loglikelihood)
    return joint if gain > width * (width - 1) / 2 * np.log(len(positions)) else separate


def estimate_vehicles(positions: Real, covariances: Real, population: Population) -> VehicleEstimates:
    """Return the empirical Bayes estimate of each vehicle: its own estimate, weighted with the population's mean.

    Parameters
    ----------
    positions, covariances
        As for `fit_population`; also of vehicles that were not among those.
    population
        Of the same type.

    Returns
    -------
    VehicleEstimates
        The uncertainties include those of the mean and, to first order, of the standard deviations between vehicles.
    """
    spread = population.spread
    weights = np.linalg.inv(covariances + spread)
    residuals = np.einsum("nij,nj->ni", weights, positions - population.mean)
    deviations = residuals @ spread
    rest = np.eye(len(spread)) - spread @ weights
    covariance = rest @ (spread + population.mean_covariance @ rest.transpose(0, 2, 1))
    # Derivative of the estimate by the logarithm of the standard deviation of parameter j, column j.
    by_scale = np.einsum("ni,ij->nij", deviations, np.eye(len(spread))) + spread * residuals[:, None, :]
    moved = rest @ by_scale * population.std_error
    covariance = covariance + moved @ moved.transpose(0, 2, 1)
    return VehicleEstimates(population.mean + deviations, (covariance + covariance.transpose(0, 2, 1)) / 2)


def _fit(positions: Real, covariances: Real, correlated: bool, begin: Real | None = None) -> Population:
    """Maximise the restricted likelihood by the EM algorithm."""
    count = len(positions)
    spread = _start(positions, covariances) if begin is None else begin
    spread = spread if correlated else np.diag(np.diag(spread))
    last, iteration = -np.inf, 0
    while True:
        weights = np.asarray(np.linalg.inv(covariances + spread), dtype=float)
        mean_covariance: Real = np.linalg.inv(weights.sum(axis=0))
        mean = np.asarray(mean_covariance @ np.einsum("nij,nj->i", weights, positions), dtype=float)
        residuals = np.asarray(np.einsum("nij,nj->ni", weights, positions - mean), dtype=float)
        value = _loglikelihood(weights, mean_covariance, residuals, positions - mean)
        penalised = value + 0.5 * np.linalg.slogdet(spread)[1]
        iteration += 1
        if penalised - last < _TOLERANCE or iteration >= _STEPS:
            break
        last = penalised
        # Expected outer product of a vehicle's deviation, given its estimate: conditional mean and covariance, and that of μ.
        deviations = residuals @ spread
        uncertain = (weights @ mean_covariance @ weights).sum(axis=0) - weights.sum(axis=0)
        expected = count * spread + deviations.T @ deviations + spread @ uncertain @ spread
        updated = expected / (count - 1)  # one vehicle less: the prior
        spread = (updated + updated.T) / 2 if correlated else np.diag(np.diag(updated))
    # Fisher information of each variance, the others given: ½ Σ (w_i)²; the standard deviation has half its relative error.
    variances = np.diag(spread)
    information = 0.5 * np.einsum("ni->i", np.diagonal(weights, axis1=1, axis2=2) ** 2)
    std_error = 0.5 / np.sqrt(information) / np.maximum(variances, np.finfo(float).tiny)
    return Population(mean, mean_covariance, spread, correlated, value, std_error, iteration)


def _start(positions: Real, covariances: Real) -> Real:
    own = np.median(np.diagonal(covariances, axis1=1, axis2=2), axis=0)
    total = np.var(positions, axis=0, ddof=1)
    # Where all vehicles are equal, the prior's maximum is at the own variance over their number.
    return np.diag(np.maximum(total - own, own / len(positions)))


def _loglikelihood(
    weights: Real, mean_covariance: Real, residuals: Real, differences: NDArray[np.floating[Any]]
) -> float:
    """Return the restricted log-likelihood, up to a constant."""
    determinants = np.linalg.slogdet(weights)[1].sum() + np.linalg.slogdet(mean_covariance)[1]
    return float(0.5 * (determinants - np.einsum("ni,ni->", residuals, differences)))
