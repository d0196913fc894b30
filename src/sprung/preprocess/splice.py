"""Splice: a recording whose first part passed another filter than the rest, in all channels, and is delayed against it.

Loggers that begin to record before a trigger may join two paths of the signal. It shows by the samples alone: from one of
them on the noise is another one, to the end of the recording, in all channels at once; and there each channel jumps by its
rate times the delay. The first part is advanced by the delay, and the samples that are then missing at the joint are filled
in by a polynomial through both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.release import median_by_channel
from sprung.uncertainty import KnownValue

Real = NDArray[np.float64]

_APART = 5.0
"""Ratio of the noise after a splice to that before it, or the other way, at the least."""

_STEADY = 0.5
"""Part of that, as a logarithm, by which the noise of either part may differ between its two ends."""

_TOGETHER = 0.002
"""s within which all channels change."""

_SHORTEST = 0.05
"""s that each part lasts at least."""

_SIDE, _DEGREE = 0.03, 4
"""s on each side of a splice to which a polynomial is fitted, and its degree."""

_FILLED, _DEGREE_FILLED = 0.012, 5
"""s on each side of the joint through which the polynomial is put that fills it in, and its degree."""

_SMEARED = 5
"""Samples on each side of a splice that interpolation to one clock may have smeared."""

_SURE = 5.0
"""Standard errors by which a delay has to differ from zero."""

_LATEST = 0.05
"""s: no filter of a logger delays by more."""


def join_splices(recordings: Sequence[Recording]) -> list[Recording]:
    """Advance the first part of recordings that are spliced from two parts.

    Parameters
    ----------
    recordings
        As they were read; several loggers' are left as they are.

    Returns
    -------
    list of Recording
        With a fault for each that is spliced.
    """
    found = [None if one.parts else find_splice(one.values, one.rate) for one in recordings]
    spliced = [(one, at) for one, at in zip(recordings, found, strict=True) if at is not None]
    delay = _estimate_delay(spliced)
    return [one if at is None else _joined(one, at, delay) for one, at in zip(recordings, found, strict=True)]


def find_splice(values: Real, rate: float) -> int | None:
    """Find the first sample of the second part.

    Parameters
    ----------
    values
        Of any unit, shape (channel, time); NaN in channels that are left out.
    rate
        Samples per second.

    Returns
    -------
    int or None
        None where a recording is of one piece.

    Notes
    -----
    Of the logarithms of second differences, whose mean changes at a splice, the likeliest sample is where the sum of squares
    about the means of both parts is least.
    """
    usable = values[~np.isnan(values).any(axis=1)]
    shortest, near = round(_SHORTEST * rate), max(round(_TOGETHER * rate), 2)
    if not len(usable) or usable.shape[1] < 4 * shortest or not _may_be_spliced(usable[[0, -1]], shortest, near):
        return None
    signed = np.diff(usable, 2, axis=1)
    differences, last = np.abs(signed), signed.shape[1]
    at = _changes(signed, shortest)
    place = int(np.median(at))
    if np.abs(at - place).max() > near:
        return None
    ends = (slice(0, shortest), slice(place - near - shortest, place - near))
    starts = (slice(place + near, place + near + shortest), slice(last - shortest, last))
    if ends[1].start < 0 or starts[0].stop > last:
        return None
    noise = [np.median(differences[:, part], axis=1) for part in (*ends, *starts)]
    first, joint, after, final = (np.log(np.maximum(one, np.finfo(float).tiny)) for one in noise)
    apart, within = np.abs(after - joint), np.maximum(np.abs(joint - first), np.abs(final - after))
    if not (apart > np.log(_APART)).all() or within.sum() > _STEADY * apart.sum():
        return None
    # A release makes no noise: second differences of noise alternate, those of a motion go on.
    noisier = signed[:, starts[0] if after.sum() > joint.sum() else ends[1]]
    if np.any(np.sum(noisier[:, 1:] * noisier[:, :-1], axis=1) > 0):
        return None
    # To the sample: a second difference between the noise of both parts is the first, or the last, that holds a sample of each.
    rises = after.sum() > joint.sum()
    other = differences[:, place - near : place + near] > np.exp((joint + after) / 2)[:, None]
    crossed = np.flatnonzero((other if rises else ~other).any(axis=0))
    return int(place - near + (crossed[0] + 2 if rises else crossed[0]))


def _may_be_spliced(two: Real, shortest: int, near: int) -> bool:
    """Whether two channels, shape (channel, time), change together: most recordings need no look at the others."""
    return bool(np.ptp(_changes(np.diff(two, 2, axis=1), shortest)) <= 2 * near)


def _changes(signed: Real, shortest: int) -> NDArray[np.int64]:
    """Return where the noise of each channel changes, from its second differences, shape (channel, time)."""
    differences = np.abs(signed)
    least = 0.1 * median_by_channel(differences)[:, None] + np.finfo(float).tiny
    before = np.cumsum(np.log(np.maximum(differences, least)), axis=1)
    last = signed.shape[1]
    count = np.arange(1, last + 1)
    between = before**2 / count + (before[:, -1:] - before) ** 2 / np.maximum(last - count, 1)
    places: NDArray[np.int64] = np.argmax(between[:, shortest : last - shortest], axis=1) + shortest
    return places


def _estimate_delay(spliced: Sequence[tuple[Recording, int]]) -> KnownValue:
    """Estimate the delay of the first parts of all recordings against the rest, s, from the jumps of their channels."""
    rates, jumps = (
        np.array([pair for one, at in spliced for pair in zip(*_jump(one, at), strict=True)]).reshape(-1, 2).T
    )
    energy = float(rates @ rates)
    if energy == 0:
        return KnownValue(0.0, np.inf)
    delay = float(rates @ jumps) / energy
    left = jumps - delay * rates
    return KnownValue(delay, float(np.sqrt(left @ left / max(len(left) - 1, 1) / energy)))


def _jump(recording: Recording, at: int) -> tuple[Real, Real]:
    """Return the rate of each channel at a splice, and how far it jumps there, both over the channel's range."""
    values = recording.values[recording.usable]
    count = min(max(round(_SIDE * recording.rate), 2 * _DEGREE), at - _SMEARED, values.shape[1] - at - _SMEARED)
    time = np.arange(_SMEARED, count + _SMEARED) / recording.rate
    before, after = slice(at - _SMEARED - count, at - _SMEARED), slice(at + _SMEARED, at + _SMEARED + count)
    first = np.polynomial.polynomial.polyfit(-time[::-1] - 1 / recording.rate, values[:, before].T, _DEGREE)
    second = np.polynomial.polynomial.polyfit(time, values[:, after].T, _DEGREE)
    span = np.ptp(values, axis=1)
    return (first[1] + second[1]) / 2 / span, (second[0] - first[0]) / span


def _joined(recording: Recording, at: int, delay: KnownValue) -> Recording:
    """Return a recording with its first part advanced by a delay."""
    moment = recording.start + at / recording.rate
    what = f"until {moment:.3f} s all channels passed another filter than after it"
    samples = round(delay.value * recording.rate)
    if not (
        abs(delay.value) > _SURE * delay.std and 0 < samples < _LATEST * recording.rate and samples + 2 * _SMEARED < at
    ):
        do = "Record with one filter throughout, or use the part after it: give start = ... for this drop."
        fault = Fault("splice", recording.name, f"{what}; nothing was changed", do)
        return replace(recording, faults=(*recording.faults, fault))
    values = recording.values.copy()
    values[:, : at - samples] = recording.values[:, samples:at]
    side = max(round(_FILLED * recording.rate), 2 * _DEGREE_FILLED)
    gap = np.arange(at - samples - _SMEARED, at + _SMEARED)
    known = np.concatenate([np.arange(max(gap[0] - side, 0), gap[0]), np.arange(gap[-1] + 1, gap[-1] + 1 + side)])
    known = known[known < values.shape[1]]
    usable = recording.usable
    through = np.polynomial.polynomial.polyfit((known - at) / side, values[usable][:, known].T, _DEGREE_FILLED)
    values[np.ix_(usable, gap)] = np.polynomial.polynomial.polyval((gap - at) / side, through)
    fault = Fault(
        "splice",
        recording.name,
        f"{what}, and are {1e3 * delay.value:.2f} ± {1e3 * delay.std:.2f} ms late there; that part was advanced",
        "Record with one filter throughout.",
    )
    return replace(recording, values=values, faults=(*recording.faults, fault))
