"""What a channel is, from what it reads at rest: unit, direction, coupling, or no acceleration at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY, acceleration_factor

Real = NDArray[np.float64]

_UNITS = ("g", "m/s^2", "mm/s^2", "mg", "cm/s^2", "ft/s^2", "in/s^2")
"""What accelerometers read in."""

_ALIKE = ("mg", "cm/s^2")

_GRAVITY = 0.08
"""Part by which tilt and offset may change what a sensor reads at rest, for its unit to be told from that."""

_STEADY = 0.1
"""Part of a level below which its noise has to stay, for the level to be no chance."""

_NOTHING = 0.3
"""Part of gravity below which a sensor that should feel it does not."""

_LITTLE = 0.02
"""Part of a channel's largest reading below which its level at rest is nothing."""


@dataclass(frozen=True)
class Channel:
    """What a channel of a recording is taken to be.

    Attributes
    ----------
    name
        The channel's.
    unit
        In which it reads; None where nothing tells.
    written
        The unit that the file names; None where it names none.
    direction
        Which way its positive reading points, as far as gravity tells.
    coupling
        DC where it feels gravity at rest, AC where it reads nothing.
    level
        What it reads at rest, in its unit.
    notes
        What was found and what it was taken for, in words.
    """

    name: str
    unit: str | None
    written: str | None
    direction: Literal["up", "down"]
    coupling: Literal["DC", "AC"]
    level: float
    notes: tuple[str, ...]
    assumed: str = "m/s^2"
    """In which its drops are looked for where nothing tells its unit."""
    logger: str | None = None
    """Whose it is, where several loggers' channels have one name; its own name then begins with it."""

    @property
    def factor(self) -> float:
        """Gives m/s², positive up, from a reading."""
        return acceleration_factor(self.unit or self.assumed) * (-1.0 if self.direction == "down" else 1.0)


def channel_of(name: str, written: str | None, spots: Real) -> Channel | str:
    """Say what a channel is; or why it is no acceleration.

    Parameters
    ----------
    name
        The channel's.
    written
        The unit that the file names; None where it names none.
    spots
        Stretches of what it reads, shape (stretch, time).
    """
    spots = spots[np.isfinite(spots).mean(axis=1) > 0.5]
    reason = _no_acceleration(written, spots)
    if reason is not None:
        return reason
    middles = np.nanmedian(spots, axis=1)
    level, quiet = float(np.median(middles)), float(np.quantile(np.nanstd(spots, axis=1), 0.25))
    told = _unit_of_gravity(abs(level)) if quiet < _STEADY * abs(level) else None
    if written is not None:
        return _with_unit(name, written, level, told)
    steps = np.diff(middles)
    nothing = abs(level) <= 5 * quiet or abs(level) < _LITTLE * float(np.nanmax(np.abs(spots)))
    if told is not None:
        return _direct(name, told, None, level, f"gravity in {told}, as the file names no unit")
    if steps.size > 2 and (np.all(steps > 0) or np.all(steps < 0)):
        return "it only counts"
    if nothing:
        return _alternating(name, None, level)
    return f"it reads {level:.4g} at rest, which is gravity in no unit, and the file names none"


def _no_acceleration(written: str | None, spots: Real) -> str | None:
    """Give the reason why a channel is no acceleration, if that shows without a look at gravity."""
    if not spots.size:
        return "it holds no numbers"
    if np.nanmax(spots) == np.nanmin(spots):
        return f"it reads {float(np.nanmax(spots)):.6g} throughout"
    try:
        acceleration_factor(written or "m/s^2")
    except ValueError:
        return f"it is in {written}, which is no unit of acceleration"
    return None


def _with_unit(name: str, written: str, level: float, told: str | None) -> Channel:
    """Say what a channel is whose file names a unit; gravity knows better."""
    felt = abs(level) * acceleration_factor(written) / STANDARD_GRAVITY
    if abs(felt - 1) < _NOTHING:
        return _direct(name, written, written, level, "gravity")
    if told is not None:
        return _direct(name, told, written, level, f"gravity in {told}, though the file says {written}")
    if felt < _NOTHING:
        return _alternating(name, written, level)
    return _direct(name, written, written, level, "neither gravity nor nothing: tilted, or not calibrated")


def _direct(name: str, unit: str, written: str | None, level: float, what: str) -> Channel:
    direction: Literal["up", "down"] = "down" if level < 0 else "up"
    said = f"reads {level:.4g}{'' if written is None else f' {written}'} at rest: {what}"
    notes = (f"{said}; upside down" if level < 0 else said,)
    return Channel(name, unit, written, direction, "DC", level, notes)


def _alternating(name: str, written: str | None, level: float) -> Channel:
    said = f"reads {level:.2g}{'' if written is None else f' {written}'} at rest, so no gravity"
    return Channel(name, written, written, "up", "AC", level, (f"{said}: AC-coupled, set to zero or not upright",))


def _unit_of_gravity(level: float) -> str | None:
    """Give the unit in which a reading would be gravity."""
    off = {unit: abs(level * acceleration_factor(unit) / STANDARD_GRAVITY - 1) for unit in _UNITS}
    nearest = min(off, key=lambda unit: off[unit])
    return nearest if off[nearest] < _GRAVITY else None


def disambiguate_units(channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """Tell mg from cm/s², in which gravity is 1000 and 981, by all channels together.

    Parameters
    ----------
    channels
        Of one recording.
    """
    alike = {i for i, channel in enumerate(channels) if channel.unit in _ALIKE and channel.written is None}
    if not alike:
        return tuple(channels)
    unit = _unit_of_gravity(float(np.mean([abs(channels[i].level) for i in alike]))) or _ALIKE[0]
    notes = (
        f"gravity in {unit}, as the file names no unit (it might be {_ALIKE[unit == _ALIKE[0]]}, 2 % less or more)",
    )
    return tuple(replace(one, unit=unit, notes=notes) if i in alike else one for i, one in enumerate(channels))
