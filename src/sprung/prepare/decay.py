"""A decay: the part of a recording in which the free-vibration model holds."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.prepare.events import Events
from sprung.prepare.release import Rest
from sprung.recording import LoggerClock

FITTED = "in the fitted vehicle every tyre is down for good"
"""Why a decay starts where it does, once a fit has moved its start."""


@dataclass(frozen=True, eq=False)
class Decay:
    """The usable part of one drop.

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
        the accelerometers alone do not tell for certain. Shape (channel, time); none where the user gave the start.
    rate
        Samples per second.
    start
        Time of the first sample on the file's own clock, s.
    rest
        What the sensors read while the vehicle stood on the blocks.
    faults
        What is wrong with the drop.
    clocks
        For several loggers how their clocks stand to this one; without any, all channels have one clock.
    events
        When what happened, and why the decay has its limits.
    """

    name: str
    file: str
    load: str
    values: NDArray[np.float64]
    earlier: NDArray[np.float64]
    rate: float
    start: float
    rest: Rest
    faults: tuple[Fault, ...] = ()
    clocks: tuple[LoggerClock, ...] = ()
    events: Events = field(default_factory=Events)

    @cached_property
    def usable(self) -> NDArray[np.bool_]:
        """Which channels are not left out; shape (channel,)."""
        usable: NDArray[np.bool_] = np.logical_not(np.isnan(self.values).any(axis=1))
        return usable

    @property
    def samples(self) -> int:
        """Samples in each channel."""
        return int(self.values.shape[1])

    def moved(self, samples: int) -> Decay:
        """Give the decay with its start moved.

        Parameters
        ----------
        samples
            Later, or where negative earlier, at most as far as `earlier` reaches.
        """
        whole = np.concatenate([self.earlier, self.values], axis=1)
        first = self.earlier.shape[1] + samples
        start = self.start + samples / self.rate
        events = replace(self.events, last_lift_off=start, why_start=FITTED) if samples else self.events
        return replace(self, values=whole[:, first:], earlier=whole[:, :first], start=start, events=events)

    @property
    def end(self) -> float:
        """Time of the last sample on the file's own clock, s."""
        return self.start + (self.samples - 1) / self.rate
