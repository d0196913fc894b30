"""Criteria for modes: modal phase collinearity, and distance from the Nyquist frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

NEAR_NYQUIST = 0.9
"""Part of half the sampling rate above which no mode is reported: there logger filters end, and noise and aliases alternate."""


def modal_phase_collinearity(shape: ArrayLike) -> float:
    """Return the :term:`modal phase collinearity` of a shape: 1 if all channels are in phase or in opposition, 0 at the least.

    Parameters
    ----------
    shape
        Shape (channel,).

    Returns
    -------
    float
        The share of the larger eigenvalue of the covariance of real and imaginary parts over the smaller, squared:
        ((λ₁ - λ₂)/(λ₁ + λ₂))².

    References
    ----------
    R. S. Pappa, K. B. Elliott and A. Schenk, J. Guid. Control Dyn. 16 (1993) 852.
    """
    values = np.asarray(shape, dtype=complex)
    parts = np.stack([values.real, values.imag])
    eigenvalues = np.linalg.eigvalsh(parts @ parts.T)
    total = float(eigenvalues.sum())
    return float(((eigenvalues[1] - eigenvalues[0]) / total) ** 2) if total > 0 else 1.0
