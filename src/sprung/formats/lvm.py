"""LabVIEW measurement files (LVM): text, in segments that each have a header."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sprung.formats.channels import Column, assemble_table
from sprung.formats.lvm_clock import Stretch, clock_of, parse_stamp
from sprung.formats.lvm_rows import SegmentSamples
from sprung.formats.lvm_segments import Segment, find_segments, is_lvm
from sprung.formats.reading_errors import input_error, memory_limit, truncation_error
from sprung.formats.sample_store import Samples, Store, select_ranges, store_in_memory
from sprung.formats.stated_rates import TIME_UNITS
from sprung.formats.text_blocks import detect_encoding
from sprung.formats.text_layout import NUMBER, Layout
from sprung.formats.text_samples import go_through
from sprung.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.channels import ChannelClock
    from sprung.formats.table import SampleTable
    from sprung.formats.text_blocks import Encoding
    from sprung.formats.text_samples import TextSamples

_SUFFIXES = frozenset((".lvm", ".txt", ".csv", ".tsv", ".dat", ".asc"))
_CODE = re.compile(r"\\(\\|[0-9A-F]{2})")
_DIGITS = re.compile(r"\d*[.,]?(\d*)(?:[eE]([+-]?\d{1,3}))?")
_X, _COMMENT = "X_Value", "Comment"
_ROUNDED = 1e-4
"""Relative error of a step that moves the frequencies found; a step that is part of a second is exact."""

_APART = "Save every recording to a file of its own."
_DO = "Save the recording again from LabVIEW, with tabs between the columns."


class LvmFormat:
    """LabVIEW measurement files: any number of segments, with one column of times, none, or one for every channel."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending of a text file and the words with which the header begins."""
        return path.suffix.lower() in _SUFFIXES and is_lvm(head)

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If a header cannot be understood, if the file is cut short, or if its segments do not follow on one another.
        """
        encoding = detect_encoding(path)
        segments, line_numbers = find_segments(path, encoding)
        alike: dict[tuple[str, ...], list[Segment]] = {}
        for segment in segments:
            alike.setdefault((segment.delimiter, *segment.titles), []).append(segment)
        series = [_read_series(path, encoding, members, line_numbers) for members in alike.values()]
        zero = next((own.stretches[0] for one in series for own in one.channels if own.stretches), None)
        columns = [column for one in series for column in _columns(one, zero, path.name)] if zero else []
        notes = [note for one in series for note in (*one.notes, *_notes(one))]
        return assemble_table(columns, path.name, memory_limit(path.stat().st_size), notes)


@dataclass(frozen=True, eq=False)
class _Channel:
    """One column of samples.

    Attributes
    ----------
    name, otherwise
        Its name, and what to call it where another has the same name.
    unit
        Its unit; None without one.
    column
        Its place in the store.
    stretches
        When its samples were taken, one stretch for every segment with samples; none where they were not taken over time.
    ranges
        Which samples of the store are its own: from one up to another, last excluded.
    elsewhere
        Whether its samples are over another quantity than time.
    """

    name: str
    otherwise: str
    unit: str | None
    column: int
    stretches: list[Stretch]
    ranges: list[tuple[int, int]]
    elsewhere: bool


@dataclass(frozen=True, eq=False)
class _Series:
    """Segments with the same columns."""

    store: Store
    channels: list[_Channel]
    notes: list[str]


def _notes(series: _Series) -> Iterator[str]:
    """Yield what was left out, and how well the rate is known where it follows from a rounded step."""
    others = [channel.name for channel in series.channels if channel.elsewhere]
    if others:
        yield f"left out, as they are not over time: {', '.join(others)}"
    stretches = (channel.stretches[0] for channel in series.channels if channel.stretches)
    steps = {(own.step, own.rounding) for own in stretches if own.times is None and (own.step or 0.0) > 0}
    rounded = [error / step for step, error in steps if step and not f"{1 / step:.6f}".endswith(".000000")]
    if max(rounded, default=0.0) > _ROUNDED:
        yield f"without numbers under X_Value the rate is known to {100 * max(rounded):.1g} %, as Delta_X is rounded"


def _columns(series: _Series, zero: Stretch, file: str) -> Iterator[Column]:
    """Yield the channels of segments that follow on one another; those with the same samples share a store and a clock."""
    stores: dict[tuple[tuple[int, int], ...], Store] = {}
    clocks: dict[tuple[object, ...], ChannelClock] = {}
    for channel in series.channels:
        if not channel.stretches:
            continue
        ranges = tuple(channel.ranges)
        if ranges not in stores:
            whole = ranges == ((0, series.store.length),)
            stores[ranges] = series.store if whole else select_ranges(series.store, ranges)
        key = tuple((one.stamp, one.x0, one.step, one.count, id(one.times)) for one in channel.stretches)
        if key not in clocks:
            clocks[key] = clock_of(channel.stretches, zero, file, channel.name)
        samples = Samples(stores[ranges], channel.column)
        yield Column(channel.name, channel.otherwise, channel.unit, clocks[key], samples)


def _read_series(
    path: Path, encoding: Encoding, segments: Sequence[Segment], line_numbers: Mapping[int, int]
) -> _Series:
    """Go through the samples of segments with the same columns."""
    head, file = segments[0], path.name
    columns, comments = _channel_columns(head, file)
    if not columns:
        return _Series(store_in_memory(np.empty((0, 0))), [], [])
    names = tuple(head.titles[: columns[-1] + 1])
    row = next((one.first_row for one in segments if one.first_row), [])
    layout = Layout(head.delimiter, _decimal(head, row[: len(names)]), head.titles_line, names, (), len(names), 0, 1)
    ranges = [own for one in segments for own in one.ranges]
    text: TextSamples = SegmentSamples(path, encoding, layout, (), line_numbers, ranges, comments)
    axes = [max(index for index in range(column) if names[index] == _X) for column in columns]
    read = list(range(len(names))) if text.small else sorted(set(axes))
    text, cells, _ = go_through(text, text.read_blocks(encoding.start), read)
    values = cells.values
    channels = [_channel(head, columns, number) for number in range(len(columns))]
    notes: list[str] = []
    for segment in segments:
        if not segment.ranges:
            continue
        first, last = (cells.samples_before(line) for line in (segment.ranges[0][0], segment.ranges[-1][1]))
        times = {axis: values[read.index(axis), first:last] for axis in set(axes)}
        times = {axis: own for axis, own in times.items() if np.isfinite(own[:1]).any()}
        counts, joined = _counts(segment, columns, last - first, file)
        if joined and not times:
            notes.append(f"samples written later below the header in line {segment.line} were taken to follow at once")
        for axis_times in times.values():
            with np.errstate(all="ignore"):
                back = np.flatnonzero(np.diff(axis_times) <= 0)
            if back.size:
                where, found = f"{file}: line {cells.line_of(first + int(back[0]) + 1)}", "an X_Value that goes back"
                raise input_error(where, found, "times that increase from row to row", _APART)
        for channel, own in zip(channels, _stretches(segment, columns, axes, counts, times), strict=True):
            if own is not None and not channel.elsewhere:
                channel.stretches.append(own)
                channel.ranges.append((first, first + own.count))
    in_memory = store_in_memory(values) if text.small else None
    store = Store(len(names), cells.count, in_memory.read if in_memory else text.read, text.find_non_number)
    return _Series(store, channels, notes)


def _channel_columns(segment: Segment, file: str) -> tuple[list[int], bool]:
    """Return the columns of the channels, and whether one for comments is behind them."""
    titles = segment.titles
    columns = [index for index, title in enumerate(titles) if title != _X]
    [declared] = _cells(segment, "Channels", [1])
    comments = titles[-1] == _COMMENT
    columns = columns[:-1] if comments else columns
    if declared not in ("", str(len(columns))):
        found = f"{len(columns)} names for {declared[:20]!r} channels"
        do = f"{_DO} A separator within a name divides it."
        raise input_error(f"{file}: line {segment.titles_line}", found, "one name for every channel", do)
    return columns, comments


def _cells(segment: Segment, tag: str, columns: Sequence[int]) -> list[str]:
    """Return the cells of some columns of a line of a header; as many cells as columns are theirs wherever they stand."""
    cells = segment.fields.get(tag, [])
    filled = [cell for cell in cells[1:] if cell]
    if len(filled) == len(columns):
        return filled
    return [cells[column] if column < len(cells) else "" for column in columns]


def _decimal(segment: Segment, row: Sequence[str]) -> str:
    """Return the decimal mark with which samples are written, which may not be the one in the header."""
    marks = [mark for mark in ".," if mark != segment.delimiter and any(mark in cell for cell in row)]
    return marks[0] if len(marks) == 1 else segment.decimal


def _channel(segment: Segment, columns: Sequence[int], number: int) -> _Channel:
    title = _decoded(segment.titles[columns[number]])
    label = _decoded(_cells(segment, "Y_Unit_Label", columns)[number])
    name, unit = (title, label) if label else split_unit(title)
    dimension, label = (_cells(segment, tag, columns)[number] for tag in ("X_Dimension", "X_Unit_Label"))
    elsewhere = dimension not in ("", "Time") or (label.lower() or "s") not in TIME_UNITS
    return _Channel(name, f"{name or 'channel'} {number + 1}", unit, columns[number], [], [], elsewhere)


def _decoded(text: str) -> str:
    """Return a text with its characters instead of their codes; nothing where it cannot be printed."""
    plain = _CODE.sub(lambda found: "\\" if found[1] == "\\" else chr(int(found[1], 16)), text)
    plain = " ".join(plain.split())
    return plain if plain.isprintable() else ""


def _counts(segment: Segment, columns: Sequence[int], rows: int, file: str) -> tuple[list[int], bool]:
    """Return the samples of every channel, and whether there are more than the header has: later ones were added."""
    stated = [int(cell) if cell.isdecimal() else None for cell in _cells(segment, "Samples", columns)]
    most = max((count for count in stated if count is not None), default=rows)
    if most > rows:
        raise truncation_error(f"{file}: line {segment.line}", f"a segment with {rows} of {most} samples")
    if most < rows:
        return [rows if count is None or count == most else count for count in stated], True
    return [rows if count is None else count for count in stated], False


def _stretches(
    segment: Segment,
    columns: Sequence[int],
    axes: Sequence[int],
    counts: Sequence[int],
    times: Mapping[int, NDArray[np.float64]],
) -> Iterator[Stretch | None]:
    """Yield when the samples of every channel were taken; None for a channel without samples.

    X_Value is the time of the longest channel to its right; others with the same step have it too, from their own beginning.
    """
    tags = ("X_Unit_Label", "Date", "Time", "X0", "Delta_X")
    rows = list(zip(*(_cells(segment, tag, columns) for tag in tags), strict=True))
    whose = {axis: max((c for c, own in enumerate(axes) if own == axis), key=lambda c: counts[c]) for axis in set(axes)}
    shared: dict[tuple[int, int, float, float], NDArray[np.float64]] = {}
    for number, (label, day, time, x0, step) in enumerate(rows):
        factor = TIME_UNITS.get(label.lower() or "s", 1.0)
        if not counts[number]:
            yield None
            continue
        axis, begin, rounding = axes[number], _number(x0) or 0.0, factor * _rounding(step)
        seconds = None if _number(step) is None else factor * (_number(step) or 0.0)
        leader, own = rows[whose[axis]], None
        if axis in times and step == leader[4]:
            later = begin - (_number(leader[3]) or 0.0)
            key = axis, counts[number], later if np.isfinite(later) else 0.0, factor
            if key not in shared:
                shared[key] = factor * (times[axis][: key[1]] + key[2])
            own = shared[key]
        stamp = parse_stamp(day, time)
        yield Stretch(segment.line, counts[number], stamp, factor * begin, seconds, rounding, own)


def _number(text: str) -> float | None:
    return float(text.replace(",", ".")) if NUMBER.fullmatch(text) and text.isascii() else None


def _rounding(text: str) -> float:
    """Return half a unit of the last digit of a number."""
    found = _DIGITS.fullmatch(text)
    return 0.5 * 10.0 ** (int(found[2] or 0) - len(found[1])) if found else 0.0
