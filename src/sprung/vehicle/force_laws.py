"""Force laws that no matrix holds: dry friction, damper and spring curves, bump stops, the ground.

A law returns the force of an element from the travel, its rate and, for hysteresis, a memory. It returns the derivatives
with the values, so that a time-stepped response can be differentiated exactly. Every argument may have leading axes; the
last axis is that of the elements.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.kinks import Kinks, differentiate_kinks, hinge

Array = NDArray[np.float64]

_SHORTEST = 1e-7
"""m: least travel over which friction builds up. It keeps a friction force of zero from dividing by zero."""

POLYTROPIC_EXPONENT = 1.3
"""Exponent of the gas in an air spring: it exchanges some heat within a period."""

LEAST_COLUMN = 0.05
"""Height of the column of an air spring, over that at rest, below which its force grows no more."""

SMALL_STRAIN = 1e-4
"""Of an air spring, below which a series is more precise than the difference of its forces."""


class ElementInput(NamedTuple):
    """Input of elements over one time step; all of one shape.

    Attributes
    ----------
    travel, rate
        At the end of the step, m and m/s.
    increment
        Change of the travel over the step, m.
    memory
        Internal state at the start of the step, dimensionless.
    """

    travel: Array
    rate: Array
    increment: Array
    memory: Array


class ElementForce(NamedTuple):
    """Output of elements over one time step; each of the shape of the travel.

    Attributes
    ----------
    force
        N, positive where it opposes the travel.
    memory
        Internal state at the end of the step.
    by_travel, by_rate, by_memory
        Derivatives of the force with the memory at the end of the step held: N/m, N s/m and N.
    memory_by_travel, memory_by_memory
        Derivatives of the memory by the travel, 1/m, and by the memory at the start. The derivative by the travel at the start
        is the first with the opposite sign, as a memory follows the increment.
    """

    force: Array
    memory: Array
    by_travel: Array
    by_rate: Array
    by_memory: Array
    memory_by_travel: Array
    memory_by_memory: Array


class TravelCurve(NamedTuple):
    """Forces that follow from the travel x alone, each of shape (element,): -p min(x, x₁)²/2, and that of an air spring.

    Attributes
    ----------
    growth, highest
        p, N/m², and x₁, m.
    rate, inverse_height
        Of an air spring, N/m and 1/m, see `AIR`; zero for none.
    """

    growth: Array
    highest: Array
    rate: Array
    inverse_height: Array


class Friction(NamedTuple):
    """Forces that follow from their memory alone, each of shape (element,).

    Attributes
    ----------
    force
        With a memory of one.
    length
        Travel over which it builds up, m.
    """

    force: Array
    length: Array


@dataclass(frozen=True, slots=True)
class ForceLaw:
    """A force law.

    Attributes
    ----------
    name
        Of the law.
    has_memory
        Whether the force depends on an internal state; the memory of a law without one is zero throughout.
    evaluate
        Forces from the law's parameters, shape (parameter, element), and the input.
    differentiate
        Derivatives of force and memory by the law's parameters, each of shape (parameter, ..., element), from the same.
    steps
        What its force is in time stepping, from the law's parameters, which may be complex: a curve or a friction. None for a
        sum of kinks.
    kinks
        Of a force that is the sum of these alone, from the law's parameters, which may be complex; None for any other.
    """

    name: str
    has_memory: bool
    evaluate: Callable[[Array, ElementInput], ElementForce]
    differentiate: Callable[[Array, ElementInput], tuple[Array, Array]]
    steps: Callable[[Array], TravelCurve | Friction] | None = None
    kinks: Callable[[Array], Kinks] | None = None


def bent_law(name: str, kinks: Callable[[Array], Kinks]) -> ForceLaw:
    """Return the law of a force that is the sum of kinks."""
    return ForceLaw(name, False, partial(_bent, kinks), partial(_bent_derivatives, kinks), kinks=kinks)


def _bent(kinks_of: Callable[[Array], Kinks], parameters: Array, given: ElementInput) -> ElementForce:
    kinks, zero = kinks_of(parameters), np.zeros_like(given.travel)
    value, slope, *_ = hinge(kinks.above(given.travel, given.rate), kinks.position, kinks.width)
    value, slope = (part * kinks.may_act(given.travel) for part in (value, kinks.jump * slope))
    force, by_travel, by_rate = (
        part.sum(axis=-2) for part in (kinks.jump * value, kinks.by_travel * slope, kinks.by_rate * slope)
    )
    return ElementForce(force, given.memory, by_travel, by_rate, zero, zero, zero)


def _bent_derivatives(
    kinks_of: Callable[[Array], Kinks], parameters: Array, given: ElementInput
) -> tuple[Array, Array]:
    kinks, by_parameter = kinks_of(parameters), differentiate_kinks(kinks_of, parameters)
    found, acts = hinge(kinks.above(given.travel, given.rate), kinks.position, kinks.width), kinks.may_act(given.travel)
    value, slope, by_position, by_width = (part * acts for part in found)
    force = np.array(
        [
            (
                moved.jump * value
                + kinks.jump
                * (
                    slope * moved.above(given.travel, given.rate)
                    + by_position * moved.position
                    + by_width * moved.width
                )
            ).sum(axis=-2)
            for moved in (Kinks(*parts) for parts in zip(*by_parameter, strict=True))
        ]
    )
    return force, np.zeros_like(force)


def _friction_length(parameters: Array) -> tuple[Array, Array]:
    """Return the travel over which friction builds up, F/s, m, and whether it is above its lower limit."""
    force, stiffness = parameters
    length = np.sign(force.real) * force / stiffness  # the modulus of real numbers alone, which may have a complex step
    above = length.real > _SHORTEST
    return np.where(above, length, _SHORTEST), above


def _friction(parameters: Array, given: ElementInput) -> ElementForce:
    # Over an increment of one sign the memory m of Dahl's law, dm/dx = (1 - m sign(x'))/length, decays to that sign.
    force, (length, _) = parameters[0], _friction_length(parameters)
    sign = np.sign(given.increment)
    decay = np.exp(-np.abs(given.increment) / length)
    memory = sign + (given.memory - sign) * decay
    slope = (1.0 - given.memory * sign) * decay / length
    zero = np.zeros_like(given.travel)
    return ElementForce(force * memory, memory, zero, zero, force + zero, slope, decay)


def _friction_derivatives(parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    (force, stiffness), (length, above) = parameters, _friction_length(parameters)
    sign = np.sign(given.increment)
    ratio = np.abs(given.increment) / length
    decay = np.exp(-ratio)
    by_length = np.where(above, (given.memory - sign) * decay * ratio / length, 0.0)
    by_force = np.stack([sign + (given.memory - sign) * decay, np.zeros_like(given.travel)])
    return by_force, np.stack([by_length * np.sign(force) / stiffness, -by_length * length / stiffness])


def _as_friction(parameters: Array) -> Friction:
    return Friction(parameters[0], _friction_length(parameters)[0])


def _load_friction(parameters: Array, given: ElementInput) -> ElementForce:
    coefficient, own = parameters[0], parameters[1:]
    memory = _friction(own, given)
    return memory._replace(force=coefficient * memory.memory, by_memory=coefficient + np.zeros_like(given.travel))


def _load_friction_derivatives(parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    by_friction, memory = _friction_derivatives(parameters[1:], given)
    force = np.concatenate([by_friction[:1], np.zeros_like(by_friction)])
    return force, np.concatenate([np.zeros_like(memory[:1]), memory])


def _as_load_friction(parameters: Array) -> Friction:
    return Friction(parameters[0], _friction_length(parameters[1:])[0])


def _uneven_friction(side: float, parameters: Array, given: ElementInput) -> ElementForce:
    difference, *own = parameters
    sliding, memory = own[0] + side * difference, _friction(np.stack(own), given)
    return memory._replace(force=sliding * memory.memory, by_memory=sliding + np.zeros_like(given.travel))


def _uneven_friction_derivatives(side: float, parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    by_friction, memory = _friction_derivatives(parameters[1:], given)
    force = np.concatenate([side * by_friction[:1], by_friction])
    return force, np.concatenate([np.zeros_like(memory[:1]), memory])


def _as_uneven_friction(side: float, parameters: Array) -> Friction:
    return Friction(parameters[1] + side * parameters[0], _friction_length(parameters[1:])[0])


def _rebound_kinks(parameters: Array) -> Kinks:
    (ratio, damping), none = parameters[:, None], np.zeros_like(parameters[:1])
    return Kinks(none, none + 1.0, none, (ratio - 1.0) * damping, none, none)


def _progressive(parameters: Array, given: ElementInput) -> ElementForce:
    growth, spring = parameters
    zero, by_travel = np.zeros_like(given.travel), -growth * spring * given.travel
    return ElementForce(0.5 * by_travel * given.travel, given.memory, by_travel, zero, zero, zero, zero)


def _progressive_derivatives(parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    growth, spring = parameters
    square = -0.5 * given.travel**2
    force = np.stack([spring * square, growth * square])
    return force, np.zeros_like(force)


def _as_progressive(highest: float, parameters: Array) -> TravelCurve:
    growth, none = np.prod(parameters, axis=0), np.zeros_like(parameters[0])
    return TravelCurve(growth, none + highest, none, none)


def _tyre_curve(parameters: Array, given: ElementInput) -> ElementForce:
    return _progressive(parameters, given._replace(travel=np.minimum(given.travel, 0.0)))


def _tyre_curve_derivatives(parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    return _progressive_derivatives(parameters, given._replace(travel=np.minimum(given.travel, 0.0)))


def _air_ratio(strain: Array) -> tuple[Array, Array]:
    """Return the mean rate of an air spring between rest and a strain, over that at rest, less one; and its derivative.

    The strain is the travel over the height of the column, positive in extension. Near rest the difference of nearly equal
    numbers is replaced by its series.
    """
    n, column = POLYTROPIC_EXPONENT, np.maximum(1.0 + strain, LEAST_COLUMN)
    is_small = np.abs(strain) < SMALL_STRAIN
    safe = np.where(is_small, 1.0, strain)
    mean = (1.0 - column**-n) / (n * safe) - 1.0
    slope = (np.where(column > LEAST_COLUMN, column ** (-n - 1), 0.0) - 1.0 - mean) / safe
    near = (n + 1) * strain * (-1 / 2 + (n + 2) * strain * (1 / 6 - (n + 3) * strain / 24))
    near_slope = (n + 1) * (-1 / 2 + (n + 2) * strain * (1 / 3 - (n + 3) * strain / 8))
    return np.where(is_small, near, mean), np.where(is_small, near_slope, slope)


def _air(parameters: Array, given: ElementInput) -> ElementForce:
    inverse, spring = parameters
    zero, strain = np.zeros_like(given.travel), inverse * given.travel
    mean, slope = _air_ratio(strain)
    return ElementForce(
        spring * given.travel * mean, given.memory, spring * (mean + strain * slope), zero, zero, zero, zero
    )


def _air_derivatives(parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    inverse, spring = parameters
    mean, slope = _air_ratio(inverse * given.travel)
    force = np.stack([spring * given.travel**2 * slope, given.travel * mean])
    return force, np.zeros_like(force)


def _as_air(parameters: Array) -> TravelCurve:
    inverse, spring = parameters
    none = np.zeros_like(spring)
    return TravelCurve(none, none + np.inf, spring, inverse)


def _bump_stop_kinks(parameters: Array) -> Kinks:
    (stiffness, clearance), none = parameters[:, None], np.zeros_like(parameters[:1])
    return Kinks(none - 1.0, none, clearance, -stiffness, none, none)


def _ground_kinks(parameters: Array) -> Kinks:
    (stiffness, *dampers), none = parameters[:, None], np.zeros_like(parameters[:1])
    tension = Kinks(stiffness, sum(dampers, none), none, none - 1.0, none, none)
    if not dampers:
        return tension
    # A damper would push a wheel that falls fast before its tyre is down.
    push = Kinks(-stiffness, -dampers[0], none, none + 1.0, none, none + 1.0)
    return Kinks(*(np.concatenate(parts) for parts in zip(tension, push, strict=True)))


def _uneven_ground_kinks(side: float, parameters: Array) -> Kinks:
    mean, uneven, *damping = parameters
    return _ground_kinks(np.stack([mean + side * uneven, *damping]))


FRICTION = ForceLaw("friction", True, _friction, _friction_derivatives, _as_friction)
"""Dry friction with presliding: force F, N, and presliding stiffness s, N/m, after :term:`Dahl <Dahl model>` (Aerospace
Corporation TOR-0158(3107-18)-1, 1968, exponent one): f' = s x' - (s/F) |x'| f."""

LOAD_FRICTION = ForceLaw("load-friction", True, _load_friction, _load_friction_derivatives, _as_load_friction)
"""What a load adds to a dry friction, per weight that the spring carries of it: a coefficient u, and the force F, N, and
presliding stiffness s, N/m, of the friction without the load. It builds up over the same travel F/s."""

REBOUND = bent_law("rebound", _rebound_kinks)
"""Excess of rebound over compression damping: ratio r of the two and damping c in compression, N s/m."""

PROGRESSIVE = ForceLaw("progressive", False, _progressive, _progressive_derivatives, partial(_as_progressive, np.inf))
"""Progressive spring or tyre: growth p of the rate with compression from rest, as a part of the rate per metre, and rate k at
rest, N/m."""

AIR = ForceLaw("air", False, _air, _air_derivatives, _as_air)
"""What the change of pressure in an air spring adds to the force of its rate at rest: inverse of the effective height h of the
column, 1/m, and rate k at rest, N/m; the force is k h/n (1 - (1 + x/h)⁻ⁿ) with the exponent n = 1.3, positive in extension
(Wong, Theory of Ground Vehicles, 2008, section 7.3)."""

TYRE_CURVE = ForceLaw("tyre-curve", False, _tyre_curve, _tyre_curve_derivatives, partial(_as_progressive, 0.0))
"""What the growth of its rate adds to the force of a tyre: growth h with deflection, as a part of the rate per metre, and rate
k where it first touches the ground, N/m; the travel is the height of the wheel above there. The whole tyre has the force
k d (1 + h d/2) at the deflection d."""

BUMP_STOP = bent_law("bump-stop", _bump_stop_kinks)
"""Bump stop: stiffness, N/m, and the compression at which it is met, m, from the empty vehicle at rest."""

GROUND = bent_law("ground", _ground_kinks)
"""Unilateral contact of a tyre with the ground: cancels the tension of the linear tyre, and in the air what its damper pushes.
Tyre rate, N/m, and tyre damping, N s/m, where it is a parameter; the travel is the height of the wheel above that at which its
tyre just touches the ground."""

UNEVEN_FRICTION: Mapping[float, ForceLaw] = {
    side: ForceLaw(
        f"friction {name}",
        True,
        partial(_uneven_friction, side),
        partial(_uneven_friction_derivatives, side),
        partial(_as_uneven_friction, side),
    )
    for side, name in ((1.0, "left"), (-1.0, "right"))
}
"""Dry friction where that of both sides differs, by the side, 1 on the left: by how much that of the left wheel is above the
mean, N; and force F, N, and presliding stiffness s, N/m, of the mean. It builds up over the same travel F/s on both sides."""

UNEVEN_GROUND: Mapping[float, ForceLaw] = {
    side: bent_law(f"ground {name}", partial(_uneven_ground_kinks, side))
    for side, name in ((1.0, "left"), (-1.0, "right"))
}
"""The same where tyre rates of both sides differ, by the side, 1 on the left: mean rate, N/m, by how much that of the left tyre
is above it, N/m, and tyre damping."""
