"""Parquet files: columns, with metadata about each and about all."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats.libraries import load_library
from sprung.formats.nested import Foreign, Node, Numbers
from sprung.formats.reading_errors import MemoryBudget, reading
from sprung.formats.sample_store import Samples, Store, regroup
from sprung.formats.vectors import table_from_nested

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.table import SampleTable

_KIND = "a Parquet file"
_TICKS = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}


class ParquetFormat:
    """Parquet files of one column per channel; needs pyarrow."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the first bytes."""
        return head.startswith(b"PAR1") and path.suffix.lower() in {".parquet", ".pq", ".parq"}

    def read(self, path: Path) -> SampleTable:
        """Read one file; of dates and times of day only the seconds since the first count.

        Raises
        ------
        InputError
            If it is damaged, holds no recording, or pyarrow is missing.
        """
        arrow = load_library("pyarrow", "parquet", path)
        parquet = load_library("pyarrow.parquet", "parquet", path)
        with reading(path.name, _KIND), parquet.ParquetFile(path, memory_map=False) as file:
            rows, schema = file.metadata.num_rows, file.schema_arrow
            fields = [field for field in schema if _is_number(arrow, field.type) or _ticks(arrow, field.type)]
            MemoryBudget(path).take(8 * rows * len(fields))
            store = _store(path, [field.name for field in fields], rows)
            node = _said(schema.metadata)
            for field in schema:
                if field in fields:
                    samples = Samples(store, fields.index(field))
                    node[field.name] = {"": _numbers(samples, bool(_ticks(arrow, field.type))), **_said(field.metadata)}
                else:
                    node[field.name] = Foreign(f"values of type {field.type}")
        return table_from_nested(node, path, "Write the time and the channels as columns of numbers.")


def _numbers(samples: Samples, moments: bool) -> Node:
    length = samples.store.length
    if length == 1 and not moments:
        return samples.all()
    return Numbers((length,), lambda _side: [samples], moments)


def _store(path: Path, names: Sequence[str], rows: int) -> Store:
    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        return regroup(_pieces(path, [names[column] for column in columns], first, last, step), step)

    return Store(len(names), rows, read)


def _pieces(path: Path, names: Sequence[str], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
    """Read from the group of rows on in which a range begins."""
    arrow, parquet = load_library("pyarrow", "parquet", path), load_library("pyarrow.parquet", "parquet", path)
    with reading(path.name, _KIND):
        file = parquet.ParquetFile(path, memory_map=False, buffer_size=1 << 16, pre_buffer=False)
    with file:
        with reading(path.name, _KIND):
            origins = _origins(arrow, file, names)
            counts = [file.metadata.row_group(group).num_rows for group in range(file.num_row_groups)]
            ends = np.cumsum(counts)
            group = int(np.searchsorted(ends, first, side="right"))
            place = int(ends[group]) - counts[group]
            groups = list(range(group, len(counts)))
            batches = iter(file.iter_batches(min(step, 1 << 16), groups, list(dict.fromkeys(names)), use_threads=False))
        while place < last:
            with reading(path.name, _KIND):
                batch = next(batches)
                values = np.array([_values(arrow, batch.column(name), origins.get(name, 0)) for name in names])
            yield values[:, max(first - place, 0) : last - place]
            place += batch.num_rows


def _origins(arrow: Any, file: Any, names: Sequence[str]) -> dict[str, int]:
    """Return the first count of every column of dates or times of day."""
    schema = file.schema_arrow
    named = [n for n in names if _ticks(arrow, (kind := schema.field(n).type)) and not arrow.types.is_duration(kind)]
    if not named:
        return {}
    batch = next(iter(file.iter_batches(1, [0], named, use_threads=False)))
    return {name: _counts(arrow, batch.column(name))[0] for name in named}


def _is_number(arrow: Any, kind: Any) -> bool:
    types = arrow.types
    return bool(types.is_integer(kind) or types.is_floating(kind) or types.is_decimal(kind) or types.is_boolean(kind))


def _ticks(arrow: Any, kind: Any) -> int | None:
    """Return the counts per second of a type of time; None for other types."""
    types = arrow.types
    return _TICKS[kind.unit] if types.is_timestamp(kind) or types.is_duration(kind) or types.is_time(kind) else None


def _values(arrow: Any, column: Any, since: int) -> NDArray[np.float64]:
    """Return the numbers of a column; of times, the seconds since a count."""
    ticks = _ticks(arrow, column.type)
    if ticks is None:
        if arrow.types.is_boolean(column.type):
            column = column.cast(arrow.int8())
        numbers = column.cast(arrow.float64(), safe=False)
        return np.asarray(numbers.to_numpy(zero_copy_only=False), dtype=np.float64)
    missing = np.asarray(column.is_null().to_numpy(zero_copy_only=False), dtype=bool)
    # Counted in integers from the first on: since 1970, a double would tell no nanoseconds apart.
    return np.where(missing, np.nan, (_counts(arrow, column) - since) / ticks)


def _counts(arrow: Any, column: Any) -> NDArray[np.int64]:
    if arrow.types.is_time32(column.type):
        column = column.cast(arrow.int32())
    return np.asarray(column.cast(arrow.int64()).fill_null(0).to_numpy(zero_copy_only=False), dtype=np.int64)


def _said(metadata: Mapping[bytes, bytes] | None) -> dict[str, Node]:
    """Return metadata as text; JSON, as pandas writes a frame's attributes, is parsed."""
    node: dict[str, Node] = {}
    for key, value in (metadata or {}).items():
        name, text = key.decode("utf-8", "replace"), value.decode("utf-8", "replace")
        if name in {"pandas", "ARROW:schema"} or name.startswith("PARQUET:"):
            continue
        try:
            node[name] = _of_json(json.loads(text)) if text.startswith("{") else text
        except ValueError:  # not JSON after all
            node[name] = text
    return node


def _of_json(value: object) -> Node:
    match value:
        case dict():
            return {str(name): _of_json(child) for name, child in value.items()}
        case list():
            return [_of_json(child) for child in value]
        case bool() | int() | float():
            return np.array(float(value))
        case _:
            return str(value)
