"""The joint fit: maximise the likelihood of all drops and loads at once, from starts of its own, and say how sure it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimate import Known
from sprung.identification.climb import RANK, least_information
from sprung.identification.inflation import of_colour
from sprung.identification.summit import Summit, ascend
from sprung.prepare import Decay
from sprung.vehicle import LinearModel, Sensor

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
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
        Covariance of the fit's coordinates.
    covariance
        Of the values, SI, shape (parameter, parameter); directions without information are left out of it.
    undetermined
        Directions of the coordinates that neither data nor knowledge determine, shape (parameter, direction).
    noise
        Noise level of each channel, m/s², shape (channel,).
    residual
        Residual sums of squares, (m/s²)², shape (drop, channel).
    inflation
        By how much coloured residuals, or drops that contradict each other, have enlarged the variances; 1 where
        neither is significant.
    fitted
        What the model makes of every record, its mean taken off; each of shape (channel, time).
    prior_residual
        For each uncertain known quantity (known - estimated) / std.
    loglikelihood
        Up to a constant.
    iterations
        Steps taken from the winning start.
    converged
        Whether the last step promised no further gain.
    starts_agreeing, starts
        How many of the refined starts ended in the same place, and how many there were.
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
    prior_residual: Mapping[str, float]
    loglikelihood: float
    iterations: int
    converged: bool
    starts_agreeing: int
    starts: int


def fit_jointly(
    decays: Sequence[Decay],
    models: Mapping[str, LinearModel],
    sensors: Sequence[Sensor],
    known: Mapping[str, Known],
    *,
    start: Mapping[str, float] | None = None,
) -> Fit:
    """Fit one vehicle to all decays: `ascend`, and `describe` where that ends.

    Parameters
    ----------
    decays, models, sensors, known, start
        As for `ascend`.

    Returns
    -------
    Fit
    """
    return describe(ascend(decays, models, sensors, known, start=start), decays)


def describe(summit: Summit, decays: Sequence[Decay]) -> Fit:
    """Say how sure the fit is.

    Parameters
    ----------
    summit
        Where it ended.
    decays
        What was fitted.

    Returns
    -------
    Fit
    """
    climb, best, knowledge = summit.climb, summit.point, summit.climb.knowledge
    fitted = climb.likelihood.fitted(summit.values, best.weights)
    residuals = [d.values - d.values.mean(axis=1, keepdims=True) - f for d, f in zip(decays, fitted, strict=True)]
    colour = float(of_colour(residuals, [decay.rate for decay in decays]).max())
    inflated = max(colour, summit.disagreement)

    information, _, free = climb.system(best, inflated)
    eigenvalues, vectors = np.linalg.eigh(information)
    directions = free @ vectors
    rounding = RANK * eigenvalues.max(initial=0.0)
    resolved = eigenvalues > rounding
    variances = np.where(resolved, 1.0 / np.where(resolved, eigenvalues, 1.0), 0.0)
    relative = directions @ (variances[:, None] * directions.T)
    slopes = knowledge.coordinates.slopes(best.u)
    uncertain = [name for name, known in knowledge.statements.items() if not known.exact]
    return Fit(
        names=summit.names,
        values=summit.values,
        slopes=slopes,
        relative_covariance=relative,
        covariance=relative * np.outer(slopes, slopes),
        undetermined=directions[:, eigenvalues < least_information(eigenvalues)],
        noise=summit.noise,
        residual=best.evaluation.residual,
        inflation=inflated,
        fitted=tuple(fitted),
        prior_residual=dict(zip(uncertain, knowledge.prior(best.u).residual.tolist(), strict=True)),
        loglikelihood=summit.loglikelihood,
        iterations=summit.steps,
        converged=summit.converged,
        starts_agreeing=summit.starts_agreeing,
        starts=summit.starts,
    )
