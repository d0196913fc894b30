"""Residuals of each channel in each drop: their size, and whether they are white."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from sprung.display import shown
from sprung.estimation import FitResult, FitStatistics
from sprung.preprocess import FreeDecay

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


def estimate_noise_level(fit: FitResult) -> Real:
    """Estimate the noise level of each sensor: at rest where a recording shows it, at most that of the residuals.

    Parameters
    ----------
    fit
        The fit.

    Returns
    -------
    ndarray
        m/s² root-mean-square, shape (channel,).
    """
    noise = fit.sensor_noise
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
        dict(
            zip(
                np.flatnonzero(decay.usable).tolist(),
                _residual_statistics(record[decay.usable], decay.rate, noise[decay.usable]),
                strict=True,
            )
        )
        for decay, record in zip(decays, fit.residuals, strict=True)
    )


def _residual_statistics(values: Real, rate: float, noise: Real) -> Iterator[ResidualStatistics]:
    """Yield the statistics of each channel of a record, shape (channel, time)."""
    count, squares = values.shape[1], np.einsum("ct,ct->c", values, values)
    lags = np.arange(1, min(max(int(_SPAN * rate), 1), count // 4) + 1)
    # Padded with zeros by the longest lag, a record meets itself once at each lag.
    padded = next_fast_len(count + len(lags), real=True)
    spectra = rfft(values, padded)
    products = irfft(spectra.real**2 + spectra.imag**2, padded)[:, lags]
    correlations = products / np.maximum(squares, np.finfo(float).tiny)[:, None]
    portmanteau = count * (count + 2) * np.sum(correlations**2 / (count - lags), axis=1)
    largest = np.abs(correlations).argmax(axis=1)
    size = np.sqrt(squares / count)
    columns = (
        size,
        size / noise,
        np.take_along_axis(correlations, largest[:, None], axis=1)[:, 0],
        lags[largest] / rate,
        (portmanteau - len(lags)) / np.sqrt(2 * len(lags)),
    )
    for statistics in zip(*(column.tolist() for column in columns), strict=True):
        yield ResidualStatistics(*statistics)
