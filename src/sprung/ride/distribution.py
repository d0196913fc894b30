"""The joint distribution of a vehicle's parameters, and what it makes of quantities that follow from them.

Parameters that must be positive are estimated by their logarithms, the others by themselves: these are the coordinates, and
their estimates are Gaussian with one covariance. A quantity that follows from them has, to first order, the variance g C gᵀ
with its gradient g by the coordinates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.errors import InputError, Problem, Problems
from sprung.results import Result
from sprung.uncertainty import NORMAL_95, Estimate
from sprung.vehicle import Load, Vehicle, parameter_of

Real = NDArray[np.float64]

_PART = 0.01
"""Of a standard uncertainty, over which quantities are differentiated."""

_LEAST = 1e-5
"""Smallest such step, as a part of the parameter: rounding and iterations leave smaller ones no digits."""

_UNSCALED = 1e-3
"""Relative change of a quantity, as masses and rates are doubled, below which it does not depend on the absolute scale."""

_MOVED, _INDEPENDENT = 1.05, 1e-5
"""Factor of a parameter that is not determined, and the relative change of a quantity below which it does not depend on it."""

_LATERAL = {"I_xx": 0.28, **dict.fromkeys(("t_f", "t_r", "t_f1", "t_f2", "t_r1", "t_r2"), 0.75)}
"""Parameters of roll, of which drops without roll say nothing, and usual values: the inertia per sprung mass, m², and m."""


@dataclass(frozen=True, eq=False)
class ParameterDistribution:
    """The joint distribution of the parameters of a vehicle and its load.

    Attributes
    ----------
    names, values
        The parameters, SI, shape (parameter,).
    covariance
        Of their coordinates, shape (parameter, parameter): relative for those that must be positive, SI for the others.
    is_scaled
        Whether the absolute scale is known; otherwise masses and rates are per kg of total mass.
    undetermined
        Parameters of roll that are not determined and have usual values: quantities that depend on them have no value.
    """

    names: tuple[str, ...]
    values: Real
    covariance: Real
    is_scaled: bool = True
    undetermined: tuple[str, ...] = ()

    @classmethod
    def of_vehicle(cls, vehicle: Vehicle) -> ParameterDistribution:
        """Return the distribution of a vehicle whose parameters are exact."""
        names = tuple(vehicle.parameters)
        return cls(names, np.array(list(vehicle.parameters.values())), np.zeros((len(names), len(names))))

    @classmethod
    def of_result(cls, result: Result, load: Load) -> ParameterDistribution:
        """Return the distribution of the parameters that were identified.

        Parameters
        ----------
        result
            Of an identification.
        load
            What is on the vehicle; uncertain masses of it are parameters too, independent of the others.

        Raises
        ------
        InputError
            If the verdict is reject, or a parameter is not determined; all reasons at once.
        """
        where = f"result of {result.name}"
        if result.verdict.state == "reject":
            do = "Read result.verdict.reasons; measure again, or correct the campaign."
            raise InputError([Problem(where, "the verdict reject", "accept or doubtful", do)])
        is_scaled = result.scale.known
        values, stds, undetermined = _values_of(result, where)
        correlation = result.correlation if is_scaled else result.scale.correlation
        masses = load.uncertain_masses
        for name, known in masses.items():
            found = result.derived.get(name)
            values[name], stds[name] = known.value, known.std
            if found is not None and found.value is not None and found.std is not None:
                values[name], stds[name] = found.value, found.std
        if not is_scaled and load.total_mass() > 0:
            do = "Weigh the vehicle or add drops with a known load; without a load its numbers need no scale."
            raise InputError([Problem(f"{where}: load '{load.name}'", "no absolute scale", "a known scale", do)])
        names = tuple(values)
        matrix = np.eye(len(names))
        places = [names.index(name) for name in correlation.names if name in names]
        rows = [i for i, name in enumerate(correlation.names) if name in names]
        matrix[np.ix_(places, places)] = np.array(correlation.matrix).reshape(2 * (len(correlation.names),))[
            np.ix_(rows, rows)
        ]
        own = np.array(list(values.values()))
        sizes = np.where(_logarithmic(names, own), own, 1.0)
        spread = np.array([stds[name] for name in names]) / sizes
        return cls(names, own, matrix * np.outer(spread, spread), is_scaled, undetermined)

    @property
    def std(self) -> Real:
        """Standard uncertainty of the coordinates, shape (parameter,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    def moved(self, step: Real) -> Real:
        """Return parameter values, SI, a step of the coordinates away; shapes (parameter,)."""
        logarithmic = _logarithmic(self.names, self.values)
        return np.where(logarithmic, self.values * np.exp(np.where(logarithmic, step, 0.0)), self.values + step)

    def draw(self, number: int, seed: int | None = None) -> Real:
        """Return draws of the parameters.

        Parameters
        ----------
        number
            Number of draws.
        seed
            Of the random numbers; None gives other ones each time.

        Returns
        -------
        ndarray
            SI, shape (draw, parameter).
        """
        # The symmetric square root is unique: neither signs nor order of eigenvectors change the draws.
        sizes, directions = np.linalg.eigh(self.covariance)
        root = (directions * np.sqrt(np.maximum(sizes, 0.0))) @ directions.T
        with np.errstate(over="ignore"):
            return self.moved(np.random.default_rng(seed).standard_normal((number, len(sizes))) @ root)

    def spread(self, function: Callable[[Real], Real], value: Real) -> tuple[Real, NDArray[np.bool_]]:
        """Return the standard uncertainties of quantities that follow from the parameters, to first order.

        Parameters
        ----------
        function
            The quantities, shape (quantity,), of parameters, SI, shape (parameter,).
        value
            The quantities at the estimates.

        Returns
        -------
        std
            In the quantities' units, shape (quantity,).
        is_determined
            Whether they depend neither on an unknown absolute scale nor on parameters that are not determined; shape
            (quantity,).
        """
        std, gradient = self.std, np.zeros((len(value), len(self.names)))
        logarithmic = _logarithmic(self.names, self.values)
        sizes = np.where(logarithmic, 1.0, np.maximum(np.abs(self.values), std))
        for i in np.flatnonzero(std):
            step = np.zeros(len(std))
            step[i] = max(_PART * std[i], _LEAST * sizes[i])
            gradient[:, i] = (function(self.moved(step)) - function(self.moved(-step))) / (2 * step[i])
        found = np.sqrt(np.maximum(np.einsum("qi,ij,qj->q", gradient, self.covariance, gradient), 0.0))
        is_determined = np.full(len(value), True)
        for name in self.undetermined:
            factors = np.where(np.array(self.names) == name, _MOVED, 1.0)
            is_determined &= np.abs(function(factors * self.values) - value) <= _INDEPENDENT * np.abs(value)
        if not self.is_scaled:
            scales = np.array([parameter_of(name).scales for name in self.names])
            doubled = function(np.where(scales, 2 * self.values, self.values))
            is_determined &= np.abs(doubled - value) <= _UNSCALED * np.abs(value)
        return found, is_determined


def _logarithmic(names: tuple[str, ...], values: Real) -> NDArray[np.bool_]:
    """Return which parameters are estimated by their logarithms."""
    return np.array([parameter_of(name).positive for name in names]) & (values > 0)


def _values_of(result: Result, where: str) -> tuple[dict[str, float], dict[str, float], tuple[str, ...]]:
    """Return the parameters of a result, their standard uncertainties, and those that have usual values instead.

    Where the scale is unknown, masses and rates are per kg of total mass.
    """
    values, stds, missing = dict[str, float](), dict[str, float](), list[str]()
    for name, estimate in result.parameters.items():
        ratio = None if result.scale.known else result.scale.per_total_mass.get(name)
        found: tuple[float | None, float | None] = (
            (estimate.value, estimate.std) if ratio is None else (ratio.value, ratio.std)
        )
        if found[0] is None or found[1] is None or (not result.scale.known and ratio is None and _scales(name)):
            missing.append(name)
        else:
            values[name], stds[name] = found[0], found[1]
    problems = Problems()
    usual = tuple(name for name in missing if name in _LATERAL)
    missing = [name for name in missing if name not in usual]
    if missing:
        found_text = f"no value of {', '.join(missing)}"
        do = "Read result.unidentifiable: it names what would determine them."
        problems.add(where, found_text, "every parameter determined, or its ratio to the total mass", do)
    elif not result.scale.known and not result.scale.correlation.names:
        do = "Identify the campaign again: results of earlier versions lack the correlation of the ratios."
        problems.add(where, "no correlation of the ratios to the total mass", "it, as no scale is known", do)
    problems.raise_if_any()
    values |= {name: _LATERAL[name] * (values["m_s"] if name == "I_xx" else 1.0) for name in usual}
    stds |= dict.fromkeys(usual, 0.0)
    order = list(result.parameters)
    in_order = sorted(values, key=order.index)
    return {name: values[name] for name in in_order}, stds, usual


def _scales(name: str) -> bool:
    return parameter_of(name).scales


def estimate_of_number(
    value: float, std: float, unit: str, is_determined: bool, limits: tuple[float, float] | None = None
) -> Estimate:
    """Return a number with its uncertainty.

    Parameters
    ----------
    value, std
        In the unit.
    unit
        SI.
    is_determined
        Whether it is determined.
    limits
        Smallest and largest possible value; None for a number that is positive, whose interval is even in its logarithm.

    Returns
    -------
    Estimate
    """
    if not is_determined or not np.isfinite(value):
        return Estimate(None, None, None, unit, "unidentifiable")
    if limits is not None:
        value = float(np.clip(value, *limits))
    if std <= 1e-9 * abs(value):
        return Estimate(value, 0.0, (value, value), unit, "known")
    if limits is None:
        factor = float(np.exp(NORMAL_95 * std / value))
        return Estimate(value, std, (value / factor, value * factor), unit, "estimated", "curvature")
    low, high = (float(np.clip(value + sign * NORMAL_95 * std, *limits)) for sign in (-1, 1))
    return Estimate(value, std, (low, high), unit, "estimated", "curvature")
