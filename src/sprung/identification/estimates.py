"""From a fit to what may be said: parameters, what is left when the scale is unknown, and what cannot be told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimate import NORMAL_95, Estimate, Known, Ratio
from sprung.identification.joint import Fit
from sprung.vehicle import PARAMETERS, quantity

Real = NDArray[np.float64]

_TOUCHED = 1e-3
"""Share of a parameter in an undetermined direction, a unit vector of logarithms, above which it is undetermined too."""

_PER_MASS = {"kg": "1", "kg m^2": "m^2", "N/m": "1/s^2", "N s/m": "1/s"}


@dataclass(frozen=True)
class Unidentifiable:
    """A combination of parameters that the data do not determine.

    Attributes
    ----------
    parameters
        Which parameters move together.
    text
        What cannot be told, and what would.
    """

    parameters: tuple[str, ...]
    text: str


@dataclass(frozen=True)
class Scale:
    """The absolute scale, and what is left without it.

    Attributes
    ----------
    known
        Whether load, weighing or another known quantity fixes masses and rates absolutely.
    per_total_mass
        Masses, inertias and rates divided by the empty vehicle's total mass, as far as they are determined.
    """

    known: bool
    per_total_mass: dict[str, Ratio]


@dataclass(frozen=True)
class Correlation:
    """Correlation of the estimated parameters; `matrix` has one row for each of `names`."""

    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Estimates:
    """Everything that may be said about the parameters."""

    parameters: dict[str, Estimate]
    scale: Scale
    unidentifiable: tuple[Unidentifiable, ...]
    correlation: Correlation


def conclude(fit: Fit, known: Mapping[str, Known]) -> Estimates:
    """Say what the fit allows to be said.

    Parameters
    ----------
    fit
        The fit.
    known
        What was known beforehand.

    Returns
    -------
    Estimates
    """
    touched = np.abs(fit.undetermined).max(axis=1, initial=0.0) > _TOUCHED
    parameters = {}
    for i, name in enumerate(fit.names):
        value, std = float(fit.values[i]), float(np.sqrt(fit.covariance[i, i]))
        unit = PARAMETERS[name].unit
        if name in known and known[name].exact:
            exact = known[name].value
            parameters[name] = Estimate(exact, 0.0, (exact, exact), unit, "known")
        elif touched[i]:
            parameters[name] = Estimate(None, None, None, unit, "unidentifiable")
        elif std <= 1e-12 * abs(value):
            parameters[name] = Estimate(value, 0.0, (value, value), unit, "known")
        else:
            parameters[name] = Estimate(value, std, _interval(name, value, std), unit, "estimated")
    return Estimates(parameters, _scale(fit), _combinations(fit), _correlation(fit, parameters))


def _interval(name: str, value: float, std: float) -> tuple[float, float]:
    if PARAMETERS[name].positive:  # estimated by its logarithm, so the interval is even there and never negative
        factor = float(np.exp(NORMAL_95 * std / value))
        return value / factor, value * factor
    return value - NORMAL_95 * std, value + NORMAL_95 * std


def _scale(fit: Fit) -> Scale:
    slopes = fit.slopes
    total, gradient = quantity("total_mass", fit.names, fit.values)
    mass_direction = gradient * slopes / total
    known = not _touches(mass_direction, fit.undetermined)
    per_total_mass = {}
    for i, name in enumerate(fit.names):
        if not PARAMETERS[name].scales:
            continue
        ratio = float(fit.values[i]) / total
        direction = (slopes[i] * np.eye(len(fit.names))[i] - fit.values[i] * mass_direction) / total
        if not _touches(direction / max(abs(ratio), 1e-300), fit.undetermined):
            std = float(np.sqrt(max(direction @ fit.relative_covariance @ direction, 0.0)))
            per_total_mass[name] = Ratio(ratio, std, _PER_MASS[PARAMETERS[name].unit])
    return Scale(known, per_total_mass)


def _touches(direction: Real, undetermined: Real) -> bool:
    return bool(np.abs(direction @ undetermined).max(initial=0.0) > _TOUCHED)


def _combinations(fit: Fit) -> tuple[Unidentifiable, ...]:
    scales = np.array([PARAMETERS[name].scales for name in fit.names])
    scaling = np.where(scales, fit.values / fit.slopes, 0.0)
    found = []
    directions = fit.undetermined
    if directions.shape[1] and np.linalg.norm(directions.T @ scaling) > 0.999 * np.linalg.norm(scaling):
        names = tuple(name for name in fit.names if PARAMETERS[name].scales)
        found.append(
            Unidentifiable(
                names,
                "multiplying every mass, inertia and rate by one number changes no acceleration: only their ratios are "
                "determined; add drops with a known load, weigh the vehicle (total_mass, front_axle_mass, "
                "rear_axle_mass), or give one mass or rate that is known",
            )
        )
        unit = scaling / np.linalg.norm(scaling)
        left, size, _ = np.linalg.svd(directions - np.outer(unit, unit @ directions), full_matrices=False)
        directions = left[:, size > 0.5]
    for direction in directions.T:
        share = np.abs(direction)
        names = tuple(name for name, part in zip(fit.names, share, strict=True) if part > 0.1 * share.max())
        signs = [
            f"{name} {'up' if part * direction[np.argmax(share)] > 0 else 'down'}"
            for name, part in zip(fit.names, direction, strict=True)
            if name in names
        ]
        what = f"{names[0]} alone" if len(names) == 1 else f"moving {', '.join(signs)} together"
        found.append(
            Unidentifiable(
                names,
                f"{what} hardly changes these recordings; drops that excite other motions, more channels, or knowing one of "
                "them beforehand would determine it",
            )
        )
    return tuple(found)


def _correlation(fit: Fit, parameters: Mapping[str, Estimate]) -> Correlation:
    chosen = [i for i, name in enumerate(fit.names) if parameters[name].status == "estimated"]
    covariance = fit.covariance[np.ix_(chosen, chosen)]
    spread = np.sqrt(np.diag(covariance))
    matrix = covariance / np.outer(spread, spread) if chosen else covariance
    return Correlation(
        tuple(fit.names[i] for i in chosen), tuple(tuple(float(entry) for entry in row) for row in matrix)
    )
