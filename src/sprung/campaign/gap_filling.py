"""Missing samples: short gaps are interpolated, longer ones cut off where the vehicle is at rest.

Between two samples a quarter of a period of wheel hop apart, 20 ms, a cubic spline follows the motion of a vehicle. A longer
gap does no harm where nothing moves: before the release, or once the motion has decayed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sprung.errors import Fault

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]
Place = Callable[[int], str]

LONGEST_GAP = 0.02
"""s between the samples beside a gap that may be filled: a quarter of a period of wheel hop."""

MAX_MISSING = 0.05
"""Fraction of a channel's samples that may be missing."""

_REST = 0.3
"""s of rest required before the release."""

_SMALL = 0.03
"""Fraction of a channel's peak below which it is at rest."""

_FEW = 20
"""Least number of samples whose median is the level at rest."""

_DO = "Check the sensor's cable and the logger, or export the recording again."


def fill_short_gaps(signal: Real, rate: float) -> Real:
    """Fill the short gaps of one channel.

    Parameters
    ----------
    signal
        Shape (time,); NaN where a sample is missing.
    rate
        Samples per second.

    Returns
    -------
    ndarray
        Shape (time,); NaN still where the gap is too long, and at the ends.
    """
    there = np.flatnonzero(np.isfinite(signal))
    placeholders = np.flatnonzero(np.diff(there) > 1)
    short = placeholders[np.diff(there)[placeholders] <= max(LONGEST_GAP * rate * (1 + 1e-9), 1)]
    if not short.size or there.size < 4:
        return signal
    wanted = np.concatenate([np.arange(there[i] + 1, there[i + 1]) for i in short])
    complete = signal.copy()
    complete[wanted] = CubicSpline(there, signal[there])(wanted)
    return complete


def fill_gaps(
    values: Real, lost: Flags, rate: float, wheres: Sequence[str], place: Place
) -> tuple[Real, int, tuple[Fault, ...], tuple[Fault, ...]]:
    """Fill short gaps, cut off what is at rest, and leave out the channels with longer gaps.

    Parameters
    ----------
    values
        Shape (channel, time), any unit; NaN where a sample is missing, throughout in a channel that is left out already.
    lost
        Samples that no channel has, for which there is a fault already; shape (time,).
    rate
        Samples per second.
    wheres
        File and channel of each row, for the faults.
    place
        Returns where in the file a sample stands.

    Returns
    -------
    values
        Shape (channel, time); a channel that is left out is NaN throughout, the others have no NaN.
    first
        Index of the sample of the given values with which they begin.
    faults
        What was missing, and what was done about it.
    left_out
        Those of the faults for which a channel was left out.
    """
    missing = np.isnan(values) & ~lost
    given: Flags = np.logical_not(np.isnan(values).all(axis=1))
    if not np.isnan(values[given]).any():
        return values, 0, (), ()
    whole = np.array([fill_short_gaps(row, rate) for row in values])
    first, last, spoilt = _stretch(whole, rate, given)
    spoilt |= given & (missing[:, first:last].mean(axis=1) > MAX_MISSING)
    faults, left_out = [], []
    for channel in np.flatnonzero(missing.any(axis=1) & given).tolist():
        own = missing[channel]
        count = f"{own.sum()} of {own.size} samples {'is' if own.sum() == 1 else 'are'} missing"
        inside = int(own[first:last].sum())
        if spoilt[channel]:
            done = "the channel is left out of this drop"
        elif inside == own.sum():
            done = "filled in from the samples around"
        else:
            done = f"{inside} were filled in, and " if inside else ""
            done += "the recording is cut off there, as nothing moves"
        what = f"{count}, the first in {place(int(own.argmax()))}; {done}"
        faults.append(Fault("missing", wheres[channel], what, _DO))
        if spoilt[channel]:
            left_out.append(faults[-1])
    whole[spoilt] = np.nan
    return whole[:, first:last], first, tuple(faults), tuple(left_out)


def find_rest(values: Real, rate: float) -> tuple[int, int]:
    """Find the rest at both ends of a recording.

    Parameters
    ----------
    values
        Shape (channel, time), any unit; NaN where a sample is missing.
    rate
        Samples per second.

    Returns
    -------
    until
        First sample at which any channel has left the level of the recording's beginning.
    since
        Sample from which on every channel stays at the level of its end.
    """
    usable = values[~np.isnan(values).all(axis=1)]
    if not usable.size:
        return 0, values.shape[1]
    few = max(_FEW, round(_REST * rate))
    beginning, end = (
        np.array([np.nanmedian(_known(row, part)) for row in usable]) for part in (slice(few), slice(-few, None))
    )
    noise = np.array([_spread(row) for row in usable])[:, None]
    from_beginning, from_end = (np.abs(usable - level[:, None]) for level in (beginning, end))
    allowed = np.maximum(_SMALL * np.nanmax(from_beginning, axis=1, keepdims=True), 5 * noise)
    left = (from_beginning > allowed).any(axis=0)
    back = (from_end > allowed).any(axis=0)
    until = int(left.argmax()) if left.any() else left.size
    since = int(back.size - back[::-1].argmax()) if back.any() else 0
    return until, since


def _known(signal: Real, part: slice) -> Real:
    return signal[np.isfinite(signal)][part]


def _spread(signal: Real) -> float:
    """Return the standard deviation of a channel's noise from its first differences (median absolute deviation)."""
    steps = np.abs(np.diff(_known(signal, slice(None))))
    return float(1.4826 * np.median(steps) / np.sqrt(2)) if steps.size else 0.0


def _stretch(values: Real, rate: float, given: Flags) -> tuple[int, int, Flags]:
    """Return the first and last sample to keep, and the channels with gaps between them, shape (channel,)."""
    first, last, spoilt = 0, values.shape[1], np.zeros(len(values), dtype=bool)
    until, since = find_rest(values, rate)
    for channel in np.flatnonzero(np.isnan(values).any(axis=1) & given).tolist():
        placeholders = np.flatnonzero(np.isnan(values[channel]))
        early, late = placeholders[placeholders + _REST * rate < until], placeholders[placeholders >= since]
        # Where nothing moves at all there is no motion to keep.
        if until >= since or early.size + late.size < placeholders.size:
            spoilt[channel] = True
            continue
        first = max(first, int(early[-1]) + 1) if early.size else first
        last = min(last, int(late[0])) if late.size else last
    return first, last, spoilt
