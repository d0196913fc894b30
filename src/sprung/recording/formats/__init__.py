"""One file per format, behind one registry."""

from sprung.recording.formats.registry import Format, formats, read_table
from sprung.recording.formats.table import Table, split_unit

__all__ = ["Format", "Table", "formats", "read_table", "split_unit"]
