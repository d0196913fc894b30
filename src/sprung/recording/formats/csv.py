"""Text tables of every dialect: whatever stands above, then names, perhaps units, then one line per sample."""

from __future__ import annotations

import codecs
from array import array
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import Problem
from sprung.recording.formats.clock import TIME_NAMES, TIME_UNITS, Columns, Rate, clock_of, rate_of, seconds_of_day
from sprung.recording.formats.dialect import COLUMNS, EMPTY, NUMBER, Layout, cells_of, layout_of, lines_of, text_of
from sprung.recording.formats.refusals import refuse
from sprung.recording.formats.table import Table, split_unit

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["TIME_NAMES", "TIME_UNITS", "CsvFormat"]

_BLANK = " \t,;|"


class CsvFormat:
    """Text tables: comma, semicolon, tab, pipe or spaces; decimal point or comma; UTF-8, UTF-16 or Windows letters."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim text by its ending; binary files hold null bytes, text does not, UTF-16 with its mark apart."""
        marked = head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        return path.suffix.lower() in {".csv", ".tsv", ".txt", ".dat", ".asc"} and (marked or b"\0" not in head)

    def read(self, path: Path) -> Table:
        """Read one file.

        Raises
        ------
        InputError
            If it holds no samples, no time column, or columns that the header does not name.
        """
        file = path.name
        try:
            text = text_of(path.read_bytes())
        except UnicodeDecodeError as error:
            do = "Export the recording again, as UTF-8."
            raise refuse(file, f"a file marked as UTF-16 that is none ({error.reason})", "text", do) from error
        end = _end(text)
        if not text[:end].strip():
            expected = "a line with the names of the columns, then the samples"
            raise refuse(file, "an empty file", expected, "Export it again.")
        layout = layout_of(text, end)
        rate = _rate(text, layout, file)
        _check(layout, rate, end, file)
        return _table(text, end, layout, rate, file)


@dataclass(slots=True)
class _Cells:
    """The cells of the samples: numbers row by row, and by column what is no number."""

    numbers: array[float] = field(default_factory=lambda: array("d"))
    lines: array[int] = field(default_factory=lambda: array("q"))
    text: dict[int, tuple[int, str, int]] = field(default_factory=dict)
    clocks: dict[int, tuple[array[int], array[float]]] = field(default_factory=dict)
    clock_cells: dict[int, tuple[int, str]] = field(default_factory=dict)


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
        return rate_of(lines, layout.decimal)
    except ValueError as error:
        where, _, found = str(error).partition("|")
        expected = "a number that can be read in one way"
        raise refuse(f"{file}: {where}", found, expected, "Write it without a thousands separator.") from None


def _check(layout: Layout, rate: Rate | None, end: int, file: str) -> None:
    """Refuse what is no table with names."""
    where = f"{file}: line {layout.header or layout.line}"
    if not layout.header:
        found, do = "numbers in the first line", "Add a line with the names of the columns above them."
        if layout.line > 1:
            found = "numbers without names above them"
        raise refuse(where, found, "the names of the columns", do)
    if any(not character.isprintable() for name in layout.names for character in name):
        found, do = "characters that nobody can read", "Export the recording as text; this file may be of another kind."
        raise refuse(where, found, "the names of the columns", do)
    if len(layout.names) < 2 and rate is None:
        expected = "the time and at least one channel, separated by comma, semicolon, tab, pipe or spaces"
        do = "Export it with separators, or add a line such as 'Sample rate: 500 Hz' above the names."
        raise refuse(where, f"a single column, '{_short(layout.names[0])}'", expected, do)
    if layout.start >= end:
        raise refuse(file, "a header and no samples", "one line per sample below the names", "Export it again.")


def _table(text: str, end: int, layout: Layout, rate: Rate | None, file: str) -> Table:
    notes = [f"line {line}, between names and samples, was passed over" for line in layout.passed]
    cut = _cut_short(text, layout, end)
    if cut is not None:
        notes.append(f"line {text.count(chr(10), 0, end) + 1}, the last, is cut short and was left out")
        end = cut
    cells = _read(text, end, layout, file)
    count, width = len(cells.lines), len(layout.names)
    values = np.frombuffer(cells.numbers, dtype=float).reshape(count, width).T
    lines = np.frombuffer(cells.lines, dtype=np.int64)
    used = [index for index, name in enumerate(layout.names) if name or not _is_empty(index, values, cells)]
    clocks: dict[int, np.ndarray] = {}
    for index, (rows, seconds) in cells.clocks.items():
        clocks[used.index(index)] = np.full(count, np.nan)
        clocks[used.index(index)][np.frombuffer(rows, dtype=np.int64)] = np.frombuffer(seconds, dtype=float)
    columns = Columns(
        names=tuple(layout.names[index] for index in used),
        units=tuple(layout.units[index] if index < len(layout.units) else "" for index in used),
        values=values[used] if len(used) < width else values,
        clocks=clocks,
        wrong={used.index(index): _problem(index, cells.text[index], layout, file) for index in cells.text},
        lines=lines,
    )
    clock = clock_of(columns, rate, file)
    channels = [index for index in range(len(used)) if index != clock.column]
    named = [split_unit(columns.names[index]) for index in channels]
    # As channels, columns of clock times are spoilt too.
    days = {
        used.index(index): _problem(index, (*cells.clock_cells[index], len(rows)), layout, file)
        for index, (rows, _) in cells.clocks.items()
    }
    spoilt = {**days, **columns.wrong}
    return Table(
        channels=tuple(name for name, _ in named),
        units=tuple(
            unit if unit is not None else columns.units[index] or None
            for (_, unit), index in zip(named, channels, strict=True)
        ),
        values=columns.values[channels],
        clock=clock.time,
        lines=lines,
        spoilt={name: spoilt[index] for (name, _), index in zip(named, channels, strict=True) if index in spoilt},
        notes=(*notes, *clock.notes),
    )


def _is_empty(index: int, values: np.ndarray, cells: _Cells) -> bool:
    return index not in cells.text and index not in cells.clocks and bool(np.isnan(values[index]).all())


def _cut_short(text: str, layout: Layout, end: int) -> int | None:
    """Say where the line before the last ends, if recording stopped within the last, as when a logger loses power."""
    last = text.rfind("\n", layout.start, end)
    before = text.rfind("\n", layout.start, last) if last > 0 else -1
    if last < 0 or before < 0:
        return None
    cells, full = (len(cells_of(line, layout.delimiter)) for line in (text[last + 1 : end], text[before + 1 : last]))
    return last if cells < len(layout.names) <= full else None


def _read(text: str, end: int, layout: Layout, file: str) -> _Cells:
    """Read the samples: a line of nothing but numbers at once, any other cell by cell."""
    cells, width, missing = _Cells(), len(layout.names), 0
    numbers, lines = cells.numbers, cells.lines
    separator = None if layout.delimiter == " " else layout.delimiter
    other, comma = (".", True) if layout.decimal == "," else ("_", False)
    for number, line in enumerate(lines_of(text, layout.start, end), layout.line):
        # float takes 1_000 and the digits of other alphabets as well; no logger means these.
        if line.isascii() and other not in line and "_" not in line:
            split = (line.replace(",", ".") if comma else line).split(separator)
            if len(split) == width:
                try:
                    numbers.extend(map(float, split))
                except ValueError:
                    del numbers[len(lines) * width :]
                else:
                    lines.append(number)
                    continue
        if line.count('"') % 2:
            do = "Look for a quotation mark that is not closed."
            raise refuse(f"{file}: line {number}", "a line that is no table", "one line per sample", do)
        row = cells_of(line, layout.delimiter) if line.count(layout.delimiter) <= COLUMNS else line.split(separator)
        if not any(row):
            continue
        _refuse_unnamed(row, layout, f"{file}: line {number}")
        missing += max(width - len(row), 0)
        if missing > len(text):
            found = f"{len(row)} cells, and few in many lines before"
            expected = f"{width}, as many as the header has names"
            raise refuse(f"{file}: line {number}", found, expected, "Export it again.")
        numbers.extend(_number(cell, index, number, layout.decimal, cells) for index, cell in enumerate(row[:width]))
        numbers.extend([np.nan] * (width - len(row)))
        lines.append(number)
    return cells


def _refuse_unnamed(row: list[str], layout: Layout, where: str) -> None:
    filled = max(index for index, cell in enumerate(row, 1) if cell)
    if filled > len(layout.names):
        do = f"Name every column in {'the first line' if layout.header == 1 else f'line {layout.header}'}."
        if layout.delimiter == ",":
            do += " If the commas are decimal marks, export with semicolons or tabs between the columns."
        expected = f"{len(layout.names)}, as many as the header has names"
        raise refuse(where, f"{filled} cells", expected, do)


def _number(cell: str, column: int, line: int, decimal: str, cells: _Cells) -> float:
    """Give the number in a cell, NaN where there is none; keep the first text of every column, and all clock times."""
    if cell.lower() in EMPTY:
        return float(cell) if cell.lower().endswith("inf") else np.nan
    if NUMBER.fullmatch(cell) and cell.isascii() and ("." if decimal == "," else ",") not in cell:
        return float(cell.replace(",", "."))
    seconds = seconds_of_day(cell) if ":" in cell else None
    if seconds is not None:
        rows, times = cells.clocks.setdefault(column, (array("q"), array("d")))
        rows.append(len(cells.lines))
        times.append(seconds)
        cells.clock_cells.setdefault(column, (line, cell))
    else:
        first, text, count = cells.text.get(column, (line, cell, 0))
        cells.text[column] = (first, text, count + 1)
    return np.nan


def _problem(column: int, text: tuple[int, str, int], layout: Layout, file: str) -> Problem:
    line, cell, count = text
    more = f" (the first of {count} such cells)" if count > 1 else ""
    do = "Correct or empty that cell, or export the recording again."
    if NUMBER.fullmatch(cell.replace(",", "").replace(".", "")):
        do = f"Export it without thousands separators, with '{layout.decimal}' as the only decimal mark."
    where = f"{file}: line {line}, column '{layout.names[column]}'"
    return Problem(where, f"'{_short(cell)}'{more}", "a number", do)


def _short(text: str) -> str:
    return text if len(text) <= 80 else f"{text[:77]}..."
