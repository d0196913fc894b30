"""Rows in Parquet files, of which each is replaced by one renaming: a row is in one file, whole, at every moment.

A row belongs to a campaign. Written again, it replaces the earlier one in the file where that is; new ones fill up the last
file until it is full. So a reader of all files finds every campaign at most once, also while a batch runs, and however it
is ended.
"""

from __future__ import annotations

import errno
import io
import os
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from sprung.batch.task import Columns, Kind, Row
from sprung.errors import InputError, Problem, Problems

if TYPE_CHECKING:
    import pyarrow as pa  # type: ignore[import-untyped]

ROWS_PER_SHARD = 500
"""Number of rows of a full file: so many are written again with every change of it."""

OWN_COLUMNS: Columns = {
    "campaign": "text",
    "key": "text",
    "status": "text",
    "message": "text",
    "seconds": "number",
}
"""Columns of every row: campaign, key of its content, ``done`` or a reason of failure, its message, and computing time, s."""

_METADATA = b"sprung"
_NEW = ".{name}.new"


class Entry(NamedTuple):
    """Where the row of a campaign is.

    Attributes
    ----------
    key
        Of the content that it follows from.
    status
        ``done``, or the reason of a failure.
    shard
        Number of its file.
    """

    key: str
    status: str
    shard: int


class ShardFolder:
    """The Parquet files of a batch in a folder, and an index of their rows.

    Parameters
    ----------
    folder
        Existing; locked by the caller.
    columns
        Of the rows, beside those that every row has.
    content
        What the rows are of, in a few words; files with other content are refused.

    Raises
    ------
    InputError
        If pyarrow is not installed, or a Parquet file in the folder is damaged or not one of this batch; with every file.
    """

    def __init__(self, folder: str | os.PathLike[str], columns: Columns, content: str) -> None:
        require_parquet()
        self.folder = Path(folder)
        self._columns: Columns = {**OWN_COLUMNS, **columns}
        self._content = content
        self._sizes: dict[int, int] = {}
        self.index: dict[str, Entry] = {}
        self._remove_unfinished()
        problems = Problems()
        for path in sorted(self.folder.glob("*.parquet")):
            with problems.collect():
                self._enter(path)
        problems.raise_if_any()

    def path(self, shard: int) -> Path:
        """Return the path of a file by its number."""
        return self.folder / f"rows-{shard:05d}.parquet"

    def write(self, rows: Sequence[Row]) -> None:
        """Write rows; each replaces the earlier one of its campaign.

        Parameters
        ----------
        rows
            One for each campaign, with the columns of `OWN_COLUMNS` and others of the batch; a missing value is null.

        Raises
        ------
        InputError
            If they cannot be written, such as on a full disk. Every file is then as it was, or as it should be.
        """
        by_shard: dict[int, dict[str, Row]] = defaultdict(dict)
        sizes = dict(self._sizes)
        last = max(sizes, default=0)
        for row in rows:
            entry = self.index.get(row["campaign"])
            if entry is None:
                if sizes.get(last, ROWS_PER_SHARD) >= ROWS_PER_SHARD:
                    last += 1
                sizes[last] = sizes.get(last, 0) + 1
            by_shard[last if entry is None else entry.shard][row["campaign"]] = row
        for shard, new in by_shard.items():
            kept = self._read(shard) if shard in self._sizes else {}
            self._replace(shard, list({**kept, **new}.values()))
            for campaign, row in new.items():
                self.index[campaign] = Entry(row["key"], row["status"], shard)

    def _read(self, shard: int) -> dict[str, Row]:
        import pyarrow.parquet as pq  # type: ignore[import-untyped]  # noqa: PLC0415 (optional)

        return {row["campaign"]: row for row in pq.read_table(self.path(shard)).to_pylist()}

    def _replace(self, shard: int, rows: Sequence[Row]) -> None:
        """Write a file aside and rename it."""
        _write_aside(self.path(shard), _parquet(rows, _schema(self._columns, self._content)))
        self._sizes[shard] = len(rows)

    def _remove_unfinished(self) -> None:
        for path in self.folder.glob(_NEW.format(name="*.parquet")):
            with suppress(OSError):
                path.unlink()

    def _enter(self, path: Path) -> None:
        """Add the rows of a file to the index."""
        import pyarrow as pa  # noqa: PLC0415 (optional)
        import pyarrow.parquet as pq  # noqa: PLC0415

        try:
            # Not mapped into memory: the file is replaced later.
            table = pq.read_table(path, columns=["campaign", "key", "status"], memory_map=False)
        except (pa.ArrowException, OSError, KeyError, ValueError) as error:
            what = " ".join(str(error).split())
            do = "Move it away; its campaigns are then done again."
            raise InputError(
                [Problem(str(path), f"no readable rows ({what})", "a Parquet file of sprung", do)]
            ) from error
        content = (table.schema.metadata or {}).get(_METADATA, b"").decode("utf-8", "replace")
        shard = path.stem.removeprefix("rows-")
        if content != self._content or not shard.isdecimal():
            found = (
                f"rows of {content}"
                if content and shard.isdecimal()
                else "a Parquet file that this batch did not write"
            )
            do = "Choose another output folder, or move it away: all Parquet files of a folder are read together."
            raise InputError([Problem(str(path), found, f"rows of {self._content}", do)])
        names = zip(*(table.column(name).to_pylist() for name in ("campaign", "key", "status")), strict=True)
        for campaign, key, status in names:
            if campaign in self.index:
                found = f"a second row of {campaign}"
                do = f"Move one of {path.name} and {self.path(self.index[campaign].shard).name} away."
                raise InputError([Problem(str(path), found, "one row for each campaign", do)])
            self.index[campaign] = Entry(key, status, int(shard))
        self._sizes[int(shard)] = table.num_rows


def write_table(folder: str | os.PathLike[str], name: str, rows: Sequence[Row], columns: Columns) -> Path:
    """Write rows as one Parquet file, whole or not at all.

    Parameters
    ----------
    folder
        Made if it does not exist.
    name
        Of the file, without suffix; an earlier one is replaced.
    rows
        In order.
    columns
        Of the rows.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        If it cannot be written, or pyarrow is not installed.
    """
    require_parquet()
    target = Path(folder) / f"{name}.parquet"
    _write_aside(target, _parquet(rows, _schema(columns, name)))
    return target


def _write_aside(target: Path, content: bytes) -> None:
    """Write a file under another name and rename it."""
    new = target.with_name(_NEW.format(name=target.name))
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with new.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())  # a name must never stand for content that a power cut would lose
        new.replace(target)
    except OSError as error:
        with suppress(OSError):
            new.unlink(missing_ok=True)
        is_full = error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
        found = "no space for more rows" if is_full else f"a file that cannot be written ({error.strerror or error})"
        do = "Make room, and start the command again: what was written before is whole and is not done again."
        raise InputError([Problem(str(target), found, "a place to write to", do)]) from error


def require_parquet() -> None:
    """Check that pyarrow is installed.

    Raises
    ------
    InputError
        If it is not; the message says how to install it.
    """
    if find_spec("pyarrow") is None:
        do = 'Install it: pip install "sprung[parquet]".'
        raise InputError([Problem("output", "no package pyarrow", "pyarrow, which writes Parquet files", do)])


def read_rows(folder: str | os.PathLike[str], columns: Sequence[str]) -> Iterator[Row]:
    """Yield the rows of a batch, some columns of them, one file at a time.

    Parameters
    ----------
    folder
        With the Parquet files of a batch.
    columns
        Names; a column that a file does not have is None in all its rows.

    Yields
    ------
    Row
        In the order of the files.
    """
    import pyarrow.parquet as pq  # noqa: PLC0415 (optional)

    for path in sorted(Path(folder).glob("*.parquet")):
        with pq.ParquetFile(path) as file:
            there = [name for name in columns if name in file.schema_arrow.names]
            for row in file.read(columns=there).to_pylist():
                yield {name: row.get(name) for name in columns}


def _schema(columns: Mapping[str, Kind], content: str) -> pa.Schema:
    import pyarrow as pa  # noqa: PLC0415 (optional)

    types: dict[Kind, Any] = {
        "text": pa.string(),
        "number": pa.float64(),
        "integer": pa.int64(),
        "texts": pa.list_(pa.string()),
        "numbers": pa.list_(pa.float64()),
    }
    fields = [pa.field(name, types[kind]) for name, kind in columns.items()]
    return pa.schema(fields, metadata={_METADATA: content.encode()})


def _parquet(rows: Sequence[Row], schema: pa.Schema) -> bytes:
    import pyarrow as pa  # noqa: PLC0415 (optional)
    import pyarrow.parquet as pq  # noqa: PLC0415

    # A lone surrogate, as a name on disk may have, is not UTF-8.
    columns = [[_plain(row.get(field.name)) for row in rows] for field in schema]
    table = pa.table(
        [pa.array(values, field.type) for values, field in zip(columns, schema, strict=True)], schema=schema
    )
    buffer = io.BytesIO()
    pq.write_table(table, buffer, compression="zstd")
    return buffer.getvalue()


def _plain(value: Any) -> Any:
    return value.encode("utf-8", "replace").decode() if isinstance(value, str) else value
