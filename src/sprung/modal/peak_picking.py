"""Peak picking on the Fourier transform, with the half-power bandwidth for damping."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.shape_fit import fit_shapes
from sprung.modal.spectrum import Spectrum

Real = NDArray[np.float64]

_REFINEMENT = 8
"""Times the resolution of the records to which spectra are interpolated, by zeros behind them."""

_PROMINENT = 1.3
"""Least ratio of a peak to the lowest power between it and a higher one."""


def peak_picking(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes as the peaks of the summed spectra, with damping from the half-power bandwidth.

    Not exact, not even without noise: a peak of an acceleration lies beside the damped frequency once damping is high, and
    modes that are closer than their widths have one peak. The paper calls it P-P, and difficult on vehicles.

    Parameters
    ----------
    records, rate
        As for `eigensystem_realisation`.
    order
        Twice the number of peaks, the highest first; unless given all that exceed the noise.

    Returns
    -------
    ModeSet
        Of the peaks with a width at half power; the others are rejected.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.
    """
    task = IdentificationTask.of(records, rate, order, "peaks")
    values = [record / task.decimated.scale[:, None] for record in task.decays.values]
    length = _REFINEMENT * max(record.shape[1] for record in values)
    spectrum = Spectrum.of(values, rate)
    transforms = [np.abs(np.fft.rfft(record, length)) ** 2 / record.shape[1] for record in values]
    power = np.sum([transform.sum(axis=0) for transform in transforms], axis=0)
    noise = float(len(values) * np.sum(spectrum.floor))
    step = rate / length
    poles, rejected = [], []
    for top in _find_peaks(power, 4 * noise)[: task.order if order is None else max(order // 2, 1)]:
        low, high = _half_power(power, top)
        if low is None or high is None:
            rejected.append(
                RejectedPole(2j * np.pi * top * step, "no half-power bandwidth: a neighbouring peak covers it")
            )
            continue
        ratio = min((high - low) / (2 * top), 0.99)
        poles.append(2 * np.pi * top * step * complex(-ratio / np.sqrt(1 - ratio**2), 1.0))
    if not poles:
        return ModeSet((), tuple(rejected), "peaks")
    found = task.modes(fit_shapes(task.decimated, np.array([pole / rate for pole in poles], dtype=complex)))
    return ModeSet(found.modes, (*rejected, *found.rejected), "peaks")


def _find_peaks(power: Real, least: float) -> list[int]:
    """Find prominent local maxima above a power, the highest first."""
    inner = power[1:-1]
    tops = np.flatnonzero((inner > power[:-2]) & (inner >= power[2:]) & (inner > least)) + 1
    kept: list[int] = []
    for top in tops[np.argsort(-power[tops])].tolist():
        between = [power[min(top, higher) : max(top, higher)].min() for higher in kept]
        if all(power[top] > _PROMINENT * lowest for lowest in between):
            kept.append(top)
    return kept


def _half_power(power: Real, top: int) -> tuple[float | None, float | None]:
    """Return the bins at which power falls to half that of a peak on either side; None where it rises again before."""
    half = power[top] / 2
    below = np.flatnonzero(power[:top][::-1] <= half)
    above = np.flatnonzero(power[top:] <= half)
    low = top - 1 - int(below[0]) if below.size else None
    high = top + int(above[0]) if above.size else None
    if low is not None and (power[low:top] > power[top]).any():
        low = None
    if high is not None and (power[top:high] > power[top]).any():
        high = None
    return (
        None if low is None else low + float((half - power[low]) / (power[low + 1] - power[low])),
        None if high is None else high - float((half - power[high]) / (power[high - 1] - power[high])),
    )
