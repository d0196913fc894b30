"""Samples of one clock at the times of another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, make_lsq_spline

Real = NDArray[np.float64]

MIN_RATE = 64.0
"""Samples per second below which wheel hop, up to some 20 Hz, is lost."""


def resolves_wheel_hop(rate: float) -> bool:
    """Whether a sampling rate is enough for wheel hop.

    Parameters
    ----------
    rate
        Samples per second. Times in files are rounded: it counts to two decimals.

    Returns
    -------
    bool
    """
    return round(rate, 2) >= MIN_RATE


_SLOWER = 1.5
"""Ratio of two rates from which samples of the faster clock are averaged: a spline through them would fold their noise."""


def interpolate(values: Real, time_from: Real, time_to: Real) -> Real:
    """Return samples at the times of another clock.

    Parameters
    ----------
    values
        Finite samples, shape (time,) or (channel, time).
    time_from
        When they were taken, s, increasing, shape (time,); at even or uneven steps.
    time_to
        Times to give them at, s, increasing, shape (other time,).

    Returns
    -------
    ndarray
        Shape (other time,) or (channel, other time); NaN outside the time of the samples.

    Notes
    -----
    From a slower clock, or one as fast: the cubic spline through the samples. From a faster one: of all cubic splines with
    their knots at steps of the new clock the one with least squares to the samples, which averages without delay, up to
    both ends, and leaves nothing of what the new clock is too slow for.
    """
    within = (time_to >= time_from[0]) & (time_to <= time_from[-1])
    result = np.full((*values.shape[:-1], time_to.size), np.nan)
    inner = time_to[within]
    if time_from.size < 4 or not inner.size:
        return result
    step = float(np.median(np.diff(time_to))) if time_to.size > 1 else 0.0
    steps = np.diff(time_from)
    if step > max(_SLOWER * np.median(steps), steps.max()):
        knots = np.arange(time_from[0] + step, time_from[-1] - step / 2, step)
        knots = np.concatenate([[time_from[0]] * 4, knots, [time_from[-1]] * 4])
        result[..., within] = make_lsq_spline(time_from, values.T, knots, k=3)(inner).T
    else:
        result[..., within] = CubicSpline(time_from, values, axis=-1)(inner)
    return result
