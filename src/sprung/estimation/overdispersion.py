"""Overdispersion: by how much variances exceed those of independent samples of the right model.

Three statistics show it without any other model: the autocorrelation of residuals, the disagreement of drops, and that of large
and small motions.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]

_SPAN = 0.25
"""s over which residuals are correlated: drift and model error last longer, but then they fill it."""

_SIGNIFICANT = 3.0
"""Standard errors by which an excess must be real before it counts."""

_DETERMINED = 1e-9
"""Information, as a part of the largest, below which one drop does not determine a direction."""


def autocorrelation_inflation(
    residuals: Iterable[Real],
    rates: Sequence[float],
    span: float = _SPAN,
    counted: Real | float = 1.0,
    least: Real | float = 0.0,
) -> Real:
    """Return the :term:`autocorrelation inflation`: variance of a mean of residuals over that of white ones.

    Parameters
    ----------
    residuals
        One record for each drop, shape (channel, time), NaN in channels that are left out.
    rates
        Samples per second of each.
    span
        s over which means are taken: as long as what correlates the residuals, and a small part of a record.
    counted
        Part of the samples that the fit counts, shape (channel,) or one for all; fewer than there are where some were
        interpolated.
    least
        Variance below which residuals are rounding, whose autocorrelation means nothing, (m/s²)²; shape (channel,) or one for
        all.

    Returns
    -------
    ndarray
        For each channel the variance of means over that time, times the samples counted in them, over that of single samples
        (batch means: Law and Kelton, Simulation Modeling and Analysis, section 9.5.3). Never below 1; 1 where the excess
        is not significant. Shape (channel,).
    """
    sums = []
    for record, rate in zip(residuals, rates, strict=True):
        length = min(max(int(span * rate), 1), record.shape[1])
        count = record.shape[1] // length
        batch = record[:, : count * length].reshape(len(record), count, length)
        energy, mean = np.einsum("cbt,cbt->c", batch, batch), np.sum(batch.mean(axis=2) ** 2, axis=1)
        used = ~np.isnan(energy)
        sums.append(
            [np.where(used, energy, 0.0), np.where(used, length * mean, 0.0), used * count * length, used * count]
        )
    total, means, samples, batches = np.sum(sums, axis=0)
    variance = np.maximum(total / np.maximum(samples, 1.0), np.maximum(least, np.finfo(float).tiny))
    ratio = counted * means / np.maximum(batches, 1.0) / variance
    return np.where(ratio > 1 + _SIGNIFICANT * np.sqrt(2 / np.maximum(batches, 1.0)), ratio, 1.0)


def independent_records(residuals: Sequence[Real], motions: Sequence[Real], weights: Real, correlation: float) -> float:
    """Return as how many records some records count, of which some repeat what the model leaves of others.

    Parameters
    ----------
    residuals
        One record for each drop from its start on, all at one rate, shape (channel, time), NaN in channels that are left out.
    motions
        What the model says of the same samples.
    weights
        1/σ² of each channel, s⁴/m², shape (channel,).
    correlation
        Autocorrelation inflation of the residuals.

    Returns
    -------
    float
        Their number, if no residual resembles that of another drop that moves alike.

    Notes
    -----
    A record counts as one over the sum of its residual's correlation coefficients with those of all records, each times that
    of the motions: an error of the model adds up where both repeat, or where both are reversed. The sum is the cross term of a
    covariance estimate that allows for correlation between parts (Driscoll and Kraay, Rev. Econ. Statist. 80 (1998) 549).
    Coefficients that are not significant count as zero.
    """
    scales = np.sqrt(weights)[:, None]
    scaled = [[np.nan_to_num(scales * record) for record in records] for records in (residuals, motions)]
    shared = np.eye(len(residuals))
    for one, other in combinations(range(len(residuals)), 2):
        of_residuals, of_motions = (_correlation_coefficient(records[one], records[other]) for records in scaled)
        samples = min(residuals[one].size, residuals[other].size)
        if abs(of_residuals) > _SIGNIFICANT * np.sqrt(correlation / samples):
            shared[one, other] = shared[other, one] = max(of_residuals * of_motions, 0.0)
    return float(np.sum(1 / shared.sum(axis=0)))


def _correlation_coefficient(one: Real, other: Real) -> float:
    length = min(one.shape[1], other.shape[1])
    one, other = one[:, :length], other[:, :length]
    size = np.sqrt(np.sum(one**2) * np.sum(other**2))
    return float(np.sum(one * other) / size) if size else 0.0


def birge_ratio(scores: Real, informations: Real, independent: float = 1.0) -> float:
    """Return the square of the :term:`Birge ratio`: by how much parts of the records differ from each other beyond their noise.

    Parameters
    ----------
    scores
        Gradient of the log-likelihood of each part at the joint optimum, in free directions; shape (part, direction).
    informations
        Fisher information of each part in the same directions; shape (part, direction, direction).
    independent
        As what part of their number they count: those that repeat others are no evidence of their own.

    Returns
    -------
    float
        Birge's ratio, squared: each part's own correction to the joint estimate, in units of its own uncertainty, squared
        and averaged (Birge, Phys. Rev. 40 (1932) 207). 1 where the excess is not significant, or with too few parts.

    Notes
    -----
    Where the parts are drops, a model error shows that depends on which way the vehicle moved; one that is the same in every
    drop goes unseen. Where they are windows of time, an error shows that depends on how far or how fast it moved.
    """
    squares, directions = drop_corrections(scores, informations)
    freedom = independent * int(directions.sum()) - scores.shape[1]
    if freedom <= 0:
        return 1.0
    ratio = float(squares.sum()) / freedom
    return ratio if ratio > 1 + _SIGNIFICANT * np.sqrt(2 / freedom) else 1.0


def drop_corrections(scores: Real, informations: Real) -> tuple[Real, NDArray[np.int64]]:
    """Return each drop's own correction to the joint estimate, in units of its own uncertainty, squared and summed.

    Parameters
    ----------
    scores, informations
        As for `birge_ratio`.

    Returns
    -------
    squares
        Shape (drop,).
    directions
        In how many directions each drop has information, shape (drop,).
    """
    squares, directions = np.zeros(len(scores)), np.zeros(len(scores), dtype=np.int64)
    for drop, (score, information) in enumerate(zip(scores, informations, strict=True)):
        if not np.isfinite(
            information
        ).all():  # derivatives of a motion that runs away overflow: they determine nothing
            continue
        eigenvalues, vectors = np.linalg.eigh(information)
        determined = eigenvalues > _DETERMINED * eigenvalues.max(initial=0.0)
        squares[drop] = np.sum((vectors.T @ score)[determined] ** 2 / eigenvalues[determined])
        directions[drop] = determined.sum()
    return squares, directions
