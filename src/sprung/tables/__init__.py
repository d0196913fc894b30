"""Tables of results: how numbers are written by their uncertainty, and the way of a table to HTML."""

from sprung.tables.cells import percent_text, unit_text, value_cells, with_std
from sprung.tables.table import Table, escaped

__all__ = [
    "Table",
    "escaped",
    "percent_text",
    "unit_text",
    "value_cells",
    "with_std",
]
