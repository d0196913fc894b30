"""Views at every width: all that their tables hold is shown, on a terminal and in a pipe."""

from __future__ import annotations

import contextlib
import io
from collections import Counter
from collections.abc import Iterator

import pytest
from rich.cells import cell_len
from rich.console import Console, Group, RenderableType

from sprung.report import text_of
from sprung.report.terminal.layout import TerminalTable
from sprung.tables import Table

WIDTHS = (40, 60, 80, 100, 120, 200)


def tables_of(view: RenderableType) -> Iterator[Table]:
    """Return every table of a view."""
    if isinstance(view, TerminalTable):
        yield view.table
    elif isinstance(view, Group):
        for part in view.renderables:
            yield from tables_of(part)


def check_view_is_whole(view: RenderableType, *, tables: int) -> None:
    """Count every word of every cell on terminals of every width, and look for every row, whole, in a pipe."""
    found = list(tables_of(view))
    assert len(found) >= tables
    held = Counter(word for table in found for row in table.rows for cell in row for word in cell.split())
    for width in WIDTHS:
        shown = text_of(view, Console(width=width, highlight=False, color_system=None))
        assert not held - Counter(shown.split()), width
        assert all(word in shown for table in found for header in table.headers for word in header.split()), width
        # Only a word that has no room is longer than the terminal is wide.
        assert not [line for line in shown.splitlines() if cell_len(line) > width > cell_len(line.split()[-1]) + 4], (
            width
        )
    lines = {" ".join(line.split()) for line in piped(view).splitlines()}
    for table in found:
        assert {" ".join(" ".join(row).split()) for row in (table.headers, *table.rows)} <= lines


def piped(view: RenderableType) -> str:
    """Return what a view writes into a pipe."""
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()):
        patch.delenv("COLUMNS", raising=False)
        patch.delenv("FORCE_COLOR", raising=False)
        return text_of(view)
