"""Frequency weightings of ISO 2631-1: how people feel accelerations, as transfer functions.

Each is the product of a band limitation, a transition from acceleration to velocity and an upward step (ISO 2631-1:1997,
annex A, with the parameters of ISO 8041).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Complex = NDArray[np.complex128]

Weighting = Literal["W_b", "W_c", "W_d", "W_e", "W_f", "W_j", "W_k"]
"""Name of a frequency weighting: W_k vertical on a seat, W_d horizontal, W_c horizontal at a back rest, W_e rotations, W_f
motion sickness, W_j the head of a recumbent person, W_b vertical in rail vehicles."""

_BUTTERWORTH = 1 / math.sqrt(2)


class _Filter(NamedTuple):
    """Parameters of a weighting: corner frequencies, Hz, and quality factors, 1."""

    high_pass: float
    low_pass: float
    zero: float
    pole: float
    pole_quality: float
    step_zero: float = math.inf
    step_zero_quality: float = 1.0
    step_pole: float = math.inf
    step_pole_quality: float = 1.0
    gain: float = 1.0


_FILTERS: Mapping[str, _Filter] = MappingProxyType(
    {
        "W_b": _Filter(0.4, 100.0, 16.0, 16.0, 0.55, 2.5, 0.9, 4.0, 0.95, 1.024),
        "W_c": _Filter(0.4, 100.0, 8.0, 8.0, 0.63),
        "W_d": _Filter(0.4, 100.0, 2.0, 2.0, 0.63),
        "W_e": _Filter(0.4, 100.0, 1.0, 1.0, 0.63),
        "W_f": _Filter(0.08, 0.63, math.inf, 0.25, 0.86, 0.0625, 0.80, 0.10, 0.80),
        "W_j": _Filter(0.4, 100.0, math.inf, math.inf, 1.0, 3.75, 0.91, 5.32, 0.91),
        "W_k": _Filter(0.4, 100.0, 12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91),
    }
)


def frequency_weighting(name: Weighting, frequency: ArrayLike) -> Complex:
    """Return the transfer function of a frequency weighting of ISO 2631-1.

    Parameters
    ----------
    name
        Of the weighting.
    frequency
        Hz, positive, any shape.

    Returns
    -------
    ndarray of complex
        Weighted over measured acceleration, dimensionless, of the shape of the frequencies.

    Examples
    --------
    >>> round(float(abs(frequency_weighting("W_k", 8.0))), 3)
    1.036
    """
    one = _FILTERS[name]
    f = np.asarray(frequency, dtype=float)
    found = one.gain * _resonance(f, one.low_pass, _BUTTERWORTH) ** -1.0
    found = found * (1j * f / one.high_pass) ** 2 / _resonance(f, one.high_pass, _BUTTERWORTH)
    found = found * (1 + 1j * f / one.zero) / _resonance(f, one.pole, one.pole_quality)
    if math.isfinite(one.step_pole):
        ratio = (one.step_zero / one.step_pole) ** 2
        step = _resonance(f, one.step_zero, one.step_zero_quality) / _resonance(f, one.step_pole, one.step_pole_quality)
        found = found * ratio * step
    return np.asarray(found, dtype=np.complex128)


def _resonance(frequency: NDArray[np.float64], corner: float, quality: float) -> Complex:
    """Return 1 + s/(Q ω₀) + (s/ω₀)² at s = iω."""
    s = 1j * frequency / corner
    return np.asarray(1 + s / quality + s**2, dtype=np.complex128)
