"""Slow motion: periods of the body compared between drops of the same wheels; another mass swings at another rate.

Two drops of the same wheels from about the same height begin alike, so that the slow motion of one is that of the other with
its time stretched by the ratio of their periods. That ratio needs no model, no place of a sensor and no fit.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

Real = NDArray[np.float64]

_HIGHEST = 3.0
"""Hz, the width of the Gaussian low-pass: bodies bounce at 1 to 2.5 Hz, and wheels hop from 8 Hz on."""

_RATE = 50.0
"""Samples per second of slow motion."""

_BEGIN, _END = 0.3, 2.0
"""s after the release that are compared: all wheels have landed, and something moves still."""

_STRETCHES = np.exp(np.linspace(-0.2, 0.2, 81))
_SHIFTS = np.linspace(-0.04, 0.04, 17)
"""Ratios of time that are tried, and s by which one drop may be behind the other: each fell as long as its blocks were high."""

_ALIKE = 0.05
"""Part of the sum of squares that may be left for two drops to be alike but for time and size."""

_LARGER, _SMALLER, _PER_PERIOD = 0.03, 0.05, 2.5
"""Logarithms of how much larger, and smaller, the slower of two drops may be for its mass to be the reason. Mass goes with the
square of the period and with the inverse of the size; a drop from higher blocks is larger, and with friction slower too."""

_ANOTHER = 0.02
"""Logarithm of the ratio of periods from which a drop swings at another rate: that of 5 % more mass, by its square root."""

_CLEAR = 3.0
"""Times the spread of the drops within a group that groups are apart."""

_LEAST = 0.015
"""The same of periods and sizes together where other drops have shown groups: a load in the middle changes the period of roll
little, and a heavier body still moves less."""


def extract_slow_motion(values: Real, rate: float, release: int, level: Real) -> Real:
    """Extract the slow motion of the body from a drop.

    Parameters
    ----------
    values
        m/s², shape (channel, time); NaN in channels that are left out.
    rate
        Samples per second.
    release
        Sample of the release.
    level
        What the channels read at rest, m/s², shape (channel,).

    Returns
    -------
    ndarray
        Off the rest, m/s², shape (channel, time), 50 samples per second from the release on; 0 in channels that are left out.
    """
    last = release + int((_END + 0.5) * _STRETCHES[-1] * rate)
    moved = np.nan_to_num(values[:, release:last] - level[:, None])
    if moved.shape[1] < 2:
        return np.zeros((len(values), 0))
    smooth = gaussian_filter1d(moved, rate / (2 * np.pi * _HIGHEST), axis=1, mode="nearest")
    time = np.arange(moved.shape[1]) / rate
    return np.array([np.interp(np.arange(0, time[-1], 1 / _RATE), time, channel) for channel in smooth])


def compare_periods(own: Real, other: Real) -> tuple[float, float]:
    """Compare the periods and the size of the slow motion of two drops of the same wheels.

    Parameters
    ----------
    own, other
        From `extract_slow_motion`, the same channels, shape (channel, time).

    Returns
    -------
    tuple of float
        Logarithms of the ratio of the periods and of the ratio of the amplitudes, own over other; NaN where the two are not
        alike but for time and size, or another mass is not the reason for the difference.
    """
    nothing = float("nan"), float("nan")
    end = min(_END, (other.shape[1] - 1) / _RATE / _STRETCHES[-1] - 0.05, own.shape[1] / _RATE - 0.05)
    time = np.arange(_BEGIN, end, 1 / _RATE)
    if time.size < _RATE / 2:
        return nothing
    own = own[:, round(_BEGIN * _RATE) :][:, : time.size]
    # The other drop at all stretches and shifts of time: linear interpolation, shape (channel, stretch, shift, time).
    at = (_BEGIN + _SHIFTS[:, None] + _STRETCHES[:, None, None] * (time - _BEGIN)) * _RATE
    before = np.clip(at.astype(int), 0, other.shape[1] - 2)
    part = np.clip(at - before, 0.0, 1.0)
    warped = other[:, before] * (1 - part) + other[:, before + 1] * part
    energy = float((own * own).sum())
    size = np.einsum("crst,crst->rs", warped, warped)
    scale = np.einsum("ct,crst->rs", own, warped) / np.maximum(size, np.finfo(float).tiny)
    residual = energy - scale**2 * size
    best = np.unravel_index(int(np.argmin(residual)), residual.shape)
    if not residual[best] < _ALIKE * energy or scale[best] <= 0:
        return nothing
    period, growth = -float(np.log(_STRETCHES[best[0]])), float(np.log(scale[best]))
    of_slower = growth * float(np.sign(period))
    by_mass = -_PER_PERIOD * abs(period) - _SMALLER < of_slower < _LARGER
    return (period, growth) if by_mass else nothing


def find_slower_drops(kinds: Sequence[Hashable], motions: Sequence[Real]) -> tuple[bool | None, ...]:
    """Find the drops that swing more slowly than others, as with another mass.

    Parameters
    ----------
    kinds
        Of each drop what has to be the same for two of them to be compared, such as the wheels that fell.
    motions
        Of each drop from `extract_slow_motion`, the same channels.

    Returns
    -------
    tuple of bool or None
        For each drop whether it is of the slower group, None where it was compared without a clear result; a drop that has no
        other of its kind is of the quicker one. Empty where all swing at one rate, or only one drop or a minority of the kinds
        does not.
    """
    several = [kind for kind in dict.fromkeys(kinds) if list(kinds).count(kind) > 1]
    compared = {
        kind: _compare_with_first([i for i, own in enumerate(kinds) if own == kind], motions) for kind in several
    }
    periods = {kind: {drop: period for drop, (period, _) in own.items()} for kind, own in compared.items()}
    clear = {kind: split for kind, own in periods.items() if (split := _split(own, _ANOTHER))}
    slow = sum(len(slower) for _, slower in clear.values())
    if slow < 2 or 2 * len(clear) < len(periods):
        return ()
    groups: list[bool | None] = [None if kind in compared else False for kind in kinds]
    for kind, own in compared.items():
        heavier = {drop: period - size for drop, (period, size) in own.items()}
        quicker, slower = clear.get(kind) or _split(heavier, _LEAST) or ((), ())
        for drop in quicker:
            groups[drop] = False
        for drop in slower:
            groups[drop] = True
    return tuple(groups)


def _compare_with_first(drops: Sequence[int], motions: Sequence[Real]) -> dict[int, tuple[float, float]]:
    first, *others = drops
    return {first: (0.0, 0.0), **{drop: compare_periods(motions[drop], motions[first]) for drop in others}}


def _split(periods: dict[int, float], least: float) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    """Split drops of one kind at the largest step of their periods; None where no step is clear."""
    ordered = sorted((drop for drop in periods if np.isfinite(periods[drop])), key=periods.__getitem__)
    steps = [periods[later] - periods[earlier] for earlier, later in pairwise(ordered)]
    if not steps or max(steps) < least:
        return None
    at = int(np.argmax(steps)) + 1
    within = max((step for i, step in enumerate(steps) if i != at - 1), default=0.0)
    return (tuple(ordered[:at]), tuple(ordered[at:])) if steps[at - 1] > _CLEAR * within else None
