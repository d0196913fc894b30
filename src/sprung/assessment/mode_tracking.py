"""One mode of the body followed through a decay: its frequency, damping ratio and amplitude, window by window."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

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
"""Standard uncertainty of a frequency, as a part, beyond which a window tells nothing."""

_LEAST, _MOST = -0.1, 0.8
"""Damping ratios between which a window shows a vibration."""


@shown
@dataclass(frozen=True, eq=False)
class AmplitudeCurve:
    """One mode through one decay. All arrays have the shape (window,); neighbouring windows overlap by five sixths.

    Attributes
    ----------
    name
        The drop's.
    time
        Middle of each window, s after the first sample.
    amplitude
        Displacement where the body moves most, of all places with a sensor, m.
    frequency, frequency_std
        Undamped natural frequency and its standard uncertainty, Hz.
    damping_ratio, damping_ratio_std
        And those of the damping ratio.
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
    """Follow one mode.

    Parameters
    ----------
    name
        The drop's.
    record
        Vertical, pitch and roll acceleration of the body, shape (3, time).
    rate
        Samples per second.
    noise
        Of each, by which they are weighed; shape (3,).
    modes
        Modes of the linear vehicle, with shapes in the seven coordinates.
    which
        The one to follow: its pole is free in each window, its shape and everything of the other modes but their amplitudes
        is not.
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
    least squares. A window says nothing where it has no more samples than unknowns, or where the frequency found is an alias,
    above half the rate of its samples.
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
        window = _Window(thin[:, inside], time[inside] - middle, noise, own.shape[:3], others)
        best, deviation, amplitude = window.fit([pole, complex(own.pole)] if found else [pole])
        found.append((middle, amplitude * largest, *_as_ratio(best, deviation)))
        sure = found[-1][3] < _SURE * found[-1][2] and _LEAST < found[-1][4] < _MOST
        # A window of another length is taken where this one's frequency has another period.
        pole = best if sure else complex(own.pole)
        begin += _HOP * 2 * np.pi / abs(pole)
        if sure and found[-1][1] < least:
            break
    table = np.array(found).reshape(-1, 6)
    told = (table[:, 3] < _SURE * table[:, 2]) & (table[:, 4] > _LEAST) & (table[:, 4] < _MOST)
    return AmplitudeCurve(name, *np.ascontiguousarray(table[told].T))


@dataclass(frozen=True, eq=False)
class _Window:
    """A stretch of a record; values (3, time) over the noise, times from its middle."""

    values: Real
    time: Real
    noise: Real
    shape: Complex
    others: Sequence[Mode]

    def _columns(self, pole: complex, shape: Complex) -> Iterator[Real]:
        """Give what the two parts of an amplitude do, each of shape (3 · time,)."""
        motion = (shape / self.noise)[:, None] * np.exp(pole * (self.time - self._largest(pole)))
        yield motion.real.ravel()
        yield -motion.imag.ravel()

    def _largest(self, pole: complex) -> float:
        """When a mode is largest, s: counted from there, none overflows or is out of all proportion to the others."""
        return float(self.time[0] if pole.real < 0 else self.time[-1])

    def _fixed(self) -> Real:
        offsets = np.kron(np.eye(3), np.ones((len(self.time), 1)))
        beside = list(chain.from_iterable(self._columns(complex(one.pole), one.shape[:3]) for one in self.others))
        columns = np.column_stack([offsets, *beside])
        sizes = np.linalg.norm(columns, axis=0)
        left, singular, _ = np.linalg.svd(columns[:, sizes > 0] / sizes[sizes > 0], full_matrices=False)
        basis: Real = left[:, singular > 1e-6 * singular[0]]
        return basis

    def fit(self, poles: Sequence[complex]) -> tuple[complex, Real | None, float]:
        """Fit the pole, from several others: it, the covariance of its parts, and the displacement in the middle.

        There is no covariance where the window says nothing.
        """
        basis = self._fixed()
        values = self.values.ravel()
        values = values - basis @ (basis.T @ values)

        def left(x: Real) -> Real:
            own = np.column_stack(list(self._columns(complex(x[0], x[1]), self.shape)))
            own = own - basis @ (basis.T @ own)
            rest: Real = values - own @ np.linalg.lstsq(own, values, rcond=None)[0]
            return rest

        starts = [
            np.array([-ratio * abs(pole) * times, abs(pole) * times])
            for pole in poles
            for times in _TRIED
            for ratio in _DAMPED
        ]
        costs = [float(left(start) @ left(start)) for start in starts]
        order = np.argsort(costs)[:2]
        size = abs(poles[0])
        ends = [least_squares(left, starts[i], method="lm", x_scale=(size, size)) for i in order]
        end = min(ends, key=lambda one: float(one.cost))
        pole = complex(end.x[0], abs(end.x[1]))
        own = np.column_stack(list(self._columns(pole, self.shape)))
        own -= basis @ (basis.T @ own)
        parts = np.linalg.lstsq(own, values, rcond=None)[0]
        freedom = len(values) - basis.shape[1] - 4
        if freedom <= 0 or pole.imag >= np.pi / (self.time[1] - self.time[0]):
            return pole, None, 0.0
        slopes = np.asarray(end.jac, dtype=float)
        covariance = 2 * float(end.cost) / freedom * np.linalg.pinv(slopes.T @ slopes)
        middle = float(np.exp(-pole.real * self._largest(pole)))
        return pole, covariance, float(np.hypot(*parts)) / abs(pole) ** 2 * middle


def _as_ratio(pole: complex, covariance: Real | None) -> tuple[float, float, float, float]:
    """Turn a pole into undamped frequency, its standard uncertainty, damping ratio, and its own."""
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
