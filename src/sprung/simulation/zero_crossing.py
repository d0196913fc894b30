"""The first zero of linear functions of an exact response, solved for and not stepped over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from sprung.vehicle import affine_response

Array = NDArray[np.float64]


def find_first_zero(
    functions: Array, generator: Array, state: Array, step: float, intervals: int
) -> tuple[float, int] | Array:
    """Find the first of several linear functions of Y to fall to zero, with Ẏ = generator Y.

    A function that is zero at the start counts only if it falls from there. One that dips below zero and back between two
    grid points is found too, as long as its slope changes sign only once in between.

    Parameters
    ----------
    functions
        Shape (function, n); positive at the start, or zero but for rounding.
    generator
        Shape (n, n), 1/s.
    state
        Y at the start, shape (n,).
    step
        Of the grid on which signs are compared, s: a fraction of the fastest time constant.
    intervals
        How many of these to search.

    Returns
    -------
    (float, int) or ndarray
        Time after the start, exact to rounding, and which function; or, if none falls, Y at the end, shape (n,).
    """
    grid = affine_response(generator, np.zeros(state.size), state, step, intervals + 1)
    value, slope = functions @ grid, functions @ generator @ grid
    before, after, down, up = value[:, :-1], value[:, 1:], slope[:, :-1], slope[:, 1:]
    fall = (before > 0) & (after <= 0)
    fall[:, 0] |= (before[:, 0] <= 0) & ((after[:, 0] <= 0) | (down[:, 0] < 0))
    # Down and up again within one interval: the tangents at its ends decide whether zero can be reached.
    dip = (before > 0) & (after > 0) & (down < 0) & (up > 0)
    dip &= np.minimum(before + step * down, after - step * up) <= 0
    for j in np.flatnonzero((fall | dip).any(axis=0)):
        roots = [
            (_root(functions[i], generator, grid[:, j], step), int(i)) for i in np.flatnonzero(fall[:, j] | dip[:, j])
        ]
        zeros = [(root, i) for root, i in roots if root is not None]
        if zeros:
            root, i = min(zeros)
            return float(j * step + root), i
    return grid[:, -1]


def _root(row: Array, generator: Array, state: Array, step: float) -> float | None:
    """Solve row·Y = 0 for a falling zero within one interval; None if there is none."""

    def value(time: float) -> float:
        return float(row @ expm(generator * time) @ state)

    def slope(time: float) -> float:
        return float(row @ generator @ expm(generator * time) @ state)

    low, high = 0.0, step
    if value(low) <= 0:
        if slope(low) < 0:
            return 0.0
        if not slope(low) > 0 > slope(high):
            return None
        low = brentq(slope, low, high)
    if value(high) > 0:
        high = brentq(slope, low, high)
        if value(high) > 0:
            return None
    return brentq(value, low, high, xtol=1e-16) if value(low) > 0 else low
