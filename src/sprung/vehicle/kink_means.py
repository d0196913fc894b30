"""Means of kinks over a time step in closed form, as their excess: twice the mean of a force less the sum of both ends.

The argument of a kink runs straight over the step, so that the mean is a difference of antiderivatives.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STILL = 1e-3
"""Change of the argument over its distance from a rounded kink, below which the law is straight within the step."""


def sharp_excess(before: Array, after: Array) -> Array:
    """Return twice the mean of max(u, 0) less the sum of both ends, where u runs straight from one to the other."""
    least = np.finfo(np.float64).tiny
    found: Array = np.minimum(before * after, 0.0) / np.maximum(np.abs(after - before), least)
    return found


def sharp_excess_slopes(before: Array, after: Array) -> tuple[Array, Array]:
    """Return the derivatives of `sharp_excess` by both ends."""
    change = after - before
    crossed = before * after < 0
    unit = np.sign(change) * crossed / np.where(crossed, change, 1.0) ** 2
    return unit * after**2, -unit * before**2


def excess_in_the_air(u: Array, v: Array, x: Array, y: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return twice the mean of max(u, 0) where x > 0, less the sum of both ends; and its derivatives by all arguments.

    Parameters
    ----------
    u, v
        The argument at both ends of a step, over which it runs straight.
    x, y
        The travel likewise.
    """
    first, last, passes = np.zeros_like(u), np.ones_like(u), np.zeros_like(u)
    for one, other in ((u, v), (x, y)):
        begins, ends = (one <= 0) & (other > 0), (one > 0) & (other <= 0)
        passes = one / np.where(begins | ends, one - other, 1.0)
        first = np.where(begins, np.maximum(first, passes), first)
        last = np.where(ends, np.minimum(last, passes), np.where(begins | (one > 0), last, 0.0))
    duration, middle = np.maximum(last - first, 0.0), 0.5 * (first + last)
    start, end = (u > 0) & (x > 0), (v > 0) & (y > 0)
    by_end = duration * middle
    # Where the travel passes zero while the argument is above it, the travel says how long the force acts.
    change = np.where((x > 0) != (y > 0), x - y, np.inf)
    lost = np.maximum(u + (v - u) * passes, 0.0) / change**2
    return (
        2.0 * (u * duration + (v - u) * by_end) - u * start - v * end,
        2.0 * (duration - by_end) - start,
        2.0 * by_end - end,
        2.0 * lost * np.abs(y),
        2.0 * lost * np.abs(x),
    )


def rounded_excess(before: Array, after: Array, width: Array) -> tuple[Array, Array, Array, Array]:
    """Return the same of (u + sqrt(u² + w²))/2, and its derivatives by both ends and by the width w."""
    roots = np.hypot(before, width), np.hypot(after, width)
    change = after - before
    moves = np.abs(change) > STILL * np.minimum(*roots)
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
