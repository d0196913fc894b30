"""A release that sensors of displacement show: the vehicle rests, is let go, and swings about another level, or the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.drafting.detected_drop import DetectedDrop
from sprung.drafting.drop_features import DropFeatures

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DetectedRelease:
    """One release in a recording; times are s on the recording's own clock.

    Attributes
    ----------
    begin
        From when the vehicle rests.
    release
        When it begins to move.
    faded
        When the vibration has faded.
    end
        Until when nothing else disturbs the recording.
    why_end
        The reason why it ends there, in words.
    channels
        Names of the channels of displacement.
    fall
        Reading at rest before the release less that after the vibration, shape (channel,), m.
    swing
        Largest distance from the level after the vibration, shape (channel,), m.
    """

    begin: float
    release: float
    faded: float
    end: float
    why_end: str
    channels: tuple[str, ...]
    fall: Real
    swing: Real

    def of(self, names: Sequence[str]) -> tuple[Real, Real]:
        """Return fall and swing of some channels, in m; 0 for one that the recording does not have."""
        index = [self.channels.index(name) if name in self.channels else -1 for name in names]
        return np.append(self.fall, 0.0)[index], np.append(self.swing, 0.0)[index]

    def as_drop(self) -> DetectedDrop:
        """Return the same times as a drop without features of accelerations; nothing flies, so it has landed at the release."""
        features = DropFeatures(*(np.zeros(0) for _ in range(7)))
        return DetectedDrop(self.begin, self.release, self.release, self.faded, self.end, self.why_end, features)

    def shifted(self, by: float) -> DetectedRelease:
        """Return the release with its times later by so many s."""
        return replace(self, begin=self.begin + by, release=self.release + by, faded=self.faded + by, end=self.end + by)
