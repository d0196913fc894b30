"""Mode tracking: frequency, damping ratio and amplitude of one mode of the body through a decay, window by window."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sprung.display import shown
from sprung.vibration import Mode

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_PERIODS, _HOP = 1.5, 0.25
"""Periods in a window, and from one window to the next."""

_PER_PERIOD = 6.0
"""Samples per period of the fastest mode of which one window is made: neighbours are averaged."""

_TRIED = (1.0, 1.4, 2.0, 2.8)
"""Multiples of the frequency from which a window is fitted: where friction holds a suspension, it leaps."""

_DAMPED = (0.05, 0.25)
"""Damping ratios from which it is fitted."""

_SURE = 0.05
"""Relative standard uncertainty of a frequency beyond which a window is discarded."""

_LEAST, _MOST = -0.1, 0.8
"""Damping ratios between which a window shows a vibration."""


@shown
@dataclass(frozen=True, eq=False)
class AmplitudeCurve:
    """Frequency and damping ratio of one mode against amplitude in one decay.

    Neighbouring windows overlap by five sixths.

    Attributes
    ----------
    name
        The drop's.
    time
        Middle of each window, s after the first sample, shape (window,).
    amplitude
        Displacement where the body moves most, of all places with a sensor, m, shape (window,).
    frequency, frequency_std
        Undamped natural frequency and its standard uncertainty, Hz, shape (window,).
    damping_ratio, damping_ratio_std
        Damping ratio and its standard uncertainty, shape (window,).
    """

    name: str
    time: Real
    amplitude: Real
    frequency: Real
    frequency_std: Real
    damping_ratio: Real
    damping_ratio_std: Real


def follow_mode(
    name: str,
    record: Real,
    rate: float,
    noise: Real,
    modes: Sequence[Mode],
    which: int,
    largest: float,
    least: float = 0.0,
) -> AmplitudeCurve:
    """Follow one mode through a decay.

    Parameters
    ----------
    name
        The drop's.
    record
        Vertical, pitch and roll acceleration of the body, shape (3, time).
    rate
        Samples per second.
    noise
        Of each, shape (3,).
    modes
        Modes of the linear vehicle, with shapes in the seven coordinates.
    which
        Position of the mode to follow: its pole is free in each window; its shape, and poles and shapes of the other modes, are
        fixed.
    largest
        Displacement of the body, where it moves most, in one unit of that mode.
    least
        Amplitude at which to stop, m.

    Returns
    -------
    Trace

    Notes
    -----
    In each window the body is taken to accelerate as Re Σ b A e^{λt}, with complex amplitudes A and an offset eliminated as
    they are linear, so that a fit has two unknowns. Averaging neighbours changes no more than A. Uncertainties are those of
    least squares. A window is discarded where it has no more samples than unknowns, or where the frequency is an alias, above
    half the rate of its samples.
    """
    fastest = max(abs(mode.pole.imag) for mode in modes) / (2 * np.pi)
    every = max(round(rate / (_PER_PERIOD * fastest)), 1)
    count = record.shape[1] // every
    thin = record[:, : count * every].reshape(3, count, every).mean(axis=2) / noise[:, None]
    own, others = modes[which], [mode for i, mode in enumerate(modes) if i != which]
    time, step = (np.arange(count) + 0.5 * (1 - 1 / every)) * every / rate, every / rate
    found: list[tuple[float, ...]] = []
    begin, pole = 0.0, complex(own.pole)
    while True:
        length = max(int(_PERIODS * 2 * np.pi / (abs(pole) * step)), 4)
        first = round(begin / step)
        if first + length > count:
            break
        inside = slice(first, first + length)
        middle = float(time[inside].mean())
        starts = [pole, complex(own.pole)] if found else [pole]
        best, covariance, amplitude = _fit_window(
            thin[:, inside],
            time[inside] - middle,
            own.shape[:3] / noise,
            [mode.shape[:3] / noise for mode in others],
            [complex(mode.pole) for mode in others],
            starts,
        )
        found.append((middle, amplitude * largest, *_frequency_and_damping(best, covariance)))
        sure = found[-1][3] < _SURE * found[-1][2] and _LEAST < found[-1][4] < _MOST
        # A window of another length is taken where this one's frequency has another period.
        pole = best if sure else complex(own.pole)
        begin += _HOP * 2 * np.pi / abs(pole)
        if sure and found[-1][1] < least:
            break
    table = np.array(found).reshape(-1, 6)
    clear = (table[:, 3] < _SURE * table[:, 2]) & (table[:, 4] > _LEAST) & (table[:, 4] < _MOST)
    return AmplitudeCurve(name, *np.ascontiguousarray(table[clear].T))


def _fit_window(
    values: Real,
    time: Real,
    shape: Complex,
    other_shapes: Sequence[Complex],
    other_poles: Sequence[complex],
    starts: Sequence[complex],
) -> tuple[complex, Real | None, float]:
    """Fit the pole of one mode in one window by variable projection: offsets and the amplitudes of all modes are eliminated.

    Values, shape (3, time), and the shapes of the modes are in units of the noise; times count from the window's middle.
    Returns the pole, the covariance of its real and imaginary part, and the displacement in the middle; no covariance where
    the window has no more samples than unknowns, or where the pole is an alias.
    """
    offsets = np.kron(np.eye(3), np.ones((len(time), 1)))
    others = [_mode_columns(time, pole, own) for pole, own in zip(other_poles, other_shapes, strict=True)]
    fixed = np.column_stack([offsets, *others])
    sizes = np.linalg.norm(fixed, axis=0)
    left, singular, _ = np.linalg.svd(fixed[:, sizes > 0] / sizes[sizes > 0], full_matrices=False)
    basis = left[:, singular > 1e-6 * singular[0]]
    remaining = values.ravel() - basis @ (basis.T @ values.ravel())

    def project(pole: complex) -> tuple[Real, Real]:
        columns = _mode_columns(time, pole, shape)
        columns = columns - basis @ (basis.T @ columns)
        return columns, np.asarray(np.linalg.lstsq(columns, remaining, rcond=None)[0], dtype=float)

    def residual(x: Real) -> Real:
        columns, parts = project(complex(x[0], x[1]))
        return np.asarray(remaining - columns @ parts)

    tried = [
        np.array([-ratio * abs(pole) * times, abs(pole) * times])
        for pole in starts
        for times in _TRIED
        for ratio in _DAMPED
    ]
    order = np.argsort([float(np.sum(residual(start) ** 2)) for start in tried])[:2]
    size = abs(starts[0])
    ends = [least_squares(residual, tried[i], method="lm", x_scale=(size, size)) for i in order]
    end = min(ends, key=lambda solution: float(solution.cost))
    pole = complex(end.x[0], abs(end.x[1]))
    _, parts = project(pole)
    freedom = remaining.size - basis.shape[1] - 4
    if freedom <= 0 or pole.imag >= np.pi / (time[1] - time[0]):
        return pole, None, 0.0
    jacobian = np.asarray(end.jac, dtype=float)
    covariance = 2 * float(end.cost) / freedom * np.linalg.pinv(jacobian.T @ jacobian)
    in_middle = float(np.exp(-pole.real * _largest_at(time, pole)))
    return pole, covariance, float(np.hypot(*parts)) / abs(pole) ** 2 * in_middle


def _mode_columns(time: Real, pole: complex, shape: Complex) -> Real:
    """Return the motion of a mode for each of the two parts of its amplitude, shape (3 · time, 2)."""
    motion = shape[:, None] * np.exp(pole * (time - _largest_at(time, pole)))
    return np.column_stack([motion.real.ravel(), -motion.imag.ravel()])


def _largest_at(time: Real, pole: complex) -> float:
    """Return when a mode is largest, s: counted from there none overflows, and all have comparable columns."""
    return float(time[0] if pole.real < 0 else time[-1])


def _frequency_and_damping(pole: complex, covariance: Real | None) -> tuple[float, float, float, float]:
    """Return undamped frequency, Hz, and damping ratio of a pole, each with its standard uncertainty."""
    size = abs(pole)
    if covariance is None:
        return size / (2 * np.pi), np.inf, -pole.real / size, np.inf
    along = np.array([pole.real, pole.imag]) / size
    across = np.array([-(pole.imag**2), pole.real * pole.imag]) / size**3
    turn = 2 * np.pi
    return (
        size / turn,
        float(np.sqrt(along @ covariance @ along)) / turn,
        -pole.real / size,
        float(np.sqrt(across @ covariance @ across)),
    )
