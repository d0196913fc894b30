"""What of a drop is drawn: one lane per channel, with its scale, as few samples as show everything, and what is the matter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.checking import DropReport, PlottedRecording
from sprung.report.terminal.layout import figures

Real = NDArray[np.float64]

_FILLED = 0.86
"""Part of a lane that its signal takes at most."""

_LONGEST = 30
"""Letters of the longest name that is written out."""


@dataclass(frozen=True, eq=False)
class Lane:
    """One channel to draw.

    Attributes
    ----------
    name, notes, wrong
        What stands on its left, and on its right: the usual, and below it what is the matter.
    values
        Shape (time,), m/s²; NaN throughout where nothing can be shown.
    used
        Whether it is in the decay.
    marked
        Positions of samples with which something is the matter.
    middle, span
        What the lane's middle and height stand for, m/s².
    """

    name: str
    notes: tuple[str, ...]
    wrong: tuple[str, ...]
    values: Real
    used: bool
    marked: NDArray[np.int64]
    middle: float
    span: float

    def height(self, values: Real | float) -> Real:
        """Place values in a lane of height 1 around 0."""
        return np.asarray(_FILLED * (values - self.middle) / self.span)

    @property
    def ticks(self) -> Iterator[tuple[float, str]]:
        """Round values within the lane, and how to write them."""
        if not np.isfinite(self.values).any():
            return
        # From the span alone, so that lanes of one scale have the same steps.
        power = 10.0 ** np.floor(np.log10(self.span / 2))
        step = power * max(size for size in (1, 2, 5) if size * power <= self.span / 2 or size == 1)
        first, last = np.ceil((self.middle - self.span / 2) / step), np.floor((self.middle + self.span / 2) / step)
        for value in step * np.arange(first, last + 1) + 0.0:
            yield float(value), f"{value:g}".replace("-", "\N{MINUS SIGN}")


def lanes_of(drop: DropReport, recorded: PlottedRecording) -> list[Lane]:
    """Choose what to draw of each channel.

    Parameters
    ----------
    drop
        What is said of it.
    recorded
        Its whole recording.
    """
    lanes = [_lane(drop, channel, recorded) for channel in range(len(drop.channels))]
    # The channels of the body have one scale, and so have those of the wheels; what is left out has its own.
    groups = [
        report.on == "body" if lane.used or drop.start is None else None
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
    """Draw one channel, at a scale of its own."""
    report, values = drop.channels[channel], recorded.values[channel].astype(float)
    marks = [mark for mark in recorded.marks if mark.channel == channel]
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    counts = {mark.code: f"{mark.code}: {len(mark.samples)}" for mark in marks}
    wrong = [counts.get(code, code) for code in dict.fromkeys(report.faults)]
    notes = [] if report.noise is None else [f"noise {figures(report.noise, 2)}"]
    notes += [] if report.peak is None else [f"peak {figures(report.peak, 3)}"]
    if drop.start is not None and not report.used:
        notes, wrong = [], ["left out:", *wrong] if len(wrong) > 1 else [f"left out: {''.join(wrong)}"]
    return Lane(
        name=plain(report.name if len(report.name) <= _LONGEST else f"{report.name[: _LONGEST - 1]}…"),
        notes=tuple(notes),
        wrong=tuple(wrong),
        values=values,
        used=report.used,
        marked=np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(mark.samples for mark in marks)])),
        middle=(low + high) / 2,
        span=high - low,
    )


def thinned(values: Real, bins: int) -> NDArray[np.int64]:
    """Choose the samples that show as much of a signal as all of them do: the lowest and highest of each stretch.

    Parameters
    ----------
    values
        Shape (time,).
    bins
        Into how many stretches to part them.

    Returns
    -------
    ndarray
        Positions in increasing order; all of them where there are few, none where the signal has none.
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


def plain(text: str) -> str:
    """Replace what XML cannot hold.

    Parameters
    ----------
    text
        Any.
    """
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)
