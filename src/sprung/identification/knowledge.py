"""What is known beforehand, as the fit uses it: exact statements bind the parameters, uncertain ones pull at them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.estimate import Known
from sprung.vehicle import PARAMETERS, quantity

Real = NDArray[np.float64]


_FINEST = 1e-6
"""Smallest relative uncertainty that a statement is taken to have: beside a finer one, rounding would hide the records."""


class Prior(NamedTuple):
    """The uncertain statements at some parameter values.

    Attributes
    ----------
    residual
        (known - value) / std, shape (statement,).
    slopes
        Derivative of value / std by the fit's coordinates, shape (statement, coordinate).
    """

    residual: Real
    slopes: Real


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Fitted coordinates of the parameters: logarithms of those that must be positive, multiples of the others.

    In logarithms every rate and mass is of order one, positive by construction, and scaling them all together, which
    no acceleration can see, is one straight line.

    Attributes
    ----------
    names
        The parameters.
    references
        For parameters that may be zero the size by which their coordinate is multiplied, SI; shape (parameter,).
    """

    names: tuple[str, ...]
    references: Real

    @property
    def _logarithmic(self) -> NDArray[np.bool_]:
        return np.array([PARAMETERS[name].positive for name in self.names])

    def values(self, u: Real) -> Real:
        """Give parameter values, SI, at coordinates."""
        return np.where(self._logarithmic, np.exp(np.where(self._logarithmic, u, 0.0)), self.references * u)

    def slopes(self, u: Real) -> Real:
        """Give the derivative of each value by its coordinate; shape (parameter,)."""
        return np.where(self._logarithmic, self.values(u), self.references)

    def of(self, values: Real) -> Real:
        """Give coordinates at parameter values, SI."""
        return np.where(self._logarithmic, np.log(np.where(self._logarithmic, values, 1.0)), values / self.references)


@dataclass(frozen=True, eq=False)
class Knowledge:
    """Statements about parameters and derived quantities.

    Attributes
    ----------
    coordinates
        The fit's coordinates.
    statements
        Known quantities by name: parameters, or derived quantities of `sprung.vehicle.DERIVED`.
    """

    coordinates: Coordinates
    statements: Mapping[str, Known]

    def _at(self, u: Real, exact: bool) -> tuple[Real, Real, Real]:
        chosen = [(name, known) for name, known in self.statements.items() if known.exact == exact]
        values, slopes = self.coordinates.values(u), self.coordinates.slopes(u)
        residual, rows = np.zeros(len(chosen)), np.zeros((len(chosen), len(u)))
        scale = np.array([known.value if exact else max(known.std, _FINEST * abs(known.value)) for _, known in chosen])
        for i, (name, known) in enumerate(chosen):
            value, gradient = quantity(name, self.coordinates.names, values)
            residual[i] = known.value - value
            rows[i] = gradient * slopes
        return residual, rows, scale

    def prior(self, u: Real) -> Prior:
        """Give the uncertain statements as observations in units of their own standard uncertainty."""
        residual, rows, std = self._at(u, exact=False)
        return Prior(residual / std, rows / std[:, None])

    def without(self, name: str) -> Knowledge:
        """Give the knowledge without one statement."""
        return replace(self, statements={one: known for one, known in self.statements.items() if one != name})

    def change(self, name: str, u: Real, step: Real) -> float:
        """Give by how much a quantity changes with a step of the coordinates, to first order, SI."""
        _, gradient = quantity(name, self.coordinates.names, self.coordinates.values(u))
        return float(gradient * self.coordinates.slopes(u) @ step)

    def bind(self, u: Real) -> Real:
        """Move coordinates, by the shortest way, to where every exact statement holds."""
        for _ in range(20):
            residual, rows, size = self._at(u, exact=True)
            if residual.size == 0 or np.all(np.abs(residual) <= 1e-14 * np.abs(size)):
                break
            u = u + np.linalg.pinv(rows / size[:, None]) @ (residual / size)
        return u

    def free(self, u: Real) -> Real:
        """Give an orthonormal basis of the directions that the exact statements leave free.

        Returns
        -------
        ndarray
            Shape (coordinate, direction).
        """
        residual, rows, size = self._at(u, exact=True)
        if residual.size == 0:
            return np.eye(len(u))
        _, singular, right = np.linalg.svd(rows / size[:, None])
        rank = int(np.sum(singular > 1e-10 * singular[0]))
        return right[rank:].T
