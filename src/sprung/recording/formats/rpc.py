"""RPC III time histories, of road simulators and durability rigs: a header of keys and values, then groups of samples."""

from __future__ import annotations

from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import did_you_mean
from sprung.recording.formats.axes import Clock, Column, even, one_table
from sprung.recording.formats.refusals import allowance, cut_short, refuse

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.recording.formats.table import Table

_SUFFIXES = frozenset((".rpc", ".rpc3", ".rsp", ".drv", ".tim"))
_BLOCK, _RECORD, _KEY = 512, 128, 32
_ORDERS = {"BINARY": "<", "BINARY_IEEE_LITTLE_END": "<", "BINARY_IEEE_BIG_END": ">"}
_TYPES = {"SHORT_INTEGER": "i2", "FLOATING_POINT": "f4"}


class RpcFormat:
    """RPC III time histories of 16 bit integers or 32 bit floats."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the first key of the header."""
        return path.suffix.lower() in _SUFFIXES and head[:_KEY].rstrip(b" \0") == b"FORMAT"

    def read(self, path: Path) -> Table:
        """Read one file.

        Raises
        ------
        InputError
            If its header lacks something, or if it ends before the samples that the header declares.
        """
        content, file = path.read_bytes(), path.name
        header = _Header(_pairs(content, file), file)
        kind = header.one_of("DATA_TYPE", _TYPES, "SHORT_INTEGER")
        header.one_of("FILE_TYPE", {"TIME_HISTORY": ""}, "TIME_HISTORY")
        dtype = np.dtype(header.one_of("FORMAT", _ORDERS, "") + kind)
        count = header.whole("CHANNELS")
        frame, group, frames = (header.whole(key) for key in ("PTS_PER_FRAME", "PTS_PER_GROUP", "FRAMES"))
        samples = frames * frame
        if "SAMPLES" in header.pairs:  # no key of the standard, but some writers tell where their padding begins
            samples = min(samples, header.whole("SAMPLES"))
        start, groups = _BLOCK * header.whole("NUM_HEADER_BLOCKS"), -(-frames * frame // group)
        size = groups * count * group * dtype.itemsize
        if len(content) - start < size:
            raise cut_short(file, f"{max(len(content) - start, 0)} of the {size} bytes that the header declares")
        data = np.frombuffer(content, dtype, groups * count * group, start).reshape(groups, count, group)
        step, uncertainty = header.step()
        clock = even(0.0, step, samples, uncertainty, f"{file}: header DELTA_T")
        # Only integers are scaled: floats are written in the unit of the channel.
        scales = [header.number(f"SCALE.CHAN_{i + 1}") if kind == "i2" else 1.0 for i in range(count)]
        columns = [_column(header.pairs, data[:, i], i + 1, scale, clock) for i, scale in enumerate(scales)]
        return one_table(columns, file, allowance(len(content)))


def _pairs(content: bytes, file: str) -> dict[str, str]:
    """Read the header; its second and third key say how long it is."""
    text = [content[i : i + _RECORD].decode("latin-1") for i in range(0, 3 * _RECORD, _RECORD)]
    first = dict(_pair(record) for record in text)
    header = _Header(first, file)
    blocks, count = header.whole("NUM_HEADER_BLOCKS"), header.whole("NUM_PARAMS")
    if blocks * _BLOCK > len(content):
        raise cut_short(file, f"{len(content)} of the {blocks * _BLOCK} bytes of its header")
    records = range(0, min(count * _RECORD, blocks * _BLOCK), _RECORD)
    pairs = dict(_pair(content[i : i + _RECORD].decode("latin-1")) for i in records)
    return {key: value for key, value in pairs.items() if key}


def _pair(record: str) -> tuple[str, str]:
    return record[:_KEY].partition("\0")[0].strip(), record[_KEY:].partition("\0")[0].strip()


class _Header:
    """The keys and values of one file."""

    def __init__(self, pairs: Mapping[str, str], file: str) -> None:
        self.pairs, self._file = pairs, file

    def one_of(self, key: str, allowed: Mapping[str, str], usual: str) -> str:
        value = self.pairs.get(key, usual)
        if value not in allowed:
            where, do = f"{self._file}: header {key}", f"Export it in another way. {did_you_mean(value, allowed)}"
            raise refuse(where, f"'{value}'", "a kind of file that can be read", do)
        return allowed[value]

    def number(self, key: str) -> float:
        return float(self._decimal(key, "a number"))

    def whole(self, key: str) -> int:
        expected = "a whole number, 1 or more"
        value = self._decimal(key, expected)
        if value != value.to_integral_value() or not 1 <= value < 2**53:
            raise self._refuse(key, expected)
        return int(value)

    def step(self) -> tuple[float, float]:
        """Give the time step and how far it may be rounded, half a unit of its last digit, s."""
        value = self._decimal("DELTA_T", "the time step in s")
        exponent = value.as_tuple().exponent
        assert isinstance(exponent, int)  # noqa: S101 (it is finite; for the type checker)
        return float(value), 0.51 * 10.0 ** min(exponent, 0)

    def _decimal(self, key: str, expected: str) -> Decimal:
        try:
            value = Decimal(self.pairs.get(key, ""))
        except InvalidOperation:
            raise self._refuse(key, expected) from None
        if not value.is_finite() or abs(value.adjusted()) > 300:
            raise self._refuse(key, expected)
        return value

    def _refuse(self, key: str, expected: str) -> Exception:
        found = f"'{self.pairs[key]}'" if key in self.pairs else "nothing"
        return refuse(f"{self._file}: header {key}", found, expected, "Export the recording again.")


def _column(pairs: Mapping[str, str], data: NDArray[np.generic], number: int, scale: float, clock: Clock) -> Column:
    def read() -> NDArray[np.float64]:
        return scale * data.reshape(-1)[: clock.count].astype(np.float64)

    name, unit = (pairs.get(f"{key}.CHAN_{number}", "") for key in ("DESC", "UNITS"))
    reader: Callable[[], NDArray[np.float64] | None] = read
    return Column(
        name, f"{name} (channel {number})".strip() if name else f"channel {number}", unit or None, clock, reader
    )
