"""Channels of recordings for the page that shows them side by side; runs in the process that answers questions.

Values are those of the files in their own units; nothing is corrected.
"""

from __future__ import annotations

import csv
import io
import time
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.app.decimation import Extremes, interval_edges
from sprung.errors import InputError, Problem
from sprung.formats import SampleTable, read_table

Real = NDArray[np.float64]

_TABLES, _COLUMNS = 40, 400
"""Tables that remain open, and channels whose values or overviews are kept."""

_WHOLE = 200_000
"""Samples of a channel up to which all are kept in memory."""

_OVERVIEW = 1 << 14
"""Intervals of the overview of a longer one."""

_TURN = 3.0
"""Time after which the reading of a long file is interrupted for an answer, s; the next question continues it."""

_MOST_ROWS = 300_000
"""Rows of a CSV file of what is visible."""

_tables: OrderedDict[tuple[str, int, int], SampleTable] = OrderedDict()
_kept: OrderedDict[tuple[str, int, int, int], _Kept] = OrderedDict()
_reading: dict[tuple[str, int, int], _Reading] = {}


class _Kept(NamedTuple):
    """A channel in memory: every sample, or the lowest and the highest value of intervals."""

    values: Real | None
    low: Real
    high: Real


class _Reading(NamedTuple):
    """A long file that is being read."""

    pieces: Iterator[tuple[int, Real]]
    overview: Extremes


def channels(files: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return the channels of recordings.

    Parameters
    ----------
    files
        Path of each, by its name on the page.

    Returns
    -------
    list of dict
        For each file ``channels`` with their units, ``begin`` and ``end`` of its clock, s, and ``samples``; or the
        ``problem`` for which it cannot be read.
    """
    found: list[dict[str, Any]] = []
    for name, path in files.items():
        try:
            table, _ = _table(path)
            first, last = _time_at(table, 0), _time_at(table, table.samples - 1)
        except InputError as error:
            why = " ".join(f"Found {one.found}; expected {one.expected}. {one.do}" for one in error.problems)
            found.append({"file": name, "problem": why})
            continue
        named = [
            {"name": channel, "unit": unit or ""} for channel, unit in zip(table.channels, table.units, strict=True)
        ]
        found.append({"file": name, "channels": named, "begin": first, "end": last, "samples": table.samples})
    return found


def visible(path: str, wanted: Sequence[str], low: float, high: float, pixels: int) -> dict[str, Any]:
    """Return what is to be drawn of the channels of one file.

    Parameters
    ----------
    path
        Of the recording.
    wanted
        Names of channels.
    low, high
        Range of time on the file's clock, s.
    pixels
        Width of the picture: for each the lowest and the highest value are returned where there are more samples.

    Returns
    -------
    dict
        ``channels``: for each times, s, and values in the unit of the file, None where the file has no number. Only ``done``,
        the part that was read, while a long file is being read: the same question continues it.

    Raises
    ------
    InputError
        If the file cannot be read, or has no such channel.
    """
    table, key = _table(path)
    done = _read_on(table, key)
    if done < 1:
        return {"done": done}
    found = {}
    for channel in wanted:
        column = _column(table, channel, path)
        times, values = _drawn(table, key, column, low, high, max(int(pixels), 10))
        found[channel] = {"time": _plain(times, 9), "values": _plain(values, 6)}
    return {"channels": found}


def visible_csv(parts: Sequence[Mapping[str, Any]], low: float, high: float) -> str:
    """Return every sample that is visible as CSV.

    Parameters
    ----------
    parts
        For each file ``file``, its name on the page; ``path``; ``offset`` of its clock in the picture, s; and ``channels``.
    low, high
        Range of time of the picture, s.

    Returns
    -------
    str
        A row for each sample of each file: file, time in the picture and on the file's clock, s, and the channels of all
        files in their units; a file that lacks a channel leaves its cell empty.

    Raises
    ------
    InputError
        If a file cannot be read, or there are too many rows.
    """
    heads: dict[tuple[str, str], None] = {}
    opened = []
    rows = 0
    for part in parts:
        table, _ = _table(part["path"])
        columns = [_column(table, channel, part["path"]) for channel in part["channels"]]
        first, last = _range(table, low - part["offset"], high - part["offset"])
        own = [(table.channels[column], table.units[column] or "") for column in columns]
        heads.update(dict.fromkeys(own))
        opened.append((part, table, columns, own, first, last))
        rows += last - first
    if rows > _MOST_ROWS:
        expected = f"at most {_MOST_ROWS} rows"
        raise InputError([Problem("visible part", f"{rows} samples", expected, "Zoom in, or show fewer files.")])
    text = io.StringIO()
    writer = csv.writer(text)
    titles = [f"{name}, {unit}" if unit else name for name, unit in heads]
    writer.writerow([_safe(cell) for cell in ("file", "time in the picture, s", "time of the file, s", *titles)])
    for part, table, columns, own, first, last in opened:
        times, values = _times(table, first, last), table.take(columns, first, last)
        order = [own.index(head) if head in own else None for head in heads]
        for i, now in enumerate(times.tolist()):
            cells = ["" if j is None or np.isnan(values[j, i]) else f"{values[j, i]:.9g}" for j in order]
            writer.writerow([_safe(part["file"]), f"{now + part['offset']:.9g}", f"{now:.9g}", *cells])
    return text.getvalue()


def _safe(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula."""
    return f"'{text}" if text[:1] in "=+-@\t\r" else text


def _table(path: str) -> tuple[SampleTable, tuple[str, int, int]]:
    """Return an open recording; it is opened again if it was changed."""
    try:
        state = Path(path).stat()
    except OSError as error:
        found = (error.strerror or str(error)).lower()
        raise InputError([Problem(Path(path).name, found, "a recording", "Load the page again.")]) from error
    key = (path, state.st_mtime_ns, state.st_size)
    if key not in _tables:
        _tables[key] = read_table(Path(path))
        while len(_tables) > _TABLES:
            _tables.popitem(last=False)
    _tables.move_to_end(key)
    return _tables[key], key


def _column(table: SampleTable, channel: str, path: str) -> int:
    if channel not in table.channels:
        found, do = f"no channel '{channel}'", "Load the page again."
        raise InputError([Problem(Path(path).name, found, ", ".join(table.channels), do)])
    return table.channels.index(channel)


def _times(table: SampleTable, first: int, last: int) -> Real:
    if isinstance(table.clock, np.ndarray):
        return np.asarray(table.clock[first:last], dtype=float)
    return np.arange(first, last) / table.clock


def _time_at(table: SampleTable, sample: int) -> float:
    return float(_times(table, sample, sample + 1)[0]) if table.samples else 0.0


def _range(table: SampleTable, low: float, high: float) -> tuple[int, int]:
    """Return the samples in a range of time, its ends included: the first, and the one after the last."""
    if isinstance(table.clock, np.ndarray):
        near = 1e-6 * (_time_at(table, table.samples - 1) - _time_at(table, 0)) / max(table.samples - 1, 1)
        first = int(np.searchsorted(table.clock, low - near, side="left"))
        return first, max(first, int(np.searchsorted(table.clock, high + near, side="right")))
    first = int(np.clip(np.ceil(low * table.clock - 1e-6), 0, table.samples))
    return first, int(np.clip(np.floor(high * table.clock + 1e-6) + 1, first, table.samples))


def _drawn(
    table: SampleTable, key: tuple[str, int, int], column: int, low: float, high: float, pixels: int
) -> tuple[Real, Real]:
    """Return times and values of a channel in a range of time, and of the samples next to it on both sides."""
    first, last = _range(table, low, high)
    first, last = max(first - 1, 0), min(last + 1, table.samples)
    if last <= first:
        return np.empty(0), np.empty(0)
    kept = _kept[(*key, column)]
    _kept.move_to_end((*key, column))
    if kept.values is not None:
        return _thinned(_times(table, first, last), kept.values[first:last], pixels)
    per_interval = table.samples / len(kept.low)
    if (last - first) / per_interval < pixels:
        return _thinned(_times(table, first, last), table.take([column], first, last)[0], pixels)
    begin, end = int(first / per_interval), min(int(np.ceil(last / per_interval)), len(kept.low))
    edges = interval_edges(table.samples, len(kept.low))[begin : end + 1]
    together = interval_edges(end - begin, pixels)
    ends = edges[together].clip(max=table.samples - 1)
    clock = table.clock
    times = np.asarray(clock[ends]) if isinstance(clock, np.ndarray) else ends / clock
    lowest = np.fmin.reduceat(kept.low[begin:end], together[:-1])
    highest = np.fmax.reduceat(kept.high[begin:end], together[:-1])
    return _interleaved(times, lowest, highest)


def _thinned(times: Real, values: Real, pixels: int) -> tuple[Real, Real]:
    if len(values) <= 4 * pixels:
        return times, values
    found = Extremes(1, len(values), pixels)
    found.add(0, values[None])
    ends = interval_edges(len(values), pixels).clip(max=len(values) - 1)
    return _interleaved(times[ends], found.low[0], found.high[0])


def _interleaved(edges: Real, low: Real, high: Real) -> tuple[Real, Real]:
    """Return the lowest and the highest value of intervals as one line, both in the middle of their interval."""
    return np.repeat((edges[:-1] + edges[1:]) / 2, 2), np.stack([low, high], axis=1).ravel()


def _read_on(table: SampleTable, key: tuple[str, int, int]) -> float:
    """Read the channels of a file into memory, or a long one for a while; return the part that was read."""
    if all((*key, column) in _kept for column in range(len(table.channels))):
        return 1.0
    if table.samples <= _WHOLE:
        # All channels at once: a text is read through for one as for all.
        for i, values in enumerate(table.take()):
            _kept[(*key, i)] = _Kept(values, np.empty(0), np.empty(0))
    else:
        # A reading that fails is not continued: the next question begins anew, and fails with the same reason.
        reading = _reading.pop(key, None)
        if reading is None:
            reading = _Reading(table.pieces(), Extremes(len(table.channels), table.samples, _OVERVIEW))
        pieces, overview = reading
        until = time.monotonic() + _TURN
        for first, values in pieces:
            overview.add(first, values)
            if time.monotonic() > until:
                _reading[key] = reading
                return 0.999 * float(first + values.shape[1]) / table.samples
        for i in range(len(table.channels)):
            _kept[(*key, i)] = _Kept(None, overview.low[i], overview.high[i])
    while len(_kept) > max(_COLUMNS, len(table.channels)):
        _kept.popitem(last=False)
    return 1.0


def _plain(values: Real, figures: int) -> list[float | None]:
    return [float(f"{value:.{figures}g}") if np.isfinite(value) else None for value in values.tolist()]
