"""Rating of starts: how much of some of the records each of many vehicles leaves unexplained, all of them at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.identification.likelihood import Likelihood
from sprung.identification.longhand import REACH
from sprung.identification.solution import solve_modes
from sprung.identification.sums import blocks, correlate, gram
from sprung.vehicle import LinearModel

Real = NDArray[np.float64]

_RATE = 120.0
"""Samples per second that are enough to tell vehicles apart: an exponential is one however sparsely it is sampled."""


def rate_vehicles(likelihood: Likelihood, vehicles: Real, weights: Real) -> Real:
    """Give what vehicles leave unexplained of the records with most drops that share load, rate and channels.

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
    model, present, records, step = _thinned(likelihood)
    energy = np.sum(records**2, axis=(0, 2))
    modes = solve_modes(model, likelihood.sensors, vehicles)
    exponent = modes.poles * step
    drops, _, samples = records.shape

    upper = exponent.imag >= 0
    of_pair = (np.cumsum(upper) - 1).reshape(upper.shape)
    cut = np.concatenate([blocks(record) for record in records])
    counts, one = np.full(drops, len(cut) // drops), np.zeros(drops, dtype=np.int64)
    half = correlate(cut, counts, exponent[upper][None], one, secular=False)[:, :, 0]
    data = np.where(upper, half[..., of_pair], half[..., of_pair].conj()).transpose(2, 1, 3, 0)

    # All records as long as each other: vehicles differ in their normal equations, drops do not.
    products = gram(exponent, np.full(len(exponent), samples), secular=False)
    shapes, w = modes.shapes, present * weights
    weighted = np.swapaxes(shapes.conj(), 1, 2) * w
    reach = (np.swapaxes(modes.right.conj(), 1, 2) / REACH**2) @ modes.right
    normal = (weighted @ shapes) * products + reach
    scale = 1 / np.sqrt(np.diagonal(normal, axis1=1, axis2=2).real)
    both = scale[:, :, None] * scale[:, None, :]
    projected = np.sum(weighted.swapaxes(1, 2)[..., None] * data, axis=1)
    q = (np.linalg.inv(normal * both) * both) @ projected
    fitted = shapes[..., None] * q[:, None]
    explained = np.sum(fitted.conj() * (2 * data - products[:, None] @ fitted), axis=(2, 3)).real
    return np.maximum(energy - explained, 0.0) / np.where(energy > 0, energy, 1.0)


def _thinned(likelihood: Likelihood) -> tuple[LinearModel, Real, Real, float]:
    """Give model, channels, records of one length, centred, and sampling interval of the largest group of records."""
    run, group = max(
        ((run, group) for run in likelihood.records.runs for group in range(len(run.load))),
        key=lambda one: int(np.sum(one[0].group == one[1])),
    )
    own = np.flatnonzero(run.group == group)
    every = max(int(1 / (run.step[group] * _RATE)), 1)
    long = own[2 * run.samples[own] >= run.samples[own].max()]
    samples = int(run.samples[long].min())
    records = np.array([run.record(i)[:, :samples:every] for i in long.tolist()])
    centred = records - records.mean(axis=2, keepdims=True)
    return likelihood.models[run.load[group]], run.present, centred, every * float(run.step[group])
