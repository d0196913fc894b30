"""Modes followed through a decay: frequency and damping against amplitude, from the records alone.

A linear system has one frequency and one damping ratio whatever the amplitude. Joints and leaf springs that rub do not: they
are softer and damp more where they slide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.modal.criteria import NEAR_NYQUIST
from sprung.modal.decays import Decays
from sprung.modal.likelihood import Poles
from sprung.modal.records import as_records
from sprung.modal.refinement import climb
from sprung.modal.uncertainty import bound_alone
from sprung.vibration import Mode

Real = NDArray[np.float64]

_FALL = 0.5
"""Powers of e by which a mode falls in a window, ..."""

_PERIODS, _SHARE = 1.5, 0.25
"""... which is so many periods long at the least, and so much of the record at the most."""

_HOP = 0.5
"""Windows from one to the next."""

_SURE = 0.05
"""Turns by which a vibration may be unsure over a window whose frequency is believed."""

_LEAST, _MOST = -0.1, 1.0
"""Damping ratios between which a window shows a free vibration."""


@shown
@dataclass(frozen=True, eq=False)
class AmplitudeDependence:
    """One mode through the decays of one or several records; all arrays of shape (window,), the largest amplitude first.

    Attributes
    ----------
    mode
        As it was identified.
    amplitude
        At the channel that moves most, in the records' unit, in the middle of each window.
    frequency, frequency_std
        Undamped natural frequency and its standard uncertainty, Hz.
    damping_ratio, damping_ratio_std
        And those of the damping ratio.
    """

    mode: Mode
    amplitude: Real
    frequency: Real
    frequency_std: Real
    damping_ratio: Real
    damping_ratio_std: Real

    @property
    def frequency_trend(self) -> tuple[float, float] | None:
        """Change of the frequency with ten times the amplitude, as a part of it, and its standard uncertainty."""
        trend = _trend(self.amplitude, self.frequency, self.frequency_std)
        return None if trend is None else (trend[0] / self.mode.frequency, trend[1] / self.mode.frequency)

    @property
    def damping_trend(self) -> tuple[float, float] | None:
        """Change of the damping ratio with ten times the amplitude, and its standard uncertainty."""
        return _trend(self.amplitude, self.damping_ratio, self.damping_ratio_std)


def amplitude_dependence(
    records: Sequence[ArrayLike], rate: float, modes: Sequence[Mode]
) -> tuple[AmplitudeDependence, ...]:
    """Fit each mode anew in one window after the other of every record.

    In each window the pole of one mode is free, those of the others and all shapes are as identified; amplitudes of all modes
    and offsets are free, and eliminated as they are linear.

    Parameters
    ----------
    records
        As they were identified, shape (channel, time) each.
    rate
        Samples per second.
    modes
        From `identify_modes`.

    Returns
    -------
    tuple of ModeTrace
        One for each mode that vibrates and is told in two windows at the least.
    """
    arrays = as_records(records, rate, "amplitude")
    poles = Poles.of(
        np.array([mode.pole / rate for mode in modes], dtype=complex), np.stack([mode.shape for mode in modes], axis=1)
    )
    found = []
    for which, mode in enumerate(modes):
        if mode.pole.imag > 0 and mode.pole.real < 0:
            rows = [row for record in arrays for row in _windows(record, rate, poles, which)]
            table = np.array(sorted(rows, key=lambda row: -row[0])).reshape(-1, 5)
            if len(table) > 1:
                found.append(AmplitudeDependence(mode, *np.ascontiguousarray(table.T)))
    return tuple(found)


def _windows(record: Real, rate: float, poles: Poles, which: int) -> list[tuple[float, ...]]:
    """Give amplitude, frequency, damping ratio and their uncertainties in each window of a record that tells them."""
    pole = complex(poles.exponent[which])
    longest = max(int(_SHARE * record.shape[1]), 1)
    length = max(min(int(_FALL / abs(pole.real)), longest), int(_PERIODS * 2 * np.pi / abs(pole)), 8)
    rows: list[tuple[float, ...]] = []
    for first in range(0, record.shape[1] - length + 1, max(int(_HOP * length), 1)):
        decays = Decays.of([record[:, first : first + length]], rate)
        stand = climb(decays, poles, only=which)
        lost = decays.numbers / max(decays.numbers - stand.parameters / decays.channels, 1.0)
        spread = bound_alone(stand.weighted(1 / (stand.variance * lost)), which)
        own = Mode(complex(stand.poles.exponent[which] * rate), stand.poles.shapes[:, which], uncertainty=spread)
        frequency_std, ratio_std = own.frequency_std or 0.0, own.damping_ratio_std or 0.0
        aliased = own.damped_frequency > NEAR_NYQUIST * rate / 2
        if aliased or frequency_std * length / rate > _SURE or not _LEAST < own.damping_ratio < _MOST:
            if rows:
                break  # the motion has died
            continue
        middle = np.exp(stand.poles.exponent[which].real * length / 2)
        size = 2 * float(np.abs(stand.coefficients[0, :, which]).max() * middle)
        rows.append((size, own.frequency, frequency_std, own.damping_ratio, ratio_std))
    return rows


def _trend(amplitude: Real, values: Real, stds: Real) -> tuple[float, float] | None:
    """Fit a line against the logarithm to base 10 of the amplitude: its slope and how sure that is, scatter included."""
    weights = 1 / np.maximum(stds, 1e-300) ** 2
    logs = np.log10(np.maximum(amplitude, 1e-300))
    centred = logs - weights @ logs / weights.sum()
    spread = float(weights @ centred**2)
    if len(values) < 3 or not spread > 0:
        return None
    slope = float(weights @ (centred * values)) / spread
    left = values - weights @ values / weights.sum() - slope * centred
    excess = max(float(weights @ left**2) / (len(values) - 2), 1.0)
    return slope, float(np.sqrt(excess / spread))
