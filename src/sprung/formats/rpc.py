"""RPC III time histories, of road simulators and durability rigs: a header of keys and values, then groups of samples."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.errors import did_you_mean
from sprung.formats.channels import ChannelClock, Column, assemble_table, regular_clock
from sprung.formats.reading_errors import input_error, memory_limit, reading, truncation_error
from sprung.formats.sample_store import Samples, Store, store_by_ranges

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.table import SampleTable

_SUFFIXES = frozenset((".rpc", ".rpc3", ".rsp", ".drv", ".tim"))
_BLOCK, _RECORD, _KEY = 512, 128, 32
_ORDERS = {"BINARY": "<", "BINARY_IEEE_LITTLE_END": "<", "BINARY_IEEE_BIG_END": ">"}
_TYPES = {"SHORT_INTEGER": "i2", "FLOATING_POINT": "f4"}


class RpcFormat:
    """RPC III time histories of 16 bit integers or 32 bit floats."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the first key of the header."""
        return path.suffix.lower() in _SUFFIXES and head[:_KEY].rstrip(b" \0") == b"FORMAT"

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If its header lacks something, or if it ends before the samples that the header declares.
        """
        file, written = path.name, path.stat().st_size
        header = _Header(_pairs(path, written), file)
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
        if written - start < size:
            raise truncation_error(file, f"{max(written - start, 0)} of the {size} bytes that the header declares")
        step, uncertainty = header.step()
        clock = regular_clock(0.0, step, samples, uncertainty, f"{file}: header DELTA_T")
        # Only integers are scaled: floats are written in the unit of the channel.
        scales = [header.number(f"SCALE.CHAN_{i + 1}") if kind == "i2" else 1.0 for i in range(count)]
        store = _store(path, _Samples(start, dtype, group, samples), scales)
        columns = [_column(header.pairs, Samples(store, i), clock) for i in range(count)]
        return assemble_table(columns, file, memory_limit(written))


def _pairs(path: Path, written: int) -> dict[str, str]:
    """Read the header; its second and third key say how long it is."""
    with path.open("rb") as stream:
        content = stream.read(3 * _RECORD)
        text = [content[i : i + _RECORD].decode("latin-1") for i in range(0, 3 * _RECORD, _RECORD)]
        header = _Header(dict(_pair(record) for record in text), path.name)
        blocks, count = header.whole("NUM_HEADER_BLOCKS"), header.whole("NUM_PARAMS")
        if blocks * _BLOCK > written:
            raise truncation_error(path.name, f"{written} of the {blocks * _BLOCK} bytes of its header")
        wanted = min(count * _RECORD, blocks * _BLOCK)
        content = (content + stream.read(max(wanted - len(content), 0)))[:wanted]
    pairs = dict(_pair(content[i : i + _RECORD].decode("latin-1")) for i in range(0, len(content), _RECORD))
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
            raise input_error(where, f"'{value}'", "a kind of file that can be read", do)
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
        """Return the time step and its rounding error, half a unit of its last digit, s."""
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
        return input_error(f"{self._file}: header {key}", found, expected, "Export the recording again.")


@dataclass(frozen=True)
class _Samples:
    """Where the samples stand: group after group, in each of them channel after channel."""

    start: int
    dtype: np.dtype[Any]
    group: int
    count: int


def _store(path: Path, samples: _Samples, scales: Sequence[float]) -> Store:
    size = samples.dtype.itemsize * samples.group

    def get(columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        values = np.empty((len(columns), last - first))
        with reading(path.name, "an RPC III file"), path.open("rb") as stream:
            for group in range(first // samples.group, -(-last // samples.group)):
                begin, end = max(first - group * samples.group, 0), min(last - group * samples.group, samples.group)
                place = group * samples.group + begin - first
                for row, column in zip(values, columns, strict=True):
                    channel = group * len(scales) + column
                    stream.seek(samples.start + channel * size + begin * samples.dtype.itemsize)
                    raw = stream.read((end - begin) * samples.dtype.itemsize)
                    row[place : place + end - begin] = np.frombuffer(raw, samples.dtype)
        values *= np.array([[scales[column]] for column in columns])
        return values

    return store_by_ranges(len(scales), samples.count, get)


def _column(pairs: Mapping[str, str], samples: Samples, clock: ChannelClock) -> Column:
    number = samples.column + 1
    name, unit = (pairs.get(f"{key}.CHAN_{number}", "") for key in ("DESC", "UNITS"))
    otherwise = f"{name} (channel {number})".strip() if name else f"channel {number}"
    return Column(name, otherwise, unit or None, clock, samples)
