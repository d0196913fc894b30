"""One file per format, behind one registry."""

from sprung.formats.interpolation import interpolate
from sprung.formats.registry import Format, formats, read_table
from sprung.formats.resampling import MIN_RATE
from sprung.formats.sep005 import Signals, from_sep005
from sprung.formats.table import Table, split_unit

__all__ = [
    "MIN_RATE",
    "Format",
    "Signals",
    "Table",
    "formats",
    "from_sep005",
    "interpolate",
    "read_table",
    "split_unit",
]
