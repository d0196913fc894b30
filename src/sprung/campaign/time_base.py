"""The time base of samples: regular, jittering, with lines lost, or with a pause."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.optimize import minimize_scalar
from scipy.signal import savgol_filter

from sprung.campaign.gap_filling import LONGEST_GAP, Place, fill_short_gaps, find_rest
from sprung.errors import Fault
from sprung.formats import interpolate

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]
Index = NDArray[np.int64]

UNEVEN = 0.2
"""Relative deviation of a step from the median step up to which a time base counts as regular."""

_JUMP = 1.6
"""Median steps from which a step is one over lost lines, as long as there are few such."""

_FEW = 0.05
"""Fraction of the steps that may be jumps; above it, the timestamps jitter."""

_PACKETS = 3
"""Number of pauses above which the samples may have been stamped packet by packet, without any pause."""

_EXACT = 1e-2
"""Fraction of the last digit of a timestamp within which two timestamps are equal."""

_SLIGHT = 0.02
"""Fraction of a step by which timestamps may deviate before the samples are examined."""

_LATE = 0.1
"""s by which timestamps may deviate, in bursts, from the regular times of the samples."""

_SLOPE = 0.006
"""s before and after a sample from which its slope is estimated."""

_ROUGH = 5.0
"""Limit of a sample's difference from its neighbours, in medians of the samples around."""

_ENOUGH = 100.0
"""Sum of squares of the expected differences, in local medians, from which the test is decisive."""

_SETTLED = 0.1
"""s of rest required between a pause and the release."""


class RegularTimeBase(NamedTuple):
    """Samples at regular steps.

    Attributes
    ----------
    values
        Shape (channel, time); NaN where a line was lost.
    start
        Time of the first on the file's clock, s.
    rate
        Samples per second.
    lost
        Samples that no channel has, shape (time,).
    origin
        The sample of the file that each was, or is next to, shape (time,).
    faults
        What was wrong with the timestamps, and what was done about it.
    """

    values: Real
    start: float
    rate: float
    lost: Flags
    origin: Index
    faults: tuple[Fault, ...] = ()


def regularise_time_base(time: Real, values: Real, place: Place, file: str) -> RegularTimeBase:
    """Return the samples at regular steps.

    Parameters
    ----------
    time
        Timestamps, s, increasing, shape (time,).
    values
        Shape (channel, time), any unit; NaN where a sample is missing.
    place
        Returns where in the file a sample stands.
    file
        Name of the file.

    Returns
    -------
    RegularTimeBase
        All values NaN where the time base cannot be used.

    Notes
    -----
    Timestamps that jitter mean one of two things: the samples were taken at regular times and stamped inaccurately, or they
    were taken at the times stamped. A vehicle moves smoothly, so that reading is used with which the samples are smoother.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    jumps = steps > _JUMP * usual
    jumps &= bool(jumps.mean() <= _FEW)
    if _is_even(time, jumps):
        return _as_they_are(time, values)
    without = _line(time, np.zeros_like(jumps))
    pauses = np.flatnonzero(jumps & (steps > LONGEST_GAP * (1 + 1e-6)))
    # Samples stamped packet by packet show many pauses; on average there is none.
    if pauses.size > _PACKETS and without.off <= _LATE:
        jumps[:] = False
    elif pauses.size:
        return _without_pauses(time, values, pauses, place, file)
    # A long step over a lost line stays long; one after a late stamp is made good by the next.
    number, step, start, off = min((_line(time, jumps), without), key=lambda line: line.off)
    uneven = np.flatnonzero(np.abs(steps - step * np.diff(number)) > UNEVEN * usual)
    if off > _LATE:
        what = f"{_steps(steps, uneven, usual, off, place)}; the drop is left out"
        do = "Export the recording at a fixed rate, or repeat the drop."
        return _nothing(time, values, Fault("clock", file, what, do))
    if off > _SLIGHT * usual and _sampled_at_timestamps(values, time - start - step * number, 1 / step):
        return _resampled(time, values, step, _steps(steps, uneven, usual, off, place), file)
    lost = np.ones(int(number[-1]) + 1, dtype=bool)
    lost[number.astype(int)] = False
    faults = []
    if lost.any():
        which = f"{lost.sum()} of {lost.size} lines {'is' if lost.sum() == 1 else 'are'} missing"
        what = f"{which}, the first before {place(int(np.argmax(np.diff(number) > 1)) + 1)}; filled in from the samples around"
        faults.append(Fault("clock", file, what, "Check how the logger stores or sends its samples."))
    if uneven.size:
        what = (
            f"{_steps(steps, uneven, usual, off, place)}; the samples are not smoother at these times, and were taken as "
            f"regular, {1 / step:.6g} per second"
        )
        faults.append(Fault("clock", file, what, "Export the recording at a fixed rate."))
    spread = np.full((len(values), lost.size), np.nan)
    spread[:, ~lost] = values
    origin = np.searchsorted(number, np.arange(lost.size))
    return RegularTimeBase(spread, start if uneven.size else float(time[0]), 1 / step, lost, origin, tuple(faults))


class _Line(NamedTuple):
    """Regular steps fitted to timestamps: each sample's number, step and start, s, and the largest deviation, s."""

    number: Real
    step: float
    start: float
    off: float


def _line(time: Real, jumps: Flags) -> _Line:
    steps = np.diff(time)
    index = np.concatenate([[0.0], np.cumsum(np.where(jumps, np.round(steps / np.median(steps)), 1.0))])
    step, start = np.polyfit(index, time - time[0], 1).tolist()
    return _Line(index, step, start + float(time[0]), float(np.abs(time - time[0] - start - step * index).max()))


def _is_even(time: Real, jumps: Flags) -> bool:
    """Return whether timestamps are regular, apart from rounding to the digits in which they are written.

    Where a step is one digit, a lost line looks like a step rounded up. But only rounding keeps all timestamps within one
    digit of a straight line: steps are rounded up at regular distances.
    """
    digits = next((digits for digits in range(10) if np.allclose(time, time.round(digits), rtol=0, atol=1e-12)), 10)
    digit, off = 10.0**-digits, time - np.linspace(time[0], time[-1], len(time))
    if np.abs(off).max() > digit:
        return False
    if not jumps.any() or _line(time, jumps).off > _EXACT * digit:
        return True
    index = np.linspace(0.0, 1.0, len(time))
    best = minimize_scalar(lambda tilt: np.ptp(off - tilt * index), bounds=(-2 * digit, 2 * digit), method="bounded")
    return bool(best.fun <= (1 + _EXACT) * digit)


def _as_they_are(time: Real, values: Real) -> RegularTimeBase:
    rate = float((len(time) - 1) / (time[-1] - time[0]))
    return RegularTimeBase(values, float(time[0]), rate, np.zeros(len(time), dtype=bool), np.arange(len(time)))


def _nothing(time: Real, values: Real, fault: Fault) -> RegularTimeBase:
    return _as_they_are(time, np.full_like(values, np.nan))._replace(faults=(fault,))


def _steps(steps: Real, uneven: Index, usual: float, off: float, place: Place) -> str:
    said = f"the time base is irregular: its timestamps deviate by up to {1e3 * off:.2g} ms from regular ones"
    if not uneven.size:
        return said
    first = int(uneven[0])
    return (
        f"{said}, and {uneven.size} of {steps.size} steps differ from the usual {usual:.6g} s by more than {UNEVEN:.0%}, "
        f"the first, {steps[first]:.6g} s, up to {place(first + 1)}"
    )


def _without_pauses(time: Real, values: Real, pauses: Index, place: Place, file: str) -> RegularTimeBase:
    """Keep the stretch between two pauses that holds the landing, if it also holds the release or nothing moved before it."""
    edges = np.concatenate([[0], pauses + 1, [time.size]])
    level = np.nanmedian(np.where(np.isnan(values).all(axis=1, keepdims=True), 0.0, values), axis=1, keepdims=True)
    deviation = np.nan_to_num(np.abs(values - level))
    landing = int((deviation / np.maximum(deviation.max(axis=1, keepdims=True), 1e-300)).sum(axis=0).argmax())
    piece = int(np.searchsorted(edges, landing, side="right")) - 1
    first, last = int(edges[piece]), int(edges[piece + 1])
    rate = 1 / float(np.median(np.diff(time)))
    longest = int(pauses[np.diff(time)[pauses].argmax()])
    what = (
        f"the logger paused {pauses.size} time{'s' * (pauses.size > 1)}, the longest for "
        f"{time[longest + 1] - time[longest]:.3g} s up to {place(longest + 1)}"
    )
    do = "Let the logger run through, or export the recording again."
    if first > 0 and find_rest(values, rate)[0] < first + _SETTLED * rate:
        fault = Fault("clock", file, f"{what}, between the release and the landing; the drop is left out", do)
        return _nothing(time, values, fault)
    what += f"; only the stretch with the landing is used, {time[first]:.6g} to {time[last - 1]:.6g} s"
    kept = regularise_time_base(time[first:last], values[:, first:last], lambda sample: place(first + sample), file)
    return kept._replace(origin=kept.origin + first, faults=(Fault("clock", file, what, do), *kept.faults))


def _sampled_at_timestamps(values: Real, off: Real, rate: float) -> bool:
    """Return whether the samples were taken at their timestamps rather than at regular times.

    A sample taken late by δ differs by δ times the slope of its signal. The differences of the samples from their neighbours
    are regressed on those expected from the timestamps: the factor is 1 where the timestamps are right, and 0 where the
    samples are regular.
    """
    window = 2 * max(round(_SLOPE * rate), 1) + 1
    product = weight = 0.0
    for signal in values:
        even = fill_short_gaps(signal, rate)
        if np.isnan(even).any() or even.size < 4 * window:
            continue
        expected = _residual_of_neighbours(off * savgol_filter(even, window, 2, deriv=1, delta=1 / rate))
        found = _residual_of_neighbours(even)
        # Against what is usual around: a landing is rough by itself.
        usual = np.maximum(median_filter(np.abs(found), 2 * window + 1), 1e-3 * np.abs(found).max() + 1e-300)
        expected, found = expected / usual, np.clip(found / usual, -_ROUGH, _ROUGH)
        usable = np.abs(expected) < _ROUGH
        product += float(found[usable] @ expected[usable])
        weight += float(expected[usable] @ expected[usable])
    return weight > _ENOUGH and product > weight / 2


def _residual_of_neighbours(signal: Real) -> Real:
    """Return the difference of each sample from the cubic through its four neighbours; shape (time - 4,)."""
    return signal[2:-2] - (4 * (signal[1:-3] + signal[3:-1]) - signal[:-4] - signal[4:]) / 6


def _resampled(time: Real, values: Real, step: float, what: str, file: str) -> RegularTimeBase:
    grid = time[0] + step * np.arange(int((time[-1] - time[0]) / step * (1 + 1e-12)) + 1)
    origin = np.minimum(np.searchsorted(time, grid), time.size - 1)
    read = np.full((len(values), grid.size), np.nan)
    for row, signal in zip(read, values, strict=True):
        there = np.isfinite(signal)
        if there.sum() > 3:
            row[:] = interpolate(signal[there], time[there], grid)
            # Missing samples of a channel are reported and filled in later, as with any clock.
            known = np.flatnonzero(there)
            before = np.clip(np.searchsorted(time[known], grid, side="right") - 1, 0, known.size - 2)
            apart = time[known[before + 1]] - time[known[before]] > max(LONGEST_GAP, _JUMP * step)
            row[apart | (np.diff(known)[before] > 1)] = np.nan
    what += f"; the samples are smooth at these times, and were interpolated to {1 / step:.6g} per second"
    fault = Fault("clock", file, what, "Export the recording at a fixed rate.")
    lost = np.zeros(grid.size, dtype=bool)
    return RegularTimeBase(read, float(time[0]), 1 / step, lost, origin, (fault,))
