"""One file per format, behind one registry."""

from sprung.recording.formats.registry import Format, formats, read_table
from sprung.recording.formats.sep005 import Signals, from_sep005, to_sep005
from sprung.recording.formats.table import Table, split_unit

__all__ = ["Format", "Signals", "Table", "formats", "from_sep005", "read_table", "split_unit", "to_sep005"]
