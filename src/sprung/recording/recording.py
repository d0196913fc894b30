"""One recording: the samples of one drop, in SI, positive up, on one clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault


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
    """

    name: str
    channels: tuple[str, ...]
    values: NDArray[np.float64]
    start: float
    rate: float
    history: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of every sample on the file's own clock, s; shape (time,)."""
        return self.start + np.arange(self.values.shape[1]) / self.rate

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Which channels are not left out; shape (channel,)."""
        return np.logical_not(np.isnan(self.values).any(axis=1))
