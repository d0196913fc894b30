"""Model error: how far the model is from the records beyond the noise of the sensors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitResult

Real = NDArray[np.float64]

_SIGNIFICANT = 4.0
"""Standard errors by which an excess must be real before it counts."""


def estimate_model_error(fit: FitResult) -> tuple[Real, Real]:
    """Separate model error from noise in the residuals.

    Parameters
    ----------
    fit
        The fit.

    Returns
    -------
    model_error : ndarray
        Model error of each channel as a part of the signal, both root-mean-square over all drops; 0 where none is
        significant. Shape (channel,).
    over_noise : ndarray
        Residual over the noise at rest of each channel; NaN where no recording shows a rest. Shape (channel,).

    Notes
    -----
    White noise has no covariance from one sample to the next, and the noise of the sensors at rest is no model error.
    So model error shows in two ways: as covariance between neighbouring residuals beyond that at rest, and as more
    variance than at rest. Each counts where it exceeds its sampling error, and the larger of the two is taken.
    """
    variance, neighbour, samples = fit.residual_moments
    signal = np.nansum([decay.energy for decay in fit.decays], axis=0) / np.maximum(samples, 1.0)
    noise = fit.sensor_noise
    known = noise.samples > 0

    # A sensor whose noise is below its resolution may show none at rest; in motion its steps make an error that is coloured
    # where the motion is slow, and that is no error of the model.
    by_colour = neighbour - noise.neighbour - noise.added
    by_variance = np.where(known, variance - noise.variance - noise.added, 0.0)
    per_sample = 1 / np.maximum(samples, 1.0) + np.where(known, 1 / np.maximum(noise.samples, 1.0), 0.0)
    error = np.sqrt(2 * noise.per_independent * per_sample) * variance
    excess = np.max([np.where(part > _SIGNIFICANT * error, part, 0.0) for part in (by_colour, by_variance)], axis=0)

    tiny = np.finfo(float).tiny
    model_error: Real = np.sqrt(excess / np.maximum(signal, tiny))
    over_noise: Real = np.sqrt(np.where(known, variance / np.maximum(noise.variance + noise.added, tiny), np.nan))
    return model_error, over_noise
