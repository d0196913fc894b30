"""Amplitude dependence of modes: frequency and damping in windows of a decay, from the records alone.

A linear system has one frequency and one damping ratio whatever the amplitude. A suspension with dry friction does not: it
is softer and damps more where the friction slides.
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
from sprung.modal.record_checks import check_records
from sprung.modal.refinement import maximise_likelihood
from sprung.modal.uncertainty import pole_bound
from sprung.vibration import Mode

Real = NDArray[np.float64]

_FALL = 0.5
"""Time constants of the decay in a window, ..."""

_PERIODS, _SHARE = 1.5, 0.25
"""... which has at least so many periods, and at most this part of the record."""

_STRIDE = 0.5
"""Distance of windows, as a part of their length."""

_LARGEST_PHASE_STD = 0.05
"""Largest standard uncertainty of a frequency that is used, cycles over the window."""

_LEAST, _MOST = -0.1, 1.0
"""Damping ratios between which a window shows a free vibration."""


@shown
@dataclass(frozen=True, eq=False)
class AmplitudeDependence:
    """One mode in windows of the decays of one or several records; all arrays of shape (window,), the largest amplitude first.

    Attributes
    ----------
    mode
        As it was identified.
    amplitude
        At the channel that moves most, in the records' unit, in the middle of each window.
    frequency, frequency_std
        Undamped natural frequency and its standard uncertainty, Hz.
    damping_ratio, damping_ratio_std
        Damping ratio and its standard uncertainty.
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
    """Fit each mode in successive windows of every record.

    In each window the pole of one mode is free, the other poles and all shapes are as identified; amplitudes of all modes
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
    tuple of AmplitudeDependence
        One for each mode that vibrates and is determined in at least two windows.
    """
    arrays = check_records(records, rate, "amplitude")
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
    """Return amplitude, frequency, damping ratio and their uncertainties in each window of a record that determines them."""
    pole = complex(poles.exponent[which])
    longest = max(int(_SHARE * record.shape[1]), 1)
    length = max(min(int(_FALL / abs(pole.real)), longest), int(_PERIODS * 2 * np.pi / abs(pole)), 8)
    rows: list[tuple[float, ...]] = []
    for first in range(0, record.shape[1] - length + 1, max(int(_STRIDE * length), 1)):
        decays = Decays.of([record[:, first : first + length]], rate)
        objective = maximise_likelihood(decays, poles, only=which)
        lost = decays.sample_count / max(decays.sample_count - objective.parameters / decays.channels, 1.0)
        uncertainty = pole_bound(objective.weighted(1 / (objective.variance * lost)), which)
        fitted = Mode(
            complex(objective.poles.exponent[which] * rate), objective.poles.shapes[:, which], uncertainty=uncertainty
        )
        frequency_std, ratio_std = fitted.frequency_std or 0.0, fitted.damping_ratio_std or 0.0
        aliased = fitted.damped_frequency > NEAR_NYQUIST * rate / 2
        if aliased or frequency_std * length / rate > _LARGEST_PHASE_STD or not _LEAST < fitted.damping_ratio < _MOST:
            if rows:
                break  # the motion has decayed
            continue
        middle = np.exp(objective.poles.exponent[which].real * length / 2)
        size = 2 * float(np.abs(objective.coefficients[0, :, which]).max() * middle)
        rows.append((size, fitted.frequency, frequency_std, fitted.damping_ratio, ratio_std))
    return rows


def _trend(amplitude: Real, values: Real, stds: Real) -> tuple[float, float] | None:
    """Fit a line against the logarithm to base 10 of the amplitude: its slope and standard uncertainty, scatter included."""
    weights = 1 / np.maximum(stds, 1e-300) ** 2
    logs = np.log10(np.maximum(amplitude, 1e-300))
    centred = logs - weights @ logs / weights.sum()
    squares = float(weights @ centred**2)
    if len(values) < 3 or not squares > 0:
        return None
    slope = float(weights @ (centred * values)) / squares
    residual = values - weights @ values / weights.sum() - slope * centred
    excess = max(float(weights @ residual**2) / (len(values) - 2), 1.0)
    return slope, float(np.sqrt(excess / squares))
