"""A decay: the part of a recording in which the free-vibration model holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import LoggerClock
from sprung.errors import Fault
from sprung.preprocess.events import Events
from sprung.preprocess.release import Release, resolution
from sprung.vehicle import Wheel

FITTED, FREE = "in the fitted vehicle every tyre is down for good", "the fitted vehicle moves freely"
"""Why a fit uses a decay from elsewhere than the recording alone shows; after a push or a bump."""


@dataclass(frozen=True, eq=False)
class FlightLikelihood:
    """Log-likelihood of the samples between release and landing near a vehicle, to second order; independent of the clocks.

    Attributes
    ----------
    names
        Of the vehicle's parameters, half-distances of springs and dampers separate.
    at
        Their values at the point of expansion, SI, shape (parameter,).
    gradient, information
        Of the log-likelihood of these samples by the parameters, there; shapes (parameter,), (parameter, parameter).
    chi_square
        Sum of squared residuals there over the variance of the noise.
    samples
        Number of samples.
    """

    names: tuple[str, ...]
    at: NDArray[np.float64]
    gradient: NDArray[np.float64]
    information: NDArray[np.float64]
    chi_square: float
    samples: int

    def chi_square_at(self, values: NDArray[np.float64]) -> float:
        """Return the sum of squared residuals over the noise variance for other parameter values, shape (parameter,)."""
        step = values - self.at
        return float(self.chi_square + step @ (self.information @ step - 2 * self.gradient))


@dataclass(frozen=True, eq=False)
class FreeDecay:
    """The :term:`free decay` of one drop: the part of its recording in which the free-vibration model holds.

    Attributes
    ----------
    name
        The drop's short name.
    file
        The recording's file name.
    load
        Name of the load on the vehicle.
    values
        Shape (channel, time), m/s², positive up; NaN throughout in a channel that is left out.
    earlier
        The samples before them, back to the first landing: they belong to the decay if no tyre lifts off again, which
        the accelerometers alone do not show for certain. Shape (channel, time); none where the campaign states the start.
    rate
        Samples per second.
    start
        Time of the first sample on the file's own clock, s.
    rest
        What the sensors read while the vehicle stood on the blocks.
    faults
        Of the drop.
    clocks
        Of several loggers, relative to the recording's clock; empty where all channels have one clock.
    rate_ratios
        Sampling rate of each channel over that of the decay; empty where it is 1 for all of them.
    high_pass
        Cut-off of the high-pass that was undone in each channel, Hz, 0 where none was; empty for none at all.
    initial_velocity
        Reading of each sensor above its level at rest, integrated from rest to the first of the `earlier` samples with the
        memory of the high-pass that was undone, m/s, shape (channel,).
    events
        Times of release and landing, and the reasons for the limits of the decay.
    flight
        Log-likelihood of the flight before it; None where that is not used.
    pads
        Wheel stations whose pads drove the vehicle all along, so that it is no free decay but a forced response.
    is_driven
        Whether a push or a bump drove the vehicle before it, so that only a fit shows which samples are free vibration.
    """

    name: str
    file: str
    load: str
    values: NDArray[np.float64]
    earlier: NDArray[np.float64]
    rate: float
    start: float
    rest: Release
    faults: tuple[Fault, ...] = ()
    clocks: tuple[LoggerClock, ...] = ()
    high_pass: tuple[float, ...] = ()
    rate_ratios: tuple[float, ...] = ()
    initial_velocity: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    events: Events = field(default_factory=Events)
    flight: FlightLikelihood | None = None
    pads: tuple[Wheel, ...] = ()
    is_driven: bool = False

    @cached_property
    def usable(self) -> NDArray[np.bool_]:
        """Which channels are not left out; shape (channel,)."""
        usable: NDArray[np.bool_] = np.logical_not(np.isnan(self.values).any(axis=1))
        return usable

    @cached_property
    def energy(self) -> NDArray[np.float64]:
        """Sum of squares about the mean of each channel, (m/s²)², shape (channel,); NaN in channels that are left out."""
        energy: NDArray[np.float64] = self.values.var(axis=1) * self.samples
        return energy

    @cached_property
    def resolution(self) -> NDArray[np.float64]:
        """Resolution of each channel as it was recorded, m/s², shape (channel,); 0 in channels that are left out."""
        unknown = np.isnan(self.rest.step)
        return np.where(unknown, resolution(self.values), self.rest.step) if unknown.any() else self.rest.step

    @property
    def samples(self) -> int:
        """Samples in each channel."""
        return int(self.values.shape[1])

    def shifted(self, samples: int) -> FreeDecay:
        """Return the decay with another start.

        Parameters
        ----------
        samples
            By which it starts later, or where negative earlier, at most as far as `earlier` reaches.
        """
        whole = np.concatenate([self.earlier, self.values], axis=1)
        first = self.earlier.shape[1] + samples
        start = self.start + samples / self.rate
        events = replace(self.events, why_fit=FREE if self.is_driven else FITTED) if samples else self.events
        return replace(self, values=whole[:, first:], earlier=whole[:, :first], start=start, events=events)

    def samples_to(self, time: float) -> int:
        """Return how many samples after its start a time on the file's own clock is, s; negative before it."""
        return round((time - self.start) * self.rate)

    def starting_at(self, time: float) -> FreeDecay:
        """Return the decay from a time on the file's own clock on, s, or from where its recording first shows that it may."""
        return self.shifted(max(self.samples_to(time), -self.earlier.shape[1]))

    @property
    def end(self) -> float:
        """Time of the last sample on the file's own clock, s."""
        return self.start + (self.samples - 1) / self.rate


def quantisation_variance(decays: Sequence[FreeDecay]) -> NDArray[np.float64]:
    """Variance of quantisation of each channel, at most.

    Where a slow signal stays between two steps, the error is not uniform over a step but nearer to its ends.

    Parameters
    ----------
    decays
        All decays; a channel counts where it is not left out.

    Returns
    -------
    ndarray
        (m/s²)², shape (channel,).
    """
    steps = np.array([np.where(decay.usable, decay.resolution, np.inf) for decay in decays]).min(axis=0)
    worst: NDArray[np.float64] = np.where(np.isfinite(steps), steps, 0.0) ** 2 / 6
    return worst
