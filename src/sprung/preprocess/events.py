"""Events of a drop, and what its recording shows besides its decay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import DropTest, Recording
from sprung.preprocess.release import Release
from sprung.vehicle import Wheel


@dataclass(frozen=True)
class Events:
    """Times of the events of a drop, and the reasons for the limits of its decay.

    Attributes
    ----------
    release
        First motion, s on the recording's clock; None where no rest was found before it.
    landing
        When the last wheel that fell met the ground, s; None where no sensor shows it.
    last_lift_off
        Last moment, not before the landing, at which a tyre may have been off the ground once more, s; None where none can have
        been, or no sensor shows it.
    start
        From when on the recording shows free vibration, s, not before any of these; None where it was not determined.
    why_start, why_end
        The reason for each limit of the decay, in words that go on after the time.
    why_fit
        The reason why a fit uses another start; empty where it does not.
    """

    release: float | None = None
    landing: float | None = None
    last_lift_off: float | None = None
    start: float | None = None
    why_start: str = ""
    why_end: str = ""
    why_fit: str = ""


class MarkedSamples(NamedTuple):
    """Samples of a channel that have a fault.

    Attributes
    ----------
    code
        The fault's.
    channel
        Position of the channel.
    samples
        Positions of the samples, shape (sample,).
    """

    code: str
    channel: int
    samples: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class DropObservation:
    """What the recording of one drop shows, whether or not it can be used.

    Attributes
    ----------
    drop
        As it is stated, with its recording as it was read.
    recording
        The whole of it, in SI, corrected; with the channels that clip within the decay.
    rest
        The release, and what the sensors read before it.
    marks
        Samples that have a fault.
    dropped
        For each wheel with a sensor, as far as the release shows it: whether it lost its block.
    wheels
        Those that were dropped: as stated, or as far as the release contradicts that, as it shows.
    """

    drop: DropTest
    recording: Recording
    rest: Release
    marks: tuple[MarkedSamples, ...] = ()
    dropped: Mapping[Wheel, bool] = field(default_factory=dict)
    wheels: tuple[Wheel, ...] = ()

    @property
    def release(self) -> int | None:
        """Position of the first sample that moves; None where no rest was found before it."""
        return self.rest.sample or None


def mark_samples(code: str, samples: NDArray[np.bool_]) -> tuple[MarkedSamples, ...]:
    """Return a mark for each channel that has any.

    Parameters
    ----------
    code
        The fault's.
    samples
        Shape (channel, time).
    """
    some = np.flatnonzero(np.asarray(samples.any(axis=1))).tolist() if samples.any() else ()
    return tuple(MarkedSamples(code, channel, np.flatnonzero(samples[channel])) for channel in some)
