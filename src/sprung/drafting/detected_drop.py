"""A detected drop: its times, the features of its channels, and which wheels fell.

A wheel differs from the body by how it moves: it falls faster, lands harder and swings less afterwards. Which wheels fell
follows from all drops together, for a wheel that stands moves no more than the body.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import drop_kind
from sprung.drafting.drop_features import DropFeatures
from sprung.preprocess import detect_dropped_channels
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, SensorPlace, Wheel

Real = NDArray[np.float64]

_WHEEL_SCORE = 400.0
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
    why_end
        The reason why it ends there, in words.
    features
        Of the channels.
    dropped_channels
        Channels that show the fall of a wheel, by their position.
    wheels
        Which wheels fell; none where the channels' wheels are not known.
    slow_motion
        Of all channels, shape (channel, time), by which its periods are compared with those of other drops; None where the
        recordings of several loggers were joined.
    """

    begin: float
    release: float
    landing: float
    faded: float
    end: float
    why_end: str
    features: DropFeatures
    dropped_channels: tuple[int, ...] = ()
    wheels: tuple[Wheel, ...] = ()
    slow_motion: Real | None = None

    @property
    def window(self) -> tuple[float, float]:
        """Begin and end, s on the file's clock."""
        return self.begin, self.end

    @property
    def kind(self) -> str | None:
        """What such a drop is called; None where the wheels are not known."""
        return drop_kind(self.wheels) if self.wheels else None

    def at(self, channels: Sequence[int | None]) -> DetectedDrop:
        """Return the drop with other channels, or in another order.

        Parameters
        ----------
        channels
            Position of each in this drop; None for one that it does not have.
        """
        slow = self.slow_motion
        if slow is not None:
            padded = np.vstack([slow, np.zeros((1, slow.shape[1]))])
            slow = padded[[-1 if channel is None else channel for channel in channels]]
        return replace(self, features=self.features.at(channels), slow_motion=slow)

    def on_clock(self, clock: Callable[[float], float]) -> DetectedDrop:
        """Return the drop with its times on another clock.

        Parameters
        ----------
        clock
            Converts s on this clock to s on that one.
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
        """Return why it is a drop, and what set its limits, in words.

        Parameters
        ----------
        channels
            Their names; by default they are counted from 1.
        """
        depths, speeds = self.features.depth, self.features.speed
        names = channels or [f"channel {i + 1}" for i in range(depths.size)]
        falling = list(self.dropped_channels) or np.flatnonzero(depths >= 0.5 * np.nanmax(depths)).tolist()
        depth, speed = np.nanmax(depths[falling]) / STANDARD_GRAVITY, np.nanmax(speeds[falling])
        s = "" if len(falling) > 1 else "s"
        like = "as a wheel that its spring pushes down" if self.dropped_channels else "as a body whose springs relax"
        fall = f"fall{s} {depth:.1f} g below rest and gain{s} {speed:.2g} m/s downward, {like}"
        return (
            f"at rest for {self.release - self.begin:.2f} s",
            f"from {self.release:.3f} s on {', '.join(names[i] for i in falling)} {fall}",
            f"landed at {self.landing:.3f} s with {np.nanmax(self.features.peak) / STANDARD_GRAVITY:.1f} g",
            f"usable until {self.end:.2f} s, when {self.why_end}",
        )


def wheel_score(drops: Sequence[DetectedDrop]) -> Real:
    """Return how much each channel moves like a wheel; a wheel that fell in none of the drops does not.

    Parameters
    ----------
    drops
        Drops that the same channels recorded.

    Returns
    -------
    ndarray
        Dimensionless, shape (channel,): above 1 a wheel, below 1 the body; the farther from 1, the clearer.
    """
    if not drops:
        return np.zeros(0)
    depth, peak, swing = (
        np.max([np.nan_to_num(getattr(drop.features, name)) for drop in drops], axis=0)
        for name in ("depth", "peak", "swing")
    )
    return np.asarray(depth * peak / np.sqrt(np.maximum(swing, 0.02)) / _WHEEL_SCORE)


def is_on_wheel(drops: Sequence[DetectedDrop], places: Sequence[SensorPlace | None] | None = None) -> NDArray[np.bool_]:
    """Return which channels sit on wheels: those that are known to, and of the unknown ones those that move like it.

    Parameters
    ----------
    drops
        Drops that the same channels recorded.
    places
        Where each channel's sensor sits, None for one that is unknown; by default all of them are.

    Returns
    -------
    ndarray
        Shape (channel,).
    """
    wheels = np.asarray(wheel_score(drops) > 1.0)
    for channel, place in enumerate(places or ()):
        if place is not None and channel < wheels.size:
            wheels[channel] = place != "body"
    return wheels


def assign_dropped_wheels(
    drops: Sequence[DetectedDrop], places: Sequence[SensorPlace | None] | None = None
) -> tuple[DetectedDrop, ...]:
    """Assign to each drop which wheels fell, from all drops that the same channels recorded.

    Parameters
    ----------
    drops
        The drops, of one recording or of several with the same channels.
    places
        Where each channel's sensor sits, None for one that is unknown; by default all of them are.

    Returns
    -------
    tuple of DetectedDrop
        With `dropped_channels` and `wheels` replaced.
    """
    on_wheel = is_on_wheel(drops, places)
    return tuple(_with_dropped_wheels(drop, on_wheel, places or (None,) * on_wheel.size) for drop in drops)


def _with_dropped_wheels(
    drop: DetectedDrop, on_wheel: NDArray[np.bool_], places: Sequence[SensorPlace | None]
) -> DetectedDrop:
    features = drop.features
    channels = detect_dropped_channels(features.level, features.onset, features.depth, features.speed, on_wheel)
    stations = {places[i] for i in channels}
    wheels = tuple(wheel for wheel in WHEELS if wheel in stations) if stations <= set(WHEELS) else ()
    if not wheels and len(channels) == on_wheel.sum() == len(WHEELS):
        wheels = WHEELS  # whichever is which, all of them fell
    return replace(drop, dropped_channels=channels, wheels=wheels)
