"""Lanes of a recording: one per channel, with its scale, notes and faulty samples."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.checking import DropReport, PlottedRecording
from sprung.report.terminal.layout import significant_figures

Real = NDArray[np.float64]

_FILLED = 0.86
"""Largest part of a lane that its signal fills."""

_LONGEST = 30
"""Letters of a name that are shown at most."""


@dataclass(frozen=True, eq=False)
class Lane:
    """One channel of a recording, as it is drawn.

    Attributes
    ----------
    name, notes, warnings
        Text on its left, and on its right: noise and peak, and below them the faults.
    values
        Shape (time,), in its unit; all NaN where the channel cannot be drawn.
    used
        Whether it is used in the free decay.
    marked
        Indices of faulty samples.
    middle, span
        Values at the middle of the lane, and over its height, in its unit.
    unit
        Of its values.
    """

    name: str
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    values: Real
    used: bool
    marked: NDArray[np.int64]
    middle: float
    span: float
    unit: str

    def height(self, values: Real | float) -> Real:
        """Return positions of values in a lane of height 1 around 0."""
        return np.asarray(_FILLED * (values - self.middle) / self.span)

    @property
    def ticks(self) -> Iterator[tuple[float, str]]:
        """Round values within the lane, with their labels."""
        if not np.isfinite(self.values).any():
            return
        # The step depends on the span alone, so that lanes of one scale have equal steps.
        power = 10.0 ** np.floor(np.log10(self.span / 2))
        step = power * max(size for size in (1, 2, 5) if size * power <= self.span / 2 or size == 1)
        first, last = np.ceil((self.middle - self.span / 2) / step), np.floor((self.middle + self.span / 2) / step)
        for value in step * np.arange(first, last + 1) + 0.0:
            yield float(value), f"{value:g}".replace("-", "\N{MINUS SIGN}")


def lanes_of(drop: DropReport, recorded: PlottedRecording) -> list[Lane]:
    """Return the lane of each channel.

    Parameters
    ----------
    drop
        Report of the drop.
    recorded
        Its whole recording.
    """
    lanes = [_lane(drop, channel, recorded) for channel in range(len(drop.channels))]
    # Channels of the body that measure the same share one scale, those of the wheels another; channels left out have their own.
    groups = [
        (report.on == "body", lane.unit) if lane.used or drop.start is None else None
        for report, lane in zip(drop.channels, lanes, strict=True)
    ]
    largest = {
        group: max(lane.span for lane, own in zip(lanes, groups, strict=True) if own == group) for group in set(groups)
    }
    return [
        replace(lane, span=(lane.span if group is None else largest[group]) or 1.0)
        for lane, group in zip(lanes, groups, strict=True)
    ]


def _lane(drop: DropReport, channel: int, recorded: PlottedRecording) -> Lane:
    """Return the lane of one channel, with a scale of its own."""
    report, values = drop.channels[channel], recorded.values[channel].astype(float)
    marks = [mark for mark in recorded.marks if mark.channel == channel]
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    counts = {mark.code: f"{mark.code}: {len(mark.samples)}" for mark in marks}
    warnings = [counts.get(code, code) for code in dict.fromkeys(report.faults)]
    notes = [] if report.noise is None else [f"noise {significant_figures(report.noise, 2)}"]
    notes += [] if report.peak is None else [f"peak {significant_figures(report.peak, 3)}"]
    if drop.start is not None and not report.used:
        notes, warnings = [], ["left out:", *warnings] if len(warnings) > 1 else [f"left out: {''.join(warnings)}"]
    return Lane(
        name=printable(report.name if len(report.name) <= _LONGEST else f"{report.name[: _LONGEST - 1]}…"),
        notes=tuple(notes),
        warnings=tuple(warnings),
        values=values,
        used=report.used,
        marked=np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(mark.samples for mark in marks)])),
        middle=(low + high) / 2,
        span=high - low,
        unit=report.unit,
    )


def thin_out(values: Real, bins: int) -> NDArray[np.int64]:
    """Return indices of the lowest and the highest sample of each of many intervals, which look like all samples.

    Parameters
    ----------
    values
        Shape (time,).
    bins
        Number of intervals.

    Returns
    -------
    ndarray
        Indices in increasing order; all where there are few, none where all values are NaN.
    """
    if np.isnan(values).all():
        return np.empty(0, dtype=np.int64)
    if values.size <= 4 * bins:
        return np.arange(values.size)
    edges = np.linspace(0, values.size, bins + 1).astype(np.int64)
    width = int(np.diff(edges).max())
    places = np.minimum(edges[:-1, None] + np.arange(width), edges[1:, None] - 1)
    among = values[places]
    rows = np.arange(bins)
    low, high = np.where(np.isnan(among), np.inf, among), np.where(np.isnan(among), -np.inf, among)
    chosen = [places[rows, low.argmin(axis=1)], places[rows, high.argmax(axis=1)], [0, values.size - 1]]
    return np.unique(np.concatenate(chosen))


def printable(text: str) -> str:
    """Return a text with the characters replaced that XML cannot hold.

    Parameters
    ----------
    text
        Any.
    """
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)
