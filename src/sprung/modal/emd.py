"""Empirical mode decomposition with the Hilbert transform."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import hilbert

from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.shape_fit import fit_shapes

Real = NDArray[np.float64]

_SIFTS, _SETTLED = 12, 0.05
"""Largest number of siftings, and the relative change of the motion at which sifting stops."""

_REFINEMENT = 4
"""Times the samples in a period that other methods work with."""

_MOTIONS = 6
"""Largest number of intrinsic motions of a channel."""

_UPPER, _LOWER = 0.9, 0.1
"""Parts of the largest amplitude between which the decay is fitted."""

_STRAIGHT = 0.9
"""Squared correlation that the logarithm of an amplitude must have with time to be a decay."""

_ALIKE = 0.2
"""Part of a frequency within which motions belong to one mode."""


def empirical_mode_decomposition(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify modes from the intrinsic mode functions of each channel, by the phase and amplitude of their analytic signals.

    Not exact, not even without noise: sifting separates motions that are more than an octave apart and last for several
    periods, and the Hilbert transform of a record that begins with its largest motion is wrong there. On vehicles it finds the
    body and the wheels as one motion each.

    Parameters
    ----------
    records, rate
        As for `eigensystem_realisation`.
    order
        Twice the number of modes, those of the most energy first; unless given all.

    Returns
    -------
    ModeSet
        Motions of several channels and records of about one frequency count as one, energies as weights.

    Raises
    ------
    InputError
        As `eigensystem_realisation`.

    References
    ----------
    N. E. Huang et al., Proc. R. Soc. Lond. A 454 (1998) 903; free vibrations after J. N. Yang, Y. Lei, S. Pan and N. Huang,
    Earthq. Eng. Struct. Dyn. 32 (2003) 1443.
    """
    task = IdentificationTask.of(records, rate, order, "emd")
    # Envelopes need more samples per period than poles.
    every = max(task.decimated.every // _REFINEMENT, 1)
    found = []
    for record in task.decays.values:
        count = record.shape[1] // every
        means = record[:, : count * every].reshape(len(record), count, every).mean(axis=2)
        for channel in means / np.maximum(np.linalg.norm(means, axis=1, keepdims=True), 1e-300):
            for motion in _intrinsic(channel):
                pole = _decay(motion)
                if pole is not None:
                    found.append((pole, float((motion**2).sum())))
    # Motions of one frequency are merged, the strongest first.
    poles, weights = [], []
    found.sort(key=lambda pair: -pair[1])
    while found:
        first = abs(found[0][0].imag)
        alike = [pair for pair in found if abs(pair[0].imag - first) < _ALIKE * first]
        found = [pair for pair in found if abs(pair[0].imag - first) >= _ALIKE * first]
        weight = np.array([energy for _, energy in alike])
        poles.append(complex(weight @ np.array([pole for pole, _ in alike]) / weight.sum()))
        weights.append(float(weight.sum()))
    kept = [pole for pole, weight in zip(poles, weights, strict=True) if weight > 1e-3 * max(weights)]
    kept = kept[: len(kept) if order is None else max(order // 2, 1)]
    rejected = tuple(
        RejectedPole(
            pole * rate / every,
            "its motion is too weak, or beyond the order",
        )
        for pole in poles
        if pole not in kept
    )
    if not kept:
        return ModeSet((), rejected, "emd")
    modes = task.modes(fit_shapes(task.decimated, np.array([pole / every for pole in kept], dtype=complex)))
    return ModeSet(modes.modes, (*rejected, *modes.rejected), "emd")


def _intrinsic(values: Real) -> Iterator[Real]:
    """Sift a channel into its intrinsic motions, the fastest first."""
    left = values
    for _ in range(_MOTIONS):
        motion = left
        for _ in range(_SIFTS):
            middle = _mean_envelope(motion)
            if middle is None:
                return
            motion = motion - middle
            if float((middle**2).sum()) < _SETTLED**2 * float((motion**2).sum()):
                break
        yield motion
        left = left - motion


def _mean_envelope(values: Real) -> Real | None:
    """Return the mean of the envelopes through maxima and minima, mirrored at the ends; None with too few of either."""
    inner = values[1:-1]
    time = np.arange(len(values))
    sides = []
    for sign in (1, -1):
        tops = np.flatnonzero((sign * inner > sign * values[:-2]) & (sign * inner >= sign * values[2:])) + 1
        if len(tops) < 3:
            return None
        at = np.concatenate([-tops[1::-1], tops, 2 * len(values) - tops[:-3:-1]])
        heights = np.concatenate([values[tops[1::-1]], values[tops], values[tops[:-3:-1]]])
        at, once = np.unique(at, return_index=True)
        sides.append(CubicSpline(at, heights[once])(time))
    return np.asarray((sides[0] + sides[1]) / 2, dtype=float)


def _decay(motion: Real) -> complex | None:
    """Fit frequency and decay rate, per sample, to the analytic signal of a motion, while it falls."""
    signal = np.asarray(hilbert(motion))
    amplitude = np.abs(signal)
    begin = int(np.argmax(amplitude))
    falling = amplitude[begin:]
    below = np.flatnonzero(falling < _LOWER * falling[0])
    end = begin + (int(below[0]) if below.size else len(falling))
    start = begin + int(np.argmax(falling < _UPPER * falling[0]))
    if end - start < 8:
        return None
    time = np.arange(start, end)
    slope = np.polyfit(time, np.log(np.maximum(amplitude[start:end], 1e-300)), 1)[0]
    straight = np.corrcoef(time, np.log(np.maximum(amplitude[start:end], 1e-300)))[0, 1] ** 2
    speed = np.polyfit(time, np.unwrap(np.angle(signal[start:end])), 1)[0]
    turned = abs(speed) * (end - start)
    if not (slope < 0 and straight > _STRAIGHT and turned > np.pi and abs(speed) < np.pi):
        return None
    return complex(float(slope), abs(float(speed)))
