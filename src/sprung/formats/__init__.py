"""One file per format, behind one registry."""

from sprung.formats.registry import Format, formats, read_table
from sprung.formats.regularise import MOST_MISSING, fill_gaps, filled, on_clock
from sprung.formats.resampled import SLOWEST
from sprung.formats.sep005 import Signals, from_sep005
from sprung.formats.table import Table, split_unit
from sprung.formats.timestamps import RegularTimeBase, regularise_time_base

__all__ = [
    "MOST_MISSING",
    "SLOWEST",
    "Format",
    "RegularTimeBase",
    "Signals",
    "Table",
    "fill_gaps",
    "filled",
    "formats",
    "from_sep005",
    "on_clock",
    "read_table",
    "regularise_time_base",
    "split_unit",
]
