"""Parquet files: columns, with metadata about each and about all."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.recording.formats.nested import Foreign, Moments, Node
from sprung.recording.formats.optional import library
from sprung.recording.formats.refusals import Allowance, reading
from sprung.recording.formats.vectors import table_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from sprung.recording.formats.table import Table

_TICKS = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}


class ParquetFormat:
    """Parquet files of one column per channel; needs pyarrow."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the first bytes."""
        return head.startswith(b"PAR1") and path.suffix.lower() in {".parquet", ".pq", ".parq"}

    def read(self, path: Path) -> Table:
        """Read one file; of dates and times of day only the seconds since the first count.

        Raises
        ------
        InputError
            If it is damaged, holds no recording, or pyarrow is missing.
        """
        arrow = library("pyarrow", "parquet", path)
        parquet = library("pyarrow.parquet", "parquet", path)
        allowance = Allowance(path)
        with reading(path, "a Parquet file"), parquet.ParquetFile(path, memory_map=False) as file:
            rows, schema = file.metadata.num_rows, file.schema_arrow
            node = _said(schema.metadata)
            for field in schema:
                if _is_number(arrow, field.type) or _ticks(arrow, field.type):
                    allowance.take(32 * rows)
                    column = file.read(columns=[field.name], use_threads=False).column(field.name)
                    node[field.name] = {"": _values(arrow, column), **_said(field.metadata)}
                else:
                    node[field.name] = Foreign(f"values of type {field.type}")
        return table_of(node, path, "Write the time and the channels as columns of numbers.")


def _is_number(arrow: Any, kind: Any) -> bool:
    types = arrow.types
    return bool(types.is_integer(kind) or types.is_floating(kind) or types.is_decimal(kind) or types.is_boolean(kind))


def _ticks(arrow: Any, kind: Any) -> int | None:
    """Give how many counts of a type of time are a second; None for other types."""
    types = arrow.types
    return _TICKS[kind.unit] if types.is_timestamp(kind) or types.is_duration(kind) or types.is_time(kind) else None


def _values(arrow: Any, column: Any) -> np.ndarray | Moments:
    ticks = _ticks(arrow, column.type)
    if ticks is None:
        if arrow.types.is_boolean(column.type):
            column = column.cast(arrow.int8())
        return np.asarray(column.cast(arrow.float64(), safe=False).to_numpy(), dtype=np.float64)
    missing = np.asarray(column.is_null())
    if arrow.types.is_time32(column.type):
        column = column.cast(arrow.int32())
    counts = np.asarray(column.cast(arrow.int64()).fill_null(0).to_numpy(), dtype=np.int64)
    # Counted in integers from the first on: since 1970, a double would tell no nanoseconds apart.
    since = 0 if arrow.types.is_duration(column.type) or not counts.size else counts[0]
    return Moments(np.where(missing, np.nan, (counts - since) / ticks))


def _said(metadata: Mapping[bytes, bytes] | None) -> dict[str, Node]:
    """Give metadata as words; those in JSON, as pandas writes a frame's attributes, with what is in them."""
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
