"""What the channels of a recording are, from what they read at rest: unit, direction, coupling, or no acceleration at all."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sprung.errors import Problem
from sprung.pipeline.drafting.names import axis_named
from sprung.recording import Table
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

_SPOTS, _SPOT = 60, 0.5
"""Stretches of a recording that its rest is looked for in, and how long each is, s."""

_SHORT = 0.01
"""s over which readings are averaged, so that a spike is not taken for the size of what was recorded."""

_PLATEAU = 3
"""Samples in a row at a channel's extreme that show its full scale."""

_PIECE = 1 << 17
"""Samples that are read together."""


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


@dataclass(frozen=True, eq=False)
class Survey:
    """What a recording's channels are.

    Attributes
    ----------
    channels
        The vertical accelerations, and their columns in the table.
    columns
        Of those channels.
    left_out
        The other channels, and why each is none.
    rate
        Samples per second.
    start, end
        s on the file's clock.
    samples
        How many.
    """

    channels: tuple[Channel, ...]
    columns: tuple[int, ...]
    left_out: dict[str, str]
    rate: float
    start: float
    end: float
    samples: int


def survey(table: Table) -> Survey:
    """Tell what the channels of a recording are.

    Parameters
    ----------
    table
        The recording.

    Returns
    -------
    Survey
    """
    samples = table.samples
    clock = table.clock
    if isinstance(clock, np.ndarray):
        rate = 1 / float(np.median(np.diff(clock))) if samples > 1 else float("nan")
        start, end = float(clock[0]), float(clock[-1])
    else:
        rate, start, end = clock, 0.0, (samples - 1) / clock
    begins, spots = _spots(table, rate)
    channels, columns, left_out = [], [], {}
    for column, (name, written) in enumerate(zip(table.channels, table.units, strict=True)):
        own = spots[:, column]
        if (problem := _spoilt(table, column, begins, own)) is not None:
            left_out[name] = f"it holds {problem.found}"
            continue
        axis = axis_named(name, table.channels)
        found = f"it measures along {axis}, beside one along z" if axis in ("x", "y") else _channel(name, written, own)
        if isinstance(found, Channel):
            channels.append(found)
            columns.append(column)
        else:
            left_out[name] = found
    return Survey(_told_apart(channels), tuple(columns), left_out, rate, start, end, samples)


def _told_apart(channels: list[Channel]) -> tuple[Channel, ...]:
    """Tell mg from cm/s², in which gravity is 1000 and 981, by all channels together."""
    alike = {i for i, channel in enumerate(channels) if channel.unit in _ALIKE and channel.written is None}
    if not alike:
        return tuple(channels)
    unit = _unit_of_gravity(float(np.mean([abs(channels[i].level) for i in alike]))) or _ALIKE[0]
    notes = (
        f"gravity in {unit}, as the file names no unit (it might be {_ALIKE[unit == _ALIKE[0]]}, 2 % less or more)",
    )
    return tuple(replace(one, unit=unit, notes=notes) if i in alike else one for i, one in enumerate(channels))


def _spots(table: Table, rate: float) -> tuple[list[int], Real]:
    """Take some short stretches of all channels: the samples they begin with, and shape (stretch, channel, time)."""
    length = max(1, min(table.samples, int(_SPOT * rate) if np.isfinite(rate) else 1))
    begins: list[int] = np.unique(np.linspace(0, table.samples - length, _SPOTS).astype(int)).tolist()
    return begins, np.array([table.take(None, begin, begin + length) for begin in begins])


def _spoilt(table: Table, column: int, begins: list[int], spots: Real) -> Problem | None:
    """Say what stands in the stretches of a channel that is no number."""
    length = spots.shape[1]
    missing = (begin for begin, spot in zip(begins, spots, strict=True) if not np.isfinite(spot).all())
    return next((problem for begin in missing if (problem := table.spoilt(column, begin, begin + length))), None)


def _channel(name: str, written: str | None, spots: Real) -> Channel | str:
    """Say what a channel is; or why it is no acceleration."""
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


def pieces(table: Table, surveyed: Survey, factors: Real) -> Iterator[tuple[int, Real]]:
    """Give a recording's accelerations piece by piece.

    Parameters
    ----------
    table
        The recording.
    surveyed
        Its survey.
    factors
        m/s² upward in one of each channel's unit, shape (channel,).

    Yields
    ------
    tuple
        Index of the first sample, and readings of shape (channel, time), m/s².
    """
    for begin, piece in table.pieces(surveyed.columns, _PIECE):
        yield begin, piece * factors[:, None]


def largest(table: Table, surveyed: Survey) -> float:
    """Give the largest reading of the channels whose unit nothing tells, averaged over some milliseconds.

    Parameters
    ----------
    table
        The recording.
    surveyed
        Its survey.

    Returns
    -------
    float
        In whatever unit it is.
    """
    unknown = np.array([channel.unit is None for channel in surveyed.channels])
    width = max(round(_SHORT * surveyed.rate), 1)
    most = 0.0
    for _, piece in pieces(table, surveyed, np.ones(len(surveyed.channels))):
        smooth = uniform_filter1d(np.nan_to_num(piece[unknown]), width, axis=1)
        most = max(most, float(np.abs(smooth).max(initial=0.0)))
    return most


def full_scales(table: Table, surveyed: Survey, first: int, last: int) -> dict[str, float]:
    """Find channels that stay at their extreme for some samples, as at full scale.

    Parameters
    ----------
    table
        The recording.
    surveyed
        Its survey.
    first, last
        Samples between which to look.

    Returns
    -------
    dict
        By channel that reading's size, in its own unit.
    """
    found = {}
    for channel, reading in zip(surveyed.channels, table.take(surveyed.columns, first, last), strict=True):
        size = np.nan_to_num(np.abs(reading))
        at = size == size.max(initial=0.0)
        if size.size > _PLATEAU and (at[:-2] & at[1:-1] & at[2:]).any():
            found[channel.name] = float(size.max())
    return found
