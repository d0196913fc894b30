"""Arrangement of a table in a given width: side by side, in blocks, or row by row; every cell is shown whole.

One line per row if the width allows it. Otherwise the columns of text are wrapped between words, or the columns are divided
into blocks, each of which repeats the columns that name the rows, or every row becomes a list of its cells. The arrangement
with the fewest lines is chosen; a continuation line counts twice, because it makes a row harder to read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from rich.cells import cell_len

from sprung.tables import Table

GAP = 2
"""Spaces between two columns."""

_READABLE = 16
"""Smallest width of a wrapped column of text."""


@dataclass(frozen=True)
class Line:
    """A line of an arranged table.

    Attributes
    ----------
    text
        Without trailing spaces.
    style
        ``dim`` for column headings, ``bold`` for the name of a row whose cells follow.
    continues
        Whether it continues the cells of the previous line.
    """

    text: str
    style: str = ""
    continues: bool = False


def arrange(table: Table, width: int) -> list[Line]:
    """Return the lines of a table, arranged for a width.

    Parameters
    ----------
    table
        Any; its title is not included.
    width
        In columns of a terminal. A longer word is not broken: its line is longer too.

    Returns
    -------
    list of Line
    """
    columns = [_Column.of(table, i) for i in range(len(table.headers))]
    natural = [column.natural for column in columns]
    if _sum(natural) <= width:
        return list(_grid(columns, natural))
    arrangements = (_wrapped(columns, width), _blocks(table, columns, width), _listed(columns, width))
    return min((lines for lines in arrangements if lines is not None), key=_cost)


@dataclass(frozen=True)
class _Column:
    """A column: header, cells, smallest and natural width."""

    header: str
    cells: tuple[str, ...]
    number: bool
    least: int
    natural: int

    @classmethod
    def of(cls, table: Table, i: int) -> _Column:
        """Return a column of a table. Text and headers may be wrapped, numbers not."""
        header, cells = table.headers[i].strip(), tuple(row[i] for row in table.rows)
        number = table.headers[i] in table.numbers
        natural = max(map(cell_len, (header, *cells)))
        whole = cells if number else [word for cell in cells for word in cell.split()]
        least = max(map(cell_len, (*header.split(), *whole)), default=0)
        return cls(header, cells, number, least if number else max(least, min(natural, _READABLE)), natural)

    def of_rows(self, rows: Sequence[int]) -> _Column:
        """Return the column with some of its cells only, in the same width."""
        return replace(self, cells=tuple(self.cells[row] for row in rows))

    def aligned(self, text: str, width: int) -> str:
        """Return a text flush left, a number flush right."""
        blanks = " " * (width - cell_len(text))
        return blanks + text if self.number else text + blanks


def _cost(lines: Sequence[Line]) -> int:
    return len(lines) + sum(line.continues for line in lines)


def _sum(widths: Sequence[int]) -> int:
    return sum(widths) + GAP * (len(widths) - 1)


def _wrapped(columns: Sequence[_Column], width: int) -> list[Line] | None:
    """Return all columns side by side, with wrapped text; None where the width does not allow it."""
    widths = _shrunk(columns, width)
    return None if widths is None else list(_grid(columns, widths))


def _shrunk(columns: Sequence[_Column], width: int) -> list[int] | None:
    """Return widths, reduced from the widest column on until all fit; None where they cannot."""
    widths = [column.natural for column in columns]
    while _sum(widths) > width:
        shrinkable = [i for i, column in enumerate(columns) if widths[i] > column.least]
        if not shrinkable:
            return None
        widths[max(shrinkable, key=lambda i: widths[i])] -= 1
    return widths


def _blocks(table: Table, columns: Sequence[_Column], width: int) -> list[Line] | None:
    """Return the columns in blocks; None where one column does not fit beside the names of the rows."""
    heads, remaining = list(columns[: table.heads]), list(range(table.heads, len(columns)))
    names = _shrunk(heads, width - GAP - max((columns[i].least for i in remaining), default=0))
    if names is None:
        return None
    room = width - _sum(names) - GAP
    widths = {i: min(columns[i].natural, max(columns[i].least, room)) for i in remaining}
    spare = [table.headers.index(header) for header in table.spare]
    lines: list[Line] = []
    while remaining:
        block = list(remaining)
        while _sum([widths[i] for i in block]) > room:
            movable = [i for i in spare if i in block]
            block.remove(movable[0] if movable and len(block) > 1 else block[-1])
        if lines and len(remaining) - len(block) == 1 and len(block) > 2:
            del block[-1]  # so that the last column does not stand alone
        remaining = [i for i in remaining if i not in block]
        cells = [columns[i] for i in block]
        # Of further blocks only the rows that have anything there; the first one names every row.
        rows = [k for k in range(len(table.rows)) if not lines or any(column.cells[k].strip() for column in cells)]
        lines += [Line("")] if lines else []
        lines += _grid([column.of_rows(rows) for column in (*heads, *cells)], [*names, *(widths[i] for i in block)])
    return lines


def _listed(columns: Sequence[_Column], width: int) -> list[Line]:
    """Return every row as a list of its cells, each after its header; "-" for an empty one."""
    name, *others = columns
    lines = [Line(line, "dim") for line in wrap(name.header, width) if line]
    for i, cell in enumerate(name.cells):
        lines += [Line(line, "bold") for line in wrap(cell, width) if line]
        for column in others:
            text = f"{column.header}: {column.cells[i] or '-'}".removeprefix(": ")
            lines += [Line(f"  {line}") for line in wrap(text, width - 2, indent=2)]
    return lines


def _grid(columns: Sequence[_Column], widths: Sequence[int]) -> Iterator[Line]:
    for i in range(-1, len(columns[0].cells)):
        cells = [column.header if i < 0 else column.cells[i] for column in columns]
        pieces = [wrap(cell, width) for cell, width in zip(cells, widths, strict=True)]
        for k in range(max(map(len, pieces))):
            texts = [piece[k] if k < len(piece) else "" for piece in pieces]
            aligned = [column.aligned(text, width) for column, text, width in zip(columns, texts, widths, strict=True)]
            yield Line((" " * GAP).join(aligned).rstrip(), "dim" if i < 0 else "", k > 0)


def wrap(text: str, width: int, indent: int = 0) -> list[str]:
    """Return the lines of a text, wrapped between words; a word longer than the width is not broken.

    Parameters
    ----------
    text
        Any.
    width
        In columns of a terminal.
    indent
        Spaces before every line but the first.

    Returns
    -------
    list of str
        One line or more.

    Examples
    --------
    >>> wrap("left out of three drops", 11)
    ['left out of', 'three drops']
    """
    ends = [0, *line_breaks(text, width, indent), len(text)]
    lines = [text[start:end].rstrip() for start, end in pairwise(ends)]
    return [lines[0], *(" " * indent + line for line in lines[1:])]


def line_breaks(text: str, width: int, indent: int = 0) -> list[int]:
    """Return where to break a text so that its lines fit; never within a word.

    Parameters
    ----------
    text
        One line.
    width
        In columns of a terminal.
    indent
        Spaces before every line but the first.

    Returns
    -------
    list of int
        Index at which each line but the first begins.
    """
    starts: list[int] = []
    begin = 0
    for word in re.finditer(r"\S+", text):
        if cell_len(text[begin : word.end()]) + (indent if begin else 0) > width and text[begin : word.start()].strip():
            begin = word.start()
            starts.append(begin)
    return starts
