"""Average run length of a multivariate EWMA chart: vehicles between two false alarms, from a Markov chain."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import beta, chi2

Real = NDArray[np.float64]

WEIGHT = 0.1
"""Weight λ of the newest vehicle in the moving average: small ones detect small drifts."""

RUN_LENGTH = 500.0
"""Average number of vehicles between two false alarms of each chart."""

_CLIPPED = 0.99
"""Part of the vehicles in control whose score is not clipped."""

_STATES, _RADII = 200, 60
"""States of the Markov chain, and quadrature points of the length of a score."""


def clipping_radius(width: int) -> float:
    """Return the length to which longer scores are reduced, so that one vehicle alone does not move the average much.

    Parameters
    ----------
    width
        Number of components of a score.

    Returns
    -------
    float
        Dimensionless: 99 % of the vehicles in control have shorter ones.
    """
    return float(np.sqrt(chi2.ppf(_CLIPPED, width)))


def average_run_length(limit: float, width: int, weight: float = WEIGHT) -> float:
    """Return the average number of vehicles until a chart in control raises a false alarm.

    The average q ← (1 - λ) q + λ u of independent standard normal scores u, reduced to `clipping_radius`, has a length that
    is a Markov chain, because the distribution of u has no direction (G. Runger, S. Prabhu, Ann. Stat. 24 (1996) 1701).

    Parameters
    ----------
    limit
        Length of q that is an alarm, dimensionless.
    width
        Number of components.
    weight
        λ, dimensionless.

    Returns
    -------
    float
        From the beginning of the chart at q = 0, dimensionless.
    """
    edges = limit * np.linspace(0, 1, _STATES + 1)
    middles = np.concatenate([[0.0], (edges[:-1] + edges[1:]) / 2])
    radius = clipping_radius(width)
    # Gauss-Legendre in the distribution function of the length, and all longer ones at the radius.
    points, weights = np.polynomial.legendre.leggauss(_RADII)
    parts = _CLIPPED * (points + 1) / 2
    lengths = np.append(np.sqrt(chi2.ppf(parts, width)), radius)
    shares = np.append(_CLIPPED * weights / 2, 1 - _CLIPPED)
    kept = (1 - weight) * middles[:, None, None]
    added = weight * lengths[None, :, None]
    # |q'|² = kept² + added² + 2 kept added cos θ: each edge is a value of cos θ, whose distribution is known.
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (edges[None, None, :] ** 2 - kept**2 - added**2) / (2 * kept * added)
    cosine = np.where(kept * added > 0, cosine, np.where(edges >= added, 1.0, -1.0))
    below = _cosine_below(np.clip(cosine, -1, 1), width)
    transition = np.einsum("sre,r->se", np.diff(below, axis=2), shares)
    transition = np.concatenate([np.zeros((len(middles), 1)), transition], axis=1)  # nothing returns to exactly 0
    return float(np.linalg.solve(np.eye(len(middles)) - transition, np.ones(len(middles)))[0])


def _cosine_below(cosine: Real, width: int) -> Real:
    """Return the probability that the cosine between a fixed and a random direction is below a value."""
    if width == 1:
        return np.where(cosine >= 1, 1.0, np.where(cosine > -1, 0.5, 0.0))
    half = (width - 1) / 2
    return np.asarray(beta.cdf((cosine + 1) / 2, half, half))


@cache
def alarm_limit(width: int, run_length: float = RUN_LENGTH, weight: float = WEIGHT) -> float:
    """Return the length of the average at which a chart raises an alarm.

    Parameters
    ----------
    width
        Number of components.
    run_length
        Average number of vehicles between two false alarms, dimensionless.
    weight
        λ, dimensionless.

    Returns
    -------
    float
        Dimensionless.
    """
    usual = np.sqrt(width * weight / (2 - weight))

    def excess(limit: float) -> float:
        return float(np.log(average_run_length(limit, width, weight) / run_length))

    low, high = usual, 2 * usual
    while excess(high) < 0:
        high *= 1.3
    while excess(low) > 0:
        low *= 0.8
    return float(brentq(excess, low, high, xtol=1e-6 * usual))
