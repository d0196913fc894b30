"""The arrangement of a table in a given width: side by side, in blocks below each other, or row by row; nothing is left out.

Three arrangements show every cell. In one line per row if the width allows it. Otherwise the columns of text wrap between
words, or the columns are divided into blocks, each of which repeats the columns that name its rows. Where even one column
does not fit beside the names, every row becomes a list of its cells. The one with the fewest lines is taken; a line that
continues another counts twice, for it makes a row harder to follow.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rich.cells import cell_len

from sprung.tables import Table

GAP = 2
"""Blanks between two columns."""

_READABLE = 16
"""Width below which a column of text does not wrap: a word on every line cannot be read."""


@dataclass(frozen=True)
class Line:
    """A line of an arranged table.

    Attributes
    ----------
    text
        Without trailing blanks.
    style
        How it is shown: dim where it names columns, bold where it names the row whose cells follow.
    continues
        Whether it continues the cells of the line before.
    """

    text: str
    style: str = ""
    continues: bool = False


def arrange(table: Table, width: int) -> list[Line]:
    """Arrange a table so that every cell is shown whole.

    Parameters
    ----------
    table
        The table, without its title.
    width
        Of the place, in columns of a terminal. A word that is longer than this is not broken: its line is longer too.

    Returns
    -------
    list of Line
    """
    columns = [_Column.of(table, i) for i in range(len(table.headers))]
    natural = [column.natural for column in columns]
    if _sum(natural) <= width:
        return list(_grid(columns, natural))
    found = (_wrapped(columns, width), _blocks(table, columns, width), _listed(columns, width))
    return min((lines for lines in found if lines is not None), key=_cost)


@dataclass(frozen=True)
class _Column:
    """A column: its header and cells, and the least and the natural width of them."""

    header: str
    cells: tuple[str, ...]
    number: bool
    least: int
    natural: int

    @classmethod
    def of(cls, table: Table, i: int) -> _Column:
        """Take a column from a table. A number is not divided, text is, and so is a header."""
        header, cells = table.headers[i].strip(), tuple(row[i] for row in table.rows)
        number = table.headers[i] in table.numbers
        natural = max(map(cell_len, (header, *cells)))
        whole = cells if number else [word for cell in cells for word in cell.split()]
        least = max(map(cell_len, (*header.split(), *whole)), default=0)
        return cls(header, cells, number, least if number else max(least, min(natural, _READABLE)), natural)

    def aligned(self, text: str, width: int) -> str:
        """Set a text flush left, a number flush right."""
        blanks = " " * (width - cell_len(text))
        return blanks + text if self.number else text + blanks


def _cost(lines: Sequence[Line]) -> int:
    return len(lines) + sum(line.continues for line in lines)


def _sum(widths: Sequence[int]) -> int:
    return sum(widths) + GAP * (len(widths) - 1)


def _wrapped(columns: Sequence[_Column], width: int) -> list[Line] | None:
    """Arrange all columns side by side, with text in several lines; None where the width does not allow that."""
    widths = _shrunk(columns, width)
    return None if widths is None else list(_grid(columns, widths))


def _shrunk(columns: Sequence[_Column], width: int) -> list[int] | None:
    """Take from the widest columns of text until all fit; None where they cannot."""
    widths = [column.natural for column in columns]
    while _sum(widths) > width:
        shrinkable = [i for i, column in enumerate(columns) if widths[i] > column.least]
        if not shrinkable:
            return None
        widths[max(shrinkable, key=lambda i: widths[i])] -= 1
    return widths


def _blocks(table: Table, columns: Sequence[_Column], width: int) -> list[Line] | None:
    """Arrange the columns in blocks below each other; None where one column does not fit beside the names of the rows."""
    heads, left = list(columns[: table.heads]), list(range(table.heads, len(columns)))
    names = _shrunk(heads, width - GAP - max((columns[i].least for i in left), default=0))
    if names is None:
        return None
    room = width - _sum(names) - GAP
    widths = {i: min(columns[i].natural, max(columns[i].least, room)) for i in left}
    spare = [table.headers.index(header) for header in table.spare]
    lines: list[Line] = []
    while left:
        block = list(left)
        while _sum([widths[i] for i in block]) > room:
            later = [i for i in spare if i in block]
            block.remove(later[0] if later and len(block) > 1 else block[-1])
        left = [i for i in left if i not in block]
        lines += [Line("")] if lines else []
        lines += _grid([*heads, *(columns[i] for i in block)], [*names, *(widths[i] for i in block)])
    return lines


def _listed(columns: Sequence[_Column], width: int) -> list[Line]:
    """Arrange every row as a list of its cells, each behind its header; a dash stands for an empty one."""
    name, *others = columns
    lines = [Line(line, "dim") for line in wrapped(name.header, width) if line]
    for i, cell in enumerate(name.cells):
        lines += [Line(line, "bold") for line in wrapped(cell, width) if line]
        for column in others:
            text = f"{column.header}: {column.cells[i] or '-'}".removeprefix(": ")
            lines += [Line(f"  {line}") for line in wrapped(text, width - 2, indent=2)]
    return lines


def _grid(columns: Sequence[_Column], widths: Sequence[int]) -> Iterator[Line]:
    for i in range(-1, len(columns[0].cells)):
        cells = [column.header if i < 0 else column.cells[i] for column in columns]
        pieces = [wrapped(cell, width) for cell, width in zip(cells, widths, strict=True)]
        for k in range(max(map(len, pieces))):
            texts = [piece[k] if k < len(piece) else "" for piece in pieces]
            aligned = [one.aligned(text, width) for one, text, width in zip(columns, texts, widths, strict=True)]
            yield Line((" " * GAP).join(aligned).rstrip(), "dim" if i < 0 else "", k > 0)


def wrapped(text: str, width: int, indent: int = 0) -> list[str]:
    """Wrap a text between words; a word that is longer than the width stays whole.

    Parameters
    ----------
    text
        Any.
    width
        In columns of a terminal.
    indent
        Blanks before every line but the first.

    Returns
    -------
    list of str
        At least one line.

    Examples
    --------
    >>> wrapped("left out of three drops", 11)
    ['left out of', 'three drops']
    """
    ends = [0, *breaks(text, width, indent), len(text)]
    lines = [text[start:end].rstrip() for start, end in pairwise(ends)]
    return [lines[0], *(" " * indent + line for line in lines[1:])]


def breaks(text: str, width: int, indent: int = 0) -> list[int]:
    """Find where a text is to be broken so that its lines fit; never within a word.

    Parameters
    ----------
    text
        One line.
    width
        In columns of a terminal.
    indent
        Blanks that will stand before every line but the first.

    Returns
    -------
    list of int
        Where each line but the first begins.
    """
    found: list[int] = []
    begin = 0
    for word in re.finditer(r"\S+", text):
        if cell_len(text[begin : word.end()]) + (indent if begin else 0) > width and text[begin : word.start()].strip():
            begin = word.start()
            found.append(begin)
    return found
