"""Classification of a channel by its reading at rest: unit, direction, coupling, or no acceleration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY, si_factor

Real = NDArray[np.float64]

_UNITS = ("g", "m/s^2", "mm/s^2", "mg", "cm/s^2", "ft/s^2", "in/s^2")
"""Units of accelerometers."""

_ALIKE = ("mg", "cm/s^2")

_GRAVITY = 0.08
"""Part by which tilt and offset may change the reading at rest for the unit to be recognised by it."""

_STEADY = 0.1
"""Largest noise, as a part of a level, for the level to be significant."""

_NOTHING = 0.3
"""Part of gravity below which a sensor does not read it."""

_LITTLE = 0.02
"""Part of a channel's largest reading below which its level at rest is nothing."""


@dataclass(frozen=True)
class Channel:
    """A channel of a recording, as classified.

    Attributes
    ----------
    name
        The channel's.
    unit
        Its unit; None where it is not known.
    stated_unit
        Unit that the file states; None where it states none.
    direction
        Direction of a positive reading, as far as gravity shows it.
    coupling
        DC where it reads gravity at rest, AC where it reads zero.
    level
        Reading at rest, in its unit.
    notes
        Findings and conclusions, in words.
    """

    name: str
    unit: str | None
    stated_unit: str | None
    direction: Literal["up", "down"]
    coupling: Literal["DC", "AC"]
    level: float
    notes: tuple[str, ...]
    assumed: str = "m/s^2"
    """Unit in which its drops are looked for where its own is not known."""
    logger: str | None = None
    """Its logger, where several loggers' channels have one name; its own name then begins with it."""

    @property
    def factor(self) -> float:
        """Factor from a reading to m/s², positive up."""
        return si_factor(self.unit or self.assumed) * (-1.0 if self.direction == "down" else 1.0)


def classify_channel(name: str, stated_unit: str | None, samples: Real) -> Channel | str:
    """Classify a channel, or return why it is no acceleration.

    Parameters
    ----------
    name
        The channel's.
    stated_unit
        Unit that the file states; None where it states none.
    samples
        Stretches of its readings, shape (stretch, time).
    """
    samples = samples[np.isfinite(samples).mean(axis=1) > 0.5]
    reason = _reason_against(stated_unit, samples)
    if reason is not None:
        return reason
    middles = np.nanmedian(samples, axis=1)
    level, quiet = float(np.median(middles)), float(np.quantile(np.nanstd(samples, axis=1), 0.25))
    unit_of_gravity = _unit_of_gravity(abs(level)) if quiet < _STEADY * abs(level) else None
    if stated_unit is not None:
        return _classify_with_stated_unit(name, stated_unit, level, unit_of_gravity)
    steps = np.diff(middles)
    nothing = abs(level) <= 5 * quiet or abs(level) < _LITTLE * float(np.nanmax(np.abs(samples)))
    if unit_of_gravity is not None:
        return _dc_coupled(
            name, unit_of_gravity, None, level, f"gravity in {unit_of_gravity}, as the file states no unit"
        )
    if steps.size > 2 and (np.all(steps > 0) or np.all(steps < 0)):
        return "it is a counter"
    if nothing:
        return _ac_coupled(name, None, level)
    return f"it reads {level:.4g} at rest, which is gravity in no known unit, and the file states none"


def _reason_against(stated_unit: str | None, samples: Real) -> str | None:
    """Return why a channel is no acceleration; None where that does not show without its reading at rest."""
    if not samples.size:
        return "it holds no numbers"
    if np.nanmax(samples) == np.nanmin(samples):
        return f"it reads {float(np.nanmax(samples)):.6g} throughout"
    try:
        si_factor(stated_unit or "m/s^2")
    except ValueError:
        return f"its unit {stated_unit} is no unit of acceleration"
    return None


def _classify_with_stated_unit(name: str, stated_unit: str, level: float, unit_of_gravity: str | None) -> Channel:
    """Classify a channel whose file states a unit; gravity at rest overrides it."""
    felt = abs(level) * si_factor(stated_unit) / STANDARD_GRAVITY
    if abs(felt - 1) < _NOTHING:
        return _dc_coupled(name, stated_unit, stated_unit, level, "gravity")
    if unit_of_gravity is not None:
        return _dc_coupled(
            name,
            unit_of_gravity,
            stated_unit,
            level,
            f"gravity in {unit_of_gravity}, though the file states {stated_unit}",
        )
    if felt < _NOTHING:
        return _ac_coupled(name, stated_unit, level)
    return _dc_coupled(name, stated_unit, stated_unit, level, "neither gravity nor zero: tilted, or not calibrated")


def _dc_coupled(name: str, unit: str, stated_unit: str | None, level: float, what: str) -> Channel:
    direction: Literal["up", "down"] = "down" if level < 0 else "up"
    said = f"reads {level:.4g}{'' if stated_unit is None else f' {stated_unit}'} at rest: {what}"
    notes = (f"{said}; points down" if level < 0 else said,)
    return Channel(name, unit, stated_unit, direction, "DC", level, notes)


def _ac_coupled(name: str, stated_unit: str | None, level: float) -> Channel:
    said = f"reads {level:.2g}{'' if stated_unit is None else f' {stated_unit}'} at rest, so no gravity"
    return Channel(name, stated_unit, stated_unit, "up", "AC", level, (f"{said}: AC-coupled, zeroed, or not upright",))


def _unit_of_gravity(level: float) -> str | None:
    """Return the unit in which a reading is gravity; None where it is in none."""
    off = {unit: abs(level * si_factor(unit) / STANDARD_GRAVITY - 1) for unit in _UNITS}
    nearest = min(off, key=lambda unit: off[unit])
    return nearest if off[nearest] < _GRAVITY else None


def disambiguate_units(channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """Distinguish mg from cm/s², in which gravity is 1000 and 981, by the mean of all channels.

    Parameters
    ----------
    channels
        Of one recording.
    """
    alike = {i for i, channel in enumerate(channels) if channel.unit in _ALIKE and channel.stated_unit is None}
    if not alike:
        return tuple(channels)
    unit = _unit_of_gravity(float(np.mean([abs(channels[i].level) for i in alike]))) or _ALIKE[0]
    notes = (
        f"gravity in {unit}, as the file states no unit (it might be {_ALIKE[unit == _ALIKE[0]]}, 2 % less or more)",
    )
    return tuple(replace(own, unit=unit, notes=notes) if i in alike else own for i, own in enumerate(channels))
