"""Kinks of force laws: what the mean force over a time step has beyond that of a straight run between the ends of the step.

Time stepping lets forces run linearly over a step. Where a law bends within it, the straight run lies on one side of the law
at every crossing, and a fit would take that for another slope. The argument of a kink runs nearly straight over a step, so the
mean of the force is a difference of antiderivatives. It acts as an addition to the force at the end of the step, which moves
the vehicle but is not read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_STILL = 1e-3
"""Change of the argument over its distance from a rounded kink, below which the law is straight within the step."""

_COMPLEX_STEP = 1e-30
"""Of a parameter, for derivatives without differences of nearly equal numbers."""


class Kinks(NamedTuple):
    """Where the force of elements bends; each of shape (kink, element), or (kink,) of all rows.

    Attributes
    ----------
    by_travel, by_rate
        The argument is the sum of the travel and the rate, multiplied by these.
    position
        The argument at which the force bends.
    jump
        The slope of the force by the argument above it less that below.
    width
        Half the width over which a hyperbola rounds it; zero for none.
    """

    by_travel: Array
    by_rate: Array
    position: Array
    jump: Array
    width: Array


@dataclass(frozen=True, eq=False)
class KinkForces:
    """All kinks of nonlinear elements at parameter values.

    Attributes
    ----------
    rows
        Rows of travels with a kink, ascending, shape (kinked row,).
    row_of
        Row of each kink as a position among these, shape (kink,).
    number
        Of all rows.
    kinks
        Shape (kink,) each.
    slopes
        Their derivatives by the parameters of the laws, shape (kink, of law) each.
    """

    rows: Index
    row_of: Index
    number: int
    kinks: Kinks
    slopes: Kinks

    @classmethod
    def of(
        cls,
        laws: Sequence[tuple[Callable[[Array], Kinks], Index, Index]],
        number: int,
        values: Array,
        of_laws: Index,
    ) -> KinkForces:
        """Collect the kinks of laws.

        Parameters
        ----------
        laws
            Of each law its kinks by its parameters, the rows of its elements, shape (element,), and the positions of the
            parameters among the values, shape (parameter, element).
        number
            Of all rows.
        values
            Parameters, SI, shape (parameter,).
        of_laws
            Positions of the parameters that laws have, ascending.
        """
        parts, slopes, on = [np.zeros((5, 0))], [np.zeros((5, 0, len(of_laws)))], [np.zeros(0, dtype=np.int64)]
        for kinks_of, at, positions in laws:
            own = values[positions]
            found = np.array(kinks_of(own))
            _, kinks, elements = found.shape
            by_parameter = np.zeros((5, kinks, elements, len(of_laws)))
            for which, columns in enumerate(np.searchsorted(of_laws, positions)):
                moved = own.astype(np.complex128)
                moved[which] += 1j * _COMPLEX_STEP
                slope = np.array(kinks_of(moved)).imag / _COMPLEX_STEP  # type: ignore[arg-type]
                by_parameter[:, :, np.arange(elements), columns] += slope
            parts.append(found.reshape(5, -1))
            slopes.append(by_parameter.reshape(5, -1, len(of_laws)))
            on.append(np.tile(at, kinks))
        rows, row_of = np.unique(np.concatenate(on), return_inverse=True)
        return cls(rows, row_of, number, Kinks(*np.concatenate(parts, 1)), Kinks(*np.concatenate(slopes, 1)))

    @cached_property
    def _of_inputs(self) -> Array:
        """Arguments of the kinks by travels and rates of all rows, shape (2 row, kink)."""
        found, kink = np.zeros((2 * self.number, len(self.row_of))), np.arange(len(self.row_of))
        found[self.rows[self.row_of], kink] = self.kinks.by_travel
        found[self.number + self.rows[self.row_of], kink] = self.kinks.by_rate
        return found

    @cached_property
    def _collect(self) -> Array:
        """1 for the row of each kink, shape (kink, kinked row)."""
        collect: Array = (self.row_of[:, None] == np.arange(len(self.rows))).astype(np.float64)
        return collect

    @cached_property
    def _is_rounded(self) -> NDArray[np.bool_]:
        is_rounded: NDArray[np.bool_] = self.kinks.width > 0
        return is_rounded

    def arguments(self, inputs: Array) -> Array:
        """Return how far each kink's argument is above its position, from travels and rates of all rows, (..., 2 row)."""
        above: Array = inputs @ self._of_inputs - self.kinks.position
        return above

    def lie_between(self, one: Array, other: Array) -> NDArray[np.bool_]:
        """Return in which rows a kink lies between two inputs, shape (..., 2 row): travels and rates of all rows."""
        passed, found = (
            self.arguments(one) * self.arguments(other) < 0,
            np.zeros((*one.shape[:-1], self.number), dtype=bool),
        )
        found[..., self.rows] = passed @ (self._collect > 0)
        return found

    def forces(self, before: Array, after: Array) -> Array:
        """Return the additions to the force at the end of a step, N, shape (..., kinked row).

        Parameters
        ----------
        before, after
            Arguments at the start and at the end, from `arguments`.
        """
        excess = _sharp(before, after)
        if self._is_rounded.any():
            at = self._is_rounded
            excess[..., at] = _rounded(before[..., at], after[..., at], self.kinks.width[at])[0]
        found: Array = excess @ (self.kinks.jump[:, None] * self._collect)
        return found

    def add_slopes(self, before: Array, after: Array, by_before: Array, by_after: Array, by_parameter: Array) -> None:
        """Add the derivatives of the same forces.

        Parameters
        ----------
        before, after
            Travels and rates of all rows at the start and at the end of steps, shape (..., 2 row).
        by_before, by_after
            Derivatives by these, to which those of the kinks are added in place, shape (..., 2 row).
        by_parameter
            Likewise by the parameters of the laws, shape (..., row, of law).
        """
        ends = self.arguments(before), self.arguments(after)
        # Few steps pass a kink: only these are computed.
        *step, kink = np.nonzero((ends[0] * ends[1] < 0) | self._is_rounded)
        kinks, slopes = (type(part)(*(each[kink] for each in part)) for part in (self.kinks, self.slopes))
        u, v = (end[(*step, kink)] for end in ends)
        excess, by_u, by_v, by_width = _sharp(u, v), *_sharp_slopes(u, v), np.zeros_like(u)
        if self._is_rounded.any():
            at = self._is_rounded[kink]
            for whole, part in zip(
                (excess, by_u, by_v, by_width), _rounded(u[at], v[at], kinks.width[at]), strict=True
            ):
                whole[at] = part
        row = self.rows[self.row_of[kink]]
        of_parameters = excess[:, None] * slopes.jump + (kinks.jump * by_width)[:, None] * slopes.width
        for by_argument, inputs, total in ((by_u, before, by_before), (by_v, after, by_after)):
            by_end = by_argument * kinks.jump
            travel, rate = (*step, row), (*step, self.number + row)
            moved = (
                inputs[travel][:, None] * slopes.by_travel + inputs[rate][:, None] * slopes.by_rate - slopes.position
            )
            of_parameters += by_end[:, None] * moved
            np.add.at(total, travel, by_end * kinks.by_travel)
            np.add.at(total, rate, by_end * kinks.by_rate)
        np.add.at(by_parameter, travel, of_parameters)


def _sharp(before: Array, after: Array) -> Array:
    """Return twice the mean of max(u, 0) less the sum of both ends, where u runs straight from one to the other."""
    least = np.finfo(np.float64).tiny
    found: Array = np.minimum(before * after, 0.0) / np.maximum(np.abs(after - before), least)
    return found


def _sharp_slopes(before: Array, after: Array) -> tuple[Array, Array]:
    """Return the derivatives of `_sharp` by both ends."""
    change = after - before
    crossed = before * after < 0
    unit = np.sign(change) * crossed / np.where(crossed, change, 1.0) ** 2
    return unit * after**2, -unit * before**2


def _rounded(before: Array, after: Array, width: Array) -> tuple[Array, Array, Array, Array]:
    """Return the same of (u + sqrt(u² + w²))/2, and its derivatives by both ends and by the width w."""
    roots = np.hypot(before, width), np.hypot(after, width)
    change = after - before
    moves = np.abs(change) > _STILL * np.minimum(*roots)
    safe = np.where(moves, change, 1.0)
    ends, slopes, by_width, wholes, of_width = [], [], [], [], []
    for u, root in zip((before, after), roots, strict=True):
        turned = width * np.arcsinh(u / width)
        ends.append(0.5 * (u + root))
        slopes.append(0.5 * (1.0 + u / root))
        by_width.append(0.5 * width / root)
        wholes.append(0.25 * (u**2 + u * root + width * turned))
        of_width.append(0.5 * turned)
    mean, mean_by_width = (wholes[1] - wholes[0]) / safe, (of_width[1] - of_width[0]) / safe
    found = (
        2.0 * mean - ends[0] - ends[1],
        2.0 * (mean - ends[0]) / safe - slopes[0],
        2.0 * (ends[1] - mean) / safe - slopes[1],
        2.0 * mean_by_width - by_width[0] - by_width[1],
    )
    return found[0] * moves, found[1] * moves, found[2] * moves, found[3] * moves
