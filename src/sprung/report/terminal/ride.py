"""Ride and inspection numbers, for the terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.report.terminal.layout import hanging_text, render_table
from sprung.ride import RideNumbers, ride_tables


def ride_view(numbers: RideNumbers) -> RenderableType:
    """Return the view of ride and inspection numbers.

    Parameters
    ----------
    numbers
        Of a vehicle.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts: list[RenderableType] = []
    for table in ride_tables(numbers):
        parts += [render_table(table), Text()]
    return Group(*parts, *(hanging_text("  - ", note) for note in numbers.notes))
