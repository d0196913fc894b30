"""Text tables of every dialect: whatever stands above, then names, perhaps units, then one line per sample.

The file is gone through once for its lines and its time, and again for the columns that are asked for.
"""

from __future__ import annotations

import codecs
from bisect import bisect_right
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sprung.formats.reading_errors import input_error, reading
from sprung.formats.sample_store import Samples, Store, join_samples, regroup, store_in_memory
from sprung.formats.stated_rates import TIME_UNITS, Rate, find_stated_rate
from sprung.formats.table import SampleTable
from sprung.formats.text_blocks import Encoding, LineBlock, detect_encoding, read_blocks
from sprung.formats.text_cells import Cells
from sprung.formats.text_clock import TIME_NAMES, Columns, find_text_clock, find_time_candidates
from sprung.formats.text_layout import Layout, detect_layout, split_cells
from sprung.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from sprung.errors import Problem

__all__ = ["TIME_NAMES", "TIME_UNITS", "CsvFormat"]

_BLANK = " \t,;|"
_SMALL = 1 << 22
"""Bytes up to which a file is read at once, as going through it twice would take longer."""

_LOOKED_AT = 50
"""Lines in which clock times show, if there are any."""


class CsvFormat:
    """Text tables: comma, semicolon, tab, pipe or spaces; decimal point or comma; UTF-8, UTF-16 or Windows letters."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim text by its ending; binary files hold null bytes, text does not, UTF-16 with its mark apart."""
        marked = head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        return path.suffix.lower() in {".csv", ".tsv", ".txt", ".dat", ".asc"} and (marked or b"\0" not in head)

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
        return _table(_Text(path, encoding, layout), chain([head], ahead), rate, times)


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
    return _table(_Lines(Path(file), Encoding("utf-8", 0), layout, (), head), [head], rate, times)


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
        if text[start:end].strip(_BLANK):
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


@dataclass(frozen=True, eq=False)
class _Text:
    """A file.

    Attributes
    ----------
    path, encoding, layout
        Where it is and how it is written.
    marks
        Of every block of lines, once it was gone through: the sample and the line with which it begins, and the byte.
    """

    path: Path
    encoding: Encoding
    layout: Layout
    marks: Sequence[tuple[int, int, int]] = ()

    @property
    def size(self) -> int:
        """Its bytes."""
        return self.path.stat().st_size

    @property
    def small(self) -> bool:
        """Whether it is read at once."""
        return self.size <= _SMALL

    def read_blocks(self, start: int) -> Iterator[LineBlock]:
        """Yield the lines from a byte on."""
        return read_blocks(self.path, self.encoding, start)

    def cells(self, columns: Sequence[int], first: int, last: int) -> Iterator[tuple[int, Cells]]:
        """Read the blocks with some samples; give the first sample of each as well."""
        sample, number, start = self.marks[bisect_right(self.marks, first, key=lambda mark: mark[0]) - 1]
        pieces = self.read_blocks(start)
        while sample < last:
            with reading(self.path.name, "a text table"):
                lines = _samples(next(pieces), number, self.layout)
                cells = Cells(self.path.name, self.layout, columns, self.size, first - sample, last - sample)
                cells.add(lines.lines, lines.start)
            yield sample, cells
            number, sample = lines.start + len(lines.lines), sample + cells.count

    def read(self, columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        """Read as a store does."""
        found = self.cells(columns, first, last)
        return regroup((cells.values[:, max(first - sample, 0) :] for sample, cells in found), step)

    def find_non_number(self, column: int, first: int, last: int) -> Problem | None:
        """Return a problem for text that is not a number, as a store does."""
        whole = Cells(self.path.name, self.layout, [column], self.size)
        for _, cells in self.cells([column], first, last):
            for all_, own in ((whole.text, cells.text), (whole.clock_cells, cells.clock_cells)):
                for line, cell, count in own.values():
                    begin, text, before = all_.get(column, (line, cell, 0))
                    all_[column] = (begin, text, before + count)
        return whole.find_non_number(column)


@dataclass(frozen=True, eq=False)
class _Lines(_Text):
    """Lines that are in memory.

    Attributes
    ----------
    held
        All of them.
    """

    held: LineBlock = LineBlock(0, [])  # noqa: RUF009 (a tuple that nobody changes)

    @property
    def size(self) -> int:
        """Letters of them."""
        return sum(len(line) + 1 for line in self.held.lines)

    @property
    def small(self) -> bool:
        """Always: they are in memory anyhow."""
        return True

    def read_blocks(self, start: int) -> Iterator[LineBlock]:  # noqa: ARG002 (there is one block)
        """Return all lines."""
        return iter([self.held])


def _samples(block: LineBlock, number: int, layout: Layout) -> LineBlock:
    """Return the lines of a block with samples, and the number of the first of them."""
    above = max(layout.line - number, 0)
    return LineBlock(number + min(above, len(block.lines)), block.lines[above:])


def _gone_through(text: _Text, ahead: Iterable[LineBlock], columns: Sequence[int]) -> tuple[_Text, Cells, int]:
    """Return the cells of some columns of a file, and the number of its last line if that is cut short."""
    layout = text.layout
    cells = Cells(text.path.name, layout, columns, text.size)
    marks: list[tuple[int, int, int]] = []
    number, held = 1, (0, "")
    before = ""
    for block in ahead:
        start, lines = _samples(block, number, layout)
        last = next((index for index in range(len(lines) - 1, -1, -1) if lines[index].strip(_BLANK)), None)
        if last is not None:
            # The last line that holds anything waits: it may be cut short, as when a logger loses power.
            if held[0]:
                cells.add([held[1]], held[0])
            marks.append((cells.count, number, block.start))
            cells.add(lines[:last], start)
            before = next((line for line in reversed(lines[:last]) if line.strip(_BLANK)), held[1])
            held = (start + last, lines[last])
        number = start + len(lines)
    found, full = (len(split_cells(line, layout.delimiter)) for line in (held[1], before))
    cut = held[0] if cells.count and found < len(layout.names) <= full else 0
    if held[0] and not cut:
        cells.add([held[1]], held[0])
    return replace(text, marks=marks), cells, cut


def _table(text: _Text, ahead: Iterable[LineBlock], rate: Rate | None, candidates: Sequence[int]) -> SampleTable:
    layout = text.layout
    small = text.small
    read = range(len(layout.names)) if small else candidates
    text, cells, cut = _gone_through(text, ahead, read)
    notes = [f"line {line}, between names and samples, was ignored" for line in layout.passed]
    if cut:
        notes.append(f"line {cut}, the last, is cut short and was left out")
    clocks: dict[int, NDArray[np.float64]] = {}
    for column, (rows, seconds) in ((column, cells.clocks[column]) for column in candidates if column in cells.clocks):
        clocks[column] = np.full(cells.count, np.nan)
        clocks[column][np.frombuffer(rows, dtype=np.int64)] = np.frombuffer(seconds, dtype=np.float64)
    samples, lines = (np.frombuffer(run, dtype=np.int64) for run in cells.runs)

    def line(sample: int) -> int:
        run = int(np.searchsorted(samples, sample, side="right")) - 1
        return int(lines[run]) + sample - int(samples[run])

    units = (*layout.units, *("",) * (len(layout.names) - len(layout.units)))
    columns = Columns(
        names=layout.names,
        units=units,
        values={column: cells.values[read.index(column)] for column in candidates},
        clocks=clocks,
        wrong={column: problem for column in candidates if (problem := cells.wrong(column)) is not None},
        line=line,
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
        place=lambda sample: f"line {line(sample)}",
        notes=(*notes, *clock.notes),
    )
