"""One recording: the samples of one drop, in SI, positive up, on one clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.errors import Fault
from sprung.vehicle import with_separate_tracks

ROUGHLY = 0.05
"""s: how far two clocks may stand apart where only the first motion that a logger shows has tied them."""


@shown
@dataclass(frozen=True, eq=False)
class LoggerClock:
    """One of several loggers of a drop, and how its clock stands to the recording's.

    Attributes
    ----------
    name
        The logger's.
    channels
        Which channels it recorded, by their positions.
    ahead
        What its own clock shows when the recording's shows zero, s, as far as the release tells.
    share
        Samples that it took for each one in the recording: below 1 where it was slower.
    late, std
        By how much later its samples were taken than the recording's clock says, and how sure that is, s.
    follows
        By how much that grows with each parameter of the vehicle that told it, s per SI unit, by the parameter's name.
    """

    name: str
    channels: tuple[int, ...]
    ahead: float
    share: float = 1.0
    late: float = 0.0
    std: float = ROUGHLY
    follows: Mapping[str, float] = field(default_factory=dict)

    def expected(self, parameters: Mapping[str, float]) -> float:
        """Give how late it is as far as is known, s, for a vehicle of these parameters, SI."""
        apart = with_separate_tracks(parameters)
        return self.late + sum(slope * apart[name] for name, slope in self.follows.items())


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
    shares
        Samples that were taken of each channel for each one that is here, below 1 where a slower clock kept it than the
        file's others. Empty where it is 1 for all of them.
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
    shares: tuple[float, ...] = ()

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of every sample on the file's own clock, s; shape (time,)."""
        return self.start + np.arange(self.values.shape[1]) / self.rate

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Which channels are not left out; shape (channel,)."""
        return np.logical_not(np.isnan(self.values).any(axis=1))
