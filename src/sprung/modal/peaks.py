"""Peaks of Fourier spectra near modes, as in the paper's Table 3."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.vibration import Mode

Real = NDArray[np.float64]

_REFINEMENT = 8
"""Times the resolution of the longest record to which spectra are interpolated, by zeros behind the records."""

_NEAR, _WIDTHS, _LINES = 0.25, 3.0, 2.0
"""How far from a mode's damped frequency its peak may lie: that part of it, or where that is less so many times its damping
ratio, or so many lines of the transform."""


def find_spectral_peaks(records: Sequence[ArrayLike], rate: float, modes: Sequence[Mode]) -> tuple[float | None, ...]:
    """Find the peak of each mode in the Fourier transform of the records projected on its shape.

    The records are projected on the real part of the mode's shape, as the paper transforms vertical, pitch and roll
    acceleration each on its own (figures 4 to 6), and the power of all records is added up.

    Parameters
    ----------
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    modes
        With shapes at the channels.

    Returns
    -------
    tuple of float or None
        Hz; None for a mode without a peak of its own near its damped frequency, as the paper's pitch.
    """
    arrays = [np.asarray(record, dtype=float) for record in records]
    arrays = [record - record.mean(axis=1, keepdims=True) for record in arrays]
    length = _REFINEMENT * max(record.shape[1] for record in arrays)
    found: list[float | None] = []
    for mode in modes:
        pattern = mode.shape.real / np.linalg.norm(mode.shape)
        motion = [np.abs(np.fft.rfft(pattern @ record, length)) ** 2 for record in arrays]
        within = max(
            min(_NEAR, _WIDTHS * mode.damping_ratio) * mode.damped_frequency, _LINES * _REFINEMENT * rate / length
        )
        found.append(find_peak_near(np.sum(motion, axis=0), rate / length, mode.damped_frequency, within))
    return tuple(found)


def find_peak_near(power: Real, step: float, frequency: float, within: float) -> float | None:
    """Return the highest local maximum of a spectrum near a frequency, interpolated by a parabola; Hz.

    Parameters
    ----------
    power
        Shape (bin,).
    step
        From bin to bin, Hz.
    frequency, within
        Hz.
    """
    inner = power[1:-1]
    tops = np.flatnonzero((inner > power[:-2]) & (inner >= power[2:])) + 1
    near = tops[np.abs(tops * step - frequency) <= within]
    if not near.size or frequency == 0:
        return None
    top = int(near[np.argmax(power[near])])
    before, here, after = np.log(np.maximum(power[top - 1 : top + 2], 1e-300))
    bend = before - 2 * here + after
    return float((top + (0.5 * (before - after) / bend if bend < 0 else 0.0)) * step)
