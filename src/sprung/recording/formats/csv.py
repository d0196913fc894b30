"""Text tables: one header line with the names of the columns, then one line per sample."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem, Problems, did_you_mean
from sprung.recording.formats.table import Table, split_unit

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

TIME_NAMES = frozenset(("t", "time", "zeit", "temps", "tiempo", "tempo", "tijd", "tid", "timestamp", "seconds"))
TIME_UNITS = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9}
_DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma"}
_WITH_UNIT = re.compile(r"(.*?)\s*[\[(](.*)[\])]")


@dataclass(frozen=True, slots=True)
class Dialect:
    """How one file is written.

    Attributes
    ----------
    delimiter
        What separates columns.
    decimal
        The decimal mark.
    header
        Index of the line that holds the names.
    names
        The names, units and all.
    """

    delimiter: str
    decimal: str
    header: int
    names: tuple[str, ...]


class CsvFormat:
    """Text tables separated by comma, semicolon or tab, with decimal point or comma, in UTF-8 or Latin-1."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim text by its ending; binary files hold null bytes, text does not."""
        return path.suffix.lower() in {".csv", ".tsv", ".txt"} and b"\0" not in head

    def read(self, path: Path) -> Table:
        """Read one file.

        Raises
        ------
        InputError
            If it holds no samples, no time column, or columns that the header does not name.
        """
        lines = _text(path.read_bytes()).split("\n")
        while lines and not lines[-1].strip(" \t,;"):
            lines.pop()
        try:
            return _table(lines, _dialect(lines, path.name), path.name)
        except csv.Error as error:
            do = "Open it in a text editor: it should show one line per sample."
            raise _refuse(path.name, f"lines that are no table ({error})", "one line per sample", do) from error


def _text(content: bytes) -> str:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # every byte is a character of it, and loggers of that age write it
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _cells(line: str, delimiter: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]


def _dialect(lines: list[str], file: str) -> Dialect:
    filled = [index for index, line in enumerate(lines) if line.strip()]
    if not filled:
        raise _refuse(
            file, "an empty file", "a line with the names of the columns, then the samples", "Export it again."
        )
    header, first = filled[0], lines[filled[1]] if len(filled) > 1 else ""
    widths = {d: (len(_cells(lines[header], d)), len(_cells(first, d))) for d in _DELIMITERS}
    # The names tell the delimiter; where a name holds another one, the first sample decides.
    delimiter = max(widths, key=lambda d: (widths[d][0] > 1, widths[d][0] == widths[d][1], widths[d][0]))
    names = _cells(lines[header], delimiter)
    if any(not character.isprintable() for name in names for character in name):
        found, do = "characters that nobody can read", "Export the recording as text; this file may be of another kind."
        raise _refuse(f"{file}: line {header + 1}", found, "the names of the columns", do)
    if len(names) < 2:
        expected = "the time and at least one channel, separated by comma, semicolon or tab"
        raise _refuse(
            f"{file}: line {header + 1}", f"a single column, '{names[0]}'", expected, "Export it with separators."
        )
    if all(_is_number(name) for name in names):
        found, do = "numbers in the first line", "Add a line with the names of the columns above them."
        raise _refuse(f"{file}: line {header + 1}", found, "the names of the columns", do)
    if len(filled) == 1:
        raise _refuse(file, "a header and no samples", "one line per sample below the names", "Export it again.")
    return Dialect(delimiter, _decimal(lines[header + 1 :], delimiter), header, tuple(names))


def _decimal(lines: list[str], delimiter: str) -> str:
    quote = '"' if delimiter == "," else '"?'
    number = rf"(?:^|{delimiter})\s*{quote}[+-]?\d*,\d+(?:[eE][+-]?\d+)?{quote}\s*(?:{delimiter}|$)"
    return "," if re.search(number, "\n".join(lines), re.MULTILINE) else "."


def _is_number(text: str) -> bool:
    return re.fullmatch(r"[+-]?[\d.,]*\d[\d.,]*(?:[eE][+-]?\d+)?", text) is not None


def _table(lines: list[str], dialect: Dialect, file: str) -> Table:
    import pandas as pd  # noqa: PLC0415 (heavy, and needed only once a text table is met)

    body = lines[dialect.header + 1 :]
    notes: tuple[str, ...] = ()
    if _cut_short(body, dialect):
        notes = (f"line {len(lines)}, the last, is cut short and was left out",)
        body = body[:-1]
    width = 1 + max(line.count(dialect.delimiter) for line in [lines[dialect.header], *body])
    try:
        frame = pd.read_csv(
            io.StringIO("\n".join(body)),
            sep=dialect.delimiter,
            decimal=dialect.decimal,
            header=None,
            names=list(range(width)),
            index_col=False,
            skip_blank_lines=False,
            skipinitialspace=True,
            low_memory=False,
        )
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        do = "Look for a quotation mark that is not closed."
        raise _refuse(file, f"lines that are no table ({error})", "one line per sample", do) from error
    frame.index = pd.RangeIndex(dialect.header + 2, dialect.header + 2 + len(frame))  # the lines of the file
    frame = frame.dropna(how="all")
    _refuse_unnamed(frame, dialect, file)

    spoilt: dict[int, Problem] = {}
    columns = np.empty((len(dialect.names), len(frame)))
    for index, name in enumerate(dialect.names):
        columns[index], problem = _numbers(frame[index], dialect, f"{file}: column '{name}'")
        if problem is not None:
            spoilt[index] = problem
    time, factor = _time_column(dialect.names, columns, file)
    if time in spoilt:
        raise InputError([spoilt[time]])
    if np.isnan(columns[time]).any():
        line = frame.index[int(np.isnan(columns[time]).argmax())]
        found = f"no time beside the samples of line {line}"
        raise _refuse(
            f"{file}: line {line}, column '{dialect.names[time]}'", found, "the time in every line", "Fill it in."
        )
    channels = [index for index in range(len(dialect.names)) if index != time]
    named = {index: split_unit(dialect.names[index]) for index in channels}
    return Table(
        channels=tuple(named[index][0] for index in channels),
        units=tuple(named[index][1] for index in channels),
        values=columns[channels],
        clock=factor * columns[time],
        lines=frame.index.to_numpy(dtype=np.int64),
        spoilt={named[index][0]: problem for index, problem in spoilt.items()},
        notes=notes,
    )


def _cut_short(body: list[str], dialect: Dialect) -> bool:
    """Say whether recording stopped within the last line, as it does when a logger loses its power."""
    if len(body) < 3:
        return False
    last, before = (len(_cells(line, dialect.delimiter)) for line in (body[-1], body[-2]))
    return last < len(dialect.names) <= before


def _refuse_unnamed(frame: pd.DataFrame, dialect: Dialect, file: str) -> None:
    filled = frame.notna().to_numpy()
    unnamed = filled[:, len(dialect.names) :].any(axis=1)
    if unnamed.any():
        row = int(unnamed.argmax())
        do = "Name every column in the first line."
        if dialect.delimiter == ",":
            do += " If the commas are decimal marks, export with semicolons or tabs between the columns."
        found = f"{np.flatnonzero(filled[row])[-1] + 1} cells"
        expected = f"{len(dialect.names)}, as many as the header has names"
        raise _refuse(f"{file}: line {frame.index[row]}", found, expected, do)


def _numbers(column: pd.Series, dialect: Dialect, where: str) -> tuple[np.ndarray, Problem | None]:
    """Give a column's numbers, NaN for empty cells and text, and a problem if there is text."""
    import pandas as pd  # noqa: PLC0415 (see above)

    if column.dtype.kind in "fiu":
        return column.to_numpy(dtype=float), None
    text = column.astype(str).str.strip()
    numbers = pd.to_numeric(text.str.replace(dialect.decimal, ".", regex=False), errors="coerce")
    wrong = (numbers.isna() & column.notna() & (text != "")).to_numpy(dtype=bool)
    if not wrong.any():
        return numbers.to_numpy(dtype=float), None
    row = int(wrong.argmax())
    more = f" (the first of {wrong.sum()} such cells)" if wrong.sum() > 1 else ""
    file, name = where.split(": ", 1)
    do = "Correct or empty that cell, or export the recording again."
    problem = Problem(f"{file}: line {column.index[row]}, {name}", f"'{text.iloc[row]}'{more}", "a number", do)
    return numbers.to_numpy(dtype=float), problem


def _time_column(names: tuple[str, ...], columns: np.ndarray, file: str) -> tuple[int, float]:
    """Find the time column and the factor that makes it seconds."""
    matches = [_WITH_UNIT.fullmatch(name) for name in names]
    units = [match[2].strip().lower() if match else "s" for match in matches]
    for index, (name, match, unit) in enumerate(zip(names, matches, units, strict=True)):
        if (match[1] if match else name).lower() in TIME_NAMES:
            if unit not in TIME_UNITS:
                do = did_you_mean(unit, TIME_UNITS)
                raise _refuse(f"{file}: column '{name}'", f"'{unit}'", "a unit of time", do)
            return index, TIME_UNITS[unit]
    if bool((np.diff(columns[0]) > 0).all()) and units[0] in TIME_UNITS:
        return 0, TIME_UNITS[units[0]]
    found = f"no column named time among {', '.join(repr(name) for name in names)}"
    expected = "a column named time, in s, or a first column that increases from line to line"
    raise _refuse(file, found, expected, "Name the time column 'time'.")


def _refuse(where: str, found: str, expected: str, do: str) -> InputError:
    problems = Problems()
    problems.add(where, found, expected, do)
    return InputError(problems)
