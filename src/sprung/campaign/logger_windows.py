"""The window of a drop in the recordings of several loggers: stated on the clock of the first one, found on the others'."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate

from sprung.campaign.recording import Recording

Real = NDArray[np.float64]

_STEP = 0.02
"""Resolution of the clock offsets, s: a window is much longer, and the release resolves the rest."""

_MARGIN = 0.1
"""s by which the windows of the other loggers are longer at each end."""


def cut_to_window(parts: Sequence[Recording], window: tuple[float, float]) -> tuple[Recording, ...]:
    """Cut the recordings of several loggers to one window.

    Parameters
    ----------
    parts
        The recording of each logger, on its own clock.
    window
        Beginning and end, s, on the clock of the first.

    Returns
    -------
    tuple of Recording

    Notes
    -----
    All loggers recorded the same motion, whatever the offsets of their clocks. Their activities in short steps of time agree
    but for a shift, at which their cross-correlation is largest.
    """
    first, *others = parts
    activity = _activity(first)
    start, end = window
    cut = [_cut(first, start, end)]
    for part in others:
        offset = part.start - first.start + _shift(activity, _activity(part))
        cut.append(_cut(part, start + offset - _MARGIN, end + offset + _MARGIN))
    return tuple(cut)


def _cut(part: Recording, start: float, end: float) -> Recording:
    begin, stop = (round((moment - part.start) * part.rate) for moment in (start, end))
    begin, stop = max(begin, 0), max(stop + 1, 0)
    return replace(part, values=part.values[:, begin:stop], start=part.start + begin / part.rate)


def _activity(part: Recording) -> Real:
    """Return the centred logarithm of a logger's activity, its mean change per sample in steps of `_STEP`; shape (step,)."""
    changes = np.abs(np.diff(part.values[part.usable], axis=1)).sum(axis=0)
    steps = (np.arange(changes.size) / part.rate / _STEP).astype(np.int64)
    count = np.maximum(np.bincount(steps), 1) if changes.size else np.ones(1)
    mean: Real = (np.bincount(steps, weights=changes) if changes.size else np.zeros(1)) / count
    usual = float(np.median(mean)) or 1.0
    activity = np.log1p(mean / usual)
    centred: Real = activity - activity.mean()
    return centred


def _shift(first: Real, second: Real) -> float:
    """Return the lag of the second activity behind the first at the maximum of their cross-correlation, s."""
    correlation = correlate(second, first, mode="full", method="fft")
    return (int(np.argmax(correlation)) - (first.size - 1)) * _STEP
