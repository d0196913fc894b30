"""Sensor noise at rest: variance and autocorrelation, from the rests of the drops and the residuals of a fit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.preprocess.decay import FreeDecay, quantisation_variance

Real = NDArray[np.float64]

Moments = tuple[Real, Real, Real]
"""Variance and covariance of neighbouring samples, (m/s²)², and number of samples, of each channel; shapes (channel,)."""

_SHORTEST_REST = 10
"""Samples below which a rest is no estimate of the noise."""

_MAY_BE = 3.0
"""Standard errors by which the autocorrelation of a short rest may differ from its estimate."""

_MOST_LOST = 0.5
"""Part of the noise, at the most, that is removed with the level and the creep of a rest."""

_LOUD = 2.0
"""Times the usual level of rests, beyond which one is none: the vehicle still moves on its blocks."""

_CHANCE = 2.0
"""Standard deviations of the random walk in a decay that chance may make of it."""


class SensorNoise(NamedTuple):
    """Noise of the sensors without any motion.

    Attributes
    ----------
    variance, neighbour
        Variance and covariance of neighbouring samples, (m/s²)²; 0 where no recording shows a rest. Shape (channel,).
    samples
        Number of samples from which they are known, shape (channel,).
    added
        What quantisation, and noise where a high-pass was undone, may add to either in a decay, (m/s²)², shape (channel,).
    per_independent
        Number of samples that determine a variance as well as one independent sample, shape (channel,).
    """

    variance: Real
    neighbour: Real
    samples: Real
    added: Real
    per_independent: Real

    @property
    def level(self) -> Real:
        """Standard deviation in a decay, m/s², shape (channel,)."""
        level: Real = np.sqrt(self.variance + self.added)
        return level

    @property
    def per_independent_mean(self) -> Real:
        """Number of samples that determine a mean as well as one independent sample, shape (channel,)."""
        rho = np.sqrt((self.per_independent - 1) / (self.per_independent + 1))
        return np.asarray((1 + rho) / (1 - rho))

    def where(self, chosen: NDArray[np.bool_], other: SensorNoise) -> SensorNoise:
        """Return the noise of chosen channels, shape (channel,), that of all others taken from another one."""
        return SensorNoise(*(np.where(chosen, own, before) for own, before in zip(self, other, strict=True)))


def pool_moments(records: Iterable[Real]) -> Moments:
    """Pool variance and covariance of neighbouring samples over records.

    Parameters
    ----------
    records
        Each of shape (channel, time); NaN in channels that are left out.

    Returns
    -------
    variance, neighbour : ndarray
        (m/s²)², shape (channel,).
    samples : ndarray
        Number of samples, shape (channel,).
    """
    sums = []
    for record in records:
        # Every sample of a channel that is left out is NaN, and so is its sum.
        sums_of_record = np.einsum("ct,ct->c", record, record), np.einsum("ct,ct->c", record[:, 1:], record[:, :-1])
        used = ~np.isnan(sums_of_record[0])
        sums.append([*np.where(used, sums_of_record, 0.0), used * record.shape[1]])
    variance, neighbour, samples = np.sum(sums, axis=0)
    count = np.maximum(samples, 1.0)
    return variance / count, neighbour / count, samples


def estimate_sensor_noise(decays: Sequence[FreeDecay], residuals: Moments) -> SensorNoise:
    """Estimate the noise of the sensors.

    Parameters
    ----------
    decays
        With their rests.
    residuals
        Of a fit, from `pool_moments`.

    Returns
    -------
    SensorNoise

    Notes
    -----
    A rest is short, and its level and creep were taken off it: of noise with a long correlation it shows too little,
    and its autocorrelation badly. Residuals are long; as far as the rest admits it, their autocorrelation is that of the noise.
    With the correlation rho of neighbours in a first-order process a mean of n samples has (1 + rho)/(1 - rho)/n of the
    variance of one of them, level and creep each remove as much of it, and n samples determine the variance as well as
    n (1 - rho²)/(1 + rho²) independent ones (Bartlett, J. R. Stat. Soc. Suppl. 8 (1946) 27).
    """
    rests = [decay.rest.noise for decay in decays if decay.rest.noise.shape[1] >= _SHORTEST_REST]
    quantisation = quantisation_variance(decays)
    if not rests:
        nothing = np.zeros(len(quantisation))
        return SensorNoise(nothing, nothing, nothing, quantisation, np.ones_like(nothing))
    variance, neighbour, number = pool_moments(_quiet(rests, quantisation))
    samples = np.maximum(number, 1.0)
    at_rest = np.clip(_correlation(variance, neighbour), 0.0, 1.0)
    admitted = at_rest + _MAY_BE * np.sqrt((1 - at_rest**2) / samples)
    rho = np.clip(np.minimum(_correlation(*residuals[:2]), admitted), at_rest, 1 - 1 / samples)
    of_means = (1 + rho) / (1 - rho)
    lost = np.minimum(2 * len(rests) / samples * of_means, _MOST_LOST)
    removed = variance * lost / (1 - lost)
    known = number > 0
    return SensorNoise(
        np.where(known, variance + removed, 0.0),
        np.where(known, neighbour + removed, 0.0),
        number,
        quantisation + _CHANCE**2 * _random_walk(decays) * of_means * (variance + removed),
        (1 + rho**2) / (1 - rho**2),
    )


def _quiet(rests: Sequence[Real], quantisation: Real) -> list[Real]:
    """Return the rests with NaN in channels in which they are far louder than usual: there the vehicle still moved."""
    levels = np.sqrt(np.array([rest.var(axis=1) for rest in rests]) + quantisation)
    usual = np.median(np.where(np.isnan(levels), np.inf, levels), axis=0)
    return [np.where((level > _LOUD * usual)[:, None], np.nan, rest) for level, rest in zip(levels, rests, strict=True)]


def _correlation(variance: Real, neighbour: Real) -> Real:
    """Correlation of neighbouring samples; 0 where nothing is known."""
    return np.divide(neighbour, variance, out=np.zeros_like(variance), where=variance > 0)


def _random_walk(decays: Sequence[FreeDecay]) -> Real:
    """Largest mean square to which white noise of one grows where a high-pass was undone; shape (channel,).

    What is undone is an integral with the cut-off ω as its rate. An error σ/√n of the level at rest becomes the ramp
    ω t σ/√n, of mean square (ω T)²/12 σ²/n about its mean; noise becomes a random walk, of ω² T/(6 f) σ².
    """
    largest = np.zeros(len(decays[0].values))
    for decay in decays:
        if decay.high_pass and decay.rest.noise.shape[1]:
            duration, rested = decay.samples / decay.rate, decay.rest.noise.shape[1]
            grown = duration**2 / (12 * rested) + duration / (6 * decay.rate)
            largest = np.maximum(largest, (2 * np.pi * np.array(decay.high_pass)) ** 2 * grown)
    return largest
