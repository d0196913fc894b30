"""Finding the drops in a long recording: hours of quiet, of people at work around the vehicle, and now and then a drop.

The recording is taken piece by piece, and only its last seconds are kept. Averages over some milliseconds tell where
anything begins to move; there, and only there, the samples themselves are looked at (`sprung.drafting.classification`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sprung.drafting.classification import AFTER, BEFORE, Fall, classify_event
from sprung.drafting.detected_drop import DetectedDrop, SensorPlace, assign_dropped_wheels, is_on_wheel
from sprung.preprocess import BLOW, SlowMotion
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Sensor

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

_TOLD = 100
"""Events that are no drops which are told one by one, the largest of the recording."""


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
    """What a recording holds.

    Attributes
    ----------
    drops
        In the order of time.
    refused
        The largest of the other events, each with the reason why it is no drop, in the order of time.
    events
        How many other events there were.
    """

    drops: tuple[DetectedDrop, ...]
    refused: tuple[RejectedEvent, ...] = ()
    events: int = 0


def drops_in(
    values: Real, rate: float, sensors: Sequence[Sensor | None] | None = None, start: float = 0.0
) -> tuple[DetectedDrop, ...]:
    """Find the drops in a recording that is in memory.

    Parameters
    ----------
    values
        Shape (channel, time), m/s², positive up where the sensor feels gravity; NaN where there is nothing.
    rate
        Samples per second.
    sensors
        One for each channel, None for one that is unknown; left out, all of them are.
    start
        Time of the first sample on the file's clock, s.

    Returns
    -------
    tuple of FoundDrop
    """
    places = None if sensors is None else [None if sensor is None else sensor.on for sensor in sensors]
    return detect_drops([(0, values)], rate, places, start=start, samples=values.shape[1]).drops


def detect_drops(
    pieces: Iterable[tuple[int, Real]],
    rate: float,
    places: Sequence[SensorPlace | None] | None = None,
    *,
    start: float = 0.0,
    samples: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> Detection:
    """Find the drops in a recording of any length.

    Parameters
    ----------
    pieces
        Its pieces in order: index of the first sample, and readings of shape (channel, time), m/s², positive up where the
        sensor feels gravity; NaN where there is nothing.
    rate
        Samples per second.
    places
        Where each channel's sensor sits; None for one that is unknown. Left out, all of them are.
    start
        Time of the first sample on the file's clock, s.
    samples
        How many there are in all, for the progress.
    progress
        Called with the part that is done, 0 to 1.

    Returns
    -------
    Found

    Notes
    -----
    Memory does not grow with the length of the recording: some fifteen seconds and one piece are kept.
    """
    wheels = None if places is None or None in places else np.array([place != "body" for place in places])
    drops: list[DetectedDrop] = []
    refused = _Refused()
    searched = clear = 0
    for origin, buffer, final in _stretches(pieces, rate):
        end = origin + buffer.shape[1] - (0 if final else int(AFTER * rate) + 1)
        for event in (origin + _events(buffer, rate)).tolist():
            if not searched <= event < end:
                continue
            first = max(clear, origin)
            judged = classify_event(buffer[:, first - origin :], rate, event - first, wheels)
            if isinstance(judged, Fall):
                drops.append(_drop(judged, first, start, rate, buffer[:, first - origin :]))
                searched, clear = (
                    first + judged.last + 1,
                    first + min(judged.landing + int(_LANDED * rate), judged.last),
                )
            else:
                refused.add(RejectedEvent(start + event / rate, judged), _size(buffer, event - origin, rate))
        searched = max(searched, end)
        if progress is not None and samples:
            progress(min(1.0, (origin + buffer.shape[1]) / samples))
    told = assign_dropped_wheels(drops, places)
    kept = tuple(_without_a_fall(told, is_on_wheel(told, places), refused))
    return Detection(kept, refused.largest, refused.count)


def _drop(fall: Fall, first: int, start: float, rate: float, values: Real) -> DetectedDrop:
    begin, release, landing, faded, end = (
        start + (first + sample) / rate for sample in (fall.first, fall.release, fall.landing, fall.faded, fall.last)
    )
    slow = SlowMotion.of(values[:, : fall.last + 1], rate, fall.release, fall.seen.level)
    return DetectedDrop(begin, release, landing, faded, end, fall.ended, fall.seen, slow=slow)


def _without_a_fall(drops: Sequence[DetectedDrop], sit: NDArray[np.bool_], refused: _Refused) -> Iterator[DetectedDrop]:
    """Take out the drops in which only the body moved, though there are sensors on wheels."""
    for drop in drops:
        if drop.dropped_channels or not sit.any():
            yield drop
            continue
        deepest = np.nanmax(drop.seen.depth[sit], initial=0.0) / STANDARD_GRAVITY
        why = f"the body moves and no wheel falls: the deepest reading of a wheel is {deepest:.2g} g below rest"
        refused.add(RejectedEvent(drop.release, why), float(np.nanmax(drop.seen.peak)))


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
    """Give the samples that are averaged to see where anything begins to move."""
    return max(round(BLOW * rate), 1)


def _events(values: Real, rate: float) -> NDArray[np.int64]:
    """Give the samples at which anything begins to move after a pause."""
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
    """Give the largest reading of an event off its beginning, m/s²."""
    stretch = values[:, event : event + max(int(_LEVEL * rate), 2)]
    return float(np.nan_to_num(np.abs(stretch - stretch[:, :1])).max(initial=0.0))


@dataclass
class _Refused:
    """Collects what is no drop: events close together are one, and only the largest are kept."""

    count: int = 0
    kept: list[tuple[float, RejectedEvent]] = field(default_factory=list)
    until: float = -np.inf

    def add(self, refusal: RejectedEvent, size: float) -> None:
        near = refusal.time - self.until <= _TOGETHER
        self.until = max(self.until, refusal.time)
        if near and self.kept:
            if size > self.kept[-1][0]:
                self.kept[-1] = (size, refusal)
            return
        self.count += 1
        self.kept.append((size, refusal))
        if len(self.kept) > 2 * _TOLD:
            self.kept = self._largest()

    def _largest(self) -> list[tuple[float, RejectedEvent]]:
        ranked = sorted(self.kept, key=lambda one: one[0], reverse=True)[:_TOLD]
        return sorted(ranked, key=lambda one: one[1].time)

    @property
    def largest(self) -> tuple[RejectedEvent, ...]:
        return tuple(refusal for _, refusal in self._largest())
