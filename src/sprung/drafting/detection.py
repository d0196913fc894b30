"""Detection of drops in a long recording: hours of quiet, of people at work around the vehicle, and now and then a drop.

The recording is read piece by piece, and only its last seconds are kept. Averages over some milliseconds show where
anything begins to move; only there the samples themselves are examined (`sprung.drafting.classification`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.drafting.classification import AFTER, BEFORE, DropEvent, classify_event
from sprung.drafting.detected_drop import DetectedDrop, assign_dropped_wheels, is_on_wheel
from sprung.preprocess import BLOW, extract_slow_motion
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import SensorPlace

Real = NDArray[np.float64]

_MOVES = 2.0
"""m/s² off its level at which a channel begins to move; the slightest drop moves wheels ten times as much."""

_LEVEL, _SINCE = 0.3, 0.02
"""s before a moment over which its level is taken, and s that are left out directly before it."""

_PAUSE = 0.06
"""s of quiet after which what moves is another event."""

_LANDED = 1.0
"""s after a landing from which another rest may be looked for, though the body may still swing a little."""

_PIECE = 20.0
"""s that are looked at together at least."""

_TOGETHER = 1.0
"""s within which events that are no drops count as one."""

_MOST_REJECTED = 100
"""Events that are no drops which are reported one by one, the largest of the recording."""


@dataclass(frozen=True)
class RejectedEvent:
    """An event that is no drop.

    Attributes
    ----------
    time
        s on the file's clock.
    why
        The reason, with the numbers.
    """

    time: float
    why: str


@dataclass(frozen=True)
class Detection:
    """The drops of a recording, and what else happened in it.

    Attributes
    ----------
    drops
        In the order of time.
    rejected
        The largest of the other events, each with the reason why it is no drop, in the order of time.
    events
        How many other events there were.
    """

    drops: tuple[DetectedDrop, ...]
    rejected: tuple[RejectedEvent, ...] = ()
    events: int = 0


def detect_drops(
    pieces: Iterable[tuple[int, Real]],
    rate: float,
    places: Sequence[SensorPlace | None] | None = None,
    *,
    start: float = 0.0,
    samples: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> Detection:
    """Detect the drops in a recording of any length.

    Parameters
    ----------
    pieces
        Its pieces in order: index of the first sample, and readings of shape (channel, time), m/s², positive up where the
        sensor reads gravity; NaN where there is nothing.
    rate
        Samples per second.
    places
        Where each channel's sensor sits, None for one that is unknown; by default all of them are.
    start
        Time of the first sample on the file's clock, s.
    samples
        Number of samples in all, for the progress.
    progress
        Called with the part that is done, 0 to 1.

    Returns
    -------
    Detection

    Notes
    -----
    Memory does not grow with the length of the recording: some fifteen seconds and one piece are kept.
    """
    wheels = None if places is None or None in places else np.array([place != "body" for place in places])
    drops: list[DetectedDrop] = []
    rejected: list[tuple[float, RejectedEvent]] = []
    searched = undisturbed = 0
    for origin, buffer, final in _stretches(pieces, rate):
        end = origin + buffer.shape[1] - (0 if final else int(AFTER * rate) + 1)
        for event in (origin + _find_events(buffer, rate)).tolist():
            if not searched <= event < end:
                continue
            first = max(undisturbed, origin)
            values = buffer[:, first - origin :]
            result = classify_event(values, rate, event - first, wheels)
            if isinstance(result, DropEvent):
                drops.append(_detected_drop(result, first, start, rate, values))
                searched = first + result.last + 1
                undisturbed = first + min(result.landing + int(_LANDED * rate), result.last)
            else:
                rejected.append((_size(buffer, event - origin, rate), RejectedEvent(start + event / rate, result)))
        searched = max(searched, end)
        if progress is not None and samples:
            progress(min(1.0, (origin + buffer.shape[1]) / samples))
    assigned = assign_dropped_wheels(drops, places)
    on_wheel = is_on_wheel(assigned, places)
    kept = tuple(drop for drop in assigned if drop.dropped_channels or not on_wheel.any())
    rejected += [_without_wheels(drop, on_wheel) for drop in assigned if drop not in kept]
    return Detection(kept, *_largest(rejected))


def _detected_drop(event: DropEvent, first: int, start: float, rate: float, values: Real) -> DetectedDrop:
    samples = (event.first, event.release, event.landing, event.faded, event.last)
    begin, release, landing, faded, end = (start + (first + sample) / rate for sample in samples)
    slow = extract_slow_motion(values[:, : event.last + 1], rate, event.release, event.features.level)
    return DetectedDrop(begin, release, landing, faded, end, event.why_end, event.features, slow_motion=slow)


def _without_wheels(drop: DetectedDrop, on_wheel: NDArray[np.bool_]) -> tuple[float, RejectedEvent]:
    """Return size and reason of an event in which only the body moved, though there are sensors on wheels."""
    lowest = np.nanmax(drop.features.depth[on_wheel], initial=0.0) / STANDARD_GRAVITY
    why = f"the body moves and no wheel falls: the lowest reading of a wheel is {lowest:.2g} g below rest"
    return float(np.nanmax(drop.features.peak)), RejectedEvent(drop.release, why)


def _largest(rejected: Sequence[tuple[float, RejectedEvent]]) -> tuple[tuple[RejectedEvent, ...], int]:
    """Return the largest of the events that are no drops, in the order of time, and the number of all; close ones are one."""
    groups: list[list[tuple[float, RejectedEvent]]] = []
    for size, event in sorted(rejected, key=lambda item: item[1].time):
        if groups and event.time - groups[-1][-1][1].time <= _TOGETHER:
            groups[-1].append((size, event))
        else:
            groups.append([(size, event)])
    events = [max(group, key=lambda item: item[0]) for group in groups]
    largest = sorted(events, key=lambda item: item[0], reverse=True)[:_MOST_REJECTED]
    return tuple(sorted((event for _, event in largest), key=lambda event: event.time)), len(groups)


def _stretches(pieces: Iterable[tuple[int, Real]], rate: float) -> Iterator[tuple[int, Real, bool]]:
    """Join pieces to stretches that overlap by what a drop needs: index of the first sample, readings, whether the last."""
    kept, fresh, width = int((BEFORE + 1 + AFTER) * rate) + 2, int(_PIECE * rate), _bin(rate)
    waiting: list[Real] = []
    origin = new = 0
    for index, piece in pieces:
        if not waiting:
            origin = index
        waiting.append(np.asarray(piece, dtype=float))
        new += piece.shape[1]
        if new >= fresh:
            buffer = np.concatenate(waiting, axis=1)
            yield origin, buffer, False
            # Bins begin at the same samples in every stretch, so that an event belongs to exactly one.
            begin = max((origin + buffer.shape[1] - kept) // width * width, origin)
            tail = buffer[:, begin - origin :]
            origin = begin
            waiting, new = [tail], 0
    if waiting:
        yield origin, np.concatenate(waiting, axis=1), True


def _bin(rate: float) -> int:
    """Return how many samples are averaged to see where anything begins to move."""
    return max(round(BLOW * rate), 1)


def _find_events(values: Real, rate: float) -> NDArray[np.int64]:
    """Return the samples at which anything begins to move after a pause."""
    width = _bin(rate)
    bins = values.shape[1] // width
    there = np.isfinite(values[:, : bins * width]).reshape(len(values), bins, width)
    count = there.sum(axis=2)
    whole = np.where(there, values[:, : bins * width].reshape(there.shape), 0.0).sum(axis=2)
    mean = whole / np.maximum(count, 1)
    sums, counts = (
        np.concatenate([np.zeros((len(values), 1)), np.cumsum(each, axis=1)], axis=1) for each in (whole, count)
    )
    bin_ = np.arange(bins)
    until = np.maximum(bin_ - max(round(_SINCE / width * rate), 1), 0)
    since = np.maximum(until - max(round(_LEVEL / width * rate), 1), 0)
    number = counts[:, until] - counts[:, since]
    level = (sums[:, until] - sums[:, since]) / np.maximum(number, 1)
    moves = ((np.abs(mean - level) > _MOVES) & (count > 0) & (number > 0)).any(axis=0)
    pause = max(round(_PAUSE / width * rate), 1)
    moved = np.concatenate([np.zeros(pause + 1, dtype=int), np.cumsum(moves)])
    recent = moved[pause : pause + bins] - moved[:bins]
    return np.flatnonzero(moves & (recent == 0)) * width


def _size(values: Real, event: int, rate: float) -> float:
    """Largest reading of an event off its beginning, m/s²."""
    stretch = values[:, event : event + max(int(_LEVEL * rate), 2)]
    return float(np.nan_to_num(np.abs(stretch - stretch[:, :1])).max(initial=0.0))
