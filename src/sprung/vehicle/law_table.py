"""The laws of nonlinear elements as tables of coefficients, as the loops over time steps take them, and the slopes of these."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class LawTable(NamedTuple):
    """The laws of all nonlinear elements at parameter values, each with its row as a first field.

    Attributes
    ----------
    kinks
        With the fields of `Kinks`, shape (7, kink).
    curves
        With the fields of `TravelCurve`, shape (5, curve).
    frictions
        With the fields of `Friction`, shape (3, memory).
    """

    kinks: Array
    curves: Array
    frictions: Array


class FieldSlopes(NamedTuple):
    """Slopes of coefficients of laws by the parameters that they depend on, one column for each pair.

    Attributes
    ----------
    of
        Which kink, curve or friction, in ascending order, shape (pair,).
    to
        To which of the dependences of forces or memories on parameters it belongs, shape (pair,).
    slopes
        Of the coefficients, shape (field, pair).
    """

    of: Index
    to: Index
    slopes: Array

    @classmethod
    def none(cls, fields: int) -> FieldSlopes:
        """Return the slopes of no law with so many fields."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((fields, 0)))

    @classmethod
    def of_law(cls, slopes: Array, first: int, to: Index) -> FieldSlopes:
        """Arrange slopes of a law.

        Parameters
        ----------
        slopes
            Shape (field, parameter, ..., element).
        first
            Which kink, curve or friction of all laws its first one is.
        to
            Dependences, of a shape that goes together with (parameter, ..., element).
        """
        which = np.broadcast_to(first + np.arange(slopes[0, 0].size).reshape(slopes.shape[2:]), slopes.shape[1:])
        of, flat = which.ravel(), slopes.reshape(len(slopes), -1)
        own = np.flatnonzero(flat.any(axis=0))
        own = own[np.argsort(of[own], kind="stable")]
        return cls(of[own], np.broadcast_to(to, slopes.shape[1:]).ravel()[own], flat[:, own])

    @classmethod
    def joined(cls, laws: Sequence[FieldSlopes]) -> FieldSlopes:
        """Join those of several laws, in their order."""
        of, to, slopes = zip(*laws, strict=True)
        return cls(np.concatenate(of), np.concatenate(to), np.concatenate(slopes, axis=1))


class TableSlopes(NamedTuple):
    """Slopes of the coefficients of a `LawTable` by parameters.

    Attributes
    ----------
    kinks
        Of the fields of `Kinks` but the last.
    curves
        Of growth, rate and inverse height.
    frictions
        Of the force.
    memories
        Of the length of frictions, to the dependences of memories.
    """

    kinks: FieldSlopes
    curves: FieldSlopes
    frictions: FieldSlopes
    memories: FieldSlopes
