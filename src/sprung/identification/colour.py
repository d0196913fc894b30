"""Colour of the residuals: how much less they tell than as many independent samples would."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]

_SPAN = 0.1
"""s over which residuals are correlated: drift and model error last longer, but then they fill it."""

_SIGNIFICANT = 3.0


def inflation(residuals: Sequence[Real], rates: Sequence[float]) -> Real:
    """Estimate by how much the variance of a mean of residuals exceeds that of white ones.

    Parameters
    ----------
    residuals
        One record for each drop, shape (channel, time), NaN in channels that are left out.
    rates
        Samples per second of each.

    Returns
    -------
    ndarray
        For each channel 1 + 2 Σ ρ_k over the lags within 0.1 s, weighted after Bartlett (Newey and West, Econometrica 55
        (1987) 703), never below 1; 1 where the excess is not significant. Shape (channel,).
    """
    channels = len(residuals[0])
    total, weighted, spread, count = np.zeros((4, channels))
    for record, rate in zip(residuals, rates, strict=True):
        lags = min(max(int(_SPAN * rate), 1), record.shape[1] // 4)
        weights = 1 - np.arange(1, lags + 1) / (lags + 1)
        clean = np.nan_to_num(record)
        used = ~np.isnan(record).any(axis=1)
        samples = record.shape[1]
        spectrum = np.abs(np.fft.rfft(clean, n=2 * samples, axis=1)) ** 2
        autocovariance = np.fft.irfft(spectrum, axis=1)[:, : lags + 1]
        total += autocovariance[:, 0]
        weighted += 2 * autocovariance[:, 1:] @ weights
        spread += used * samples * 4 * float(weights @ weights)
        count += used * samples
    safe = np.maximum(total, np.finfo(float).tiny)
    excess = weighted / safe
    error = np.sqrt(spread) / np.maximum(count, 1)
    return np.where(excess > _SIGNIFICANT * error, 1 + excess, 1.0)
