"""Does the model explain the records? What is left of them is held against what the sensors do at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.identification import Fit
from sprung.prepare import Decay

Real = NDArray[np.float64]

_SIGNIFICANT = 4.0
"""Standard errors by which an excess must be real before it counts."""


@dataclass(frozen=True, eq=False)
class Misfit:
    """How far the model is from the records, beyond the sensors' noise.

    Attributes
    ----------
    relative
        For each channel the model error as a part of the signal, both root-mean-square over all drops; 0 where none is
        significant. Shape (channel,).
    ratio
        For each channel the residual over the noise at rest; NaN where no recording shows a rest. Shape (channel,).
    by_drop
        Model error as a part of the signal, over all channels, for each drop; shape (drop,).
    """

    relative: Real
    ratio: Real
    by_drop: Real


def residual_records(fit: Fit, decays: Sequence[Decay]) -> list[Real]:
    """Give measured minus fitted for every drop, each of shape (channel, time), m/s²."""
    return [
        decay.values - decay.values.mean(axis=1, keepdims=True) - fitted
        for decay, fitted in zip(decays, fit.fitted, strict=True)
    ]


def judge_residuals(fit: Fit, decays: Sequence[Decay]) -> Misfit:
    """Separate model error from noise in the residuals.

    Parameters
    ----------
    fit
        The fit.
    decays
        What was fitted.

    Returns
    -------
    Misfit

    Notes
    -----
    White noise has no covariance from one sample to the next, and what the sensors do at rest is not the model's fault.
    So model error shows in two ways: as covariance between neighbouring residuals, and as more variance than at rest.
    Each counts where it exceeds its own sampling error, and the larger of the two is taken.
    """
    residuals = residual_records(fit, decays)
    signal = np.array([np.nanvar(np.where(d.usable[:, None], d.values, 0.0), axis=1) for d in decays])
    samples = np.array([d.usable * d.samples for d in decays], dtype=float)
    variance = np.array([np.nan_to_num(r).var(axis=1) for r in residuals])
    neighbour = np.array([np.mean(np.nan_to_num(r[:, 1:] * r[:, :-1]), axis=1) for r in residuals])

    count = np.maximum(samples.sum(axis=0), 1.0)
    pooled = (samples * variance).sum(axis=0) / count
    coloured = (samples * neighbour).sum(axis=0) / count
    rest = np.array([d.rest.variance for d in decays])
    rest_samples = np.array([np.where(d.usable, d.rest.samples, 0) for d in decays], dtype=float)
    known_rest = rest_samples.sum(axis=0)
    rest_variance = _pool(rest, rest_samples)
    rest_neighbour = _pool(np.array([d.rest.neighbour for d in decays]), rest_samples)

    by_colour = coloured - np.where(known_rest > 0, rest_neighbour, 0.0)
    colour_error = pooled * np.sqrt(1 / count + np.where(known_rest > 0, 1 / np.maximum(known_rest, 1.0), 0.0))
    by_variance = np.where(known_rest > 0, pooled - rest_variance, 0.0)
    variance_error = np.sqrt(2 / count * pooled**2 + 2 / np.maximum(known_rest, 1.0) * rest_variance**2)
    excess = np.maximum(
        np.where(by_colour > _SIGNIFICANT * colour_error, by_colour, 0.0),
        np.where(by_variance > _SIGNIFICANT * variance_error, by_variance, 0.0),
    )
    tiny = np.finfo(float).tiny
    pooled_signal = (samples * signal).sum(axis=0) / count
    used = samples > 0
    drop_excess = np.maximum(np.where(used, variance - (pooled - excess), 0.0).sum(axis=1), 0.0)
    return Misfit(
        relative=np.sqrt(excess / np.maximum(pooled_signal, tiny)),
        ratio=np.sqrt(np.where(known_rest > 0, pooled / np.maximum(rest_variance, tiny), np.nan)),
        by_drop=np.sqrt(drop_excess / np.maximum(np.where(used, signal, 0.0).sum(axis=1), tiny)),
    )


def _pool(values: Real, samples: Real) -> Real:
    total = np.where(samples > 0, samples * np.nan_to_num(values), 0.0).sum(axis=0)
    pooled: Real = total / np.maximum(samples.sum(axis=0), 1.0)
    return pooled
