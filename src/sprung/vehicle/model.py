"""The equations of motion as functions of the parameters: M, C and K, and their exact derivatives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.vehicle.elements import Element
from sprung.vehicle.kinematics import UNCONSTRAINED, Row, coordinates, heave, massive_coordinates, unconstrained
from sprung.vehicle.layout import LinearLaw
from sprung.vehicle.nuisances import parameter_of

Array = NDArray[np.float64]

_DENSE = 600
"""Entries of all matrices up to which zeros among them are multiplied as well."""

LINEAR_LAWS: tuple[LinearLaw, ...] = ("mass", "damper", "spring")
"""Laws of the elements in M, in C and in K."""


class Matrices(NamedTuple):
    """Mass, damping and stiffness matrices of n coordinates.

    Attributes
    ----------
    M, C, K
        Mass (kg, kg m²), damping (N s/m, N s, N m s) and stiffness (N/m, N, N m), shape (..., n, n). The coordinates without
        mass are the last; their rows of M are zero.

    Notes
    -----
    The state is {X, Ẋ}, displacements of all n coordinates, then velocities of the m that move a mass: n + m numbers. The
    highest derivatives are the accelerations of the m coordinates with mass and the velocities of the others. They follow from
    the equations of motion, as M has no entry for the others: with L, the first m columns of M and the others of C, they are
    -L⁻¹ (K X + C Ẋ). The poles of A are the finite eigenvalues of λ² M + λ C + K.
    """

    M: Array
    C: Array
    K: Array

    @property
    def state(self) -> Array:
        """State matrix A of eq. (4), shape (..., n + m, n + m), for the state {X, Ẋ}."""
        return self.state_and_leading_inverse(self.massive)[0]

    def state_and_leading_inverse(self, massive: int) -> tuple[Array, Array]:
        """Return the state matrix and the inverse of L, shape (..., n, n).

        Parameters
        ----------
        massive
            Number of coordinates that move a mass.
        """
        inverse: Array = np.asarray(np.linalg.inv(self._leading(massive)), dtype=np.float64)
        forces = np.concatenate([self.K, self.C[..., :massive]], axis=-1)
        return state_matrix(-inverse @ forces, massive), inverse

    @property
    def massive(self) -> int:
        """Number of coordinates that move a mass, m."""
        return int(np.any(self.M, axis=tuple(range(self.M.ndim - 1))).sum())

    @property
    def leading(self) -> Array:
        """Coefficients of the highest derivatives, L, shape (..., n, n)."""
        return self._leading(self.massive)

    def _leading(self, m: int) -> Array:
        return self.M if m == self.M.shape[-1] else np.concatenate([self.M[..., :m], self.C[..., m:]], axis=-1)

    def deflection(self, force: ArrayLike) -> Array:
        """Return the displacements under constant forces, X, of the shape of the forces, (n,) or (n, force).

        A coordinate without mass and without stiffness stays where it is.
        """
        is_free = (np.diag(self.K) == 0) & ~self.M.any(axis=0)
        K = self.K + np.diag(is_free.astype(float))
        return np.asarray(np.linalg.solve(K, np.asarray(force, dtype=float)), dtype=np.float64)


def state_matrix(highest: ArrayLike, massive: int) -> Array:
    """Return the matrix A of Ẏ = A Y from the rows of the highest derivatives.

    Parameters
    ----------
    highest
        Accelerations of the coordinates with mass, then velocities of the others, as functions of the state {X, Ẋ} and of any
        inputs; shape (..., n, n + m + input).
    massive
        Number of coordinates that move a mass, m.

    Returns
    -------
    ndarray
        Shape (..., n + m, n + m + input).
    """
    highest = np.asarray(highest, dtype=float)
    n = highest.shape[-2]
    A = np.zeros((*highest.shape[:-2], n + massive, highest.shape[-1]))
    A[..., :massive, n : n + massive] = np.eye(massive)
    A[..., highest_derivatives(n, massive), :] = highest
    return A


def highest_derivatives(n: int, massive: int) -> NDArray[np.int64]:
    """Return the positions in the state of what the highest derivatives of the coordinates are the rates of.

    Parameters
    ----------
    n
        Number of coordinates.
    massive
        How many of them, the first, move a mass.

    Returns
    -------
    ndarray of int
        Shape (n,).
    """
    return np.concatenate([np.arange(n, n + massive), np.arange(massive, n)])


@shown
@dataclass(frozen=True, eq=False)
class Rows:
    """Several rows, compiled over one list of parameters.

    Attributes
    ----------
    affine
        Shape (row, coordinate, 1 + parameter): each row's constant part, then its slopes.
    """

    affine: Array

    @classmethod
    def of(cls, rows: Sequence[Row], names: Sequence[str], further: Sequence[str] = ()) -> Rows:
        """Stack rows over the coordinates and parameters of a vehicle; a slope by a name not in the list is an error.

        Parameters
        ----------
        rows
            Displacements.
        names
            The parameters.
        further
            Coordinates beside those that these parameters imply.

        Raises
        ------
        KeyError
            If a row depends on a parameter that is not listed.
        """
        every = (*coordinates(names), *further)
        affine = np.zeros((len(rows), len(every), 1 + len(names)))
        for number, coordinate, factor, value in _entries(rows, names, every):
            affine[number, coordinate, factor] = value
        return cls(affine)

    def at(self, values: ArrayLike) -> Array:
        """Return the rows at parameter values of shape (..., parameter), further ones ignored; shape (..., row, coordinate)."""
        factors = _with_one(values)[..., : self.affine.shape[2]]
        rows: Array = factors @ self.affine.reshape(-1, factors.shape[-1]).T
        return rows.reshape(*factors.shape[:-1], *self.affine.shape[:2])

    @cached_property
    def slopes(self) -> Array:
        """Derivative of each row by each parameter; shape (row, parameter, coordinate)."""
        return np.ascontiguousarray(np.swapaxes(self.affine[:, :, 1:], 1, 2))


def _entries(rows: Sequence[Row], names: Sequence[str], every: Sequence[str]) -> Iterator[tuple[int, int, int, float]]:
    """Yield the entries of rows: row, coordinate among all of them, parameter counted from 1 or 0 for none, and value."""
    index = {"": 0, **{name: i for i, name in enumerate(names, start=1)}}
    position = {coordinate: i for i, coordinate in enumerate(every)}
    for number, row in enumerate(rows):
        for name, shape in (("", row.constant), *row.slopes.items()):
            for coordinate, value in shape.items():
                # Rows of sensors and loads hold whatever the body may do, also what this vehicle's does not.
                if coordinate in position:
                    yield number, position[coordinate], index[name], value


@shown
@dataclass(frozen=True, eq=False)
class LinearModel:
    """M, C and K over one list of parameters, as polynomials in them.

    An element adds κ g gᵀ with κ a parameter and g affine in the geometry, so every entry is a sum of products of at
    most three parameters: k_sf, k_sf a, k_sf a². Only these products, which are few, depend on the parameters; their
    coefficients are constant matrices.

    Where masses also move along the coordinates `UNCONSTRAINED`, on which no force acts, their momentum along these stays zero,
    as it is at rest before the release. With M = [[M₁₁, M₁₂], [M₂₁, M₂₂]], the second block for these, they are -M₂₂⁻¹ M₂₁ X,
    and the mass matrix of X is the Schur complement M₁₁ - M₁₂ M₂₂⁻¹ M₂₁ (Routh's reduction of cyclic coordinates: Goldstein,
    Classical Mechanics, section 8.3).

    Attributes
    ----------
    names
        The parameters, in the order of every vector of values.
    products
        The products of parameters that occur: their positions in the list of names counted from 1, in order, filled up
        with 0 in front for a product of fewer than three; shape (product, 3).
    terms
        Coefficient of each product in M, C and K, SI: shape (product, 3, n, n) with n coordinates, or (product, model, 3, n, n)
        of several models put together by `stack`, whose matrices then have a leading axis.
    elements
        The elements it was compiled from; none for several models.
    """

    names: tuple[str, ...]
    products: NDArray[np.int64]
    terms: Array
    elements: tuple[Element, ...] = ()

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
        index = {name: i for i, name in enumerate(names, start=1)}
        coefficients = [
            (index[one.coefficient], one.factor)
            if isinstance(one.coefficient, str)
            else (0, one.coefficient * one.factor)
            for one in elements
        ]
        kappa, size = np.array(coefficients, dtype=float).reshape(-1, 2).T
        laws = np.array([LINEAR_LAWS.index(one.law) for one in elements], dtype=np.int64)
        used = {coordinate for one in elements for coordinate in one.row.constant}
        every = (*coordinates(names), *(unconstrained(names) if used.intersection(UNCONSTRAINED) else ()))
        n, base = len(every), 1 + len(names)
        # Every pair of an element's entries, each of a coordinate and a factor, the constant among these, is a part of κ g gᵀ.
        entries = [one for one in _entries([one.row for one in elements], names, every) if one[3]]
        owner, coordinate, factor = np.array([one[:3] for one in entries], dtype=np.int64).reshape(-1, 3).T
        entry = np.array([one[3] for one in entries])
        counts = np.bincount(owner, minlength=len(elements))
        begins = np.cumsum(counts) - counts
        first = np.repeat(np.arange(len(owner)), counts[owner])
        second = np.arange(len(first)) - np.repeat(np.cumsum(counts**2) - counts**2, counts**2)
        second = begins[owner[first]] + second % counts[owner[first]]
        own = owner[first]
        keys = np.sort([kappa[own].astype(np.int64), factor[first], factor[second]], axis=0)
        codes, which = np.unique(np.ravel_multi_index((*keys,), (base, base, base)), return_inverse=True)
        shape = (len(codes), len(LINEAR_LAWS), n, n)
        place = np.ravel_multi_index((which, laws[own], coordinate[first], coordinate[second]), shape)
        sums = np.bincount(place, size[own] * entry[first] * entry[second], math.prod(shape))
        terms = np.asarray(sums, dtype=np.float64).reshape(shape)
        kept = terms.any(axis=(1, 2, 3))
        if not kept.all():
            codes, terms = codes[kept], terms[kept]
        products = np.stack(np.unravel_index(codes, (base, base, base)), axis=1)
        return cls(tuple(names), products, terms, tuple(elements))

    def with_known(self, known: Mapping[str, float]) -> LinearModel:
        """Return the model in which some parameters that multiply elements are known numbers, SI by name."""
        elements = [
            replace(element, coefficient=known[element.coefficient])
            if isinstance(element.coefficient, str) and element.coefficient in known
            else element
            for element in self.elements
        ]
        return LinearModel.of(elements, [name for name in self.names if name not in known])

    @classmethod
    def stack(cls, models: Sequence[LinearModel]) -> LinearModel:
        """Stack models over the same parameters, so that all of them are evaluated at once."""
        keys = [[tuple(key) for key in model.products.tolist()] for model in models]
        place = {key: i for i, key in enumerate(dict.fromkeys(key for own in keys for key in own))}
        terms = np.zeros((len(place), len(models), *models[0].terms.shape[1:]))
        for i, (model, own) in enumerate(zip(models, keys, strict=True)):
            terms[[place[key] for key in own], i] = model.terms
        return cls(models[0].names, np.array(list(place)), terms)

    def referred_to_front_axle(self, wheelbase: float) -> LinearModel:
        """Return the equations over the body's motion above the front axle, for a known wheelbase in m; see `Row`."""
        moved = [replace(element, row=element.row.referred_to_front_axle(wheelbase)) for element in self.elements]
        return LinearModel.of(moved, self.names)

    def matrices(self, values: ArrayLike) -> Matrices:
        """Return M, C and K at parameter values of shape (..., parameter), in the order of `names`."""
        M, C, K = whole = self._all_matrices(values)
        if not self.is_reduced:
            return whole
        T, n = self._reduction(M), self.size
        return Matrices(np.swapaxes(T, -1, -2) @ M @ T, C[..., :n, :n], K[..., :n, :n])

    def slopes(self, values: ArrayLike, along: Array | None = None) -> Matrices:
        """Return the derivatives of M, C and K at values of shape (parameter,); each of shape (parameter, ..., n, n).

        Those along some directions, shape (direction, parameter), where these are given.
        """
        first, second, third = _with_one(values)[self._positions]
        others = np.array([second * third, first * third, first * second])
        factors = self._factors if along is None else self._factors @ along.T
        dM, dC, dK = whole = self._combined(np.einsum("ik,ikp->pk", others, factors))
        if not self.is_reduced:
            return whole
        # The derivative of the Schur complement is Tᵀ dM T: that of T is multiplied by momenta, which are zero.
        T, n = self._reduction(self._all_matrices(values).M), self.size
        return Matrices(np.swapaxes(T, -1, -2) @ dM @ T, dC[..., :n, :n], dK[..., :n, :n])

    @cached_property
    def size(self) -> int:
        """Number of coordinates, n, without those on which no force acts."""
        return len(coordinates(self.names))

    @cached_property
    def has_scale(self) -> bool:
        """Whether something in it does not grow with every mass and rate of the vehicle alike, as the known mass of a load."""
        grows = np.array([False, *(parameter_of(name).scales for name in self.names)])
        return bool(np.any(grows[self.products].sum(axis=1) != 1))

    @property
    def is_reduced(self) -> bool:
        """Whether masses also move along coordinates on which no force acts."""
        return int(self.terms.shape[-1]) > self.size

    def unconstrained_motion(self, values: ArrayLike) -> Array:
        """Return the coordinates `UNCONSTRAINED` as functions of the others, shape (3, n); 0 where no mass moves along them."""
        if not self.is_reduced:
            return np.zeros((len(UNCONSTRAINED), self.size))
        return self._reduction(self._all_matrices(values).M)[self.size :]

    def _all_matrices(self, values: ArrayLike) -> Matrices:
        """Return M, C and K over all coordinates, also those on which no force acts; each of shape (..., all, all)."""
        factors = _with_one(values)[..., self._positions]
        return self._combined(factors[..., 0, :] * factors[..., 1, :] * factors[..., 2, :])

    def _combined(self, factors: Array) -> Matrices:
        """Return sums of the terms times factors, shape (..., product); each of shape (..., all, all)."""
        entries, terms = self._nonzero
        if entries is None:
            flat = factors @ terms
        else:
            flat = np.zeros((*factors.shape[:-1], math.prod(self.terms.shape[1:])))
            flat[..., entries] = factors @ terms
        whole = flat.reshape(*factors.shape[:-1], *self.terms.shape[1:])
        return Matrices(whole[..., 0, :, :], whole[..., 1, :, :], whole[..., 2, :, :])

    def _reduction(self, M: Array) -> Array:
        """Return all coordinates as functions of those on which forces act, T, shape (..., all, n)."""
        T = np.zeros((*M.shape[:-1], self.size))
        T[..., : self.size, :] = np.eye(self.size)
        # A load alone may have no mass along one of them, hence the pseudoinverse.
        inverse = np.linalg.pinv(M[..., self.size :, self.size :], hermitian=True)
        T[..., self.size :, :] = -inverse @ M[..., self.size :, : self.size]
        return T

    def accelerations(self, values: ArrayLike) -> tuple[Array, Array]:
        """Return the highest derivatives as functions of the state {X, Ẋ}, and their derivatives; see `Matrices`.

        Returns
        -------
        highest
            Accelerations of the coordinates with mass, then velocities of the others, shape (n, n + m): the lower half of the
            state matrix of eq. (4), [-M⁻¹K, -M⁻¹C], where all have mass.
        slopes
            Its derivative by each parameter, shape (parameter, n, n + m).
        """
        M, C, K = self.matrices(values)
        dM, dC, dK = self.slopes(values)
        m = self.massive
        leading = np.hstack([M[:, :m], C[:, m:]])
        by_leading = np.concatenate([dM[..., :m], dC[..., m:]], axis=2)
        highest: Array = -np.asarray(np.linalg.solve(leading, np.hstack([K, C[:, :m]])), dtype=float)
        right = by_leading @ highest + np.concatenate([dK, dC[..., :m]], axis=2)
        slopes: Array = -np.asarray(np.linalg.solve(leading, right), dtype=float)
        return highest, slopes

    def velocities(self, values: ArrayLike) -> Array:
        """Return the velocities of all coordinates as functions of the state {X, Ẋ}, shape (n, n + m)."""
        return self.matrices(values).state_and_leading_inverse(self.massive)[0][: len(self.heave)]

    @cached_property
    def massive(self) -> int:
        """Number of coordinates that move a mass, m; they are the first."""
        return len(massive_coordinates(self.names))

    @cached_property
    def heave(self) -> Array:
        """A unit of heave: everything moving up alike, in the coordinates; M times this is the weight over gravity, (n,)."""
        return np.array(heave(self.names))

    @cached_property
    def _positions(self) -> NDArray[np.int64]:
        """The products by factor, shape (3, product)."""
        return np.ascontiguousarray(self.products.T)

    @cached_property
    def _nonzero(self) -> tuple[NDArray[np.int64] | None, Array]:
        """Entries of the matrices that any term has, None for all, and the terms in these, shape (product, entry).

        Of a large vehicle most are zero.
        """
        flat = self.terms.reshape(len(self.terms), math.prod(self.terms.shape[1:]))
        if flat.shape[1] <= _DENSE:
            return None, flat
        entries = np.flatnonzero(flat.any(axis=0))
        return entries, np.ascontiguousarray(flat[:, entries])

    @cached_property
    def _factors(self) -> Array:
        """Parameter of each factor of each product, as unit vectors; shape (3, product, parameter)."""
        factors: Array = np.eye(1 + len(self.names))[self.products.T, 1:]
        return np.ascontiguousarray(factors)


def _with_one(values: ArrayLike) -> Array:
    values = np.asarray(values, dtype=float)
    with_one = np.ones((*values.shape[:-1], 1 + values.shape[-1]))
    with_one[..., 1:] = values
    return with_one
