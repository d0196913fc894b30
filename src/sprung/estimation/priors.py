"""What is known beforehand: exact statements are constraints of the fit, uncertain ones and usual sizes its priors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.uncertainty import KnownValue
from sprung.vehicle import evaluate_quantities, evaluate_quantity, layout_of, parameter_of

Real = NDArray[np.float64]


_FINEST = 1e-6
"""Smallest relative uncertainty of a statement: with a finer one, rounding would hide the records."""


_LARGEST_STEP = 1.0
"""Of a logarithm, to which a linearisation may be followed."""

_STIFFEST = 1e-9
"""Part of the reciprocal of a rate in series, to which it is followed towards zero."""

_TRAVEL = 0.03
"""m of travel at which a spring's force is the size of a friction that is large."""


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Fitted coordinates of the parameters: logarithms of those that must be positive, multiples of the others.

    In logarithms every rate and mass is of order one, positive by construction, and scaling them all together, which
    no acceleration can see, is one straight line. Coordinates u are dimensionless, shape (parameter,), or (..., parameter).

    Attributes
    ----------
    names
        The parameters.
    references
        For parameters that may be zero the size by which their coordinate is multiplied, SI; shape (parameter,).
    """

    names: tuple[str, ...]
    references: Real

    @classmethod
    def scaled_by(cls, names: tuple[str, ...], typical: Mapping[str, float]) -> Coordinates:
        """Return coordinates of parameters, those that may be zero scaled by a typical vehicle's, SI by name."""
        return cls(names, np.array([_reference(name, typical) for name in names]))

    @cached_property
    def is_logarithmic(self) -> NDArray[np.bool_]:
        """Which parameters are fitted by their logarithms, shape (parameter,)."""
        return np.array([parameter_of(name).positive for name in self.names])

    @cached_property
    def _vanishing(self) -> NDArray[np.bool_]:
        return np.array([parameter_of(name).vanishes_at_infinity for name in self.names])

    def values(self, u: Real) -> Real:
        """Parameter values, SI, at coordinates."""
        values = self.references * u
        values[self.is_logarithmic] = np.exp(u[self.is_logarithmic])
        return values

    def from_parameters(self, values: Mapping[str, float]) -> Real:
        """Coordinates of parameter values, SI, by name."""
        return self.from_values(np.array([values[name] for name in self.names]))

    def derivatives(self, u: Real) -> Real:
        """Return the derivative of each value by its coordinate, shape (parameter,)."""
        return np.where(self.is_logarithmic, self.values(u), self.references)

    def from_values(self, values: Real) -> Real:
        """Coordinates of parameter values, SI."""
        u = values / self.references
        u[self.is_logarithmic] = np.log(values[self.is_logarithmic])
        return u

    def extrapolated(self, u: Real, step: Real) -> Real:
        """Return the parameter values, SI, that a step of the coordinates leads to from far away.

        A logarithm changes by one at the most. The motion of a vehicle is nearly linear in the reciprocal of the rate of a
        spring in series, which is followed to any value.
        """
        values = self.values(u + np.clip(step, -_LARGEST_STEP, _LARGEST_STEP))
        softer = np.maximum(1.0 - step, _STIFFEST)
        return np.where(self._vanishing, self.values(u) / softer, values)

    def distance(self, u: Real, name: str, value: float) -> float:
        """Return how far the coordinate of a parameter is from that of another value, SI.

        For the rate of a spring in series it is the distance of the reciprocals, to first order.
        """
        own = self.names.index(name)
        if self._vanishing[own]:
            return float(self.values(u)[own] / value - 1.0)
        values = self.values(u)
        values[own] = value
        return float(u[own] - self.from_values(values)[own])


class UsualValue(NamedTuple):
    """Usual value of a parameter in vehicles of all kinds: a weak :term:`prior`.

    Attributes
    ----------
    value
        SI.
    spread
        Factor by which one standard deviation lies above or below it.
    is_knowledge
        Whether it counts in the uncertainty. One that does not only keeps the fit where the records say nothing.
    """

    value: float
    spread: float
    is_knowledge: bool = True


def scaling_direction(names: Sequence[str], values: Real, slopes: Real) -> Real:
    """Return the direction of the coordinates in which every mass and rate grows alike, which no acceleration shows.

    Parameters
    ----------
    names, values
        Of the parameters; values in SI, shape (parameter,).
    slopes
        Derivative of each value by its coordinate, shape (parameter,).
    """
    scales = np.array([parameter_of(name).scales for name in names])
    return np.where(scales, values / slopes, 0.0)


@dataclass(frozen=True, eq=False)
class PriorsAndConstraints:
    """:term:`Priors <prior>` and constraints: statements about parameters and derived quantities.

    Coordinates u, and steps and directions of them, are those of `Coordinates`: dimensionless, shape (parameter,).

    Attributes
    ----------
    coordinates
        The fit's coordinates.
    statements
        Known quantities by name: parameters, or derived quantities of `sprung.vehicle.DERIVED`.
    usual
        Usual values of parameters by name, which hold where the records say little.
    """

    coordinates: Coordinates
    statements: Mapping[str, KnownValue]
    usual: Mapping[str, UsualValue] = field(default_factory=dict)

    @cached_property
    def _usual(self) -> tuple[Real, Real]:
        """Coordinates of the usual values, and derivatives of the residuals; (value,) and (value, coordinate)."""
        names = self.coordinates.names
        places = [names.index(name) for name in self.usual]
        values = np.ones(len(names))
        values[places] = [usual.value for usual in self.usual.values()]
        centre = self.coordinates.from_values(values)
        # A coordinate that is no logarithm has the same relative standard deviation at the usual value.
        std = np.array([np.log(usual.spread) for usual in self.usual.values()])
        std = std * values[places] / self.coordinates.derivatives(centre)[places]
        return centre[places], np.eye(len(names))[places] / std[:, None]

    @property
    def usual_rows(self) -> Real:
        """Derivatives of the usual values' residuals, in standard deviations, shape (value, coordinate)."""
        return self._usual[1] if self.usual else np.zeros((0, len(self.coordinates.names)))

    @property
    def is_knowledge(self) -> NDArray[np.bool_]:
        """Whether each usual value counts in the uncertainty, shape (value,)."""
        return np.array([usual.is_knowledge for usual in self.usual.values()], dtype=bool)

    @cached_property
    def _chosen(self) -> dict[bool, tuple[tuple[str, ...], Real, Real]]:
        """Names, values and scales of the exact statements, and of the others."""
        chosen = {}
        for exact in (True, False):
            stated = {name: known for name, known in self.statements.items() if known.is_exact == exact}
            values = np.array([known.value for known in stated.values()])
            std = np.array([known.std for known in stated.values()])
            sizes = np.abs(values) if exact else np.maximum(std, _FINEST * np.abs(values))
            chosen[exact] = tuple(stated), values, sizes
        return chosen

    def _at(self, u: Real, exact: bool) -> tuple[Real, Real]:
        """Residuals of statements at coordinates and their derivatives, both over the statements' scales."""
        names, known, sizes = self._chosen[exact]
        if not names:
            return np.zeros(0), np.zeros((0, len(u)))
        values = self.coordinates.values(u)
        derivatives = np.where(self.coordinates.is_logarithmic, values, self.coordinates.references)
        found, gradients = evaluate_quantities(names, self.coordinates.names, values)
        rows = gradients * derivatives
        sizes = np.where(sizes > 0, sizes, np.linalg.norm(rows, axis=1))  # nothing is a part of zero
        return (known - found) / sizes, rows / sizes[:, None]

    def residuals(self, u: Real) -> tuple[Real, Real]:
        """Return residuals of the uncertain statements and of the usual values, and their derivatives.

        Returns
        -------
        residuals
            (known - value) / std, shape (statement,); usual values in the coordinates.
        derivatives
            Of value / std by the coordinates, shape (statement, coordinate).
        """
        residuals, rows = self._at(u, exact=False)
        if not self.usual:
            return residuals, rows
        centre, usual_rows = self._usual
        usual_residuals = usual_rows.sum(axis=1) * centre - usual_rows @ u
        return np.append(residuals, usual_residuals), np.vstack([rows, usual_rows])

    def without(self, name: str) -> PriorsAndConstraints:
        """Return the same without one statement."""
        return replace(self, statements={one: known for one, known in self.statements.items() if one != name})

    def change(self, name: str, u: Real, step: Real) -> float:
        """Change of a quantity with a step of the coordinates, to first order, SI."""
        _, gradient = evaluate_quantity(name, self.coordinates.names, self.coordinates.values(u))
        return float(gradient * self.coordinates.derivatives(u) @ step)

    def nearest(self, values: Mapping[str, float]) -> Real:
        """Return the nearest coordinates to parameter values, SI by name, at which every exact statement holds."""
        return self.project(self.coordinates.from_parameters(values))

    def project(self, u: Real) -> Real:
        """Return the nearest coordinates at which every exact statement holds."""
        for _ in range(20):
            residual, rows = self._at(u, exact=True)
            if np.all(np.abs(residual) <= 1e-14):
                break
            u = u + np.linalg.pinv(rows) @ residual
        return u

    def null_space(self, u: Real) -> Real:
        """Return an orthonormal basis of the directions in which no exact statement changes.

        Returns
        -------
        ndarray
            Shape (coordinate, direction).
        """
        residual, rows = self._at(u, exact=True)
        if residual.size == 0:
            return np.eye(len(u))
        _, singular, right = np.linalg.svd(rows)
        rank = int(np.sum(singular > 1e-10 * singular[0]))
        return right[rank:].T


_SIZES = {"N/(m kg)": 100.0, "1/m": 10.0}
"""Sizes of parameters that are the same for vehicles of all sizes: a rate over what it carries is that of 1.6 Hz, squared, and
a rate that grows is twice as large after 10 cm."""


def _reference(name: str, typical: Mapping[str, float]) -> float:
    """Scale of a parameter's coordinate, SI; 1 for those that are fitted by their logarithms."""
    parameter = parameter_of(name)
    if parameter.positive:
        return 1.0
    if not parameter.scales:
        return _SIZES.get(parameter.unit, 1.0)
    axle = layout_of(typical).axles[0]
    stiffness = typical[f"k_s{axle}"]
    sizes = {
        "N": _TRAVEL * stiffness,
        "N/m": stiffness,
        "N m": stiffness,
        "N s/m": typical[f"c_s{axle}"],
        "kg": typical[f"m_u{axle}"],
    }
    return sizes[parameter.unit]
