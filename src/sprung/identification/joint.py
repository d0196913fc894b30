"""The joint fit: maximise the likelihood of all drops and loads at once, from starts of its own, and say how sure it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimate import Known
from sprung.identification.climb import RANK, Climb, Point
from sprung.identification.inflation import of_colour, of_disagreement
from sprung.identification.knowledge import Coordinates, Knowledge
from sprung.identification.likelihood import Likelihood
from sprung.identification.start import catalogue
from sprung.prepare import Decay
from sprung.vehicle import PARAMETERS, LinearModel, Rows, Sensor

Real = NDArray[np.float64]

_STARTS = 3
"""How many of the catalogue's vehicles are refined: those that explain the records best as they are."""

_NO_INFORMATION = 1.0
"""Fisher information below which a direction is not determined: its value cannot be told from e times it."""


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
    states
        {X, Ẋ} of each drop at the start of its decay, SI, shape (drop, 14).
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
    states: Real
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
    progress: Callable[[str], None] = lambda _: None,
) -> Fit:
    """Fit one vehicle to all decays.

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
        Parameter values, SI, to start from; the catalogue of usual vehicles is tried where it is left out.
    progress
        Told what is being done.

    Returns
    -------
    Fit
    """
    names = next(iter(models.values())).names
    likelihood = Likelihood.of(decays, models, Rows.of([sensor.row for sensor in sensors], names))
    candidates = list(catalogue(known, sensors)) if start is None else [dict(start)]
    references = np.array([_reference(name, candidates[0]) for name in names])
    coordinates = Coordinates(names, references)
    knowledge = Knowledge(coordinates, known)
    climb = Climb(likelihood, knowledge)

    tried = [knowledge.bind(coordinates.of(np.array([values[name] for name in names]))) for values in candidates]
    if start is None:
        progress(f"trying {len(tried)} usual vehicles")
        tried = sorted(tried, key=climb.first_cost)[:_STARTS]
    ends: list[Point] = []
    for number, u in enumerate(tried, start=1):
        progress(f"fitting from start {number} of {len(tried)}")
        ends.append(climb.to_the_top(u, min(ends, key=climb.cost, default=None)))
    best = min(ends, key=climb.cost)
    agreeing = sum(climb.cost(end) - climb.cost(best) < 1e-3 for end in ends)
    return _conclude(climb, best, decays, agreeing, len(ends))


def _reference(name: str, typical: Mapping[str, float]) -> float:
    if PARAMETERS[name].positive:
        return 1.0
    return typical["c_sf"] if name.startswith("c") else typical["k_sf"]


def _conclude(climb: Climb, best: Point, decays: Sequence[Decay], agreeing: int, starts: int) -> Fit:
    knowledge, values = climb.knowledge, climb.knowledge.coordinates.values(best.u)
    fitted = climb.likelihood.fitted(values, best.weights)
    residuals = [d.values - d.values.mean(axis=1, keepdims=True) - f for d, f in zip(decays, fitted, strict=True)]
    colour = float(of_colour(residuals, [decay.rate for decay in decays]).max())
    inflated = max(colour, of_disagreement(*climb.by_drop(best)))

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
        names=knowledge.coordinates.names,
        values=values,
        slopes=slopes,
        relative_covariance=relative,
        covariance=relative * np.outer(slopes, slopes),
        undetermined=directions[:, eigenvalues < max(rounding, _NO_INFORMATION)],
        noise=np.sqrt(climb.variance(best.evaluation.residual, best.evaluation.leverage)),
        residual=best.evaluation.residual,
        inflation=inflated,
        states=climb.likelihood.states(values, best.weights),
        fitted=tuple(fitted),
        prior_residual=dict(zip(uncertain, knowledge.prior(best.u).residual.tolist(), strict=True)),
        loglikelihood=-0.5 * climb.cost(best),
        iterations=best.steps,
        converged=best.converged,
        starts_agreeing=agreeing,
        starts=starts,
    )
