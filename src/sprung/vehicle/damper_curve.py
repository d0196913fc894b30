"""The curve of a damper: a force law that is linear between knots, or rounded there by hyperbolas."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ElementForce, ElementInput, ForceLaw

Array = NDArray[np.float64]


def damper_curve(*, has_ratio: bool = False, is_rounded: bool = False) -> ForceLaw:
    """Return the law of what the knots of a damper's curve add to the force of a damper of constant rate.

    The force is continuous and passes through zero; it is linear between the knots, which are alike in compression and
    rebound. Its parameters are the damping c before the first knot in compression, N s/m; the rebound ratio r, if it is one;
    half the width w over which hyperbolas round the knots, m/s, if it is one; and for each knot its velocity, m/s, and the
    slope after it over that before it. Positive ratios of knots in ascending order make the curve monotone.

    Parameters
    ----------
    has_ratio
        Whether rebound has a ratio of its own.
    is_rounded
        Whether the knots are rounded.
    """
    return ForceLaw(
        "damper-curve",
        False,
        partial(_force, has_ratio=has_ratio, is_rounded=is_rounded),
        partial(_derivatives, has_ratio=has_ratio, is_rounded=is_rounded),
    )


def _force(parameters: Array, given: ElementInput, *, has_ratio: bool, is_rounded: bool) -> ElementForce:
    """Return what the knots take off the force of a damper of constant rate."""
    ratio, rounding, velocities, drops = _knots(parameters, has_ratio, is_rounded)
    factor = parameters[0] * np.where(given.rate > 0, ratio, 1.0)
    size, zero = np.abs(given.rate), np.zeros_like(given.travel)
    missing, slope = zero, zero
    for velocity, drop in zip(velocities, drops, strict=True):
        excess, by_size, _, _ = _knot(size, velocity, rounding)
        missing = missing + drop * excess
        slope = slope + drop * by_size
    force = -factor * np.sign(given.rate) * missing
    return ElementForce(force, given.memory, zero, -factor * slope, zero, zero, zero)


def _derivatives(parameters: Array, given: ElementInput, *, has_ratio: bool, is_rounded: bool) -> tuple[Array, Array]:
    """Return the derivatives of the force by the parameters; it has no memory."""
    ratio, rounding, velocities, drops = _knots(parameters, has_ratio, is_rounded)
    extends, size, damping = given.rate > 0, np.abs(given.rate), parameters[0]
    unit = -np.sign(given.rate) * np.where(extends, ratio, 1.0)
    knots = [_knot(size, velocity, rounding) for velocity in velocities]
    excesses = [knot[0] for knot in knots]
    zero = np.zeros_like(size)
    missing = sum((drop * excess for drop, excess in zip(drops, excesses, strict=True)), zero)
    force = [unit * missing]
    if has_ratio:
        force.append(-damping * missing * extends)
    if is_rounded:
        by_rounding = sum((drop * knot[3] for drop, knot in zip(drops, knots, strict=True)), zero)
        force.append(damping * unit * by_rounding)
    ratios = parameters[_first_knot(has_ratio, is_rounded) + 1 :: 2]
    slopes = _slopes(ratios)
    # Behind a knot all slopes have its ratio as a factor.
    behind = [
        slopes[i] * excesses[i] - sum((drops[k] * excesses[k] for k in range(i + 1, len(drops))), zero) / own
        for i, own in enumerate(ratios)
    ]
    for drop, knot, lost in zip(drops, knots, behind, strict=True):
        force += [damping * unit * drop * knot[2], -damping * unit * lost]
    return np.stack(force), np.zeros((len(force), *size.shape))


def _knots(parameters: Array, has_ratio: bool, is_rounded: bool) -> tuple[Array | float, Array | None, Array, Array]:
    """Return ratio, rounding, velocities and what each knot takes off the slope, as a part of the damping."""
    first = _first_knot(has_ratio, is_rounded)
    slopes = _slopes(parameters[first + 1 :: 2])
    ratio = parameters[1] if has_ratio else 1.0
    return ratio, parameters[first - 1] if is_rounded else None, parameters[first::2], slopes[:-1] - slopes[1:]


def _first_knot(has_ratio: bool, is_rounded: bool) -> int:
    """Return the position of the first knot's velocity among the parameters."""
    return 1 + has_ratio + is_rounded


def _slopes(ratios: Array) -> Array:
    """Return the slopes before and after each knot, as parts of the damping, shape (knot + 1, element)."""
    return np.cumprod(np.concatenate([np.ones_like(ratios[:1]), ratios]), axis=0)


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
