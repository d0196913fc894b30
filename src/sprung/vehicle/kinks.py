"""Kinks of force laws: forces that begin to act where a travel or a rate passes a position, and their means over time steps.

A damper's rebound and knots, a bump stop and the ground are sums of such forces, so all are evaluated together.

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
    """Forces that begin to act where their argument passes a position; each of shape (kink, element), or (kink,) of all rows.

    Attributes
    ----------
    by_travel, by_rate
        The argument is the sum of the travel and the rate, multiplied by these.
    position
        The argument above which the force acts.
    jump
        The slope of the force by the argument there.
    width
        Half the width over which a hyperbola rounds it, (u + sqrt(u² + w²))/2 instead of max(u, 0); zero for none. The force
        is then less by what it is at the argument zero, and none below that.
    """

    by_travel: Array
    by_rate: Array
    position: Array
    jump: Array
    width: Array

    def above(self, travel: Array, rate: Array) -> Array:
        """Return how far arguments are above the positions, shape (..., kink, element), from those of elements."""
        found: Array = self.by_travel * travel[..., None, :] + self.by_rate * rate[..., None, :] - self.position
        return found


def differentiate_kinks(kinks_of: Callable[[Array], Kinks], parameters: Array) -> Kinks:
    """Differentiate kinks by the parameters of their law, shape (parameter, element): each (parameter, kink, element)."""
    moved = parameters + 1j * _COMPLEX_STEP * np.eye(len(parameters))[:, :, None]
    slopes = [np.array(kinks_of(own)).imag / _COMPLEX_STEP for own in moved]
    return Kinks(*np.stack(slopes, axis=1))


@dataclass(frozen=True, eq=False)
class KinkForces:
    """All kinks of nonlinear elements at parameter values.

    Attributes
    ----------
    row_of
        Row of each kink, shape (kink,).
    number
        Of rows.
    kinks
        Shape (kink,) each.
    laws
        Of each law with kinks its kinks by its parameters, the rows of its elements, shape (element,), the parameters, shape
        (parameter, element), and their positions among the dependences of all forces on parameters.
    dependences
        How many there are.
    """

    row_of: Index
    number: int
    kinks: Kinks
    laws: Sequence[tuple[Callable[[Array], Kinks], Index, Array, Index]]
    dependences: int

    @classmethod
    def of(
        cls, laws: Sequence[tuple[Callable[[Array], Kinks], Index, Array, Index]], number: int, dependences: int
    ) -> KinkForces:
        """Collect the kinks of laws of elements with a number of rows, arguments as the attributes."""
        parts, on = [np.zeros((5, 0))], [np.zeros(0, dtype=np.int64)]
        for kinks_of, at, parameters, _ in laws:
            found = np.array(kinks_of(parameters))
            parts.append(found.reshape(5, -1))
            on.append(np.tile(at, found.shape[1]))
        return cls(np.concatenate(on), number, Kinks(*np.concatenate(parts, 1)), laws, dependences)

    @cached_property
    def slopes(self) -> Kinks:
        """Derivatives of the kinks by parameters, shape (kink, dependence) each: of each, those of its row."""
        slopes = [np.zeros((5, 0, self.dependences))]
        for kinks_of, _, parameters, positions in self.laws:
            by_parameter = np.array(differentiate_kinks(kinks_of, parameters))
            _, _, kinks, elements = by_parameter.shape
            whole = np.zeros((5, kinks, elements, self.dependences))
            for which, columns in enumerate(positions):
                whole[:, :, np.arange(elements), columns] += by_parameter[:, which]
            slopes.append(whole.reshape(5, -1, self.dependences))
        return Kinks(*np.concatenate(slopes, 1))

    @cached_property
    def _of_inputs(self) -> Array:
        """Arguments of the kinks by travels and rates of all rows, shape (2 row, kink)."""
        found, kink = np.zeros((2 * self.number, len(self.row_of))), np.arange(len(self.row_of))
        found[self.row_of, kink] = self.kinks.by_travel
        found[self.number + self.row_of, kink] = self.kinks.by_rate
        return found

    @cached_property
    def _is_on_row(self) -> NDArray[np.bool_]:
        """Whether each kink is on each row, shape (kink, row)."""
        is_on_row: NDArray[np.bool_] = self.row_of[:, None] == np.arange(self.number)
        return is_on_row

    @cached_property
    def _by_hinge(self) -> Array:
        """Force of each row by how far arguments are above their positions, shape (kink, row)."""
        return np.where(self._is_on_row, self.kinks.jump[:, None], 0.0)

    @cached_property
    def _by_slope(self) -> Array:
        """Slopes of each row's force by its travel and its rate, by which arguments are above, shape (kink, 2 row)."""
        by_input = self.kinks.by_travel[:, None], self.kinks.by_rate[:, None]
        return np.hstack([factor * self._by_hinge for factor in by_input])

    @cached_property
    def _is_rounded(self) -> NDArray[np.bool_]:
        is_rounded: NDArray[np.bool_] = self.kinks.width > 0
        return is_rounded

    @cached_property
    def _rounded(self) -> tuple[Index, Array, Array, Array]:
        """Of the kinks that are rounded: positions, widths, arguments from which they act, and what is subtracted."""
        at = np.flatnonzero(self._is_rounded)
        position, width = self.kinks.position[at], self.kinks.width[at]
        return at, width, -position, np.hypot(position, width) - position

    def arguments(self, inputs: Array) -> Array:
        """Return how far each kink's argument is above its position, from travels and rates of all rows, (..., 2 row)."""
        above: Array = inputs @ self._of_inputs - self.kinks.position
        return above

    def act(self, arguments: Array) -> tuple[Array, Array]:
        """Return forces, and their slopes by travels and rates, shapes (..., row) and (..., 2 row), from `arguments`."""
        values, slopes = np.maximum(arguments, 0.0), (arguments > 0).astype(np.float64)
        at, width, least, at_zero = self._rounded
        if at.size:
            # As `hinge`, of which a step needs no more than this.
            above = arguments[..., at]
            root = np.hypot(above, width)
            values[..., at] = np.maximum(0.5 * (above + root - at_zero), 0.0)
            slopes[..., at] = 0.5 * (1.0 + above / root) * (above > least)
        return values @ self._by_hinge, slopes @ self._by_slope

    def lie_between(self, one: Array, other: Array) -> NDArray[np.bool_]:
        """Return in which rows a kink lies between two inputs, shape (..., 2 row): travels and rates of all rows."""
        passed: NDArray[np.bool_] = self.arguments(one) * self.arguments(other) < 0
        return np.asarray(passed @ self._is_on_row)

    def surplus(self, before: Array, after: Array) -> Array:
        """Return the additions to the force at the end of a step, N, shape (..., row).

        Parameters
        ----------
        before, after
            Arguments at the start and at the end, from `arguments`.
        """
        excess = _sharp(before, after)
        if self._is_rounded.any():
            at = self._is_rounded
            excess[..., at] = _mean_rounded(before[..., at], after[..., at], self.kinks.width[at])[0]
        found: Array = excess @ self._by_hinge
        return found

    def add_surplus_slopes(
        self, before: Array, after: Array, by_before: Array, by_after: Array, by_parameter: Array
    ) -> None:
        """Add the derivatives of the same forces.

        Parameters
        ----------
        before, after
            Travels and rates of all rows at the start and at the end of steps, shape (..., 2 row).
        by_before, by_after
            Derivatives by these, to which those of the kinks are added in place, shape (..., 2 row).
        by_parameter
            Likewise of each dependence on a parameter, shape (..., dependence).
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
                (excess, by_u, by_v, by_width), _mean_rounded(u[at], v[at], kinks.width[at]), strict=True
            ):
                whole[at] = part
        row = self.row_of[kink]
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
        np.add.at(by_parameter, tuple(step), of_parameters)


def hinge(above: Array, position: Array, width: Array) -> tuple[Array, Array, Array, Array]:
    """Return the force of kinks of jump one, and its derivatives by u, the position and the width, where the others are held.

    Parameters
    ----------
    above
        How far arguments are above their positions, u, shape (..., of kinks).
    position, width
        Of the kinks.
    """
    is_rounded = width > 0
    is_above = above > np.where(is_rounded, -position, 0.0)
    # Any width does where none is asked for.
    safe = np.where(is_rounded, width, 1.0)
    root, at_zero = np.hypot(above, safe), np.hypot(position, safe)
    rounded = (
        0.5 * (above + root - at_zero + position),
        0.5 * (1.0 + above / root),
        0.5 * (1.0 - position / at_zero),
        0.5 * safe * (1 / root - 1 / at_zero),
    )
    nowhere = np.zeros_like(above)
    value, slope, by_position, by_width = (
        np.where(is_above, np.where(is_rounded, one, sharp), 0.0)
        for one, sharp in zip(rounded, (above, nowhere + 1.0, nowhere, nowhere), strict=True)
    )
    return value, slope, by_position, by_width


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


def _mean_rounded(before: Array, after: Array, width: Array) -> tuple[Array, Array, Array, Array]:
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
