"""The look at one recording: what its channels are, and which drops it holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sprung.drafting.channel import Channel
from sprung.drafting.detected_drop import DetectedDrop, is_on_wheel
from sprung.drafting.detection import Detection, detect_drops
from sprung.drafting.records import DraftFile
from sprung.drafting.survey import Survey, full_scales, largest, pieces, survey
from sprung.errors import InputError, Problem
from sprung.formats import MIN_RATE, read_table
from sprung.units import acceleration_factor

if TYPE_CHECKING:
    from sprung.formats import SampleTable

_UNITS = ("m/s^2", "g", "mm/s^2", "mg")
"""What a sensor that feels no gravity may read in where its file names no unit; the first in which wheels fall is taken."""

_LEAST, _MOST = 5.0, 600.0
"""m/s² between which the largest reading lies, averaged over some milliseconds, of a recording with drops in it."""


@dataclass(frozen=True, eq=False)
class Look:
    """What one recording shows.

    Attributes
    ----------
    file
        About the file.
    channels
        Its vertical accelerations.
    drops
        Its drops, on the file's clock; their readings by channel, in the same order.
    full_scale
        By channel a reading at which it stays for some samples of a drop.
    files
        Names of the recordings, where several loggers' were looked at together.
    """

    file: DraftFile
    channels: tuple[Channel, ...]
    drops: tuple[DetectedDrop, ...]
    full_scale: Mapping[str, float]
    files: tuple[str, ...] = ()


def look(folder: Path, name: str, progress: Callable[[float], None]) -> Look:
    """Read one recording and find its drops.

    Parameters
    ----------
    folder
        Of the campaign.
    name
        The file's, relative to it.
    progress
        Called with the part that is done, 0 to 1.

    Returns
    -------
    Look

    Raises
    ------
    InputError
        If it cannot be read, or holds nothing in which a drop could be found.
    """
    try:
        table = read_table(folder / name)
    except InputError as error:
        raise InputError(
            replace(each, where=each.where.replace(Path(name).name, name, 1)) for each in error.problems
        ) from None
    seen = survey(table)
    _refuse(name, seen)
    seen, found = _found(table, seen, progress)
    drops = tuple(_on_clock(drop, table, seen) for drop in found.drops)
    scales: dict[str, float] = {}
    for drop in found.drops:
        first, last = (int((time - seen.start) * seen.rate) for time in (drop.release, drop.end))
        for channel, size in full_scales(table, seen, first, last).items():
            scales[channel] = max(size, scales.get(channel, 0.0))
    file = DraftFile(name, seen.rate, seen.start, seen.end, len(drops), found.rejected, found.events, seen.left_out)
    return Look(file, seen.channels, drops, scales)


def _refuse(name: str, seen: Survey) -> None:
    """Refuse what holds nothing in which a drop could be found."""
    if not seen.channels:
        reasons = "; ".join(f"'{channel}': {why}" for channel, why in list(seen.left_out.items())[:8])
        found = f"no vertical acceleration ({reasons})" if reasons else "no channels"
        do = "If one of them is, let the file name its unit, such as 'ch1 [g]'."
        raise InputError([Problem(name, found, "channels of accelerometers", do)])
    if not seen.rate >= MIN_RATE:
        found = f"{seen.rate:.4g} samples per second"
        raise InputError(
            [Problem(name, found, f"at least {MIN_RATE:g}, to resolve wheel hop", "Record at 200 Hz or more.")]
        )


def _found(table: SampleTable, seen: Survey, progress: Callable[[float], None]) -> tuple[Survey, Detection]:
    """Find the drops; where a unit is not known, in one in which wheels fall as wheels do."""
    if all(channel.unit is not None for channel in seen.channels):
        return seen, _drops_of(table, seen, progress)
    results: list[tuple[bool, int, Survey, Detection]] = []
    size = largest(table, seen)
    for unit in _UNITS:
        choice = replace(seen, channels=tuple(replace(channel, assumed=unit) for channel in seen.channels))
        if not _LEAST < size * acceleration_factor(unit) < _MOST:
            continue
        found = _drops_of(table, choice, progress)
        results.append((bool(is_on_wheel(found.drops).any()), len(found.drops), choice, found))
        if results[-1][0]:
            break
    if not results:
        return seen, _drops_of(table, seen, progress)
    return max(results, key=lambda result: result[:2])[2:]


def _drops_of(table: SampleTable, seen: Survey, progress: Callable[[float], None]) -> Detection:
    factors = np.array([channel.factor for channel in seen.channels])
    read = pieces(table, seen, factors)
    return detect_drops(read, seen.rate, start=seen.start, samples=seen.samples, progress=progress)


def _on_clock(drop: DetectedDrop, table: SampleTable, seen: Survey) -> DetectedDrop:
    """Put a drop's times on a clock that is not quite even."""
    clock = table.clock
    if not isinstance(clock, np.ndarray):
        return drop
    return drop.on_clock(lambda time: float(clock[min(round((time - seen.start) * seen.rate), seen.samples - 1)]))
