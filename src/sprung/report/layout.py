"""How text is laid out on a terminal of any width: what does not fit is left out or wrapped, never cut."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.table import Table as Grid
from rich.text import Text

from sprung.tables import Table

_GAP = 2
"""Columns between the columns of a table."""


@dataclass(frozen=True)
class Fitting:
    """A table that leaves columns out where the terminal is narrow; made by `laid_out`."""

    table: Table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it for a terminal."""
        table = self.table
        kept = dict(enumerate(table.headers))
        widths = [max(map(cell_len, column)) + _GAP for column in zip(table.headers, *table.rows, strict=True)]
        for header in table.spare:
            if sum(widths[i] for i in kept) - _GAP <= options.max_width:
                break
            del kept[table.headers.index(header)]
        # Of its natural width, whatever the terminal's: a line that wraps can still be read, a cut number cannot.
        width = sum(widths[i] for i in kept) - _GAP
        shown = Grid(header_style="dim", box=None, pad_edge=False, padding=(0, _GAP, 0, 0), width=width)
        for header in kept.values():
            shown.add_column(header, justify="right" if header in table.numbers else "left", no_wrap=True)
        for row in table.rows:
            shown.add_row(*(Text(row[i]) for i in kept))
        yield shown


def table(
    title: str,
    headers: Sequence[str],
    rows: Iterable[Sequence[str]],
    numbers: Iterable[str] = (),
    spare: Iterable[str] = (),
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
        Headers of the columns that a narrow terminal can do without, the first to go first.
    """
    return laid_out(Table(title, tuple(headers), tuple(map(tuple, rows)), frozenset(numbers), tuple(spare)))


def laid_out(table: Table) -> RenderableType:
    """Lay out a table with its title above it.

    Parameters
    ----------
    table
        The table.
    """
    return Group(Text(table.title, style="bold"), Fitting(table))


def hanging(first: str, text: str | Text) -> RenderableType:
    """Set a text beside what leads it in, its further lines below its own first one.

    Parameters
    ----------
    first
        What leads it in, such as a dash.
    text
        The text.
    """
    grid = Grid.grid(padding=0)
    grid.add_column(no_wrap=True)
    grid.add_column(overflow="fold")
    grid.add_row(first, text)
    return grid


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
        Knows the terminal's width and colours; standard output unless given.

    Returns
    -------
    str
        Lines without trailing blanks; with colours if the console has any.
    """
    console = console or Console(highlight=False)
    with console.capture() as capture:
        console.print(view, crop=False)
    return "".join(f"{line.rstrip()}\n" for line in capture.get().splitlines())
