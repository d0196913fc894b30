"""Long recordings for the screen: the lowest and the highest value in each of many intervals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]


class Extremes:
    """The lowest and the highest value of each channel in intervals of equal length, in memory that does not grow.

    Parameters
    ----------
    channels, samples
        Number of channels, and of samples of all pieces together.
    intervals
        Number of intervals; there are fewer where there are fewer samples.

    Attributes
    ----------
    low, high
        In the unit of the values, shape (channel, interval); NaN where no sample of an interval is a number.

    Examples
    --------
    >>> import numpy as np
    >>> values = np.array([[1.0, 5.0, np.nan, 2.0, 0.0, 3.0]])
    >>> found = Extremes(channels=1, samples=6, intervals=2)
    >>> found.add(0, values[:, :4])
    >>> found.add(4, values[:, 4:])
    >>> found.low.tolist(), found.high.tolist()
    ([[1.0, 0.0]], [[5.0, 3.0]])
    """

    def __init__(self, channels: int, samples: int, intervals: int) -> None:
        self._edges = interval_edges(samples, intervals)
        self.low, self.high = np.full((2, channels, len(self._edges) - 1), np.nan)

    def add(self, first: int, values: Real) -> None:
        """Add samples that follow those before.

        Parameters
        ----------
        first
            Number of the first of them, from 0.
        values
            Shape (channel, time), not empty.
        """
        begins = int(np.searchsorted(self._edges, first, side="right")) - 1
        ends = int(np.searchsorted(self._edges, first + values.shape[1], side="left"))
        places = np.maximum(self._edges[begins:ends], first) - first
        for kept, least in ((self.low, np.fmin), (self.high, np.fmax)):
            kept[:, begins:ends] = least(kept[:, begins:ends], least.reduceat(values, places, axis=1))


def interval_edges(samples: int, intervals: int) -> NDArray[np.int64]:
    """Return the first sample of each interval, and the number of samples, shape (interval + 1,).

    Parameters
    ----------
    samples
        Number of samples.
    intervals
        Number of intervals; there are fewer where there are fewer samples.
    """
    return np.linspace(0, samples, min(intervals, samples) + 1).astype(np.int64)
