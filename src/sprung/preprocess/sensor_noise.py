"""The sensors' own noise: what they read at rest, and which colour it has."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.preprocess.decay import FreeDecay, quantisation_variance

Real = NDArray[np.float64]

_SHORTEST_REST = 10
"""Samples below which a rest says nothing about the noise."""

_MAY_BE = 3.0
"""Standard errors by which the colour of a short rest may be another one than it seems."""

_MOST_LOST = 0.5
"""Part of the noise, at the most, that goes with the level and the creep of a rest."""

_CHANCE = 2.0
"""Standard deviations of what walks in a decay that chance may make of it."""


class Moments(NamedTuple):
    """Variance and covariance of neighbouring samples of each channel.

    Attributes
    ----------
    variance
        (m/s²)², shape (channel,).
    neighbour
        Covariance of neighbouring samples, (m/s²)², shape (channel,).
    samples
        How many, shape (channel,).
    """

    variance: Real
    neighbour: Real
    samples: Real

    @property
    def colour(self) -> Real:
        """Correlation of neighbouring samples; 0 where nothing is known."""
        seen = self.variance > 0
        return np.where(seen, self.neighbour / np.where(seen, self.variance, 1.0), 0.0)


class SensorNoise(NamedTuple):
    """What the sensors read without any motion.

    Attributes
    ----------
    variance, neighbour
        Variance and covariance of neighbouring samples, (m/s²)²; 0 where no recording shows a rest. Shape (channel,).
    samples
        From how many samples that is known, shape (channel,).
    added
        What rounding, and noise where a high-pass was undone, may add to either in a decay, (m/s²)², shape (channel,).
    per_independent
        How many samples tell a variance as well as one independent one, shape (channel,).
    """

    variance: Real
    neighbour: Real
    samples: Real
    added: Real
    per_independent: Real


def pool_moments(records: Iterable[Real]) -> Moments:
    """Pool variance and covariance of neighbouring samples over records, by channel; NaN channels count nothing.

    Parameters
    ----------
    records
        Each of shape (channel, time).

    Returns
    -------
    Moments
    """
    sums = []
    for record in records:
        clean = np.nan_to_num(record)
        neighbours = np.einsum("ct,ct->c", clean[:, 1:], clean[:, :-1])
        sums.append([np.einsum("ct,ct->c", clean, clean), neighbours, np.sum(~np.isnan(record), axis=1)])
    variance, neighbour, samples = np.sum(sums, axis=0)
    count = np.maximum(samples, 1.0)
    return Moments(variance / count, neighbour / count, samples)


def estimate_sensor_noise(decays: Sequence[FreeDecay], left: Moments) -> SensorNoise:
    """Tell what the sensors read without any motion.

    Parameters
    ----------
    decays
        With their rests.
    left
        Of the residuals of a fit.

    Returns
    -------
    SensorNoise

    Notes
    -----
    A rest is short, and its level and creep were taken off it: of noise that is correlated for long it shows too little,
    and its colour badly. Residuals are long; as far as the rest admits it, their colour is that of the noise. With the
    correlation rho of neighbours in a first-order process a mean of n samples has (1 + rho)/(1 - rho)/n of the variance of
    one of them, level and creep each take as much of it away, and n samples tell the variance as well as
    n (1 - rho²)/(1 + rho²) independent ones (Bartlett, J. R. Stat. Soc. Suppl. 8 (1946) 27).
    """
    rests = [decay.rest.noise for decay in decays if decay.rest.noise.shape[1] >= _SHORTEST_REST]
    if not rests:
        nothing = np.zeros(len(left.variance))
        return SensorNoise(nothing, nothing, nothing, quantisation_variance(decays), np.ones_like(nothing))
    seen = pool_moments(rests)
    samples = np.maximum(seen.samples, 1.0)
    of_rest = np.clip(seen.colour, 0.0, 1.0)
    admitted = of_rest + _MAY_BE * np.sqrt((1 - of_rest**2) / samples)
    colour = np.clip(np.minimum(left.colour, admitted), of_rest, 1 - 1 / samples)
    of_means = (1 + colour) / (1 - colour)
    lost = np.minimum(2 * len(rests) / samples * of_means, _MOST_LOST)
    more = seen.variance * lost / (1 - lost)
    known = seen.samples > 0
    return SensorNoise(
        np.where(known, seen.variance + more, 0.0),
        np.where(known, seen.neighbour + more, 0.0),
        seen.samples,
        quantisation_variance(decays) + _CHANCE**2 * _walk(decays) * of_means * (seen.variance + more),
        (1 + colour**2) / (1 - colour**2),
    )


def _walk(decays: Sequence[FreeDecay]) -> Real:
    """Give the mean square to which white noise of one grows where a high-pass was undone, at its most; shape (channel,).

    What is undone is an integral with the corner ω as its rate. An error σ/√n of the level at rest becomes the ramp
    ω t σ/√n, of mean square (ω T)²/12 σ²/n about its mean; noise becomes a walk, of ω² T/(6 f) σ².
    """
    most = np.zeros(len(decays[0].values))
    for decay in decays:
        if decay.high_pass and decay.rest.noise.shape[1]:
            lasts, rested = decay.samples / decay.rate, decay.rest.noise.shape[1]
            grown = lasts**2 / (12 * rested) + lasts / (6 * decay.rate)
            most = np.maximum(most, (2 * np.pi * np.array(decay.high_pass)) ** 2 * grown)
    return most
