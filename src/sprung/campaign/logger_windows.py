"""The window of a drop in what several loggers recorded all day: stated on the first one's clock, found on the others'."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate

from sprung.campaign.recording import Recording

Real = NDArray[np.float64]

_STEP = 0.02
"""s to which it is told how the clocks stand: a window is longer by far, and the release tells the rest."""

_MARGIN = 0.1
"""s by which the others' windows are longer at each end."""


def cut_to_window(parts: Sequence[Recording], window: tuple[float, float]) -> tuple[Recording, ...]:
    """Cut the recordings of several loggers to one window.

    Parameters
    ----------
    parts
        What each of them recorded, on its own clock.
    window
        From when to when, s on the clock of the first.

    Returns
    -------
    tuple of Recording

    Notes
    -----
    However far the clocks stand apart, all loggers saw the same day: where the one moved, the others did. How long and how
    strongly each moved, in short steps of time, is the same in all of them but for a shift, that of their best correlation.
    """
    first, *others = parts
    lively = _liveliness(first)
    start, end = window
    cut = [_cut(first, start, end)]
    for part in others:
        ahead = part.start - first.start + _shift(lively, _liveliness(part))
        cut.append(_cut(part, start + ahead - _MARGIN, end + ahead + _MARGIN))
    return tuple(cut)


def _cut(part: Recording, start: float, end: float) -> Recording:
    begin, stop = (round((moment - part.start) * part.rate) for moment in (start, end))
    begin, stop = max(begin, 0), max(stop + 1, 0)
    return replace(part, values=part.values[:, begin:stop], start=part.start + begin / part.rate)


def _liveliness(part: Recording) -> Real:
    """Return the centred logarithm of a logger's activity, its mean change per sample in steps of `_STEP`; shape (step,)."""
    changes = np.abs(np.diff(part.values[part.usable], axis=1)).sum(axis=0)
    steps = (np.arange(changes.size) / part.rate / _STEP).astype(np.int64)
    count = np.maximum(np.bincount(steps), 1) if changes.size else np.ones(1)
    mean: Real = (np.bincount(steps, weights=changes) if changes.size else np.zeros(1)) / count
    usual = float(np.median(mean)) or 1.0
    lively = np.log1p(mean / usual)
    centred: Real = lively - lively.mean()
    return centred


def _shift(one: Real, other: Real) -> float:
    """Return the lag of the second activity behind the first at the maximum of their cross-correlation, s."""
    alike = correlate(other, one, mode="full", method="fft")
    return (int(np.argmax(alike)) - (one.size - 1)) * _STEP
