"""Universal files (UFF, UNV): time responses in data sets 58, in text or binary."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.errors import did_you_mean
from sprung.recording.formats.axes import Clock, Column, even, one_table, stamped
from sprung.recording.formats.clock import TIME_UNITS
from sprung.recording.formats.optional import library
from sprung.recording.formats.refusals import allowance, contained, cut_short, refuse

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.recording.formats.table import Table

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

    def read(self, path: Path) -> Table:
        """Read one file.

        Raises
        ------
        InputError
            If pyuff is not installed, if the file is cut short or damaged, or if it holds no time response.
        """
        pyuff, file = library("pyuff", "uff", path), path.name
        marks = sum(1 for _ in _MARK.finditer(path.read_bytes()))
        if marks % 2:
            raise cut_short(file, "a data set without its end")
        columns: list[Column] = []
        others: list[int] = []
        with contained(file, "UFF"):
            content = pyuff.UFF(str(path))
            numbers = [number for number, kind in enumerate(content.get_set_types()) if kind == 58]
        for number in numbers:
            where = f"{file}: data set {number + 1}"
            with contained(where, "UFF"):
                head = content.read_sets(number, header_only=True)
            if head["func_type"] != _TIME_RESPONSE or head["ord_data_type"] not in _REAL:
                others.append(head["func_type"])
                continue
            if head["binary"] and head["fp_format"] != _IEEE:
                do = "Export it again, with numbers in the IEEE 754 format."
                raise refuse(where, f"binary numbers of format {head['fp_format']}", f"format {_IEEE}, IEEE 754", do)
            with contained(where, "UFF"):
                columns.append(_column(content.read_sets(number), where))
        notes = [f"left out {len(others)} functions that are no real time responses"] if others else []
        return one_table(columns, file, allowance(path.stat().st_size), notes)


def _column(function: dict[str, Any], where: str) -> Column:
    values: NDArray[np.float64] = np.asarray(function["data"], dtype=np.float64)
    declared = int(function["num_pts"])
    if len(values) < declared or declared < 0:
        raise cut_short(where, f"{len(values)} of {declared} samples")
    values = values[:declared]  # line ends behind binary numbers may look like one more
    clock = _clock(function, declared, where)
    point = _point(function)
    name, unit = _text(function["id1"]), _text(function["ordinate_axis_units_lab"])
    return Column(name or point, point, unit or None, clock, lambda: values)


def _clock(function: dict[str, Any], count: int, where: str) -> Clock:
    label = _text(function["abscissa_axis_units_lab"]).lower().strip("[]().") or "s"
    if label not in TIME_UNITS:
        raise refuse(f"{where}: abscissa", f"'{label}'", "a unit of time", did_you_mean(label, TIME_UNITS))
    factor = TIME_UNITS[label]
    if function["abscissa_spacing"] == 0:
        return stamped(factor * np.asarray(function["x"], dtype=np.float64)[:count])
    step = factor * float(function["abscissa_inc"])
    # The field has room for six digits: 1/2048 s reads 4.88281e-04.
    uncertainty = 0.51e-5 * 10.0 ** np.floor(np.log10(step)) if 0 < step < np.inf else 0.0
    return even(factor * float(function["abscissa_min"]), step, count, float(uncertainty), f"{where}: abscissa")


def _point(function: dict[str, Any]) -> str:
    """Name where and in which direction was measured: ``3Z+``."""
    node, direction = int(function["rsp_node"]), int(function["rsp_dir"])
    if abs(direction) >= len(_DIRECTIONS):
        return f"{node}"
    sign = "+" if direction > 0 else "-" if direction < 0 else ""
    return f"{_text(function['rsp_ent_name'])} {node}{_DIRECTIONS[abs(direction)]}{sign}".strip()


def _text(field: str) -> str:
    plain = field.strip().strip("\0")
    return "" if plain.upper() == "NONE" or not plain.isprintable() else plain
