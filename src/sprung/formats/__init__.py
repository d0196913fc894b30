"""One file per format, behind one registry: from a file to columns of numbers with their names, units and a clock."""

from typing import TYPE_CHECKING, Any

from sprung.formats.interpolation import MIN_RATE, interpolate, resolves_wheel_hop
from sprung.formats.registry import Format, formats, read_table

if TYPE_CHECKING:
    from sprung.formats.sep005 import Signals, from_sep005
    from sprung.formats.table import SampleTable

__all__ = [
    "MIN_RATE",
    "Format",
    "SampleTable",
    "Signals",
    "formats",
    "from_sep005",
    "interpolate",
    "read_table",
    "resolves_wheel_hop",
]


def __getattr__(name: str) -> Any:
    # What only a file needs is loaded with the first file.
    if name == "SampleTable":
        from sprung.formats.table import SampleTable  # noqa: PLC0415

        return SampleTable
    if name in {"Signals", "from_sep005"}:
        from sprung.formats import sep005  # noqa: PLC0415

        return getattr(sep005, name)
    raise AttributeError(f"module 'sprung.formats' has no attribute '{name}'")
