"""Does the model explain the records? What is left of them is held against what the sensors do at rest."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.identification import Fit, of_colour, residual_records
from sprung.prepare import Decay, resolution

Real = NDArray[np.float64]

_SHORTEST_REST = 10
"""Samples below which a rest says nothing about the noise."""

_REST_SPAN = 0.1
"""s over which the sensors' own colour is sought: a rest holds a few of them at least."""

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
    """

    relative: Real
    ratio: Real


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
    So model error shows in two ways: as covariance between neighbouring residuals beyond that at rest, and as more
    variance than at rest. Each counts where it exceeds its sampling error, and the larger of the two is taken.
    """
    residuals = residual_records(fit.fitted, decays)
    signals = [decay.values - decay.values.mean(axis=1, keepdims=True) for decay in decays]
    rested = [decay for decay in decays if decay.rest.noise.shape[1] >= _SHORTEST_REST]
    rests = [decay.rest.noise for decay in rested]
    left, signal = _moments(residuals), _moments(signals)
    rest = _moments(rests) if rests else _Moments(*np.zeros((3, len(left.variance))))
    known = rest.samples > 0

    # Sensors with a colour of their own have as few independent samples in their short rests as that colour leaves.
    colour = of_colour(rests, [decay.rate for decay in rested], _REST_SPAN) if rests else 1.0
    effective = np.maximum(rest.samples / colour, 1.0)
    at_rest = np.where(known, rest.variance / np.maximum(1 - 2 * len(rests) / effective, 0.5), 0.0)

    # A sensor whose noise is below its resolution may show none at rest; in motion its steps make an error that is coloured
    # where the motion is slow, and of which no model is to blame.
    steps = _of_steps(decays)
    by_colour = left.neighbour - np.where(known, rest.neighbour, 0.0) - steps
    by_variance = np.where(known, left.variance - at_rest - steps, 0.0)
    samples = np.maximum(left.samples, 1.0)
    error = np.sqrt(2) * left.variance * np.sqrt(colour / samples + np.where(known, 1 / effective, 0.0))
    excess = np.max([np.where(part > _SIGNIFICANT * error, part, 0.0) for part in (by_colour, by_variance)], axis=0)

    tiny = np.finfo(float).tiny
    return Misfit(
        relative=np.sqrt(excess / np.maximum(signal.variance, tiny)),
        ratio=np.sqrt(np.where(known, left.variance / np.maximum(at_rest + steps, tiny), np.nan)),
    )


def _of_steps(decays: Sequence[Decay]) -> Real:
    """Give the mean square of rounding to each channel's resolution at its worst, (m/s²)², shape (channel,).

    Where a slow signal stays between two steps, the error is not spread evenly over a step but nearer to its ends.
    """
    steps = [np.where(decay.usable, resolution(np.nan_to_num(decay.values)), np.inf) for decay in decays]
    smallest = np.min(steps, axis=0)
    return np.where(np.isfinite(smallest), smallest, 0.0) ** 2 / 6


class _Moments(NamedTuple):
    variance: Real
    neighbour: Real
    samples: Real


def _moments(records: Iterable[Real]) -> _Moments:
    """Pool variance and covariance of neighbouring samples over records, by channel; NaN channels count nothing."""
    sums = []
    for record in records:
        clean = np.nan_to_num(record)
        neighbours = np.einsum("ct,ct->c", clean[:, 1:], clean[:, :-1])
        sums.append([np.einsum("ct,ct->c", clean, clean), neighbours, np.sum(~np.isnan(record), axis=1)])
    variance, neighbour, samples = np.sum(sums, axis=0)
    count = np.maximum(samples, 1.0)
    return _Moments(variance / count, neighbour / count, samples)
