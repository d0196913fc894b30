"""Examination of one recording: its channels, and the drops in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from sprung.drafting.channel import Channel
from sprung.drafting.channel_survey import (
    PIECE,
    ChannelSurvey,
    detect_full_scales,
    largest_reading,
    read_pieces,
    survey_channels,
)
from sprung.drafting.detected_drop import DetectedDrop, is_on_wheel
from sprung.drafting.detected_release import DetectedRelease
from sprung.drafting.detection import Detection, RejectedEvent, detect_drops
from sprung.drafting.excitation_names import excitation_named
from sprung.drafting.other_channel import OtherChannel
from sprung.drafting.pad_motion import moving_pads
from sprung.drafting.quantity_names import is_pad_named
from sprung.drafting.records import DraftFile
from sprung.drafting.release_detection import average_pieces, detect_releases
from sprung.errors import InputError, Problem
from sprung.formats import MIN_RATE, read_table, resolves_wheel_hop
from sprung.units import si_factor

if TYPE_CHECKING:
    from sprung.formats import SampleTable

_UNITS = ("m/s^2", "g", "mm/s^2", "mg")
"""Units tried for a sensor that reads no gravity and whose file states none; the first in which wheels fall is used."""

_LEAST, _MOST = 5.0, 600.0
"""m/s² between which the largest reading lies, averaged over some milliseconds, of a recording with drops in it."""


@dataclass(frozen=True, eq=False)
class ExaminedRecording:
    """One recording with its channels and drops.

    Attributes
    ----------
    file
        About the file.
    channels
        Its vertical accelerations.
    drops
        Its drops, on the file's clock; their features by channel, in the same order.
    full_scale
        By channel a reading at which it stays for some samples of a drop.
    files
        Names of the recordings, where those of several loggers were joined.
    others
        Its channels of other quantities.
    releases
        What its displacements show, where its accelerations show no drop.
    pads
        Its channels of pads that move.
    driven
        A push or a pass over a bump by its name, where its channels show no release: only accelerations tell of it.
    """

    file: DraftFile
    channels: tuple[Channel, ...]
    drops: tuple[DetectedDrop, ...]
    full_scale: Mapping[str, float]
    files: tuple[str, ...] = ()
    others: tuple[OtherChannel, ...] = ()
    releases: tuple[DetectedRelease, ...] = ()
    pads: tuple[str, ...] = ()
    driven: Literal["push", "pass"] | None = None

    @property
    def shows_excitation(self) -> bool:
        """Whether it is a drop, another release, one on pads, or a push or a pass by its name."""
        return bool(self.drops or self.releases or self.pads or self.driven)


def examine_recording(folder: Path, name: str, progress: Callable[[float], None]) -> ExaminedRecording:
    """Read one recording and detect its drops.

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
    seen = survey_channels(table)
    _require_channels(name, seen)
    seen, found = _detect(table, seen, progress) if seen.channels else (seen, Detection(()))
    pads, releases, motions = _motions(table, seen, no_drop=not found.drops)
    found = Detection(()) if pads else found
    drops = tuple(_on_clock(drop, table, seen) for drop in found.drops)
    scales: dict[str, float] = {}
    for drop in found.drops:
        first, last = (int((time - seen.start) * seen.rate) for time in (drop.release, drop.end))
        for channel, size in detect_full_scales(table, seen, first, last).items():
            scales[channel] = max(size, scales.get(channel, 0.0))
    named = excitation_named(name) if seen.channels and not (drops or releases or pads) else None
    driven = None if named == "drop" else named
    number = len(drops) + len(releases) + bool(pads) + bool(driven)
    rejected = () if releases or pads or driven else (*found.rejected, *motions)
    file = DraftFile(name, seen.rate, seen.start, seen.end, number, rejected, found.events, seen.left_out)
    return ExaminedRecording(
        file, seen.channels, drops, scales, others=seen.others, releases=releases, pads=pads, driven=driven
    )


def _require_channels(name: str, seen: ChannelSurvey) -> None:
    """Raise if a recording holds no channel in which a drop could be detected."""
    if not seen.channels and not any(channel.quantity == "displacement" for channel in seen.others):
        reasons = "; ".join(f"'{channel}': {why}" for channel, why in list(seen.left_out.items())[:8])
        found = f"no vertical acceleration ({reasons})" if reasons else "no channels"
        if seen.others:
            measured = ", ".join(f"'{channel.name}' {channel.quantity.replace('-', ' ')}" for channel in seen.others)
            found = f"neither accelerations nor displacements ({measured})"
        do = "If one of them is, state its unit in the file, such as 'ch1 [g]'."
        raise InputError([Problem(name, found, "channels of accelerometers", do)])
    if not resolves_wheel_hop(seen.rate):
        found = f"{seen.rate:.4g} samples per second"
        raise InputError(
            [Problem(name, found, f"at least {MIN_RATE:g}, to resolve wheel hop", "Record at 200 Hz or more.")]
        )


def _detect(
    table: SampleTable, seen: ChannelSurvey, progress: Callable[[float], None]
) -> tuple[ChannelSurvey, Detection]:
    """Detect the drops; where a unit is not known, in one in which wheels fall."""
    if all(channel.unit is not None for channel in seen.channels):
        return seen, _drops_of(table, seen, progress)
    results: list[tuple[bool, int, ChannelSurvey, Detection]] = []
    size = largest_reading(table, seen)
    for unit in _UNITS:
        choice = replace(seen, channels=tuple(replace(channel, assumed=unit) for channel in seen.channels))
        if not _LEAST < size * si_factor(unit) < _MOST:
            continue
        found = _drops_of(table, choice, progress)
        results.append((bool(is_on_wheel(found.drops).any()), len(found.drops), choice, found))
        if results[-1][0]:
            break
    if not results:
        return seen, _drops_of(table, seen, progress)
    return max(results, key=lambda result: result[:2])[2:]


def _drops_of(table: SampleTable, seen: ChannelSurvey, progress: Callable[[float], None]) -> Detection:
    factors = np.array([channel.factor for channel in seen.channels])
    read = read_pieces(table, seen, factors)
    return detect_drops(read, seen.rate, start=seen.start, samples=seen.samples, progress=progress)


def _motions(
    table: SampleTable, seen: ChannelSurvey, *, no_drop: bool
) -> tuple[tuple[str, ...], tuple[DetectedRelease, ...], tuple[RejectedEvent, ...]]:
    """Return the pads that move, and the releases and other motions that the displacements show where there is no drop."""
    pairs = [(c, i) for c, i in zip(seen.others, seen.other_columns, strict=True) if c.quantity == "displacement"]
    names = tuple(channel.name for channel, _ in pairs)
    if not pairs or not (no_drop or any(map(is_pad_named, names))):
        return (), (), ()
    factors = np.array([[channel.factor] for channel, _ in pairs])
    pieces = ((begin, piece * factors) for begin, piece in table.pieces([column for _, column in pairs], PIECE))
    averages = average_pieces(pieces, seen.rate, seen.start)
    pads = moving_pads(averages, names)
    return (pads, (), ()) if pads or not no_drop else ((), *detect_releases(averages, names))


def _on_clock(drop: DetectedDrop, table: SampleTable, seen: ChannelSurvey) -> DetectedDrop:
    """Return a drop with its times on a clock whose steps are not equal."""
    clock = table.clock
    if not isinstance(clock, np.ndarray):
        return drop
    return drop.on_clock(lambda time: float(clock[min(round((time - seen.start) * seen.rate), seen.samples - 1)]))
