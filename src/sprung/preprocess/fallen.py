"""A drop that was found: its times, what its channels read, and which wheels fell.

A wheel is told from the body by how it moves: it falls faster, lands harder and swings less afterwards. Which wheels fell
is told from all drops together, for a wheel that stands moves no more than the body.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import drop_kind
from sprung.preprocess.slow_motion import SlowMotion
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, Wheel

Real = NDArray[np.float64]

Place = Literal["body", "wheel", "fl", "fr", "rl", "rr"]
"""Where a channel's sensor sits: on the body, on some wheel, or on that wheel."""

SPEED = 0.2
"""m/s downward that a wheel gains at least: blocks of 0.02 m give 0.3."""

_A_WHEEL = 400.0
"""Of depth times peak over the square root of the swing, from which a channel sits on a wheel: a body stays below 290 in
any drop from 0.02 to 0.15 m of vehicles from 400 to 16000 kg, and a wheel that falls stays above 530."""

_AT_ONCE, _DEEP = 0.0067, 0.2
"""Parts of what the wheel that fell most has of depth times onset, and of depth, from which another fell too. Over 1650 drops
of 150 vehicles one that stood has 0.005 and 0.153 at most; one let go together with it has 0.009 at least, a later one more
than 0.2 of the depth as a rule."""


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
        How far below rest during the fall, m/s².
    speed
        Gained downward, m/s.
    peak
        The largest off the rest within half a second of the release, m/s².
    swing
        The largest of the slow swinging that follows, m/s².
    """

    level: Real
    noise: Real
    onset: Real
    depth: Real
    speed: Real
    peak: Real
    swing: Real

    def at(self, channels: Sequence[int | None]) -> DropFeatures:
        """Give the readings of other channels, or in another order.

        Parameters
        ----------
        channels
            Index of each in these readings; None for one that they do not have.
        """
        index = np.array([-1 if channel is None else channel for channel in channels], dtype=int)
        columns = {field.name: np.append(getattr(self, field.name), np.nan)[index] for field in fields(self)}
        return DropFeatures(**columns)

    def beside(self, other: DropFeatures) -> DropFeatures:
        """Give these readings and after them those of other channels."""
        both = {field.name: np.append(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)}
        return DropFeatures(**both)


@dataclass(frozen=True, eq=False)
class FoundDrop:
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
    fell
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
    fell: tuple[int, ...] = ()
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

    def on_clock(self, clock: Callable[[float], float]) -> FoundDrop:
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
        shown = list(self.fell) or np.flatnonzero(seen.depth >= 0.5 * np.nanmax(seen.depth)).tolist()
        depth, speed = np.nanmax(seen.depth[shown]) / STANDARD_GRAVITY, np.nanmax(seen.speed[shown])
        s = "" if len(shown) > 1 else "s"
        whose = "as only a wheel can that its spring pushes down" if self.fell else "as a body whose springs slacken"
        fall = f"read{s} {depth:.1f} g below rest and gain{s} {speed:.2g} m/s downward, {whose}"
        return (
            f"everything rests for {self.release - self.begin:.2f} s",
            f"then at {self.release:.3f} s {', '.join(names[i] for i in shown)} {fall}",
            f"landed at {self.landing:.3f} s with {np.nanmax(seen.peak) / STANDARD_GRAVITY:.1f} g",
            f"usable until {self.end:.2f} s, when {self.ended}",
        )


def wheel_score(drops: Sequence[FoundDrop]) -> Real:
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


def on_wheels(drops: Sequence[FoundDrop], places: Sequence[Place | None] | None = None) -> NDArray[np.bool_]:
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


def tell_wheels(drops: Sequence[FoundDrop], places: Sequence[Place | None] | None = None) -> tuple[FoundDrop, ...]:
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
        The same with `fell` and `wheels` told anew.
    """
    sit = on_wheels(drops, places)
    return tuple(_told(drop, sit, places or (None,) * sit.size) for drop in drops)


def channels_that_fell(seen: DropFeatures, sit: NDArray[np.bool_]) -> tuple[int, ...]:
    """Say which channels show the fall of a wheel; none where no wheel with a sensor fell.

    Parameters
    ----------
    seen
        What the channels read during the drop.
    sit
        Which of them sit on wheels, shape (channel,).
    """
    depth, speed = (np.where(sit, np.nan_to_num(each), 0.0) for each in (seen.depth, seen.speed))
    over = np.abs(np.nan_to_num(seen.level)) < STANDARD_GRAVITY / 2  # an AC-coupled sensor may point down
    over &= np.nan_to_num(seen.onset) > 0
    at_once = depth * np.maximum(np.nan_to_num(np.where(over, seen.onset, -seen.onset)), 0.0)
    falls = (depth > _DEEP * depth.max()) | (at_once > _AT_ONCE * at_once.max())
    any_fell = bool(((depth > STANDARD_GRAVITY) & (speed > SPEED)).any())
    return tuple(np.flatnonzero(falls & sit).tolist()) if any_fell else ()


def _told(drop: FoundDrop, sit: NDArray[np.bool_], places: Sequence[Place | None]) -> FoundDrop:
    fell = channels_that_fell(drop.seen, sit)
    stations = {places[i] for i in fell}
    wheels = tuple(wheel for wheel in WHEELS if wheel in stations) if stations <= set(WHEELS) else ()
    if not wheels and len(fell) == sit.sum() == len(WHEELS):
        wheels = WHEELS  # whichever is which, all of them fell
    return replace(drop, fell=fell, wheels=wheels)
