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


def excess_in_the_air(u: Array, v: Array, x: Array, y: Array) -> Array:
    """Return twice the mean of max(u, 0) where x > 0, less the sum of both ends.

    Parameters
    ----------
    u, v
        The argument at both ends of a step, over which it runs straight.
    x, y
        The travel likewise.
    """
    first, last = np.zeros_like(u), np.ones_like(u)
    for one, other in ((u, v), (x, y)):
        begins, ends = (one <= 0) & (other > 0), (one > 0) & (other <= 0)
        passes = one / np.where(begins | ends, one - other, 1.0)
        first = np.where(begins, np.maximum(first, passes), first)
        last = np.where(ends, np.minimum(last, passes), np.where(begins | (one > 0), last, 0.0))
    duration, middle = np.maximum(last - first, 0.0), 0.5 * (first + last)
    start, end = (u > 0) & (x > 0), (v > 0) & (y > 0)
    found: Array = 2.0 * duration * (u + (v - u) * middle) - u * start - v * end
    return found


def rounded_excess(before: Array, after: Array, width: Array) -> Array:
    """Return the same of (u + sqrt(u² + w²))/2."""
    roots = np.hypot(before, width), np.hypot(after, width)
    change = after - before
    moves = np.abs(change) > STILL * np.minimum(*roots)
    wholes = [
        u**2 + u * root + width**2 * np.arcsinh(u / width) for u, root in zip((before, after), roots, strict=True)
    ]
    twice_mean = 0.5 * (wholes[1] - wholes[0]) / np.where(moves, change, 1.0)
    found: Array = (twice_mean - 0.5 * (before + roots[0] + after + roots[1])) * moves
    return found
