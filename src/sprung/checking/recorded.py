"""The whole recording of one drop, as figures plot it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.preprocess import DropObservation, MarkedSamples

Real = NDArray[np.float64]
Drawn = NDArray[np.float32]


@shown
@dataclass(frozen=True, eq=False)
class PlottedRecording:
    """Whole recording of one drop, in SI, corrected.

    Attributes
    ----------
    start
        Time of the first sample on the recording's clock, s.
    rate
        Samples per second.
    values
        m/s², positive up, shape (channel, time); as read in channels that are left out, NaN where nothing was read.
    marks
        Samples that have a fault.
    """

    start: float
    rate: float
    values: Drawn
    marks: tuple[MarkedSamples, ...] = ()

    @classmethod
    def of(cls, observation: DropObservation) -> PlottedRecording:
        """Make it from an observation.

        Parameters
        ----------
        observation
            Of the drop.
        """
        values, as_read = observation.recording.values, observation.drop.recording.values
        if values.shape == as_read.shape:
            values = np.where(np.isnan(values).any(axis=1, keepdims=True), as_read, values)
        return cls(
            observation.recording.start, observation.recording.rate, values.astype(np.float32), observation.marks
        )

    @property
    def time(self) -> Real:
        """Time of every sample on the recording's clock, s; shape (time,)."""
        return self.start + np.arange(self.values.shape[1]) / self.rate
