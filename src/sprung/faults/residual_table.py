"""The residuals of a fit by drop and channel, beside what the sensors read at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitResult
from sprung.preprocess import FreeDecay, SensorNoise
from sprung.selection import required_gain
from sprung.vehicle import is_of_sensor

Real = NDArray[np.float64]

_EXPLAINED = 1.5
"""Residual of a channel in a drop over its noise at rest, up to which the records are explained."""

_CHANCE = 4.0
"""Standard errors by which a residual may exceed the noise at rest by chance."""

_LEAST_NOISE = 1e-3
"""Noise as a part of a channel's signal, below which no model error matters: for records without any."""

_FEW = 50
"""Samples at rest below which they say nothing about the noise."""


@dataclass(frozen=True, eq=False)
class ResidualTable:
    """Residuals by drop and channel.

    Attributes
    ----------
    residual
        Sums of squares, (m/s²)², shape (drop, channel); 0 for what is left out.
    counts
        Samples of each, 0 for what is left out.
    penalty
        How far the sensors of the fit are from what is stated of them, in standard uncertainties, squared and summed.
    uncertainties
        How many uncertainties are stated of them.
    """

    residual: Real
    counts: Real
    penalty: float = 0.0
    uncertainties: int = 0

    @cached_property
    def cost(self) -> float:
        """Minus twice the log-likelihood with every channel's noise fitted, up to a constant."""
        residual, counts = self.residual.sum(axis=0), self.counts.sum(axis=0)
        there = counts > 0
        variances = np.maximum(residual[there] / counts[there], 1e-24)
        return float(np.sum(counts[there] * np.log(variances))) + self.penalty

    def inflated_cost(self, overdispersion: float) -> float:
        """Return the same where the records count for less by a factor; what is stated of the sensors counts whole."""
        return (self.cost - self.penalty) / overdispersion + self.penalty

    def explicable(self, noise: SensorNoise) -> float:
        """Return what twice the log-likelihood would gain if nothing but noise were left."""
        counts = self.counts.sum(axis=0)
        used = counts > 0
        return self.cost - float(np.sum(counts[used] * np.log(noise.level[used] ** 2)))

    def ratio(self, noise: SensorNoise) -> Real:
        """Return residual over noise, root-mean-square, of each drop and channel; 0 for what is left out."""
        ratio: Real = np.sqrt(self.residual / np.maximum(self.counts, 1)) / noise.level
        return ratio

    def _excess(self, noise: SensorNoise) -> Real:
        """Return the same ratio over its upper limit in noise alone."""
        errors = noise.per_independent * (0.5 / noise.samples + 0.5 / np.maximum(self.counts, 1))
        excess: Real = self.ratio(noise) / (1 + _CHANCE * np.sqrt(errors))
        return excess

    def misfit(self, noise: SensorNoise) -> float:
        """Return what the residuals are beyond noise, and the sensors beyond what is stated, in twice the log-likelihood."""
        excess = max(self.penalty - self._largest_penalty, 0.0)
        return float(np.sum(self.counts * 2 * np.log(np.maximum(self._excess(noise), 1.0)))) + excess

    @cached_property
    def _largest_penalty(self) -> float:
        """Penalty of sensors that are as stated, by chance: chi-squared, of which each uncertainty is a degree of freedom."""
        return required_gain(self.uncertainties, 1, 1.0)

    def explained_channels(self, noise: SensorNoise) -> NDArray[np.bool_]:
        """Of which channels the residuals are noise alone, shape (channel,)."""
        excess = np.minimum(self.ratio(noise) / _EXPLAINED, self._excess(noise))
        return np.asarray(excess.max(axis=0, initial=0.0) < 1)

    def is_explained(self, noise: SensorNoise) -> bool:
        """Whether the residuals are noise alone, and the sensors what is stated of them."""
        return bool(self.explained_channels(noise).all()) and self.penalty <= self._largest_penalty

    def with_part(self, drops: Sequence[int], channels: Sequence[int], residual: Real, counts: Real) -> ResidualTable:
        """Return the table with the residuals of some channels of some drops replaced; both of shape (drop, channel)."""
        whole = ResidualTable(self.residual.copy(), self.counts.copy(), self.penalty, self.uncertainties)
        whole.residual[np.ix_(drops, channels)] = residual
        whole.counts[np.ix_(drops, channels)] = counts
        return whole


def residual_table(recordings: Sequence[str], decays: Sequence[FreeDecay], optimum: FitResult) -> ResidualTable:
    """Return the residuals of a fit.

    Parameters
    ----------
    recordings
        Names of the rows, whether they were fitted or not.
    decays
        What was fitted.
    optimum
        Where that ended.

    Returns
    -------
    ResidualTable
    """
    left = optimum.residual_sums
    residual, counts = np.zeros((len(recordings), left.shape[1])), np.zeros((len(recordings), left.shape[1]))
    # Of a record on pads not its samples count but its lines.
    for decay, of_decay, numbers in zip(decays, left, optimum.problem.objective.observations, strict=True):
        row = recordings.index(decay.file)
        counts[row] = decay.usable * numbers
        residual[row] = np.where(decay.usable, of_decay, 0.0)
    uncertainties = sum(map(is_of_sensor, optimum.names))
    return ResidualTable(residual, counts, optimum.sensor_penalty, uncertainties)


def reference_noise(decays: Sequence[FreeDecay], optimum: FitResult) -> SensorNoise:
    """Return what the sensors read at rest.

    Where too little rest was recorded, noise is what of the residuals changes from one sample to the next.

    Parameters
    ----------
    decays
        What was fitted, with the readings at rest.
    optimum
        Where that ended.

    Returns
    -------
    SensorNoise
    """
    samples = np.maximum(np.sum([decay.usable * decay.samples for decay in decays], axis=0), 1)
    signal = np.sqrt(optimum.problem.objective.energy / samples)
    noise = optimum.sensor_noise
    few = noise.samples < _FEW
    variance = noise.variance
    if few.any():
        differences = [np.nansum(np.diff(record, n=2, axis=1) ** 2, axis=1) for record in optimum.residuals]
        variance = np.where(few, np.sum(differences, axis=0) / 6 / samples, variance)
    least = np.maximum(_LEAST_NOISE * signal, np.finfo(float).tiny ** 0.5) ** 2
    return noise._replace(
        variance=np.maximum(variance, least - noise.added),
        samples=np.maximum(noise.samples, _FEW),
        per_independent=np.where(few, 1.0, noise.per_independent),
    )


def is_explained(decays: Sequence[FreeDecay], optimum: FitResult) -> bool:
    """Whether the residuals of a fit are noise alone.

    Parameters
    ----------
    decays, optimum
        As for `reference_noise`.

    Returns
    -------
    bool
    """
    return residual_table([decay.file for decay in decays], decays, optimum).is_explained(
        reference_noise(decays, optimum)
    )
