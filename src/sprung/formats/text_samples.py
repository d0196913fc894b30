"""The samples of a text table: its lines gone through once, and read again where they are asked for."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sprung.formats.reading_errors import reading
from sprung.formats.sample_store import regroup
from sprung.formats.text_blocks import Encoding, LineBlock, read_blocks
from sprung.formats.text_cells import Cells
from sprung.formats.text_layout import Layout, split_cells

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from sprung.errors import Problem

BLANK = " \t,;|"
"""What stands in lines without cells."""

_SMALL = 1 << 22
"""Bytes up to which a file is read at once, as going through it twice would take longer."""


@dataclass(frozen=True, eq=False)
class TextSamples:
    """The lines with samples of a text file.

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
class LineSamples(TextSamples):
    """Lines with samples that are in memory.

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


def go_through(text: TextSamples, ahead: Iterable[LineBlock], columns: Sequence[int]) -> tuple[TextSamples, Cells, int]:
    """Read some columns of a text.

    Parameters
    ----------
    text
        The text.
    ahead
        Its lines from the beginning, block by block.
    columns
        Which, one or more.

    Returns
    -------
    text
        With the marks that it needs to read any part.
    cells
        What stands in the columns.
    cut
        Number of the last line if that is cut short, and left out; otherwise 0.
    """
    layout = text.layout
    cells = Cells(text.path.name, layout, columns, text.size)
    marks: list[tuple[int, int, int]] = []
    number, held = 1, (0, "")
    before = ""
    for block in ahead:
        start, lines = _samples(block, number, layout)
        last = next((index for index in range(len(lines) - 1, -1, -1) if lines[index].strip(BLANK)), None)
        if last is not None:
            # The last line that holds anything waits: it may be cut short, as when a logger loses power.
            if held[0]:
                cells.add([held[1]], held[0])
            marks.append((cells.count, number, block.start))
            cells.add(lines[:last], start)
            before = next((line for line in reversed(lines[:last]) if line.strip(BLANK)), held[1])
            held = (start + last, lines[last])
        number = start + len(lines)
    found, full = (len(split_cells(line, layout.delimiter)) for line in (held[1], before))
    cut = held[0] if cells.count and found < len(layout.names) <= full else 0
    if held[0] and not cut:
        cells.add([held[1]], held[0])
    return replace(text, marks=marks), cells, cut
