"""Universal files (UFF, UNV): time responses in data sets 58, in text or binary."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.errors import did_you_mean
from sprung.formats.channels import ChannelClock, Column, assemble_table, clock_from_times, regular_clock
from sprung.formats.libraries import load_library
from sprung.formats.reading_errors import input_error, memory_limit, reading, truncation_error
from sprung.formats.sample_store import Samples, Store, split_range
from sprung.formats.stated_rates import TIME_UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.table import SampleTable

_SUFFIXES = frozenset((".uff", ".unv", ".uf", ".58", ".bunv"))
_HEAD = re.compile(rb"\s*-1 *\r?\n {0,5}\d+")
_MARK = re.compile(rb"    -1(?=[\r\n]|\Z| {74})")
_DIRECTIONS = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_TIME_RESPONSE = 1
_REAL = frozenset((2, 4))
_IEEE = 2


class UffFormat:
    """Universal files with time responses."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the mark that begins every data set."""
        return path.suffix.lower() in _SUFFIXES and _HEAD.match(head) is not None

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If pyuff is not installed, if the file is cut short or damaged, or if it holds no time response.
        """
        pyuff, file = load_library("pyuff", "uff", path), path.name
        if sum(1 for _ in _MARK.finditer(path.read_bytes())) % 2:
            raise truncation_error(file, "a data set without its end")
        columns: list[Column] = []
        others: list[int] = []
        with reading(file, "a universal file"):
            content = pyuff.UFF(str(path))
            numbers = [number for number, kind in enumerate(content.get_set_types()) if kind == 58]
        for number in numbers:
            where = f"{file}: data set {number + 1}"
            with reading(where, "a universal file"):
                head = content.read_sets(number, header_only=True)
            if head["func_type"] != _TIME_RESPONSE or head["ord_data_type"] not in _REAL:
                others.append(head["func_type"])
                continue
            if head["binary"] and head["fp_format"] != _IEEE:
                do = "Export it again, with numbers in the IEEE 754 format."
                raise input_error(
                    where, f"binary numbers of format {head['fp_format']}", f"format {_IEEE}, IEEE 754", do
                )
            with reading(where, "a universal file"):
                columns.append(_column(content, number, head, where))
        notes = [f"left out {len(others)} functions that are no real time responses"] if others else []
        return assemble_table(columns, file, memory_limit(path.stat().st_size), notes)


def _column(content: Any, number: int, head: dict[str, Any], where: str) -> Column:
    declared = int(head["num_pts"])
    if declared < 0:
        raise truncation_error(where, f"{declared} samples")
    times = None if head["abscissa_spacing"] else np.asarray(content.read_sets(number)["x"], dtype=np.float64)
    if times is not None and len(times) < declared:
        raise truncation_error(where, f"{len(times)} of {declared} samples")

    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        with reading(where, "a universal file"):  # the library reads a function as a whole
            values = np.asarray(content.read_sets(number)["data"], dtype=np.float64)
        if len(values) < declared:
            raise truncation_error(where, f"{len(values)} of {declared} samples")
        for begin, end in split_range(first, last, step):  # line ends behind binary numbers may look like one more
            yield np.repeat(values[None, begin:end], len(columns), axis=0)

    point = _point(head)
    name, unit = _text(head["id1"]), _text(head["ordinate_axis_units_lab"])
    clock = _clock(head, times, declared, where)
    return Column(name or point, point, unit or None, clock, Samples(Store(1, declared, read), 0))


def _clock(function: dict[str, Any], times: NDArray[np.float64] | None, count: int, where: str) -> ChannelClock:
    label = _text(function["abscissa_axis_units_lab"]).lower().strip("[]().") or "s"
    if label not in TIME_UNITS:
        raise input_error(f"{where}: abscissa", f"'{label}'", "a unit of time", did_you_mean(label, TIME_UNITS))
    factor = TIME_UNITS[label]
    if times is not None:
        return clock_from_times(factor * times[:count])
    step = factor * float(function["abscissa_inc"])
    # The field has room for six digits: 1/2048 s reads 4.88281e-04.
    uncertainty = 0.51e-5 * 10.0 ** np.floor(np.log10(step)) if 0 < step < np.inf else 0.0
    return regular_clock(
        factor * float(function["abscissa_min"]), step, count, float(uncertainty), f"{where}: abscissa"
    )


def _point(function: dict[str, Any]) -> str:
    """Return the node and direction of a measurement: ``3Z+``."""
    node, direction = int(function["rsp_node"]), int(function["rsp_dir"])
    if abs(direction) >= len(_DIRECTIONS):
        return f"{node}"
    sign = "+" if direction > 0 else "-" if direction < 0 else ""
    return f"{_text(function['rsp_ent_name'])} {node}{_DIRECTIONS[abs(direction)]}{sign}".strip()


def _text(field: str) -> str:
    plain = field.strip().strip("\0")
    return "" if plain.upper() == "NONE" or not plain.isprintable() else plain
