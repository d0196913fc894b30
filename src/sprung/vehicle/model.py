"""The equations of motion as functions of the parameters: M, C and K, and their exact derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.vehicle.elements import Element, Law
from sprung.vehicle.rows import Row

Array = NDArray[np.float64]


class Matrices(NamedTuple):
    """Mass, damping and stiffness matrices, each of shape (7, 7), SI."""

    M: Array
    C: Array
    K: Array

    @property
    def state(self) -> Array:
        """State matrix A of eq. (4), shape (14, 14), for the state {X, Ẋ}."""
        inverse = np.linalg.inv(self.M)
        return np.block([[np.zeros((7, 7)), np.eye(7)], [-inverse @ self.K, -inverse @ self.C]])


@dataclass(frozen=True, eq=False)
class Rows:
    """Several rows over one list of parameters.

    Attributes
    ----------
    affine
        Shape (row, 7, 1 + parameter): each row's constant part, then its slopes.
    """

    affine: Array

    @classmethod
    def of(cls, rows: Sequence[Row], names: Sequence[str]) -> Rows:
        """Stack rows over a list of parameter names; a slope by a name not in it is an error.

        Raises
        ------
        KeyError
            If a row depends on a parameter that is not listed.
        """
        index = {name: i for i, name in enumerate(names, start=1)}
        affine = np.zeros((len(rows), 7, 1 + len(names)))
        for row, block in zip(rows, affine, strict=True):
            block[:, 0] = row.constant
            for name, slope in row.slopes.items():
                block[:, index[name]] = slope
        return cls(affine)

    def at(self, values: ArrayLike) -> Array:
        """Give the rows at parameter values; shape (row, 7)."""
        rows: Array = self.affine @ np.concatenate([[1.0], np.asarray(values, dtype=float)])
        return rows

    @property
    def slopes(self) -> Array:
        """Change of each row with each parameter; shape (parameter, row, 7)."""
        return np.moveaxis(self.affine[:, :, 1:], 2, 0)


@dataclass(frozen=True, eq=False)
class Quadratic:
    """A sum over elements of κ g gᵀ: one of the three matrices.

    Attributes
    ----------
    rows
        The elements' rows.
    coefficients
        Shape (element, 1 + parameter): κ is this times (1, parameters).
    """

    rows: Rows
    coefficients: Array

    def at(self, values: ArrayLike) -> Array:
        """Give the matrix; shape (7, 7)."""
        g = self.rows.at(values)
        return g.T @ (self._kappa(values)[:, None] * g)

    def slopes(self, values: ArrayLike) -> Array:
        """Give its exact derivative by each parameter; shape (parameter, 7, 7)."""
        g = self.rows.at(values)
        squares = (g[:, :, None] * g[:, None, :]).reshape(len(g), -1)
        by_coefficient = (self.coefficients[:, 1:].T @ squares).reshape(-1, 7, 7)
        half = np.swapaxes(self.rows.slopes, 1, 2) @ (self._kappa(values)[:, None] * g)
        slopes: Array = by_coefficient + half + np.swapaxes(half, 1, 2)
        return slopes

    def _kappa(self, values: ArrayLike) -> Array:
        kappa: Array = self.coefficients @ np.concatenate([[1.0], np.asarray(values, dtype=float)])
        return kappa


@dataclass(frozen=True, eq=False)
class LinearModel:
    """M, C and K over one list of parameters.

    Attributes
    ----------
    names
        The parameters, in the order of every vector of values.
    mass, damping, stiffness
        The three sums over elements.
    """

    names: tuple[str, ...]
    mass: Quadratic
    damping: Quadratic
    stiffness: Quadratic

    @classmethod
    def of(cls, elements: Sequence[Element], names: Sequence[str]) -> LinearModel:
        """Compile elements over a list of parameter names.

        Parameters
        ----------
        elements
            The vehicle's and the load's.
        names
            The parameters.

        Raises
        ------
        KeyError
            If an element needs a parameter that is not listed.
        """

        def quadratic(law: Law) -> Quadratic:
            chosen = [element for element in elements if element.law == law]
            index = {name: i for i, name in enumerate(names, start=1)}
            coefficients = np.zeros((len(chosen), 1 + len(names)))
            for element, kappa in zip(chosen, coefficients, strict=True):
                if isinstance(element.coefficient, str):
                    kappa[index[element.coefficient]] = 1.0
                else:
                    kappa[0] = element.coefficient
            return Quadratic(Rows.of([element.row for element in chosen], names), coefficients)

        return cls(tuple(names), quadratic("mass"), quadratic("damper"), quadratic("spring"))

    def matrices(self, values: ArrayLike) -> Matrices:
        """Give M, C and K at parameter values, in the order of `names`."""
        return Matrices(self.mass.at(values), self.damping.at(values), self.stiffness.at(values))

    def slopes(self, values: ArrayLike) -> Matrices:
        """Give the derivatives of M, C and K by each parameter; each of shape (parameter, 7, 7)."""
        return Matrices(self.mass.slopes(values), self.damping.slopes(values), self.stiffness.slopes(values))

    def accelerations(self, values: ArrayLike) -> tuple[Array, Array]:
        """Give the lower half of the state matrix of eq. (4) and its derivatives.

        Returns
        -------
        lower
            [-M⁻¹K, -M⁻¹C], shape (7, 14): accelerations from {X, Ẋ}.
        slopes
            Its derivative by each parameter, shape (parameter, 7, 14).
        """
        M, C, K = self.matrices(values)
        dM, dC, dK = self.slopes(values)
        inverse: Array = np.asarray(np.linalg.inv(M), dtype=float)
        lower: Array = -inverse @ np.hstack([K, C])
        slopes: Array = -inverse @ (dM @ lower + np.concatenate([dK, dC], axis=2))
        return lower, slopes
