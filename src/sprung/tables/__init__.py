"""Tables of results: numbers rounded by their uncertainty, and tables as HTML."""

from sprung.tables.cells import percent_text, unit_text, value_cells, with_minus_signs, with_std
from sprung.tables.table import Table, escaped

__all__ = [
    "Table",
    "escaped",
    "percent_text",
    "unit_text",
    "value_cells",
    "with_minus_signs",
    "with_std",
]
