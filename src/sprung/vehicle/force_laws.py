"""Laws of force that no matrix carries: dry friction, damping that depends on the direction, springs that stiffen, stops.

A law says what force an element makes of the travel and its rate, and of a memory where what went before matters. It gives
its derivatives along with its values, so that whatever steps it can also differentiate what comes out. Every argument may
have leading axes; the last one is that of the elements.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SHORTEST = 1e-7
"""m over which a friction of no force is taken to build up: any length does, and none may be zero."""


class ElementInput(NamedTuple):
    """What elements feel over a step of time; all of one shape.

    Attributes
    ----------
    travel, rate
        At its end, m and m/s.
    way
        Travel since its beginning, m.
    memory
        What was remembered at its beginning.
    """

    travel: Array
    rate: Array
    way: Array
    memory: Array


class ElementForce(NamedTuple):
    """What a law makes of a travel; each of the travel's shape.

    Attributes
    ----------
    force
        N, in the direction of the travel that it resists.
    memory
        What is remembered of the way here.
    by_travel, by_rate, by_memory
        Derivatives of the force, the memory held: N/m, N s/m and N.
    memory_by_travel, memory_by_memory
        Derivatives of the memory by the travel, 1/m, and by what was remembered before. By the travel before it has the
        opposite of the first: memories follow the way, not the place.
    """

    force: Array
    memory: Array
    by_travel: Array
    by_rate: Array
    by_memory: Array
    memory_by_travel: Array
    memory_by_memory: Array


class Sensitivity(NamedTuple):
    """Derivatives by the law's own parameters, each of shape (parameter, ..., element)."""

    force: Array
    memory: Array


@dataclass(frozen=True, slots=True)
class ForceLaw:
    """A law of force.

    Attributes
    ----------
    name
        Of the law.
    remembers
        Whether it has a memory; in one without, zero goes in and comes out.
    answer
        From the law's parameters, shape (parameter, element), and what is felt.
    sensitivity
        From the same.
    """

    name: str
    remembers: bool
    answer: Callable[[Array, ElementInput], ElementForce]
    sensitivity: Callable[[Array, ElementInput], Sensitivity]


def _reach(parameters: Array) -> tuple[Array, Array]:
    """Give the way over which friction builds up, m, and where it is as it should be and not held."""
    force, stiffness = parameters
    reach = np.abs(force) / stiffness
    return np.maximum(reach, _SHORTEST), reach > _SHORTEST


def _friction(parameters: Array, felt: ElementInput) -> ElementForce:
    # Along a way in one direction the memory m of Dahl's law, dm/dx = (1 - m sign(x'))/reach, goes to that sign exponentially.
    force, (reach, _) = parameters[0], _reach(parameters)
    sign = np.sign(felt.way)
    kept = np.exp(-np.abs(felt.way) / reach)
    new = sign + (felt.memory - sign) * kept
    slope = (1.0 - felt.memory * sign) * kept / reach
    nothing = np.zeros_like(felt.travel)
    return ElementForce(force * new, new, nothing, nothing, force + nothing, slope, kept)


def _friction_sensitivity(parameters: Array, felt: ElementInput) -> Sensitivity:
    (force, stiffness), (reach, free) = parameters, _reach(parameters)
    sign = np.sign(felt.way)
    far = np.abs(felt.way) / reach
    kept = np.exp(-far)
    by_reach = np.where(free, (felt.memory - sign) * kept * far / reach, 0.0)
    by_force = np.stack([sign + (felt.memory - sign) * kept, np.zeros_like(felt.travel)])
    return Sensitivity(by_force, np.stack([by_reach * np.sign(force) / stiffness, -by_reach * reach / stiffness]))


def _rebound(parameters: Array, felt: ElementInput) -> ElementForce:
    ratio, damping = parameters
    nothing = np.zeros_like(felt.travel)
    up = np.maximum(felt.rate, 0.0)
    more = (ratio - 1.0) * damping
    return ElementForce(more * up, felt.memory, nothing, more * (felt.rate > 0), nothing, nothing, nothing)


def _rebound_sensitivity(parameters: Array, felt: ElementInput) -> Sensitivity:
    ratio, damping = parameters
    up = np.maximum(felt.rate, 0.0)
    force = np.stack([damping * up, (ratio - 1.0) * up])
    return Sensitivity(force, np.zeros_like(force))


def _progressive(parameters: Array, felt: ElementInput) -> ElementForce:
    per_metre, spring = parameters
    nothing = np.zeros_like(felt.travel)
    rise = per_metre * spring
    return ElementForce(
        -0.5 * rise * felt.travel**2, felt.memory, -rise * felt.travel, nothing, nothing, nothing, nothing
    )


def _progressive_sensitivity(parameters: Array, felt: ElementInput) -> Sensitivity:
    per_metre, spring = parameters
    square = -0.5 * felt.travel**2
    force = np.stack([spring * square, per_metre * square])
    return Sensitivity(force, np.zeros_like(force))


def _stop(parameters: Array, felt: ElementInput) -> ElementForce:
    stiffness, gap = parameters
    nothing = np.zeros_like(felt.travel)
    into = np.maximum(-felt.travel - gap, 0.0)
    return ElementForce(-stiffness * into, felt.memory, stiffness * (into > 0), nothing, nothing, nothing, nothing)


def _stop_sensitivity(parameters: Array, felt: ElementInput) -> Sensitivity:
    stiffness, gap = parameters
    into = np.maximum(-felt.travel - gap, 0.0)
    force = np.stack([-into, stiffness * (into > 0)])
    return Sensitivity(force, np.zeros_like(force))


def _pull(parameters: Array, felt: ElementInput) -> Array:
    """Give what a tyre that held fast to the ground would pull with, N: by its damping as well where that is a parameter."""
    stiffness, *damping = parameters
    pull: Array = stiffness * felt.travel + sum((each * felt.rate for each in damping), np.zeros_like(felt.travel))
    return np.maximum(pull, 0.0)


def _lifted(parameters: Array, felt: ElementInput) -> ElementForce:
    stiffness, *damping = parameters
    pull, nothing = _pull(parameters, felt), np.zeros_like(felt.travel)
    off = pull > 0
    by_rate = -sum(damping, np.zeros_like(stiffness)) * off
    return ElementForce(-pull, felt.memory, -stiffness * off, by_rate, nothing, nothing, nothing)


def _lifted_sensitivity(parameters: Array, felt: ElementInput) -> Sensitivity:
    off = _pull(parameters, felt) > 0
    force = np.stack([-felt.travel * off, -felt.rate * off][: len(parameters)])
    return Sensitivity(force, np.zeros_like(force))


FRICTION = ForceLaw("friction", True, _friction, _friction_sensitivity)
"""Dry friction that gives way before it slides: force F, N, and stiffness s at rest, N/m, after Dahl (Aerospace Corporation
TOR-0158(3107-18)-1, 1968, exponent one): f' = s x' - (s/F) |x'| f."""

REBOUND = ForceLaw("rebound", False, _rebound, _rebound_sensitivity)
"""What a damper resists more in rebound than in compression: ratio r of the two and damping c in compression, N s/m."""

PROGRESSIVE = ForceLaw("progressive", False, _progressive, _progressive_sensitivity)
"""What a spring is stiffer in compression: growth p of its rate with compression, as a part per metre, and rate k, N/m."""

BUMP_STOP = ForceLaw("bump-stop", False, _stop, _stop_sensitivity)
"""A stop: stiffness, N/m, and the compression at which the suspension meets it, m, from the empty vehicle at rest."""

GROUND = ForceLaw("ground", False, _lifted, _lifted_sensitivity)
"""The ground, which pushes and never pulls: what a linear tyre would pull with is taken off. Tyre rate, N/m, and tyre
damping, N s/m, where there is any; the travel is the wheel's height above where its tyre just touches the ground."""
