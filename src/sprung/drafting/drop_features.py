"""Features of a drop: how far and fast the readings of its channels fall, how hard they land, how they swing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DropFeatures:
    """What the channels read during a drop, shape (channel,) each, NaN where a recording has gaps.

    Attributes
    ----------
    level, noise
        At rest, and the standard deviation of it, m/s².
    onset
        Directly after the release, off the rest and in the channel's own direction, m/s².
    depth
        Farthest below rest during the fall, m/s².
    speed
        Gained downward, m/s.
    peak
        The largest off the rest within half a second of the release, m/s².
    swing
        Amplitude of the slow swinging that follows, m/s².
    """

    level: Real
    noise: Real
    onset: Real
    depth: Real
    speed: Real
    peak: Real
    swing: Real

    def at(self, channels: Sequence[int | None]) -> DropFeatures:
        """Return the features of other channels, or in another order.

        Parameters
        ----------
        channels
            Position of each in these features; None for one that they do not have.
        """
        index = np.array([-1 if channel is None else channel for channel in channels], dtype=int)
        columns = {field.name: np.append(getattr(self, field.name), np.nan)[index] for field in fields(self)}
        return DropFeatures(**columns)

    def joined_with(self, other: DropFeatures) -> DropFeatures:
        """Return these features and after them those of other channels."""
        both = {field.name: np.append(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)}
        return DropFeatures(**both)
