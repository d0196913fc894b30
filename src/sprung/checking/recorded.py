"""One drop's whole recording, as figures draw it."""

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
    """One drop's whole recording, in SI, put right as far as it could be.

    Attributes
    ----------
    start
        Time of the first sample on the recording's clock, s.
    rate
        Samples per second.
    values
        m/s², positive up, shape (channel, time); of channels that are left out what was read, NaN where nothing was.
    marks
        Samples with which something is the matter.
    """

    start: float
    rate: float
    values: Drawn
    marks: tuple[MarkedSamples, ...] = ()

    @classmethod
    def of(cls, seen: DropObservation) -> PlottedRecording:
        """Take what a recording shows.

        Parameters
        ----------
        seen
            What its drop shows.
        """
        values, as_read = seen.recording.values, seen.drop.recording.values
        if values.shape == as_read.shape:
            values = np.where(np.isnan(values).any(axis=1, keepdims=True), as_read, values)
        return cls(seen.recording.start, seen.recording.rate, values.astype(np.float32), seen.marks)

    @property
    def time(self) -> Real:
        """Time of every sample on the recording's clock, s; shape (time,)."""
        return self.start + np.arange(self.values.shape[1]) / self.rate
