"""From a fit to estimates: parameters, ratios where the absolute scale is unknown, and unidentifiable combinations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation.statistics import FitStatistics
from sprung.estimation.subspace import canonical_basis
from sprung.uncertainty import NORMAL_95, Estimate, KnownValue, Ratio
from sprung.vehicle import DERIVED, LOAD_MASS, UNITS_PER_MASS, evaluate_quantity, is_nuisance, parameter_of
from sprung.vibration import largest_entry

Real = NDArray[np.float64]

_SCALE = (
    "multiplying every mass, inertia and rate by one number changes no acceleration: only their ratios are determined; add "
    "drops with a known load, weigh the vehicle (total_mass, front_axle_mass, rear_axle_mass), or give one mass or rate that "
    "is known"
)

_HARDLY = (
    "hardly changes these recordings; drops that excite other motions, more channels, or knowing one of them beforehand "
    "would determine it"
)


@shown
@dataclass(frozen=True)
class Unidentifiable:
    """A combination of parameters that the data do not determine.

    Attributes
    ----------
    parameters
        Which parameters move together.
    text
        Which combination it is, and what would determine it.
    """

    parameters: tuple[str, ...]
    text: str


@shown
@dataclass(frozen=True)
class Correlation:
    """Correlation of the estimated parameters.

    Attributes
    ----------
    names
        The parameters.
    matrix
        Correlation coefficients, one row for each name.
    """

    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]


@shown
@dataclass(frozen=True)
class Scale:
    """The absolute scale, and ratios that do not need it.

    Attributes
    ----------
    known
        Whether load, weighing or another known quantity fixes masses and rates absolutely.
    per_total_mass
        Masses, inertias and rates divided by the empty vehicle's total mass, as far as they are determined.
    correlation
        Of these ratios and the other estimated parameters, where the scale is unknown; empty where it is known.
    """

    known: bool
    per_total_mass: dict[str, Ratio]
    correlation: Correlation = field(default_factory=lambda: Correlation((), ()))


def to_estimates(fit: FitStatistics, known: Mapping[str, KnownValue]) -> dict[str, Estimate]:
    """Return the estimates of all parameters of the vehicle.

    Parameters
    ----------
    fit
        The fit.
    known
        What was known beforehand.

    Returns
    -------
    dict
        By name.
    """
    return {name: estimate_of(fit, known, name) for name in fit.names if not is_nuisance(name)}


def estimate_of(fit: FitStatistics, known: Mapping[str, KnownValue], name: str) -> Estimate:
    """Return the estimate of one quantity.

    Parameters
    ----------
    fit, known
        As for `to_estimates`.
    name
        A parameter, or a derived quantity of `sprung.vehicle.DERIVED`.

    Returns
    -------
    Estimate
    """
    value, gradient = evaluate_quantity(name, fit.names, fit.values)
    unit = DERIVED[name].unit if name in DERIVED else parameter_of(name).unit
    if name in known and known[name].is_exact:
        exact = known[name].value
        return Estimate(exact, 0.0, (exact, exact), unit, "known")
    std = fit.spread(gradient * fit.slopes, fit.size(name) if name in fit.names else value)
    if std is None:
        return Estimate(None, None, None, unit, "unidentifiable")
    if std <= 1e-12 * abs(value) and value:
        return Estimate(value, 0.0, (value, value), unit, "known")
    return Estimate(value, std, _interval(name, value, std), unit, "estimated", "curvature")


def _interval(name: str, value: float, std: float) -> tuple[float, float]:
    # Estimated by its logarithm, so that the interval is even there and never negative; what is unknown of a sensor is not.
    if name in DERIVED or parameter_of(name).positive:
        factor = float(np.exp(NORMAL_95 * std / value))
        return value / factor, value * factor
    return value - NORMAL_95 * std, value + NORMAL_95 * std


def scale_of(fit: FitStatistics) -> Scale:
    """Return whether the absolute scale is determined, and ratios that do not need it.

    Parameters
    ----------
    fit
        The fit.

    Returns
    -------
    Scale
    """
    total, gradient = evaluate_quantity("total_mass", fit.names, fit.values)
    mass_direction = gradient * fit.slopes / total
    per_total_mass, directions = {}, {}
    for i, name in enumerate(fit.names):
        own = fit.slopes[i] * np.eye(len(fit.names))[i]
        if parameter_of(name).scales and not name.startswith(LOAD_MASS):
            ratio = float(fit.values[i]) / total
            own = (own - fit.values[i] * mass_direction) / total
            std = fit.spread(own, fit.size(name) / total)
            if std is not None:
                per_total_mass[name] = Ratio(ratio, std, UNITS_PER_MASS[parameter_of(name).unit])
        elif not is_nuisance(name):
            std = fit.spread(own, fit.size(name))
        else:
            continue
        if std:
            directions[name] = own / std
    known = fit.spread(mass_direction, 1.0) is not None
    return Scale(known, per_total_mass, Correlation((), ()) if known else _correlation(fit, directions))


def _correlation(fit: FitStatistics, directions: Mapping[str, Real]) -> Correlation:
    """Return the correlation of quantities, from their gradients by the coordinates over their standard uncertainties."""
    gradients = np.array(list(directions.values())).reshape(len(directions), len(fit.names))
    matrix = gradients @ fit.relative_covariance @ gradients.T
    return Correlation(tuple(directions), tuple(tuple(float(entry) for entry in row) for row in matrix))


def unidentifiable_combinations(fit: FitStatistics, parameters: Mapping[str, Estimate]) -> tuple[Unidentifiable, ...]:
    """Return the combinations of parameters that the data do not determine.

    Parameters
    ----------
    fit
        The fit.
    parameters
        Its estimates.

    Returns
    -------
    tuple of Unidentifiable
    """
    scaling = fit.scaling
    found = []
    directions = fit.undetermined
    if directions.shape[1] and np.linalg.norm(directions.T @ scaling) > 0.999 * np.linalg.norm(scaling):
        found.append(Unidentifiable(tuple(name for name in fit.names if parameter_of(name).scales), _SCALE))
        unit = scaling / np.linalg.norm(scaling)
        left, size, _ = np.linalg.svd(directions - np.outer(unit, unit @ directions), full_matrices=False)
        directions = canonical_basis(left[:, size > 0.5])
    shares = np.abs(directions)
    together = shares > 0.1 * shares.max(axis=0, initial=1e-300)
    # Whatever is undetermined belongs to the direction that moves it most, if to no other.
    named = {name for one in found for name in one.parameters}
    for i, name in enumerate(fit.names):
        if (
            name in parameters
            and parameters[name].status == "unidentifiable"
            and not together[i].any()
            and name not in named
            and shares.size
        ):
            together[i, np.argmax(shares[i])] = True
    for direction, moved in zip(directions.T, together.T, strict=True):
        names = tuple(name for name, moves in zip(fit.names, moved, strict=True) if moves)
        leading = direction[largest_entry(direction)]
        ways = [
            f"{name} {'up' if part * leading > 0 else 'down'}"
            for name, part, moves in zip(fit.names, direction, moved, strict=True)
            if moves
        ]
        what = f"{names[0]} alone" if len(names) == 1 else f"moving {', '.join(ways)} together"
        found.append(Unidentifiable(names, f"{what} {_HARDLY}"))
    return tuple(found)


def correlation_of(fit: FitStatistics, parameters: Mapping[str, Estimate]) -> Correlation:
    """Return the correlation of the estimated parameters.

    Parameters
    ----------
    fit
        The fit.
    parameters
        Its estimates.

    Returns
    -------
    Correlation
    """
    chosen = [i for i, name in enumerate(fit.names) if name in parameters and parameters[name].status == "estimated"]
    covariance = fit.covariance[np.ix_(chosen, chosen)]
    spread = np.sqrt(np.diag(covariance))
    matrix = covariance / np.outer(spread, spread) if chosen else covariance
    return Correlation(
        tuple(fit.names[i] for i in chosen), tuple(tuple(float(entry) for entry in row) for row in matrix)
    )
