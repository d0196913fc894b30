"""Measured against simulated in the coordinates of the body: its vertical, pitch and roll acceleration, figures 7 to 9."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.assessment.residuals import estimate_noise_level
from sprung.display import shown
from sprung.estimation import FitResult, FitStatistics
from sprung.preprocess import FreeDecay
from sprung.vehicle import FULL, Layout, Readout, Sensor, layout_of, wheelbase_of

Real = NDArray[np.float64]

MOTIONS = ("vertical", "pitch", "roll")
"""Motions of the body: figures 7, 8 and 9 of the paper."""


def motions_of(layout: Layout) -> tuple[str, ...]:
    """Return the motions that the body of a vehicle, or of a part of one, has.

    Parameters
    ----------
    layout
        Of the vehicle.

    Returns
    -------
    tuple of str
        Some of `MOTIONS`.

    Examples
    --------
    >>> from sprung.vehicle import LAYOUTS
    >>> motions_of(LAYOUTS["roll-plane"])
    ('vertical', 'roll')
    """
    return tuple(motion for motion, one in zip(MOTIONS, FULL.body, strict=True) if one in layout.body)


_SEEN = 1e-6
"""Part of a motion that the sensors may leave undetermined."""

_COMPARABLE = 3.0
"""Root-mean-square of a motion over its noise from which an error in percent of it is one of the model."""

_SIGNIFICANT = 4.0
"""Standard deviations by which its mean square must exceed that of the noise for a motion to be there at all."""


@shown
@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Motion of the body in one drop, measured and simulated.

    Attributes
    ----------
    name
        The drop's.
    time
        s on the recording's clock, shape (time,).
    measured, simulated
        Vertical acceleration of the centre of gravity, m/s², pitch and roll acceleration, rad/s², each with its mean taken
        off; shape (3, time). NaN for what the sensors in use do not determine.
    noise
        Noise of each at rest, m/s² and rad/s² root-mean-square, shape (3,).
    noise_samples
        Number of independent samples from which that noise is known.
    """

    name: str
    time: Real
    measured: Real
    simulated: Real
    noise: Real
    noise_samples: float = np.inf

    @cached_property
    def errors(self) -> Real:
        """Normalised errors: rms of the difference over rms of the measured, shape (3,).

        NaN for what the sensors do not determine, and for motions so small that the error would be one of their noise.
        """
        size = _rms(self.measured)
        there = size > _COMPARABLE * self.noise
        return np.where(there, _rms(self.measured - self.simulated) / np.where(there, size, 1.0), np.nan)

    @cached_property
    def over_noise(self) -> Real:
        """Root-mean-square of each motion over that of the noise, shape (3,); NaN where no motion is significant.

        Notes
        -----
        The mean square of N independent samples of noise alone has a relative standard deviation of √(2/N), and that of the
        noise itself is known from a number of samples. Noise of which neighbours are correlated by ρ counts N (1 - ρ²)/(1 + ρ²)
        samples (Bartlett 1946); ρ is that of measured minus simulated.
        """
        size, residual = _rms(self.measured), self.measured - self.simulated
        variance = np.maximum(np.mean(residual**2, axis=-1), np.finfo(float).tiny)
        correlation = np.clip(np.mean(residual[:, 1:] * residual[:, :-1], axis=-1) / variance, 0.0, 0.99)
        independent = self.measured.shape[1] * (1 - correlation**2) / (1 + correlation**2)
        chance = np.sqrt(2 / independent + 2 / self.noise_samples)
        ratio = size / np.where(self.noise > 0, self.noise, 1.0)
        there = np.where(self.noise > 0, ratio**2 > 1 + _SIGNIFICANT * chance, size > 0)
        return np.where(there, ratio, np.nan)


def body_motions(
    fit: FitResult, decays: Sequence[FreeDecay], fitted: Sequence[Real], sensors: Sequence[Sensor]
) -> tuple[BodyMotion, ...]:
    """Compute the motion of the body from its sensors, measured and simulated.

    Parameters
    ----------
    fit
        The fit.
    decays
        What was fitted.
    fitted
        What the model says of them, their means subtracted, m/s²; one array of shape (channel, time) per drop.
    sensors
        The sensors, in the order of the decays' channels.

    Returns
    -------
    tuple of BodyMotion
        One for each drop.
    """
    rows, noise = body_rows(fit, sensors), estimate_noise_level(fit)
    at_rest = sum(decay.rest.noise.shape[1] for decay in decays)
    known_from = float(at_rest or sum(decay.samples for decay in decays))
    # Drops usually have all their channels, and then one inverse.
    inverses: dict[tuple[bool, ...], tuple[Real, Real]] = {}
    for used in {tuple(decay.usable.tolist()) for decay in decays}:
        own = motion_from_channels(rows, np.where(used, noise, np.inf))
        determined = np.abs(own @ rows - np.eye(3)).max(axis=1) < _SEEN
        inverses[used] = np.where(determined[:, None], own, np.nan)[:, np.array(used)], np.sqrt(own**2 @ noise**2)
    motions = []
    for decay, modelled in zip(decays, fitted, strict=True):
        inverse, of_motion = inverses[tuple(decay.usable.tolist())]
        measured = inverse @ decay.values[decay.usable]
        motions.append(
            BodyMotion(
                name=decay.name,
                time=decay.start + np.arange(decay.samples) / decay.rate,
                measured=measured - measured.mean(axis=1, keepdims=True),
                simulated=inverse @ modelled[decay.usable],
                noise=of_motion,
                noise_samples=known_from,
            )
        )
    return tuple(motions)


def body_rows(fit: FitResult | FitStatistics, sensors: Sequence[Sensor]) -> Real:
    """Return the reading of each sensor per vertical, pitch and roll acceleration, shape (channel, 3).

    Zero on wheels, for what is no accelerometer, and for a motion that the vehicle has not.
    """
    body = layout_of(fit.names).body
    rows = np.zeros((len(sensors), 3))
    readout = Readout.of(sensors, fit.names, wheelbase_of(fit.names, fit.values))
    accelerations = readout.of_accelerations(readout.at(fit.values))
    rows[:, [FULL.body.index(one) for one in body]] = accelerations[:, : len(body)]
    on_body = np.array([sensor.on == "body" for sensor in sensors])
    return np.where(on_body[:, None], rows, 0.0)


def motion_from_channels(rows: Real, noise: Real) -> Real:
    """Return the matrix from channels to motions by weighted least squares.

    Parameters
    ----------
    rows
        Reading of each channel per motion, shape (channel, motion).
    noise
        Of each channel, infinite for one that is left out; shape (channel,).

    Returns
    -------
    ndarray
        Shape (motion, channel).
    """
    weights = 1 / noise
    inverse: Real = np.linalg.pinv(rows * weights[:, None]) * weights
    return inverse


def _rms(values: Real) -> Real:
    size: Real = np.sqrt(np.mean(values**2, axis=-1))
    return size
