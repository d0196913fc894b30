"""Does the model explain the records? What is left of them is held against what the sensors do at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.estimation import FitStatistics
from sprung.preprocess import FreeDecay, estimate_sensor_noise, pool_moments

Real = NDArray[np.float64]

_SIGNIFICANT = 4.0
"""Standard errors by which an excess must be real before it counts."""


@shown
@dataclass(frozen=True, eq=False)
class Misfit:
    """How far the model is from the records, beyond the sensors' noise.

    Attributes
    ----------
    relative
        For each channel the model error as a part of the signal, both root-mean-square over all drops; 0 where none is
        significant. Shape (channel,).
    ratio
        For each channel the ratio of residual and noise at rest; NaN where no recording shows a rest. Shape (channel,).
    """

    relative: Real
    ratio: Real


def estimate_model_error(fit: FitStatistics, decays: Sequence[FreeDecay]) -> Misfit:
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
    So model error shows in two ways: as covariance between neighbouring residuals beyond that at rest, and as more
    variance than at rest. Each counts where it exceeds its sampling error, and the larger of the two is taken.
    """
    residuals = fit.residuals
    signals = [decay.values - decay.values.mean(axis=1, keepdims=True) for decay in decays]
    left, signal = pool_moments(residuals), pool_moments(signals)
    noise = estimate_sensor_noise(decays, left)
    known = noise.samples > 0

    # A sensor whose noise is below its resolution may show none at rest; in motion its steps make an error that is coloured
    # where the motion is slow, and of which no model is to blame.
    by_colour = left.neighbour - noise.neighbour - noise.added
    by_variance = np.where(known, left.variance - noise.variance - noise.added, 0.0)
    samples = 1 / np.maximum(left.samples, 1.0) + np.where(known, 1 / np.maximum(noise.samples, 1.0), 0.0)
    error = np.sqrt(2 * noise.per_independent * samples) * left.variance
    excess = np.max([np.where(part > _SIGNIFICANT * error, part, 0.0) for part in (by_colour, by_variance)], axis=0)

    tiny = np.finfo(float).tiny
    return Misfit(
        relative=np.sqrt(excess / np.maximum(signal.variance, tiny)),
        ratio=np.sqrt(np.where(known, left.variance / np.maximum(noise.variance + noise.added, tiny), np.nan)),
    )
