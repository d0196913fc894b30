"""The curve of a damper: a force law that is linear between knots, or rounded there by hyperbolas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import accumulate
from operator import mul
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw
from sprung.vehicle.kinks import Kinks

Array = NDArray[np.float64]


class CurveParts(NamedTuple):
    """What the curve of a damper has besides its knots, each a parameter of its own.

    Attributes
    ----------
    has_ratio
        Whether rebound has another rate than compression.
    has_rebound_knee
        Whether rebound has a knee of its own: other velocities of knots, and another slope behind the first.
    is_rounded
        Whether the knots are rounded.
    """

    has_ratio: bool = False
    has_rebound_knee: bool = False
    is_rounded: bool = False


_KNOTS_ALONE = CurveParts()
"""A curve of straight lines between knots that are alike in compression and rebound."""

_ONE = np.ones(1)
"""Of any shape: a ratio that changes nothing."""

Value = TypeVar("Value")
"""Of a parameter: a number, an array, or its name in another language."""


@dataclass(frozen=True, slots=True)
class CurveParameters(Generic[Value]):
    """The parameters of the curve of a damper by their meaning, as numbers, arrays or names.

    Attributes
    ----------
    damping
        In compression before the first knot, N s/m.
    ratio
        Rebound over compression.
    velocity_ratio, slope_ratio
        Likewise of the knots' velocities, and of the slope after the first over that before it.
    rounding
        Half the width over which knots are rounded, m/s; None where they are not.
    velocities, ratios
        Of each knot its velocity, m/s, and the slope after it over that before it.
    """

    damping: Value
    ratio: Value
    velocity_ratio: Value
    slope_ratio: Value
    rounding: Value | None
    velocities: Sequence[Value]
    ratios: Sequence[Value]

    @classmethod
    def of(cls, parts: CurveParts, parameters: Sequence[Value], neutral: Value) -> CurveParameters[Value]:
        """Sort the parameters of a law.

        Parameters
        ----------
        parts
            What the curve has besides knots.
        parameters
            In the order of `damper_curve`.
        neutral
            One, for what it has not.

        Returns
        -------
        CurveParameters
        """
        damping, *further = parameters
        ratio = further.pop(0) if parts.has_ratio else neutral
        shift, bend = (further.pop(0), further.pop(0)) if parts.has_rebound_knee else (neutral, neutral)
        rounding = further.pop(0) if parts.is_rounded else None
        return cls(damping, ratio, shift, bend, rounding, further[::2], further[1::2])


def damper_curve(parts: CurveParts = _KNOTS_ALONE) -> ForceLaw:
    """Return the law of what the knots of a damper's curve add to the force of a damper of constant rate.

    The force is continuous and passes through zero; it is linear between the knots. Its parameters are the damping c before
    the first knot in compression, N s/m; of `parts` those that it has, in their order: the rebound ratio r; of rebound over
    compression the velocity of the knots, and the slope after the first over that before it; half the width w over which
    hyperbolas round the knots, m/s; and for each knot its velocity, m/s, and the slope after it over that before it. Positive
    ratios of knots in ascending order make the curve monotone.

    Parameters
    ----------
    parts
        What it has besides knots.
    """
    return ForceLaw(
        "damper-curve",
        False,
        partial(_force, parts),
        partial(_derivatives, parts),
        partial(_kinks, parts),
    )


class _Side(NamedTuple):
    """The parameters of a curve on the side on which each element moves: damping, rounding, velocities and ratios of knots."""

    damping: Array
    rounding: Array | None
    velocities: Sequence[Array]
    ratios: Sequence[Array]

    @property
    def slopes(self) -> list[Array]:
        """The slope before each knot, as a part of the damping."""
        return list(accumulate(self.ratios[:-1], mul, initial=_ONE))

    @property
    def drops(self) -> list[Array]:
        """What each knot takes off the slope, as a part of the damping."""
        return [slope * (1.0 - ratio) for slope, ratio in zip(self.slopes, self.ratios, strict=True)]


def _side(parts: CurveParts, own: CurveParameters[Array], extends: NDArray[np.bool_]) -> _Side:
    """Return the parameters of the side on which each element moves."""
    damping = own.damping * np.where(extends, own.ratio, 1.0) if parts.has_ratio else own.damping
    if not parts.has_rebound_knee:
        return _Side(damping, own.rounding, own.velocities, own.ratios)
    shift, bend = np.where(extends, own.velocity_ratio, 1.0), np.where(extends, own.slope_ratio, 1.0)
    first, *others = own.ratios
    rounding = None if own.rounding is None else own.rounding * shift
    return _Side(damping, rounding, [velocity * shift for velocity in own.velocities], [first * bend, *others])


def _force(parts: CurveParts, parameters: Array, given: ElementInput) -> ElementForce:
    """Return what the knots take off the force of a damper of constant rate."""
    side = _side(parts, CurveParameters.of(parts, list(parameters), _ONE), given.rate > 0)
    size, zero = np.abs(given.rate), np.zeros_like(given.travel)
    missing, slope = zero, zero
    for velocity, drop in zip(side.velocities, side.drops, strict=True):
        excess, by_size, _, _ = _knot(size, velocity, side.rounding)
        missing, slope = missing + drop * excess, slope + drop * by_size
    force = -side.damping * np.sign(given.rate) * missing
    return ElementForce(force, given.memory, zero, -side.damping * slope, zero, zero, zero)


def _derivatives(parts: CurveParts, parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    """Return the derivatives of the force by the parameters; it has no memory."""
    own, extends = CurveParameters.of(parts, list(parameters), _ONE), given.rate > 0
    side, size, zero = _side(parts, own, extends), np.abs(given.rate), np.zeros_like(given.travel)
    knots, drops = [_knot(size, velocity, side.rounding) for velocity in side.velocities], side.drops
    lost = [drop * knot[0] for drop, knot in zip(drops, knots, strict=True)]
    unit, missing = -np.sign(given.rate), sum(lost, zero)
    whole = unit * side.damping
    by_velocity = [whole * drop * knot[2] for drop, knot in zip(drops, knots, strict=True)]
    # Behind a knot all slopes have its ratio as a factor.
    by_ratio = [
        whole * (sum(lost[i + 1 :], zero) / ratio - slope * knots[i][0])
        for i, (ratio, slope) in enumerate(zip(side.ratios, side.slopes, strict=True))
    ]
    by_rounding = zero
    if parts.is_rounded:
        by_rounding = whole * sum((drop * knot[3] for drop, knot in zip(drops, knots, strict=True)), zero)
    force = [unit * missing * np.where(extends, own.ratio, 1.0)]
    if parts.has_ratio:
        force.append(own.damping * unit * missing * extends)
    if parts.has_rebound_knee:
        shifted = sum((one * velocity for one, velocity in zip(by_velocity, own.velocities, strict=True)), zero)
        shifted += 0.0 if own.rounding is None else by_rounding * own.rounding
        force += [shifted * extends, by_ratio[0] * own.ratios[0] * extends]
        shift = np.where(extends, own.velocity_ratio, 1.0)
        by_velocity, by_rounding = [one * shift for one in by_velocity], by_rounding * shift
        by_ratio[0] = by_ratio[0] * np.where(extends, own.slope_ratio, 1.0)
    if parts.is_rounded:
        force.append(by_rounding)
    for of_velocity, of_ratio in zip(by_velocity, by_ratio, strict=True):
        force += [of_velocity, of_ratio]
    return np.stack(force), np.zeros((len(force), *size.shape))


def _kinks(parts: CurveParts, parameters: Array) -> Kinks:
    """Return the knots of both sides; the force of each bends by what it takes off the slope."""
    own, none = CurveParameters.of(parts, list(parameters), _ONE), np.zeros_like(parameters[0])
    found = []
    for sign in (1.0, -1.0):
        side = _side(parts, own, np.array(sign > 0))
        width = none if side.rounding is None else side.rounding
        for velocity, drop in zip(side.velocities, side.drops, strict=True):
            found.append((none, none + 1.0, sign * velocity, -sign * side.damping * drop, none + width))
    return Kinks(*(np.stack(part) for part in zip(*found, strict=True)))


def _knot(size: Array, velocity: Array, rounding: Array | None) -> tuple[Array, Array, Array, Array]:
    """Return max(u, 0) of u = size - velocity, and its derivatives by size, velocity and rounding.

    With a rounding w it is (u + sqrt(u² + w²))/2, less its value at rest.
    """
    u = size - velocity
    if rounding is None:
        slope = (u > 0).astype(float)
        return np.maximum(u, 0.0), slope, -slope, np.zeros_like(u)
    root, rest = np.hypot(u, rounding), np.hypot(velocity, rounding)
    safe = np.maximum(root, np.finfo(float).tiny)
    slope, slope_at_rest = 0.5 * (1.0 + u / safe), 0.5 * (1.0 - velocity / rest)
    value = 0.5 * (u + root) - 0.5 * (rest - velocity)
    return value, slope, slope_at_rest - slope, 0.5 * rounding * (1 / safe - 1 / rest)
