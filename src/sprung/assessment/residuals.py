"""Residuals of each channel in each drop: their size, and whether they are white."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from sprung.display import shown
from sprung.estimation import FitStatistics
from sprung.preprocess import FreeDecay, estimate_sensor_noise, pool_moments

Real = NDArray[np.float64]

_SPAN = 0.25
"""s over which residuals are correlated with themselves: a quarter of a period of a body mode."""


@shown
@dataclass(frozen=True, slots=True)
class ResidualStatistics:
    """Residuals of one channel in one drop.

    Attributes
    ----------
    residual
        m/s² root-mean-square.
    over_noise
        Ratio of that to the sensor's noise: at rest where a recording shows it, else in the residuals of all drops.
    correlation, lag
        The largest autocorrelation within a quarter of a second, and its lag, s.
    colour
        Portmanteau statistic of all these autocorrelations, in standard deviations beyond white noise: Ljung and Box,
        Biometrika 65 (1978) 297.
    """

    residual: float
    over_noise: float
    correlation: float
    lag: float
    colour: float


def estimate_noise_level(fit: FitStatistics, decays: Sequence[FreeDecay]) -> Real:
    """Estimate the noise level of each sensor: at rest where a recording shows it, at most that of the residuals.

    Parameters
    ----------
    fit
        The fit.
    decays
        What was fitted.

    Returns
    -------
    ndarray
        m/s² root-mean-square, shape (channel,).
    """
    noise = estimate_sensor_noise(decays, pool_moments(fit.residuals))
    at_rest = np.where((noise.samples > 0) & (noise.variance > 0), np.sqrt(noise.variance + noise.added), np.inf)
    return np.minimum(at_rest, fit.noise)


def describe_residuals(
    fit: FitStatistics, decays: Sequence[FreeDecay], noise: Real
) -> tuple[dict[int, ResidualStatistics], ...]:
    """Describe the residuals of each channel in each drop.

    Parameters
    ----------
    fit
        The fit.
    decays
        What was fitted.
    noise
        Noise level of each sensor, m/s², shape (channel,).

    Returns
    -------
    tuple of dict
        `ResidualStatistics` for each drop, by the position of the channel; without channels that are left out.
    """
    return tuple(
        {
            int(channel): _residual_statistics(record[channel], decay.rate, float(noise[channel]))
            for channel in np.flatnonzero(decay.usable)
        }
        for decay, record in zip(decays, fit.residuals, strict=True)
    )


def _residual_statistics(values: Real, rate: float, noise: float) -> ResidualStatistics:
    count, size = len(values), float(np.sqrt(np.mean(values**2)))
    lags = np.arange(1, min(max(int(_SPAN * rate), 1), count // 4) + 1)
    correlations = fftconvolve(values, values[::-1])[count - 1 + lags] / max(count * size**2, np.finfo(float).tiny)
    portmanteau = count * (count + 2) * float(np.sum(correlations**2 / (count - lags)))
    largest = int(np.abs(correlations).argmax())
    return ResidualStatistics(
        residual=size,
        over_noise=size / noise,
        correlation=float(correlations[largest]),
        lag=float(lags[largest] / rate),
        colour=float((portmanteau - len(lags)) / np.sqrt(2 * len(lags))),
    )
