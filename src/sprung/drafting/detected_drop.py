"""A drop that was found: its times, what its channels read, and which wheels fell.

A wheel is told from the body by how it moves: it falls faster, lands harder and swings less afterwards. Which wheels fell
is told from all drops together, for a wheel that stands moves no more than the body.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import drop_kind
from sprung.preprocess import DropFeatures, SlowMotion, detect_dropped_channels
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, Wheel

Real = NDArray[np.float64]

SensorPlace = Literal["body", "wheel", "fl", "fr", "rl", "rr"]
"""Where a channel's sensor sits: on the body, on some wheel, or on that wheel."""

_A_WHEEL = 400.0
"""Of depth times peak over the square root of the swing, from which a channel sits on a wheel: a body stays below 290 in
any drop from 0.02 to 0.15 m of vehicles from 400 to 16000 kg, and a wheel that falls stays above 530."""


@dataclass(frozen=True, eq=False)
class DetectedDrop:
    """One drop in a recording; times are s on the recording's own clock.

    Attributes
    ----------
    begin
        From when the vehicle rests on its blocks: the beginning of the drop's window.
    release, landing
        When the vehicle begins to fall, and when the last of the wheels that fall has met the ground.
    faded
        When the vibration has sunk into the noise.
    end
        Until when nothing else disturbs the recording: the end of the drop's window.
    ended
        Why it ends there, in words.
    seen
        What the channels read.
    dropped_channels
        Channels that show the fall of a wheel, by their index.
    wheels
        Which wheels fell; none where the channels' wheels are not known.
    slow
        The slow part of it, of all channels, by which its periods are compared with those of other drops; None where the
        recordings of several loggers were put together.
    """

    begin: float
    release: float
    landing: float
    faded: float
    end: float
    ended: str
    seen: DropFeatures
    dropped_channels: tuple[int, ...] = ()
    wheels: tuple[Wheel, ...] = ()
    slow: SlowMotion | None = None

    @property
    def window(self) -> tuple[float, float]:
        """Begin and end, s on the file's clock."""
        return self.begin, self.end

    @property
    def kind(self) -> str | None:
        """What such a drop is called; None where the wheels are not known."""
        return drop_kind(self.wheels) if self.wheels else None

    def interpolate(self, clock: Callable[[float], float]) -> DetectedDrop:
        """Give the same with its times on another clock.

        Parameters
        ----------
        clock
            Gives s on that clock from s on this one.
        """
        return replace(
            self,
            begin=clock(self.begin),
            release=clock(self.release),
            landing=clock(self.landing),
            faded=clock(self.faded),
            end=clock(self.end),
        )

    def why(self, channels: Sequence[str] | None = None) -> tuple[str, ...]:
        """Say what it was taken for a drop from, and what set its limits.

        Parameters
        ----------
        channels
            Their names; left out, they are counted from 1.
        """
        seen = self.seen
        names = channels or [f"channel {i + 1}" for i in range(seen.level.size)]
        shown = list(self.dropped_channels) or np.flatnonzero(seen.depth >= 0.5 * np.nanmax(seen.depth)).tolist()
        depth, speed = np.nanmax(seen.depth[shown]) / STANDARD_GRAVITY, np.nanmax(seen.speed[shown])
        s = "" if len(shown) > 1 else "s"
        whose = (
            "as only a wheel can that its spring pushes down"
            if self.dropped_channels
            else "as a body whose springs slacken"
        )
        fall = f"read{s} {depth:.1f} g below rest and gain{s} {speed:.2g} m/s downward, {whose}"
        return (
            f"everything rests for {self.release - self.begin:.2f} s",
            f"then at {self.release:.3f} s {', '.join(names[i] for i in shown)} {fall}",
            f"landed at {self.landing:.3f} s with {np.nanmax(seen.peak) / STANDARD_GRAVITY:.1f} g",
            f"usable until {self.end:.2f} s, when {self.ended}",
        )


def wheel_score(drops: Sequence[DetectedDrop]) -> Real:
    """Give how much each channel moves like a wheel; one that fell in none of the drops does not.

    Parameters
    ----------
    drops
        Drops that the same channels recorded.

    Returns
    -------
    ndarray
        Dimensionless, shape (channel,): above 1 a wheel, below 1 the body; how far from 1 tells how surely.
    """
    if not drops:
        return np.zeros(0)
    depth, peak, swing = (
        np.max([np.nan_to_num(getattr(drop.seen, name)) for drop in drops], axis=0)
        for name in ("depth", "peak", "swing")
    )
    return np.asarray(depth * peak / np.sqrt(np.maximum(swing, 0.02)) / _A_WHEEL)


def is_on_wheel(drops: Sequence[DetectedDrop], places: Sequence[SensorPlace | None] | None = None) -> NDArray[np.bool_]:
    """Say which channels sit on wheels: those that are known to, and of the unknown ones those that move like it.

    Parameters
    ----------
    drops
        Drops that the same channels recorded.
    places
        Where each channel's sensor sits, None for one that is unknown; left out, all of them are.

    Returns
    -------
    ndarray
        Shape (channel,).
    """
    seen = np.asarray(wheel_score(drops) > 1.0)
    for channel, place in enumerate(places or ()):
        if place is not None and channel < seen.size:
            seen[channel] = place != "body"
    return seen


def assign_dropped_wheels(
    drops: Sequence[DetectedDrop], places: Sequence[SensorPlace | None] | None = None
) -> tuple[DetectedDrop, ...]:
    """Tell which wheels fell, from all drops that the same channels recorded.

    Parameters
    ----------
    drops
        The drops, of one recording or of several with the same channels.
    places
        Where each channel's sensor sits, None for one that is unknown; left out, all of them are.

    Returns
    -------
    tuple of FoundDrop
        The same with `dropped_channels` and `wheels` told anew.
    """
    sit = is_on_wheel(drops, places)
    return tuple(_told(drop, sit, places or (None,) * sit.size) for drop in drops)


def _told(drop: DetectedDrop, sit: NDArray[np.bool_], places: Sequence[SensorPlace | None]) -> DetectedDrop:
    fell = detect_dropped_channels(drop.seen, sit)
    stations = {places[i] for i in fell}
    wheels = tuple(wheel for wheel in WHEELS if wheel in stations) if stations <= set(WHEELS) else ()
    if not wheels and len(fell) == sit.sum() == len(WHEELS):
        wheels = WHEELS  # whichever is which, all of them fell
    return replace(drop, dropped_channels=fell, wheels=wheels)
