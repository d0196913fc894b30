"""A recording: its channels one above the other, with release, landing, the part that is fitted and faulty samples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from sprung.checking import DropReport, PlottedRecording
from sprung.report.drawing.axis import Axis
from sprung.report.drawing.picture import Band, Curve, Mark, Panel, Picture, Points, Rule
from sprung.report.excitations import record_text
from sprung.report.pictures.lanes import Lane, lanes_of

_LANE = 0.42
"""Relative height of a lane."""

_BEGINNINGS: Mapping[str, str] = {"drop": "Release and landing", "push": "Release"}
"""Title of the picture of the beginning of a test."""

_RELEASED = frozenset(_BEGINNINGS)
"""Excitations after which the vehicle is let go."""


def recording_picture(drop: DropReport, recorded: PlottedRecording) -> Picture:
    """Return the picture of a whole recording.

    Parameters
    ----------
    drop
        Report of the drop.
    recorded
        Its recording.

    Returns
    -------
    Picture
        A panel for each channel, in SI over s.
    """
    time = recorded.time
    return _picture("The whole recording", drop, recorded, (float(time[0]), float(time[-1])), False)


def landing_picture(drop: DropReport, recorded: PlottedRecording) -> Picture | None:
    """Return the picture of release and landing.

    Parameters
    ----------
    drop
        Report of the drop.
    recorded
        Its recording.

    Returns
    -------
    Picture or None
        None where no release was detected.
    """
    moments = [moment for moment in (drop.landing, drop.last_lift_off, drop.start) if moment is not None]
    if drop.release is None:
        return None
    time, last = recorded.time, max([drop.release, *moments])
    length = max(last - drop.release, 0.1)
    limits = max(drop.release - 0.3 * length, float(time[0])), min(last + 1.2 * length, float(time[-1]))
    return _picture(_beginning(drop), drop, recorded, limits, True)


def beginning_title(drops: Sequence[DropReport]) -> str:
    """Return the titles of the pictures of the beginning of drops, for a caption; empty where no drop has one.

    Parameters
    ----------
    drops
        Reports of the drops.
    """
    titles = dict.fromkeys(_beginning(drop).lower() for drop in drops if drop.release is not None)
    return ", or ".join(titles)


def _beginning(drop: DropReport) -> str:
    return _BEGINNINGS.get(drop.excitation, "First motion")


def _picture(
    title: str, drop: DropReport, recorded: PlottedRecording, limits: tuple[float, float], near: bool
) -> Picture:
    time = recorded.time
    inside = (time >= limits[0]) & (time <= limits[1])
    events = tuple(_events(drop, labelled=near))
    panels = []
    for lane in lanes_of(drop, recorded):
        marks: list[Mark] = []
        if drop.start is not None and drop.end is not None:
            marks.append(Band(drop.start, drop.end))
        marks += [*events, Curve(time[inside], lane.values[inside], "signal" if lane.used else "unused", width=0.9)]
        if (faulty := lane.marked[inside[lane.marked]]).size:
            marks.append(Points(time[faulty], lane.values[faulty], "fault", size=0.7))
        note, warning = ("", "") if near else (", ".join(lane.notes), ", ".join(lane.warnings))
        panels.append(Panel(_axis(lane), tuple(marks), _LANE, note, warning, lane.name, lane.name))
    reason = f" Reason for its start: {drop.why_start}." if drop.why_start and not near else ""
    what = "Accelerations" if {channel.quantity for channel in drop.channels} == {"acceleration"} else "Readings"
    units = ", ".join(dict.fromkeys(channel.unit for channel in drop.channels))
    description = f"{what} of {len(panels)} channels in {units}, the {record_text(drop)} shaded.{reason}"
    return Picture(title, Axis("time on the recording's clock, s", *limits), tuple(panels), description, zoomable=True)


def _axis(lane: Lane) -> Axis:
    ticks = tuple(lane.ticks)
    spread = lane.span / 0.86
    return Axis(lane.unit, lane.middle - spread / 2, lane.middle + spread / 2, ticks=_few(ticks))


def _few(ticks: tuple[tuple[float, str], ...]) -> tuple[tuple[float, str], ...]:
    """Return as many ticks as a lane has room for."""
    return ticks if len(ticks) <= 3 else tuple(ticks[:: int(np.ceil(len(ticks) / 3))])


def _events(drop: DropReport, labelled: bool) -> Iterator[Rule]:
    word = "release" if drop.excitation in _RELEASED else "first motion"
    record = "response" if drop.is_driven else "decay"
    if drop.release is not None:
        yield Rule(drop.release, "release", f"{word} {drop.release:.3f} s" if labelled else "", dashed=True)
    if drop.landing is not None:
        yield Rule(drop.landing, "landing", f"landing {drop.landing:.3f} s" if labelled else "", dashed=True)
    if drop.start is not None:
        yield Rule(drop.start, "landing", f"{record} from {drop.start:.3f} s" if labelled else "")
