"""Rating of starts: how much of a sketch of the records each of many vehicles leaves unexplained, all of them at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import Likelihood
from sprung.estimation.projected_response import inverse_of, reach_of
from sprung.estimation.solution import solve_modes
from sprung.vibration import exponential_gram

Real = NDArray[np.float64]

_RATE = 120.0
"""Samples per second that are enough to tell vehicles apart: an exponential is one however sparsely it is sampled."""

_LONGEST, _MOST = 10.0, 8  # s of each decay, and decays


def rank_starts(likelihood: Likelihood, vehicles: Real, weights: Real) -> Real:
    """Give what vehicles leave unexplained of some of the records with most drops that share load, rate and channels.

    Parameters
    ----------
    likelihood
        The records.
    vehicles
        Parameters, SI, shape (vehicle, parameter).
    weights
        1/σ² of each channel, shape (channel,).

    Returns
    -------
    ndarray
        Residual sums of squares over their energy, shape (vehicle, channel).
    """
    largest = max(
        ((run, group) for run in likelihood.records.runs for group in range(len(run.load))),
        key=lambda one: int(np.sum(one[0].group == one[1])),
    )
    run = largest[0].sketch(largest[1], _RATE, _LONGEST, _MOST)
    energy = run.energy.sum(axis=0)
    modes = solve_modes(likelihood.model_of[run.load[0]], likelihood.sensors, vehicles)
    exponent = modes.poles * run.step
    data = run.correlate(exponent.reshape(1, -1), secular=False)
    data = data.reshape(*data.shape[:2], *exponent.shape).transpose(2, 1, 3, 0)

    # All records are as long as each other: vehicles differ in their normal equations, drops do not.
    products = exponential_gram(exponent, np.full(len(exponent), run.samples[0]), secular=False)
    shapes, w = modes.shapes, run.present * weights
    weighted = np.swapaxes(shapes.conj(), 1, 2) * w
    inverse = inverse_of((weighted @ shapes) * products + reach_of(modes.right))
    projected = np.sum(weighted.swapaxes(1, 2)[..., None] * data, axis=1)
    q = inverse @ projected
    fitted = shapes[..., None] * q[:, None]
    explained = np.sum(fitted.conj() * (2 * data - products[:, None] @ fitted), axis=(2, 3)).real
    shares: Real = np.maximum(energy - explained, 0.0) / np.where(energy > 0, energy, 1.0)
    return shares
