"""Ranking of starts: how much of the decimated records each of many vehicles leaves unexplained, all of them at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.modal_solution import solve_modes
from sprung.estimation.projected_response import amplitude_prior, inverse_of
from sprung.vibration import exponential_gram

if TYPE_CHECKING:
    from sprung.estimation.closed_form import ClosedFormObjective

Real = NDArray[np.float64]

_RATE = 120.0
"""Samples per second that are enough to rank vehicles: an exponential is one however sparsely it is sampled."""

_LONGEST, _MOST = 10.0, 8  # s of each decay, and decays


def rank_starts(objective: ClosedFormObjective, vehicles: Real, weights: Real) -> Real:
    """Return what vehicles leave unexplained of some of the records with most drops that share load, rate and channels.

    Parameters
    ----------
    objective
        The likelihood of the records.
    vehicles
        Parameters, SI, shape (vehicle, parameter).
    weights
        1/σ² of each channel, shape (channel,).

    Returns
    -------
    ndarray
        Residual sums of squares over their energy, shape (vehicle, channel).
    """
    groups = [(batch, group) for batch in objective.batches for group in range(len(batch.load))]
    largest, group = max(groups, key=lambda pair: int(np.sum(pair[0].group == pair[1])))
    batch = largest.decimated(group, _RATE, _LONGEST, _MOST)
    energy = batch.energy.sum(axis=0)
    modes = solve_modes(objective.models[objective.loads[batch.load[0]]], objective.sensors, vehicles)
    exponent = modes.poles * batch.step
    data = batch.correlate(exponent.reshape(1, -1), secular=False)
    data = data.reshape(*data.shape[:2], *exponent.shape).transpose(2, 1, 3, 0)

    # All records are as long as each other: vehicles differ in their normal equations, drops do not.
    gram = exponential_gram(exponent, np.full(len(exponent), batch.samples[0]), secular=False)
    shapes, w = modes.shapes, batch.channel_weights * weights
    weighted = np.swapaxes(shapes.conj(), 1, 2) * w
    inverse = inverse_of((weighted @ shapes) * gram + amplitude_prior(modes))
    projected = np.sum(weighted.swapaxes(1, 2)[..., None] * data, axis=1)
    q = inverse @ projected
    fitted = shapes[..., None] * q[:, None]
    explained = np.sum(fitted.conj() * (2 * data - gram[:, None] @ fitted), axis=(2, 3)).real
    parts: Real = np.maximum(energy - explained, 0.0) / np.where(energy > 0, energy, 1.0)
    return parts
