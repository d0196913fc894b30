"""How text is laid out on a terminal of any width: what does not fit is wrapped or set below, never cut or left out."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text

from sprung.report.terminal.columns import arrange, breaks
from sprung.tables import Table

_MEASURE = 100
"""Columns that a line of prose has at most: longer ones are hard to read."""

_UNLIMITED = 1 << 20
"""Width of what is no terminal: a file or another program, which takes every table as wide as it is."""


@dataclass(frozen=True)
class Fitting:
    """A table that is arranged for the width of the terminal; made by `laid_out`."""

    table: Table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal."""
        for line in arrange(self.table, options.max_width):
            yield Text(line.text, style=line.style, no_wrap=True, overflow="ignore")


@dataclass(frozen=True)
class Hanging:
    """A text beside what leads it in; made by `hanging`."""

    first: str
    text: Text

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal: its further lines below its own first one, words whole."""
        indent = cell_len(self.first)
        width = max(min(options.max_width, _MEASURE) - indent, 1)
        lead = self.first
        for paragraph in self.text.split("\n", allow_blank=True):
            for line in paragraph.divide(breaks(paragraph.plain, width)):
                line.rstrip()
                yield Text.assemble(lead, line, no_wrap=True, overflow="ignore")
                lead = " " * indent


def table(
    title: str,
    headers: Sequence[str],
    rows: Iterable[Sequence[str]],
    numbers: Iterable[str] = (),
    spare: Iterable[str] = (),
    heads: int = 1,
) -> RenderableType:
    """Lay out one table.

    Parameters
    ----------
    title
        Above it.
    headers
        Of its columns.
    rows
        Cells as text.
    numbers
        Headers of the columns to set flush right.
    spare
        Headers of the columns that a narrow terminal sets below the others, the first to go first.
    heads
        How many columns at the left name the rows.
    """
    return laid_out(Table(title, tuple(headers), tuple(map(tuple, rows)), frozenset(numbers), tuple(spare), heads))


def laid_out(table: Table) -> RenderableType:
    """Lay out a table with its title above it.

    Parameters
    ----------
    table
        The table.
    """
    return Group(hanging("", Text(table.title, style="bold")), Fitting(table))


def hanging(first: str, text: str | Text) -> RenderableType:
    """Set a text beside what leads it in, its further lines below its own first one.

    Parameters
    ----------
    first
        What leads it in, such as a dash.
    text
        The text.
    """
    return Hanging(first, Text(text) if isinstance(text, str) else text)


def figures(number: float, count: int) -> str:
    """Write a number with a few figures, trailing zeros among them.

    Parameters
    ----------
    number
        The number.
    count
        How many figures.

    Examples
    --------
    >>> figures(0.0201, 2), figures(111.96, 3), figures(2e7, 3)
    ('0.020', '112', '2e+07')
    """
    return f"{number:#.{count}g}".rstrip(".") if 1e-3 <= abs(number) < 10.0**count else f"{number:.{count}g}"


def text_of(view: RenderableType, console: Console | None = None) -> str:
    """Turn a view into the text that a terminal shows.

    Parameters
    ----------
    view
        From one of this room's views.
    console
        Knows the width and the colours; standard output unless given. What is no terminal, a file or another program, takes
        tables of any width, unless the variable COLUMNS says otherwise.

    Returns
    -------
    str
        Lines without trailing blanks; with colours if the console has any.
    """
    console = console or _standard_output()
    with console.capture() as capture:
        console.print(view, crop=False)
    return "".join(f"{line.rstrip()}\n" for line in capture.get().splitlines())


def _standard_output() -> Console:
    limited = sys.stdout.isatty() or "COLUMNS" in os.environ
    return Console(highlight=False, width=None if limited else _UNLIMITED)
