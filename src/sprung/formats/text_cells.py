"""The cells of some columns of a text table, as numbers."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from itertools import chain
from operator import itemgetter, methodcaller
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import Problem
from sprung.formats.reading_errors import input_error
from sprung.formats.text_clock import parse_clock_time
from sprung.formats.text_layout import COLUMNS, EMPTY, NUMBER, Layout, split_cells

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

_TOGETHER = 1000
"""Lines that are read together where they hold nothing but numbers."""

_WITH_POINT = methodcaller("replace", ",", ".")


@dataclass(slots=True)
class Cells:
    """What stands in some columns, read line by line.

    Attributes
    ----------
    file
        Name of the file, for messages.
    layout
        How it is written.
    columns
        Which, one or more.
    size
        Bytes of the file: with many more cells missing it is no table.
    first, last
        From which line with samples up to which, last excluded, to look for what is no number, and where to stop.
    numbers
        Of all columns, line by line; NaN where there is none.
    count
        How many lines held samples.
    missing
        How many cells lines had too few, all together.
    text
        By column, what is neither a number nor a clock time: the line and text of the first such cell, and how many.
    clock_cells
        By column, the same of clock times.
    clocks
        By column: which samples have a clock time, and which, in seconds since midnight.
    runs
        Samples with which runs of neighbouring lines begin, and the numbers of those lines.
    """

    file: str
    layout: Layout
    columns: Sequence[int]
    size: int
    first: int = 0
    last: int | None = None
    numbers: array[float] = field(default_factory=lambda: array("d"))
    count: int = 0
    missing: int = 0
    text: dict[int, tuple[int, str, int]] = field(default_factory=dict)
    clock_cells: dict[int, tuple[int, str, int]] = field(default_factory=dict)
    clocks: dict[int, tuple[array[int], array[float]]] = field(default_factory=dict)
    runs: tuple[array[int], array[int]] = field(default_factory=lambda: (array("q"), array("q")))
    _split: Callable[[str], list[str]] = field(init=False)
    _chosen: Callable[[list[str]], Sequence[str]] = field(init=False)

    def __post_init__(self) -> None:
        """Prepare what takes the cells of the columns out of a line."""
        separator = None if self.layout.delimiter == " " else self.layout.delimiter
        self._split = methodcaller("split", separator, max(self.columns) + 1 if separator else -1)
        [only, *others] = self.columns
        self._chosen = itemgetter(*self.columns) if others else itemgetter(slice(only, only + 1))

    @property
    def values(self) -> NDArray[np.float64]:
        """The numbers, shape (column, time); `add` must not be called while they are looked at."""
        return np.frombuffer(self.numbers, dtype=np.float64).reshape(self.count, len(self.columns)).T

    def line_of(self, sample: int) -> int:
        """Return the number of the line in which a sample stands."""
        samples, lines = (np.frombuffer(run, dtype=np.int64) for run in self.runs)
        run = int(np.searchsorted(samples, sample, side="right")) - 1
        return int(lines[run]) + sample - int(samples[run])

    def samples_before(self, line: int) -> int:
        """Return how many samples stand above a line of some number."""
        samples, lines = (np.frombuffer(run, dtype=np.int64) for run in self.runs)
        run = int(np.searchsorted(lines, line)) - 1
        if run < 0:
            return 0
        end = self.count if run + 1 == len(samples) else int(samples[run + 1])
        return min(int(samples[run]) + line - int(lines[run]), end)

    def add(self, lines: Sequence[str], number: int) -> None:
        """Read lines, the first of them of some number: one of nothing but numbers at once, any other cell by cell.

        Raises
        ------
        InputError
            If one has more cells than there are names, or a quotation mark that is not closed.
        """
        for begin in range(0, len(lines), _TOGETHER):
            some = lines[begin : begin + _TOGETHER]
            if self._add_together(some, number + begin):
                continue
            for here, line in enumerate(some, number + begin):
                if self.count == self.last:
                    return
                if self._add_at_once(line) or self._add_slowly(line, here):
                    self._counted(1, here)

    def _counted(self, count: int, line: int) -> None:
        """Count samples that stand in neighbouring lines from one on."""
        samples, lines = self.runs
        if not lines or line - lines[-1] != self.count - samples[-1]:
            samples.append(self.count)
            lines.append(line)
        self.count += count

    def _add_together(self, lines: Sequence[str], number: int) -> bool:
        """Read lines that hold nothing but numbers where it matters, and as many cells as there are names."""
        together = "\n".join(lines)
        if not self._is_plain(together) or '"' in together or (self.last or np.inf) < self.count + len(lines):
            return False
        delimiter, width = self.layout.delimiter, len(self.layout.names)
        cells = [line.split() for line in lines] if delimiter == " " else map(self._split, lines)
        counts = map(len, cells) if delimiter == " " else map(methodcaller("count", delimiter), lines)
        if set(counts) != {width if delimiter == " " else width - 1}:
            return False
        numbers = chain.from_iterable(map(self._chosen, cells))
        try:
            self.numbers.extend(map(float, map(_WITH_POINT, numbers) if self.layout.decimal == "," else numbers))
        except ValueError:
            del self.numbers[self.count * len(self.columns) :]
            return False
        self._counted(len(lines), number)
        return True

    def _add_at_once(self, line: str) -> bool:
        """Read a line of as many cells as there are names if those that matter are nothing but numbers."""
        if '"' in line:
            return False
        cells = self._split(line)
        if (len(cells) if self.layout.delimiter == " " else line.count(self.layout.delimiter) + 1) != len(
            self.layout.names
        ):
            return False
        own = self._chosen(cells)
        if not self._is_plain("".join(own)):
            return False
        try:
            self.numbers.extend(map(float, map(_WITH_POINT, own) if self.layout.decimal == "," else own))
        except ValueError:
            del self.numbers[self.count * len(self.columns) :]
            return False
        return True

    def _is_plain(self, text: str) -> bool:
        """Return whether a text has only numbers as loggers write them: Python also reads 1_000, and digits beyond ASCII."""
        return text.isascii() and "_" not in text and (self.layout.decimal != "," or "." not in text)

    def _add_slowly(self, line: str, number: int) -> bool:
        """Read a line cell by cell; say whether it held any."""
        where, layout = f"{self.file}: line {number}", self.layout
        if line.count('"') % 2:
            do = "Look for a quotation mark that is not closed."
            raise input_error(where, "a line that is not part of a table", "one line per sample", do)
        separator = None if layout.delimiter == " " else layout.delimiter
        row = split_cells(line, layout.delimiter) if line.count(layout.delimiter) <= COLUMNS else line.split(separator)
        if not any(row):
            return False
        _refuse_unnamed(row, layout, where)
        width = len(layout.names)
        self.missing += max(width - len(row), 0)
        if self.missing > self.size:
            found = f"{len(row)} cells, and few in many lines before"
            raise input_error(where, found, f"{width}, as many as the header has names", "Export it again.")
        row += [""] * (max(self.columns) + 1 - len(row))
        self.numbers.extend([self._number(row[column], column, number) for column in self.columns])
        return True

    def _number(self, cell: str, column: int, line: int) -> float:
        """Return the number in a cell; NaN where there is none, and the text is kept."""
        if cell.lower() in EMPTY:
            return float(cell) if cell.lower().endswith("inf") else np.nan
        other = "." if self.layout.decimal == "," else ","
        if NUMBER.fullmatch(cell) and cell.isascii() and other not in cell:
            return float(cell.replace(",", "."))
        if self.count < self.first:
            return np.nan
        seconds = parse_clock_time(cell) if ":" in cell else None
        kept = self.text if seconds is None else self.clock_cells
        if seconds is not None:
            rows, times = self.clocks.setdefault(column, (array("q"), array("d")))
            rows.append(self.count)
            times.append(seconds)
        first, text, count = kept.get(column, (line, cell, 0))
        kept[column] = (first, text, count + 1)
        return np.nan

    def wrong(self, column: int) -> Problem | None:
        """Return a problem for text in a column that is neither a number nor a clock time; None where there is none."""
        return _problem(column, self.text[column], self.layout, self.file) if column in self.text else None

    def find_non_number(self, column: int) -> Problem | None:
        """Return a problem for text in a column that is not a number; None where there is none."""
        kept = self.text.get(column) or self.clock_cells.get(column)
        return _problem(column, kept, self.layout, self.file) if kept else None


def _refuse_unnamed(row: list[str], layout: Layout, where: str) -> None:
    filled = max(index for index, cell in enumerate(row, 1) if cell)
    if filled > len(layout.names):
        do = f"Name every column in {'the first line' if layout.header == 1 else f'line {layout.header}'}."
        if layout.delimiter == ",":
            do += " If the commas are decimal marks, export with semicolons or tabs between the columns."
        expected = f"{len(layout.names)}, as many as the header has names"
        raise input_error(where, f"{filled} cells", expected, do)


def _problem(column: int, text: tuple[int, str, int], layout: Layout, file: str) -> Problem:
    line, cell, count = text
    more = f" (the first of {count} such cells)" if count > 1 else ""
    do = "Correct or empty that cell, or export the recording again."
    if NUMBER.fullmatch(cell.replace(",", "").replace(".", "")):
        do = f"Export it without thousands separators, with '{layout.decimal}' as the only decimal mark."
    where = f"{file}: line {line}, column '{layout.names[column]}'"
    return Problem(where, f"'{cell if len(cell) <= 80 else f'{cell[:77]}...'}'{more}", "a number", do)
