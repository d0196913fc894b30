"""The curve of a damper: a force law that is linear between knots, or rounded there by hyperbolas."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw

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
    )


class _Side(NamedTuple):
    """The parameters of a curve on the side on which each element moves: damping, rounding, velocities and ratios of knots."""

    damping: Array
    rounding: Array | None
    velocities: list[Array]
    ratios: list[Array]


class _Given(NamedTuple):
    """The parameters of a curve by their meaning, neutral where it has none of a kind."""

    damping: Array
    ratio: Array | float
    velocity_ratio: Array | float
    slope_ratio: Array | float
    rounding: Array | None
    velocities: list[Array]
    ratios: list[Array]

    @classmethod
    def of(cls, parts: CurveParts, parameters: Array) -> _Given:
        """Sort the parameters of the law."""
        damping, *further = parameters
        ratio = further.pop(0) if parts.has_ratio else 1.0
        shift, bend = (further.pop(0), further.pop(0)) if parts.has_rebound_knee else (1.0, 1.0)
        rounding = further.pop(0) if parts.is_rounded else None
        return cls(damping, ratio, shift, bend, rounding, further[::2], further[1::2])

    def side(self, extends: NDArray[np.bool_]) -> _Side:
        """Return the parameters of the side on which each element moves."""
        shift = np.where(extends, self.velocity_ratio, 1.0)
        first, *others = self.ratios
        return _Side(
            self.damping * np.where(extends, self.ratio, 1.0),
            None if self.rounding is None else self.rounding * shift,
            [velocity * shift for velocity in self.velocities],
            [first * np.where(extends, self.slope_ratio, 1.0), *others],
        )


def _force(parts: CurveParts, parameters: Array, given: ElementInput) -> ElementForce:
    """Return what the knots take off the force of a damper of constant rate."""
    side = _Given.of(parts, parameters).side(given.rate > 0)
    size, zero = np.abs(given.rate), np.zeros_like(given.travel)
    before, missing, slope = zero + 1.0, zero, zero
    for velocity, ratio in zip(side.velocities, side.ratios, strict=True):
        excess, by_size, _, _ = _knot(size, velocity, side.rounding)
        drop = before * (1.0 - ratio)
        missing, slope, before = missing + drop * excess, slope + drop * by_size, before * ratio
    force = -side.damping * np.sign(given.rate) * missing
    return ElementForce(force, given.memory, zero, -side.damping * slope, zero, zero, zero)


def _derivatives(parts: CurveParts, parameters: Array, given: ElementInput) -> tuple[Array, Array]:
    """Return the derivatives of the force by the parameters; it has no memory."""
    own, extends = _Given.of(parts, parameters), given.rate > 0
    side, size, zero = own.side(extends), np.abs(given.rate), np.zeros_like(given.travel)
    knots = [_knot(size, velocity, side.rounding) for velocity in side.velocities]
    slopes = np.cumprod(np.stack([zero + 1.0, *(zero + ratio for ratio in side.ratios)]), axis=0)
    drops, excesses = slopes[:-1] - slopes[1:], [knot[0] for knot in knots]
    missing = sum((drop * excess for drop, excess in zip(drops, excesses, strict=True)), zero)
    unit = -np.sign(given.rate)
    by_velocity = [side.damping * unit * drop * knot[2] for drop, knot in zip(drops, knots, strict=True)]
    by_rounding = side.damping * unit * sum((drop * knot[3] for drop, knot in zip(drops, knots, strict=True)), zero)
    # Behind a knot all slopes have its ratio as a factor.
    by_ratio = [
        side.damping
        * unit
        * (sum((drops[k] * excesses[k] for k in range(i + 1, len(drops))), zero) / ratio - slopes[i] * excesses[i])
        for i, ratio in enumerate(side.ratios)
    ]
    shift = np.where(extends, own.velocity_ratio, 1.0)
    force = [unit * missing * np.where(extends, own.ratio, 1.0)]
    if parts.has_ratio:
        force.append(own.damping * unit * missing * extends)
    if parts.has_rebound_knee:
        shifted = sum((one * velocity for one, velocity in zip(by_velocity, own.velocities, strict=True)), zero)
        shifted += 0.0 if own.rounding is None else by_rounding * own.rounding
        force += [shifted * extends, by_ratio[0] * own.ratios[0] * extends]
    if parts.is_rounded:
        force.append(by_rounding * shift)
    by_ratio[0] = by_ratio[0] * np.where(extends, own.slope_ratio, 1.0)
    for of_velocity, of_ratio in zip(by_velocity, by_ratio, strict=True):
        force += [of_velocity * shift, of_ratio]
    return np.stack(force), np.zeros((len(force), *size.shape))


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
