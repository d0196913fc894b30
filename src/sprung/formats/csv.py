"""Text tables of every dialect: whatever stands above, then names, perhaps units, then one line per sample.

The file is gone through once for its lines and its time, and again for the columns that are asked for.
"""

from __future__ import annotations

import codecs
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sprung.formats.lvm_segments import is_lvm
from sprung.formats.reading_errors import input_error
from sprung.formats.sample_store import Samples, Store, join_samples, store_in_memory
from sprung.formats.stated_rates import TIME_UNITS, Rate, find_stated_rate
from sprung.formats.table import SampleTable
from sprung.formats.text_blocks import Encoding, LineBlock, detect_encoding, read_blocks
from sprung.formats.text_clock import TIME_NAMES, Columns, find_text_clock, find_time_candidates
from sprung.formats.text_layout import Layout, detect_layout, split_cells
from sprung.formats.text_samples import BLANK, LineSamples, TextSamples, go_through
from sprung.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray


__all__ = ["TIME_NAMES", "TIME_UNITS", "CsvFormat"]

SUFFIXES = frozenset((".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm"))
"""Endings of text tables."""

_LOOKED_AT = 50
"""Lines in which clock times show, if there are any."""


class CsvFormat:
    """Text tables: comma, semicolon, tab, pipe or spaces; decimal point or comma; UTF-8, UTF-16 or Windows letters."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim text by its ending; binary files hold null bytes, text does not, UTF-16 with its mark apart.

        A LabVIEW measurement file without its headers is one too.
        """
        marked = head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        return path.suffix.lower() in SUFFIXES and (marked or b"\0" not in head) and not is_lvm(head)

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If it holds no samples, no time column, or columns that the header does not name.
        """
        file = path.name
        try:
            encoding = detect_encoding(path)
        except UnicodeDecodeError as error:
            do = "Export the recording again, as UTF-8."
            raise input_error(
                file, f"a file marked as UTF-16 with invalid text ({error.reason})", "text", do
            ) from error
        ahead = read_blocks(path, encoding)
        head = next(ahead, LineBlock(0, []))
        layout, rate, times = _understood(head, file)
        return _table(TextSamples(path, encoding, layout), chain([head], ahead), rate, times)


def table_from_lines(file: str, lines: Sequence[str]) -> SampleTable:
    """Understand lines as a text table, for formats whose cells can be written as text.

    Parameters
    ----------
    file
        What to call their file in messages.
    lines
        All of them, in memory, the cells separated as in a text table.

    Returns
    -------
    SampleTable

    Raises
    ------
    InputError
        As from `CsvFormat.read`.
    """
    head = LineBlock(0, list(lines))
    layout, rate, times = _understood(head, file)
    return _table(LineSamples(Path(file), Encoding("utf-8", 0), layout, (), head), [head], rate, times)


def _understood(head: LineBlock, file: str) -> tuple[Layout, Rate | None, list[int]]:
    """Recognise the layout of a table, its rate where a line above says it, and the columns that may be the time."""
    text = "\n".join(head.lines)
    end = _end(text)
    if not text[:end].strip():
        expected = "a line with the names of the columns, then the samples"
        raise input_error(file, "an empty file", expected, "Export it again.")
    layout = detect_layout(text, end)
    rate = _rate(text, layout, file)
    _check(layout, rate, end, file)
    return layout, rate, _may_be_time(text, layout)


def _end(text: str) -> int:
    """Find where the last line ends that holds anything."""
    end = len(text)
    while end:
        start = text.rfind("\n", 0, end) + 1
        if text[start:end].strip(BLANK):
            break
        end = max(start - 1, 0)
    return end


def _rate(text: str, layout: Layout, file: str) -> Rate | None:
    lines = text[: layout.start].split("\n") if layout.line < 10_000 else text[: layout.start].split("\n")[:10_000]
    try:
        return find_stated_rate(lines, layout.decimal)
    except ValueError as error:
        where, _, found = str(error).partition("|")
        expected = "a number that can be read in one way"
        raise input_error(f"{file}: {where}", found, expected, "Write it without a thousands separator.") from None


def _check(layout: Layout, rate: Rate | None, end: int, file: str) -> None:
    """Refuse what is no table with names."""
    where = f"{file}: line {layout.header or layout.line}"
    if not layout.header:
        found, do = "numbers in the first line", "Add a line with the names of the columns above them."
        if layout.line > 1:
            found = "numbers without names above them"
        raise input_error(where, found, "the names of the columns", do)
    if any(not character.isprintable() for name in layout.names for character in name):
        found, do = "unreadable characters", "Export the recording as text; this file may be of another kind."
        raise input_error(where, found, "the names of the columns", do)
    if len(layout.names) < 2 and rate is None:
        expected = "the time and at least one channel, separated by comma, semicolon, tab, pipe or spaces"
        do = "Export it with separators, or add a line such as 'Sample rate: 500 Hz' above the names."
        raise input_error(where, f"a single column, '{layout.names[0][:80]}'", expected, do)
    if layout.start >= end:
        raise input_error(file, "a header and no samples", "one line per sample below the names", "Export it again.")


def _may_be_time(text: str, layout: Layout) -> list[int]:
    """Return the columns that may hold the time, by their names or their first cells."""
    rows = [split_cells(line, layout.delimiter) for line in text[layout.start :].split("\n", _LOOKED_AT)[:_LOOKED_AT]]
    return find_time_candidates(layout.names, rows)


def _table(text: TextSamples, ahead: Iterable[LineBlock], rate: Rate | None, candidates: Sequence[int]) -> SampleTable:
    layout = text.layout
    small = text.small
    read = range(len(layout.names)) if small else candidates
    text, cells, cut = go_through(text, ahead, read)
    notes = [f"line {line}, between names and samples, was ignored" for line in layout.passed]
    if cut:
        notes.append(f"line {cut}, the last, is cut short and was left out")
    clocks: dict[int, NDArray[np.float64]] = {}
    for column, (rows, seconds) in ((column, cells.clocks[column]) for column in candidates if column in cells.clocks):
        clocks[column] = np.full(cells.count, np.nan)
        clocks[column][np.frombuffer(rows, dtype=np.int64)] = np.frombuffer(seconds, dtype=np.float64)
    units = (*layout.units, *("",) * (len(layout.names) - len(layout.units)))
    columns = Columns(
        names=layout.names,
        units=units,
        values={column: cells.values[read.index(column)] for column in candidates},
        clocks=clocks,
        wrong={column: problem for column in candidates if (problem := cells.wrong(column)) is not None},
        line=cells.line_of,
    )
    clock = find_text_clock(columns, rate, text.path.name)
    channels = [column for column, name in enumerate(layout.names) if name and column != clock.column]
    named = [split_unit(layout.names[column]) for column in channels]
    in_memory = store_in_memory(cells.values) if small else None
    store = Store(len(layout.names), cells.count, in_memory.read if in_memory else text.read, text.find_non_number)
    return SampleTable(
        channels=tuple(name for name, _ in named),
        units=tuple(
            unit if unit is not None else units[column] or None
            for (_, unit), column in zip(named, channels, strict=True)
        ),
        store=join_samples([Samples(store, column) for column in channels]),
        clock=clock.time,
        place=lambda sample: f"line {cells.line_of(sample)}",
        notes=(*notes, *clock.notes),
    )
