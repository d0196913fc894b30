"""The covariance of a joint fit: information, what noise adds to it, and overdispersion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation.fit_result import FitResult, Inflater
from sprung.estimation.identifiability import NO_INFORMATION, RANK
from sprung.estimation.linear_fit import STARTS, escape_local_optimum, fit_linear
from sprung.estimation.priors import scaling_direction
from sprung.estimation.score_test import per_total_mass
from sprung.estimation.subspace import canonical_basis
from sprung.preprocess import FreeDecay
from sprung.uncertainty import KnownValue
from sprung.vehicle import LinearModel, Sensor, is_of_sensor, mean_of_sides, parameter_of

Real = NDArray[np.float64]

_BEYOND_DOUBT = 1e4
"""Information that noise alone never adds: one percent of uncertainty."""

_BIAS_FACTOR = 4.0
"""How many times what noise adds on average is subtracted: more than that it adds hardly ever."""

_LEAST = 0.01
"""Information that a direction without any is given, so that it hides behind no other: ten powers of e of uncertainty."""


@shown
@dataclass(frozen=True, eq=False)
class FitStatistics:
    """The joint fit of all decays.

    Attributes
    ----------
    names
        The parameters.
    values
        SI, shape (parameter,).
    slopes
        Derivative of each value by the coordinate it is fitted in: the value itself for those that must be positive,
        which are fitted by their logarithms; shape (parameter,).
    relative_covariance
        Covariance of the fit's coordinates, dimensionless, shape (parameter, parameter); directions without information have a
        very large variance in it.
    covariance
        Of the values, SI, shape (parameter, parameter).
    undetermined
        Directions of the coordinates that neither data nor knowledge determine, dimensionless, shape (parameter, direction):
        the `canonical_basis` of all of them.
    noise
        Noise level of each channel, m/s², shape (channel,).
    residual
        Residual sums of squares, (m/s²)², shape (drop, channel).
    inflation
        By how much coloured residuals, or drops that contradict each other, have enlarged the variances: a factor, 1
        where neither is significant.
    residuals
        Measured minus modelled, centred, m/s²; one array of shape (channel, time) per drop, NaN for channels that are left out.
    contradictions
        For each known quantity by how many standard uncertainties the recordings and everything else that is known would
        rather have another value; not for quantities of which they say nothing.
    loglikelihood
        Dimensionless, up to a constant.
    iterations
        Steps taken from the winning start.
    converged
        Whether the last step promised no further gain.
    starts_agreeing, starts
        How many of the refined starts ended in the same place, and how many there were.
    inflated_by
        Which of the two, the larger, has enlarged the variances.
    most_coloured
        For coloured residuals the position of the channel in which they are worst; None otherwise.
    """

    names: tuple[str, ...]
    values: Real
    slopes: Real
    relative_covariance: Real
    covariance: Real
    undetermined: Real
    noise: Real
    residual: Real
    inflation: float
    residuals: tuple[Real, ...]
    contradictions: Mapping[str, float]
    loglikelihood: float
    iterations: int
    converged: bool
    starts_agreeing: int
    starts: int
    inflated_by: Inflater = "nothing"
    most_coloured: int | None = None

    def moved(self, step: Real) -> Real:
        """Return parameter values, SI, a step of the coordinates away, shape (parameter,)."""
        logarithmic, scales = np.array(
            [(parameter_of(name).positive, parameter_of(name).scales) for name in self.names]
        ).T
        # What scales everything is taken apart: it multiplies those that are not fitted by their logarithms as well.
        alike = float(step @ self.scaling) / max(float(self.scaling @ self.scaling), np.finfo(float).tiny)
        rest = step - alike * self.scaling
        moved = np.where(
            logarithmic, self.values * np.exp(np.where(logarithmic, rest, 0.0)), self.values + self.slopes * rest
        )
        return np.where(scales, moved * np.exp(alike), moved)

    def only(self, names: Sequence[str]) -> FitStatistics:
        """Return the marginal statistics of some of the parameters."""
        chosen = [self.names.index(name) for name in names]
        square = np.ix_(chosen, chosen)
        return replace(
            self,
            names=tuple(names),
            values=self.values[chosen],
            slopes=self.slopes[chosen],
            relative_covariance=self.relative_covariance[square],
            covariance=self.covariance[square],
            undetermined=self.undetermined[chosen],
        )

    @property
    def of_vehicle(self) -> FitStatistics:
        """Marginal statistics of vehicle and loads, without the unknowns of the sensors."""
        own = [name for name in self.names if not is_of_sensor(name)]
        return self if len(own) == len(self.names) else self.only(own)

    @property
    def scaling(self) -> Real:
        """The direction of the coordinates in which every mass and rate grows alike, which no acceleration shows."""
        return scaling_direction(self.names, self.values, self.slopes)

    def size(self, name: str) -> float:
        """Size of a parameter: its value, or, where that may be zero, what would matter beside others.

        What differs between left and right matters beside the mean of both.
        """
        at, mean = self.names.index(name), mean_of_sides(name)
        value = abs(float(self.values[at]))
        if mean in self.names:
            return max(value, abs(float(self.values[self.names.index(mean)])))
        return value if parameter_of(name).positive else max(value, abs(float(self.slopes[at])))

    def spread(self, direction: Real, value: float) -> float | None:
        """Return the standard uncertainty of a function of the coordinates.

        Parameters
        ----------
        direction
            Its gradient by the coordinates, in its own unit, shape (parameter,).
        value
            Its value, in its own unit.

        Returns
        -------
        float or None
            None where it is undetermined: where its uncertainty is as large as itself.
        """
        std = float(np.sqrt(max(float(direction @ self.relative_covariance @ direction), 0.0)))
        return None if std > abs(value) else std


def fit_jointly(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, KnownValue],
    *,
    start: Mapping[str, float] | None = None,
    starts: int = STARTS,
) -> FitStatistics:
    """Fit one vehicle to all decays and return its uncertainty: `fit_linear`, then `uncertainty_of`.

    Parameters
    ----------
    decays, models, sensors, known, start, starts
        As for `fit_linear`.

    Returns
    -------
    FitStatistics
    """
    return uncertainty_of(escape_local_optimum(fit_linear(decays, models, sensors, known, start=start, starts=starts)))


def uncertainty_of(fit: FitResult) -> FitStatistics:
    """Return the covariance of the estimates, and what it rests on.

    Parameters
    ----------
    fit
        Where the fit ended.

    Returns
    -------
    FitStatistics
    """
    problem, optimum = fit.problem, fit.iterate
    by_channel = fit.autocorrelation_inflation
    inflation, inflated_by = fit.inflation
    eigenvalues, directions = _directions(fit, inflation)
    relative = directions @ (directions / np.maximum(eigenvalues, _LEAST)).T
    derivatives = problem.priors.coordinates.derivatives(optimum.u)
    return FitStatistics(
        names=fit.names,
        values=fit.values,
        slopes=derivatives,
        relative_covariance=relative,
        covariance=relative * np.outer(derivatives, derivatives),
        undetermined=canonical_basis(directions[:, eigenvalues < NO_INFORMATION]),
        noise=fit.noise,
        residual=fit.residual_sums,
        inflation=inflation,
        residuals=fit.residuals,
        contradictions=problem.conflicts(optimum, inflation),
        loglikelihood=fit.loglikelihood,
        iterations=fit.steps,
        converged=fit.converged,
        starts_agreeing=fit.starts_agreeing,
        starts=fit.starts,
        inflated_by=inflated_by,
        most_coloured=int(by_channel.argmax()) if inflated_by == "coloured residuals" else None,
    )


def consider_held(statistics: FitStatistics, larger: FitStatistics, spreads: Mapping[str, float]) -> FitStatistics:
    """Return the statistics of a fit in which some parameters were held that are uncertain.

    What they may be widens the covariance of the others, by as much as the records do not tell them themselves (consider
    covariance; Schmidt, Adv. Control Syst. 3 (1966) 293).

    Parameters
    ----------
    statistics
        Of the fit.
    larger
        Where the fit ended, of the model in which the held parameters are free.
    spreads
        Standard uncertainty of each of them, by its name, SI.

    Returns
    -------
    FitStatistics
    """
    held = [larger.names.index(name) for name in spreads]
    prior = np.array([*spreads.values()]) / np.abs(larger.slopes[held])
    free = larger.relative_covariance
    gained = free[:, held] @ np.linalg.solve(free[np.ix_(held, held)] + np.diag(prior**2), free[held])
    own = [larger.names.index(name) for name in statistics.names]
    relative = (free - gained)[np.ix_(own, own)]
    return replace(
        statistics,
        relative_covariance=relative,
        covariance=relative * np.outer(statistics.slopes, statistics.slopes),
    )


def _directions(fit: FitResult, inflation: float) -> tuple[Real, Real]:
    """Return the information that is there, and its directions in the coordinates; (direction,), (parameter, direction).

    What noise alone adds is subtracted, and what is only rounding beside the largest information counts as none. Usual values
    of some parameters are none of the scale: those of a friction, say, would be a weighing that nobody did. What only held a
    parameter is none at all.
    """
    problem, optimum = fit.problem, fit.iterate
    information, _, null_space = problem.system(optimum, inflation)
    usual = problem.priors.usual_rows
    known = problem.priors.is_knowledge
    usual, beside = usual @ null_space, per_total_mass(fit, usual[known]) @ null_space
    information = information + beside.T @ beside - usual.T @ usual
    eigenvalues, vectors = np.linalg.eigh(information)
    rounding = RANK * eigenvalues.max(initial=0.0)
    # A stepped motion follows its initial states: nothing is known of a bias.
    modal = optimum.at.modal
    if modal is not None and eigenvalues.size and eigenvalues[0] < _BEYOND_DOUBT:
        basis = problem.priors.coordinates.derivatives(optimum.u)[:, None] * null_space
        bias = basis.T @ modal.noise_bias_of_information() @ basis
        eigenvalues, vectors = np.linalg.eigh(information - _BIAS_FACTOR * bias)
    return np.where(eigenvalues < rounding, 0.0, eigenvalues), null_space @ vectors
