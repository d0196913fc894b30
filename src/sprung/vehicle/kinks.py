"""Kinks of force laws: forces that begin to act where a travel or a rate passes a position, and their means over time steps.

A damper's rebound and knots, a bump stop and the ground are sums of such forces, so all are evaluated together.

Time stepping lets forces run linearly over a step. Where a law bends within it, the straight run lies on one side of the law
at every crossing, and a fit would take that for another slope. The argument of a kink runs nearly straight over a step, so the
mean of the force is a difference of antiderivatives. It acts as an addition to the force at the end of the step, which moves
the vehicle but is not read.

A tyre's damper pushes the wheel only while the tyre touches the ground, so a kink may act in the air alone: where the travel
is above zero. Its force begins or ends with a jump there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.kink_means import excess_in_the_air, rounded_excess, sharp_excess

Array = NDArray[np.float64]
Index = NDArray[np.int64]

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
    in_the_air
        1 for a sharp kink that acts only where the travel is above zero, else 0.
    """

    by_travel: Array
    by_rate: Array
    position: Array
    jump: Array
    width: Array
    in_the_air: Array

    def above(self, travel: Array, rate: Array) -> Array:
        """Return how far arguments are above the positions, shape (..., kink, element), from those of elements."""
        found: Array = self.by_travel * travel[..., None, :] + self.by_rate * rate[..., None, :] - self.position
        return found

    def may_act(self, travel: Array) -> NDArray[np.bool_]:
        """Return where kinks act if their arguments are above their positions, shape (..., kink, element)."""
        allowed: NDArray[np.bool_] = (self.in_the_air == 0) | (travel[..., None, :] > 0)
        return allowed


_FIELDS = len(Kinks._fields)


def differentiate_kinks(kinks_of: Callable[[Array], Kinks], parameters: Array) -> Kinks:
    """Differentiate kinks by the parameters of their law, shape (parameter, element): each (parameter, kink, element)."""
    return Kinks(*differentiate_fields(kinks_of, parameters))


def differentiate_fields(fields_of: Callable[[Array], Sequence[Array]], parameters: Array) -> Array:
    """Differentiate fields of a law by its parameters, shape (parameter, element): (field, parameter, ..., element)."""
    moved = parameters + 1j * _COMPLEX_STEP * np.eye(len(parameters))[:, :, None]
    slopes: Array = np.stack([np.array(fields_of(own)).imag for own in moved], axis=1) / _COMPLEX_STEP
    return slopes


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
    """

    row_of: Index
    number: int
    kinks: Kinks

    @classmethod
    def of(cls, laws: Sequence[tuple[Callable[[Array], Kinks], Index, Array]], number: int) -> KinkForces:
        """Collect the kinks of laws of elements with a number of rows.

        Parameters
        ----------
        laws
            Of each the kinks by its parameters, the rows of its elements, shape (element,), and the parameters, shape
            (parameter, element).
        number
            Of rows.
        """
        parts, on = [np.zeros((_FIELDS, 0))], [np.zeros(0, dtype=np.int64)]
        for kinks_of, at, parameters in laws:
            found = np.array(kinks_of(parameters))
            parts.append(found.reshape(_FIELDS, -1))
            on.append(np.tile(at, found.shape[1]))
        return cls(np.concatenate(on), number, Kinks(*np.concatenate(parts, 1)))

    @cached_property
    def _by_jump(self) -> Array:
        """Force of each row by kinks of jump one, shape (kink, row)."""
        return np.where(self.row_of[:, None] == np.arange(self.number), self.kinks.jump[:, None], 0.0)

    def _arguments(self, inputs: Array) -> tuple[Array, Array]:
        """Return how far each kink's argument is above its position, and the travel of its row, shape (..., kink)."""
        travel, rate = inputs[..., self.row_of], inputs[..., self.number + self.row_of]
        above: Array = self.kinks.by_travel * travel + self.kinks.by_rate * rate - self.kinks.position
        return above, travel

    def surplus(self, before: Array, after: Array) -> Array:
        """Return the additions to the force at the end of a step, N, shape (..., row).

        Parameters
        ----------
        before, after
            Travels and rates of all rows at the start and at the end, m and m/s, shape (..., 2 row).
        """
        found: Array = self._excess(before, after) @ self._by_jump
        return found

    def unresolved(self, before: Array, after: Array) -> Array:
        """Return what mean forces over steps are above what their ends say, N, shape (..., row), from the same.

        The ends say it by the trapezoidal rule and its correction by the slopes there (Euler and Maclaurin): to a filter,
        which takes samples for those of a smooth signal, they say everything but where kinks lie.
        """
        moved = self._arguments(after)[0] - self._arguments(before)[0]
        turned = self._slopes(after) - self._slopes(before)
        found: Array = 0.5 * self.surplus(before, after) + (moved * turned / 12.0) @ self._by_jump
        return found

    def _slopes(self, inputs: Array) -> Array:
        """Return the slopes of kinks of jump one, shape (..., kink)."""
        above, travel = self._arguments(inputs)
        acts = (self.kinks.in_the_air == 0) | (travel > 0)
        slopes: Array = hinge(above, self.kinks.position, self.kinks.width)[1] * acts
        return slopes

    def _excess(self, before: Array, after: Array) -> Array:
        """Return twice the mean forces of kinks of jump one less the sum of both ends, shape (..., kink)."""
        (u, x), (v, y) = self._arguments(before), self._arguments(after)
        excess, is_rounded, is_aloft = sharp_excess(u, v), self.kinks.width > 0, self.kinks.in_the_air > 0
        if is_rounded.any():
            at = np.flatnonzero(is_rounded)
            excess[..., at] = rounded_excess(u[..., at], v[..., at], self.kinks.width[at])
        if is_aloft.any():
            at = np.flatnonzero(is_aloft)
            excess[..., at] = excess_in_the_air(u[..., at], v[..., at], x[..., at], y[..., at])
        return excess


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
