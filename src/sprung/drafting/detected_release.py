"""A release that sensors of displacement show: the vehicle rests, is let go, and swings about another level, or the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
    onset
        Largest speed directly after the release, with the sign of the first motion, shape (channel,), m/s.
    """

    begin: float
    release: float
    faded: float
    end: float
    why_end: str
    channels: tuple[str, ...]
    fall: Real
    swing: Real
    onset: Real

    def of(self, names: Sequence[str]) -> tuple[Real, Real, Real]:
        """Return fall, swing and onset of some channels; 0 for one that the recording does not have."""
        index = [self.channels.index(name) if name in self.channels else -1 for name in names]
        fall, swing, onset = (np.append(each, 0.0)[index] for each in (self.fall, self.swing, self.onset))
        return fall, swing, onset

    def as_drop(self) -> DetectedDrop:
        """Return the same times as a drop without features of accelerations; nothing flies, so it has landed at the release."""
        features = DropFeatures(*(np.zeros(0) for _ in range(7)))
        return DetectedDrop(self.begin, self.release, self.release, self.faded, self.end, self.why_end, features)
