"""The joint fit: maximise the likelihood of all drops and loads at once, from starts of its own, and say how sure it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation.fit import STARTS, FitResult, escape_local_optimum, fit_linear
from sprung.estimation.overdispersion import autocorrelation_inflation
from sprung.estimation.problem import NO_INFORMATION, RANK
from sprung.estimation.subspace import canonical_basis
from sprung.preprocess import FreeDecay
from sprung.uncertainty import KnownValue
from sprung.vehicle import PARAMETERS, LinearModel, Sensor

Real = NDArray[np.float64]

Inflater = Literal["nothing", "coloured residuals", "drops that disagree"]
"""What shows that the records tell less than white residuals would."""

_BEYOND_DOUBT = 1e4
"""Information that noise never feigns: one percent of uncertainty."""

_FEIGNED = 4.0
"""How many times what noise feigns on average is taken off: more than that it feigns hardly ever."""

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
    fitted
        Modelled records, their means subtracted, m/s²; one array of shape (channel, time) per drop.
    residuals
        Measured minus modelled, centred, m/s²; the same, NaN for channels that are left out.
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
    fitted: tuple[Real, ...]
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
        """Give parameter values, SI, a step of the coordinates away, shape (parameter,)."""
        logarithmic, scales = np.array([(PARAMETERS[name].positive, PARAMETERS[name].scales) for name in self.names]).T
        # What scales everything is taken apart: it multiplies those that are not fitted by their logarithms as well.
        alike = float(step @ self.scaling) / max(float(self.scaling @ self.scaling), np.finfo(float).tiny)
        rest = step - alike * self.scaling
        moved = np.where(
            logarithmic, self.values * np.exp(np.where(logarithmic, rest, 0.0)), self.values + self.slopes * rest
        )
        return np.where(scales, moved * np.exp(alike), moved)

    def only(self, names: Sequence[str]) -> FitStatistics:
        """Give what the fit says of some of its parameters, whatever the others are."""
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
    def scaling(self) -> Real:
        """The direction of the coordinates in which every mass and rate grows alike, which no acceleration shows."""
        scales = np.array([PARAMETERS[name].scales for name in self.names])
        return np.where(scales, self.values / self.slopes, 0.0)

    def size(self, name: str) -> float:
        """Give what counts as much of a parameter: its value, or, where that may be zero, what would matter beside others."""
        at = self.names.index(name)
        value = abs(float(self.values[at]))
        return value if PARAMETERS[name].positive else max(value, abs(float(self.slopes[at])))

    def spread(self, direction: Real, value: float) -> float | None:
        """Give the standard uncertainty of a function of the coordinates.

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
    """Fit one vehicle to all decays: `fit_linear`, and `uncertainty_of` where that ends.

    Parameters
    ----------
    decays, models, sensors, known, start, starts
        As for `fit_linear`.

    Returns
    -------
    Fit
    """
    return uncertainty_of(escape_local_optimum(fit_linear(decays, models, sensors, known, start=start, starts=starts)))


def uncertainty_of(optimum: FitResult) -> FitStatistics:
    """Return the covariance of the estimates, and what it rests on.

    Parameters
    ----------
    optimum
        Where the fit ended.

    Returns
    -------
    Fit
    """
    problem, best, priors = optimum.problem, optimum.point, optimum.problem.priors
    colours = _colours(optimum)
    colour = float(colours.max())
    inflated = max(colour, optimum.disagreement)
    coloured = 1 < colour == inflated

    eigenvalues, directions = _directions(optimum, inflated)
    relative = directions @ (directions / np.maximum(eigenvalues, _LEAST)).T
    slopes = priors.coordinates.slopes(best.u)
    return FitStatistics(
        names=optimum.names,
        values=optimum.values,
        slopes=slopes,
        relative_covariance=relative,
        covariance=relative * np.outer(slopes, slopes),
        undetermined=canonical_basis(directions[:, eigenvalues < NO_INFORMATION]),
        noise=optimum.noise,
        residual=best.evaluation.residual,
        inflation=inflated,
        fitted=optimum.fitted,
        residuals=optimum.residuals,
        contradictions=problem.contradictions(best, inflated),
        loglikelihood=optimum.loglikelihood,
        iterations=optimum.steps,
        converged=optimum.converged,
        starts_agreeing=optimum.starts_agreeing,
        starts=optimum.starts,
        inflated_by="nothing" if inflated == 1 else "coloured residuals" if coloured else "drops that disagree",
        most_coloured=int(colours.argmax()) if coloured else None,
    )


def overdispersion_of(optimum: FitResult) -> float:
    """Return the overdispersion of a fit: by how much less its records tell than white residuals of drops that agree would.

    Parameters
    ----------
    optimum
        Where the fit ended.

    Returns
    -------
    float
        Factor on every variance, dimensionless; 1 where neither is significant.
    """
    return max(float(_colours(optimum).max()), optimum.disagreement)


def _colours(optimum: FitResult) -> Real:
    """Return by how much the autocorrelation of the residuals inflates variances, shape (channel,)."""
    decays = optimum.decays
    # Samples that were interpolated are coloured, but counted for no more than those that were taken.
    there = np.sum([decay.usable * decay.samples for decay in decays], axis=0)
    counted = optimum.problem.likelihood.observations.sum(axis=0) / np.maximum(there, 1)
    rates = [decay.rate for decay in decays]
    return autocorrelation_inflation(optimum.residuals, rates, counted=counted, least=optimum.problem.least_variance)


def _directions(optimum: FitResult, inflated: float) -> tuple[Real, Real]:
    """Give the information that is there, and its directions in the coordinates; shapes (direction,), (parameter, direction).

    What noise feigns is taken off, and what is only rounding beside the largest information counts as none.
    """
    problem, point = optimum.problem, optimum.point
    information, _, free = problem.system(point, inflated)
    eigenvalues, vectors = np.linalg.eigh(information)
    rounding = RANK * eigenvalues.max(initial=0.0)
    if eigenvalues.size and eigenvalues[0] < _BEYOND_DOUBT:
        seen = problem.priors.coordinates.slopes(point.u)[:, None] * free
        noise_bias_of_information = seen.T @ point.place.noise_bias_of_information(point.weights) @ seen
        eigenvalues, vectors = np.linalg.eigh(information - _FEIGNED * noise_bias_of_information)
    return np.where(eigenvalues < rounding, 0.0, eigenvalues), free @ vectors
