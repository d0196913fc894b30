"""How a text table is written, recognised from the text itself: its columns, its names and units, where it begins.

The table begins where the lines become regular: the run of lines of equally many cells that holds most numbers. The
delimiter is the one with which such a run is found, and the names stand in the nearest line of words above it.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sprung.formats.stated_rates import TIME_UNITS
from sprung.formats.text_clock import CLOCK, is_time_name
from sprung.units import quantity_of_unit

if TYPE_CHECKING:
    from collections.abc import Iterator

DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "pipe", " ": "space"}
"""What may separate columns; a space stands for any run of spaces and tabs."""

COLUMNS = 10_000
"""More columns than this no logger has: such a line is something else, and not worth its memory."""

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*|,\d+)?|[.,]\d+)(?:[eE][+-]?\d+)?")
EMPTY = frozenset(("", "nan", "-nan", "na", "n/a", "<na>", "#n/a", "null", "none", "inf", "-inf", "+inf"))
"""Cells that stand for a number that is not there, in small letters."""

_COMMENT = re.compile(r"\s*(?:#(?!n/a)+|%+|//+)[ \t]*", re.IGNORECASE)
_DIGIT = re.compile(r"\d")
_ENOUGH = 200.0  # lines of nothing but numbers that no preamble has
_ROWS_ABOVE = 4  # names, units, and what else stands between them and the samples


@dataclass(frozen=True, slots=True)
class Layout:
    """How one file is written.

    Attributes
    ----------
    delimiter
        One of `DELIMITERS`.
    decimal
        The decimal mark.
    header
        Line that holds the names, from 1; 0 where no line does.
    names
        The names, units and all.
    units
        By name, what a row of units says; empty text where it says nothing.
    width
        Cells in most lines of samples.
    start
        Where in the text the samples begin.
    line
        Line in which they begin, from 1.
    passed
        Lines between names and samples that were taken for neither.
    """

    delimiter: str
    decimal: str
    header: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    width: int
    start: int
    line: int
    passed: tuple[int, ...] = ()


@dataclass(slots=True)
class _Run:
    """Lines of equally many cells, some of them numbers, that follow one another; weight counts lines of only those."""

    start: int = 0
    width: int = 0
    lines: int = 0
    weight: float = 0.0


def iterate_lines(text: str, start: int, end: int) -> Iterator[str]:
    """Yield the lines of a part of a text."""
    while start <= end:
        stop = text.find("\n", min(start + 65536, end), end)
        stop = end if stop < 0 else stop
        yield from text[start:stop].split("\n")
        start = stop + 1


def split_cells(line: str, delimiter: str) -> list[str]:
    """Split a line into its cells, without blanks and quotation marks around them."""
    if delimiter == " ":
        line = " ".join(line.split())
    if '"' in line:
        try:
            line = line.strip(" ")
            return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]
        except csv.Error:
            pass  # a cell that is longer than any
    return [cell.strip() for cell in line.split(delimiter)]


def detect_layout(text: str, end: int) -> Layout:
    """Recognise how a text is written.

    Parameters
    ----------
    text
        With at least one line that is not blank.
    end
        Where its last line ends.

    Returns
    -------
    Layout
        With header 0 where there are numbers and no names above them. Where no line holds a number, the first line is
        taken for the names.
    """
    runs = _runs(text, end)
    heaviest = max(run.weight for run in runs.values())
    found = [
        _below_names(text, run, delimiter)
        for delimiter, run in runs.items()
        if run.weight > 0 and run.weight >= heaviest / 2
    ]
    if not found:
        return _without_numbers(text, end)
    weight = {delimiter: run.weight for delimiter, run in runs.items()}
    return max(found, key=lambda it: (len(it.names) == it.width, round(weight[it.delimiter]), it.width))


def _runs(text: str, end: int) -> dict[str, _Run]:
    best = {delimiter: _Run() for delimiter in DELIMITERS}
    current = {delimiter: _Run() for delimiter in DELIMITERS}
    start = 0
    for line in iterate_lines(text, 0, end):
        here, start = start, start + len(line) + 1
        if not line or line.isspace():
            continue
        if _DIGIT.search(line) is None:
            current = {delimiter: _Run() for delimiter in DELIMITERS}
            continue
        for delimiter in DELIMITERS:
            width, share = _numbers(line, delimiter)
            if not share or width != current[delimiter].width:
                current[delimiter] = _Run(here, width if share else 0)
            run = current[delimiter]
            run.lines += bool(share)
            run.weight += share**2  # square: half a line of words is more of a sign than half a line of numbers
            if run.weight > best[delimiter].weight:
                best[delimiter] = run
        if any(run.weight >= _ENOUGH or run.lines >= 10 * _ENOUGH for run in best.values()):
            break
    return best


def _numbers(line: str, delimiter: str) -> tuple[int, float]:
    """Return the number of cells, and the fraction of numbers and clock times among those that are not empty."""
    if _COMMENT.match(line) or line.count(delimiter) >= COLUMNS:
        return 0, 0.0
    cells = split_cells(line, delimiter)
    filled = [cell for cell in cells if cell.lower() not in EMPTY]
    if any(not cell[:1].isdigit() and is_time_name(cell) for cell in filled):
        return len(cells), 0.0  # names, of channels that are called 1, 2, 3
    numbers = sum(1 for cell in filled if NUMBER.fullmatch(cell) or CLOCK.fullmatch(cell))
    return len(cells), numbers / len(filled) if filled else 0.0


def _above(text: str, start: int) -> Iterator[tuple[int, str]]:
    """Yield the lines above a place and where they begin, nearest first."""
    while start > 0:
        stop = start - 1
        start = text.rfind("\n", 0, stop) + 1
        yield start, text[start:stop]


def _below_names(text: str, run: _Run, delimiter: str) -> Layout:
    """Find the rows of words above a run; lines with numbers in between, even with other things in them, are samples."""
    start = run.start
    rows: list[tuple[int, tuple[str, ...]]] = []
    for here, line in _above(text, run.start):
        plain = _COMMENT.sub("", line, count=1) if _COMMENT.match(line) else line
        if plain.count(delimiter) >= COLUMNS:
            break
        names = _names(plain, delimiter, run.width)
        if len(names) < min(2, run.width) or not any(names):
            if rows:
                break
            continue  # a blank line, or a sentence
        if _numbers(plain, delimiter)[1]:
            if rows:
                break
            start = here if plain is line else start
            continue
        rows.append((here, names))
        if len(rows) == _ROWS_ABOVE:
            break
    return _layout(text, run, delimiter, start, rows)


def _layout(text: str, run: _Run, delimiter: str, start: int, rows: list[tuple[int, tuple[str, ...]]]) -> Layout:
    head = 0
    while (
        head + 1 < len(rows)
        and len(rows[head][1]) == len(rows[head + 1][1])
        and (not rows[head][1][0] or _are_units(rows[head][1]))
    ):
        head += 1
    names = rows[head][1] if rows else ()
    between = rows[:head]
    units = next((row for row in between if _are_units(row[1])), (0, ("",) * len(names)))
    return Layout(
        delimiter=delimiter,
        decimal=_decimal(text, start, delimiter),
        header=_line(text, rows[head][0]) if rows else 0,
        names=names,
        units=tuple(unit.strip("[]() ") for unit in units[1]),
        width=run.width,
        start=start,
        line=_line(text, start),
        passed=tuple(_line(text, here) for here, row in between if row is not units[1]),
    )


def _without_numbers(text: str, end: int) -> Layout:
    here, lines = 0, []
    for line in iterate_lines(text, 0, end):
        if line.strip():
            lines.append((here, line))
        here += len(line) + 1
        if len(lines) == 2:
            break
    first, below = lines[0][1], lines[-1][1]
    widths = {d: (len(split_cells(first, d)), len(split_cells(below, d))) for d in list(DELIMITERS)[:-1]}
    delimiter = max(widths, key=lambda d: (widths[d][0] > 1, widths[d][0] == widths[d][1], widths[d][0]))
    run = _Run(lines[1][0] if len(lines) > 1 else end, widths[delimiter][0])
    names = _names(first, delimiter, run.width)
    return _layout(text, run, delimiter, run.start, [(lines[0][0], names)])


def _names(line: str, delimiter: str, width: int) -> tuple[str, ...]:
    """Return the cells of a header line; in a table separated by spaces, a unit in brackets belongs to the name before it."""
    names = split_cells(line, delimiter)
    if delimiter == " " and len(names) != width:
        joined: list[str] = []
        for name in names:
            if joined and name[:1] in ("[", "("):
                joined[-1] += f" {name}"
            else:
                joined.append(name)
        apart = re.split(r"[ \t]{2,}", line.strip())
        names = apart if len(apart) == width else joined
    while len(names) > 1 and not names[-1]:
        names.pop()
    return tuple(names)


def _are_units(cells: tuple[str, ...]) -> bool:
    """Return whether a row holds units: one of time or of what sensors measure, or text in brackets, and no name of time."""
    return not any(is_time_name(cell) for cell in cells) and any(_is_unit(cell) for cell in cells)


def _is_unit(cell: str) -> bool:
    bracketed = cell[:1] in ("[", "(") and cell[-1:] in ("]", ")")
    return cell.lower() in TIME_UNITS or bracketed or quantity_of_unit(cell) is not None


def _decimal(text: str, start: int, delimiter: str) -> str:
    """Return the decimal mark: that of the majority of the first numbers, otherwise the comma where any number has one."""
    between = r"[ \t\n]" if delimiter == " " else rf"[{delimiter}\n]"
    quote = '"' if delimiter == "," else '"?'  # between commas, a comma is a decimal mark only within quotation marks
    ends = rf"[ ]{{0,40}}(?={between}|\Z)"
    comma = re.compile(rf"(?:{between}|\A|^)[ ]{{0,40}}{quote}[+-]?\d*,\d+(?:[eE][+-]?\d+)?{quote}{ends}", re.MULTILINE)
    point = re.compile(rf"(?:{between}|\A|^)[ ]{{0,40}}\"?[+-]?\d*\.\d+(?:[eE][+-]?\d+)?\"?{ends}", re.MULTILINE)
    window = start + 65536
    commas, points = (sum(1 for _ in mark.finditer(text, start, window)) for mark in (comma, point))
    if commas == points == 0:
        return "," if comma.search(text, start) else "."
    return "," if commas > points else "."


def _line(text: str, here: int) -> int:
    return text.count("\n", 0, here) + 1
