"""Layout of text and tables on a terminal of any width: wrapped or rearranged, never truncated."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text

from sprung.report.terminal.columns import arrange, line_breaks
from sprung.tables import Table

_MEASURE = 100
"""Longest line of prose, in columns: longer ones are hard to read."""

_UNLIMITED = 1 << 20
"""Width of a file or pipe, which takes tables of any width."""


@dataclass(frozen=True)
class TerminalTable:
    """A table that is arranged for the width of the terminal; made by `render_table`."""

    table: Table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal."""
        for line in arrange(self.table, options.max_width):
            yield Text(line.text, style=line.style, no_wrap=True, overflow="ignore")


@dataclass(frozen=True)
class HangingText:
    """A text with a hanging indent; made by `hanging_text`."""

    first: str
    text: Text

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal: further lines indented as the first one, words unbroken."""
        indent = cell_len(self.first)
        width = max(min(options.max_width, _MEASURE) - indent, 1)
        lead = self.first
        for paragraph in self.text.split("\n", allow_blank=True):
            for line in paragraph.divide(line_breaks(paragraph.plain, width)):
                line.rstrip()
                yield Text.assemble(lead, line, no_wrap=True, overflow="ignore")
                lead = " " * indent


def render_rows(
    title: str,
    headers: Sequence[str],
    rows: Iterable[Sequence[str]],
    numbers: Iterable[str] = (),
    spare: Iterable[str] = (),
    heads: int = 1,
) -> RenderableType:
    """Render a table from headers and rows.

    Parameters
    ----------
    title
        Above it.
    headers
        Of its columns.
    rows
        Cells as text.
    numbers
        Headers of the columns that are flush right.
    spare
        Headers of the columns that a narrow terminal moves below the others, in this order.
    heads
        Number of columns, from the left, that name the rows.
    """
    return render_table(Table(title, tuple(headers), tuple(map(tuple, rows)), frozenset(numbers), tuple(spare), heads))


def render_table(table: Table) -> RenderableType:
    """Render a table with its title above it.

    Parameters
    ----------
    table
        Any.
    """
    return Group(hanging_text("", Text(table.title, style="bold")), TerminalTable(table))


def hanging_text(first: str, text: str | Text) -> RenderableType:
    """Render a text with a hanging indent.

    Parameters
    ----------
    first
        Beginning of the first line, such as a dash.
    text
        Any; further lines are indented by the width of `first`.
    """
    return HangingText(first, Text(text) if isinstance(text, str) else text)


def significant_figures(number: float, count: int) -> str:
    """Return a number with a given number of significant figures, trailing zeros included.

    Parameters
    ----------
    number
        In any unit.
    count
        Number of figures.

    Examples
    --------
    >>> significant_figures(0.0201, 2), significant_figures(111.96, 3), significant_figures(2e7, 3)
    ('0.020', '112', '2e+07')
    """
    return f"{number:#.{count}g}".rstrip(".") if 1e-3 <= abs(number) < 10.0**count else f"{number:.{count}g}"


def text_of(view: RenderableType, console: Console | None = None) -> str:
    """Return a view as the text that a terminal shows.

    Parameters
    ----------
    view
        From one of the functions that return a view.
    console
        Determines width and colours; standard output unless given. A file or pipe takes tables of any width, unless the
        variable COLUMNS is set.

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
