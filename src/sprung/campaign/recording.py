"""One recording: the samples of one drop, in SI, positive up, on one clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.errors import Fault
from sprung.vehicle import with_separate_tracks

CLOCK_STD = 0.05
"""Standard uncertainty of a clock offset that was estimated from the first motion in the records alone, s."""


@shown
@dataclass(frozen=True, eq=False)
class LoggerClock:
    """Clock of one of several loggers of a drop, relative to the recording's clock.

    Attributes
    ----------
    name
        Name of the logger.
    channels
        Positions of the channels that it recorded.
    offset
        Reading of its clock at time zero of the recording, s, estimated from the release.
    rate_ratio
        Ratio of its sampling rate to that of the recording; at most 1.
    delay, delay_std
        Delay of its samples behind the time that the recording gives them, and its standard uncertainty, s.
    d_delay_d_parameter
        Derivative of the delay with respect to the parameters of the vehicle from which it was estimated, s per SI unit.
    """

    name: str
    channels: tuple[int, ...]
    offset: float
    rate_ratio: float = 1.0
    delay: float = 0.0
    delay_std: float = CLOCK_STD
    d_delay_d_parameter: Mapping[str, float] = field(default_factory=dict)

    def expected_delay(self, parameters: Mapping[str, float]) -> float:
        """Return the expected delay of its samples, s.

        Parameters
        ----------
        parameters
            Of the vehicle, SI.
        """
        apart = with_separate_tracks(parameters)
        return self.delay + sum(slope * apart[name] for name, slope in self.d_delay_d_parameter.items())


@shown
@dataclass(frozen=True, eq=False)
class Recording:
    """The samples of one drop.

    Attributes
    ----------
    name
        The file's name.
    channels
        Channel names, in the order of the campaign's sensors.
    values
        Shape (channel, time), m/s², positive up, gravity still in it. A channel that is left out is NaN throughout, and
        a fault says why.
    start
        Time of the first sample on the file's own clock, s.
    rate
        Samples per second.
    history
        What was done to it since it was read, in words, in order.
    faults
        What is wrong with it.
    parts
        Where several loggers recorded the drop, what each of them did, on its own clock and with its own channels.
    clocks
        For several loggers how their clocks stand to this one; without any, all channels have one clock.
    full_scale
        The largest reading of each channel's sensor, m/s², by the unit of the file if nothing else names one; None where
        nobody says it. Empty where no file was read: the sensors' own units hold then.
    rate_ratios
        Sampling rate of each channel over that of the recording, below 1 where a slower clock of the file sampled it. Empty
        where it is 1 for all of them.
    """

    name: str
    channels: tuple[str, ...]
    values: NDArray[np.float64]
    start: float
    rate: float
    history: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()
    parts: tuple[Recording, ...] = ()
    clocks: tuple[LoggerClock, ...] = ()
    full_scale: tuple[float | None, ...] = ()
    rate_ratios: tuple[float, ...] = ()

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of every sample on the file's own clock, s; shape (time,)."""
        return self.start + np.arange(self.values.shape[1]) / self.rate

    @cached_property
    def usable(self) -> NDArray[np.bool_]:
        """Which channels are not left out; shape (channel,)."""
        usable: NDArray[np.bool_] = np.logical_not(np.isnan(self.values).any(axis=1))
        return usable
