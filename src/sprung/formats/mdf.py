"""MDF files of versions 3 and 4, of measurement and calibration tools (ASAM)."""

from __future__ import annotations

from contextlib import closing, contextmanager, suppress
from io import BytesIO
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats.channels import ChannelClock, Column, assemble_table, clock_from_times
from sprung.formats.libraries import load_library
from sprung.formats.mdf_blocks import AGAIN, MAGIC, Content, check_blocks
from sprung.formats.reading_errors import check_declared_size, input_error, memory_limit, reading, truncation_error
from sprung.formats.sample_store import Samples, Store, split_range
from sprung.formats.stated_rates import TIME_UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.table import SampleTable

_SUFFIXES = frozenset((".mdf", ".mf3", ".mf4", ".dat"))
_SYNC_TIME = 1
_INVALIDATED = 1 << 1
_WORDS_3, _LAST_NUMBER_4 = (7, 8), 5
"""Types of data: text and bytes of version 3, the last that is a real number of version 4."""
_AT_ONCE = 1 << 22
"""Bytes of records that are read together."""


class MdfFormat:
    """MDF files with a time channel in every group."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the mark of the format."""
        return path.suffix.lower() in _SUFFIXES and head.startswith(MAGIC)

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If asammdf is not installed, if the file is cut short or damaged, or if it has no channel over time.
        """
        file, largest = path.name, memory_limit(path.stat().st_size)
        load_library("asammdf", "mdf", path)
        with path.open("rb") as stream:
            check_blocks(Content(stream, path.stat().st_size), file)
        with _measurement(path) as measurement:
            columns: list[Column] = []
            timeless: list[str] = []
            for index in range(len(measurement.groups)):
                with reading(f"{file}: group {index + 1}", "an MDF file"):
                    clock = _clock(measurement, index, file, largest)
                    found = list(_columns(measurement, index, clock, path))
                    columns += found
                    if found and clock is None:
                        timeless += [f"{column.fallback_name}" for column in found]
            columns = [column for column in columns if column.clock.count]
            notes = (f"left out, as they have no time: {', '.join(timeless)}",) if timeless else ()
            return assemble_table(columns, file, largest, notes)


@contextmanager
def _measurement(path: Path) -> Iterator[Any]:
    """Open a file; one that was never finished is put right in memory."""
    with path.open("rb") as stream:
        unfinished = stream.read(8) == MAGIC[1]
        stream.seek(0)
        with reading(path.name, "an MDF file"), _closing_what_was_begun():
            measurement = load_library("asammdf", "mdf", path).MDF(BytesIO(stream.read()) if unfinished else stream)
            measurement.configure(read_fragment_size=_AT_ONCE)
        with closing(measurement):
            yield measurement


@contextmanager
def _closing_what_was_begun() -> Iterator[None]:
    """Close what the library gives up halfway: by itself it would complain on standard error, long afterwards."""
    try:
        yield
    except Exception as error:
        for frame, _ in walk_tb(error.__traceback__):
            partial_reader: Any = frame.f_locals.get("self")
            if hasattr(partial_reader, "_closed"):
                vars(partial_reader).update(
                    {name: None for name in ("header", "identification") if not hasattr(partial_reader, name)}
                )
                with suppress(Exception):
                    partial_reader.close()
        raise


def _clock(measurement: Any, index: int, file: str, largest: float) -> ChannelClock | None:
    """Return the clock of a group; None where it has none or no samples."""
    group = measurement.groups[index]
    count, size = group.channel_group.cycles_nr, group.channel_group.samples_byte_nr
    if index not in measurement.masters_db or not count or not size:
        return None
    where = f"{file}: group {index + 1}"
    whole = size + getattr(group.channel_group, "invalidation_bytes_nr", 0)
    check_declared_size(count * max(1, -(-whole // 8)), where, largest)
    _refuse_misfit(group, where)
    master = group.channels[measurement.masters_db[index]]
    if getattr(master, "sync_type", _SYNC_TIME) != _SYNC_TIME:
        return None  # over angle or distance
    times = np.asarray(measurement.get_master(index), dtype=np.float64)
    if len(times) < count:
        raise truncation_error(where, f"the times of {len(times)} of {count} samples")
    return clock_from_times(TIME_UNITS.get(_unit(master).lower(), 1.0) * times)


def _refuse_misfit(group: Any, where: str) -> None:
    """Check that the channels lie within the records, and the records within the data; the library does not."""
    record = group.channel_group
    held = sum(int(block.original_size) for block in group.data_blocks)
    if held < record.cycles_nr * record.samples_byte_nr:
        raise truncation_error(where, f"{held} bytes of {record.cycles_nr} samples")
    for channel in group.channels:
        if hasattr(channel, "start_offset"):  # version 3
            begin, bits = channel.additional_byte_offset + channel.start_offset // 8, channel.start_offset % 8
            within = True
        else:
            begin, bits = channel.byte_offset, channel.bit_offset
            within = not channel.flags & _INVALIDATED or channel.pos_invalidation_bit < 8 * record.invalidation_bytes_nr
        if not within or begin + (bits + channel.bit_count + 7) // 8 > record.samples_byte_nr:
            found = f"channel '{channel.name}' at byte {begin} of records of {record.samples_byte_nr} bytes"
            raise input_error(where, found, "channels within the records", AGAIN)


def _columns(measurement: Any, index: int, clock: ChannelClock | None, path: Path) -> Iterator[Column]:
    group = measurement.groups[index]
    source = getattr(group.channel_group, "acq_name", "") or f"group {index + 1}"
    nothing = ChannelClock(0.0, 0.0, 0, None, np.empty(0))
    clock = clock or nothing
    numbers = [number for number in range(len(group.channels)) if number != measurement.masters_db.get(index)]
    store = _store(path, index, numbers, clock.count)
    for column, channel in enumerate(group.channels[number] for number in numbers):
        name = str(channel.name).strip()
        samples = Samples(store, column) if _is_number(channel, group, numbers[column]) else None
        yield Column(name, f"{source}.{name}", _unit(channel) or None, clock, samples)


def _is_number(channel: Any, group: Any, index: int) -> bool:
    """Return whether the samples of a channel, converted, are single numbers."""
    kind, version_3 = channel.dtype_fmt, hasattr(channel, "start_offset")
    words = channel.data_type in _WORDS_3 if version_3 else channel.data_type > _LAST_NUMBER_4
    if (
        words
        or kind is None
        or kind.subdtype is not None
        or kind.kind not in "fiub"
        or group.channel_dependencies[index]
    ):
        return False
    converted = channel.conversion.convert(np.zeros(1, kind)) if channel.conversion else np.zeros(1, kind)
    return bool(converted.ndim == 1 and converted.dtype.kind in "fiub")


def _unit(channel: Any) -> str:
    stated = (getattr(channel.conversion, "unit", ""), getattr(channel, "unit", ""))
    return next((text.strip() for text in stated if isinstance(text, str) and text.strip()), "")


def _store(path: Path, group: int, channels: Sequence[int], length: int) -> Store:
    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        with _measurement(path) as measurement:
            for begin, end in split_range(first, last, step):
                values = np.empty((len(columns), end - begin))
                own = [channels[column] for column in columns]
                with reading(f"{path.name}: group {group + 1}", "an MDF file"):
                    place = 0
                    for records in _records(measurement, group, begin, end - begin):
                        for row, channel in zip(values, own, strict=True):
                            samples = _samples(measurement, group, channel, records)[: end - begin - place]
                            row[place : place + len(samples)] = samples
                        place += len(samples)
                    if place < end - begin:
                        raise truncation_error(
                            f"{path.name}: group {group + 1}", f"{begin + place} of {length} samples"
                        )
                yield values

    return Store(len(channels), length, read)


def _records(measurement: Any, group: int, first: int, count: int) -> Iterator[Any]:
    """Yield the records of a range, once for all channels: the library itself would read them again for each channel."""
    found: Iterator[Any] = measurement._mdf._load_data(
        measurement.groups[group], record_offset=first, record_count=count
    )
    return found


def _samples(measurement: Any, group: int, channel: int, records: Any) -> NDArray[np.float64]:
    """Return the samples of a channel from records; NaN where they are invalid or were converted to text."""
    samples, invalid = measurement.get(
        group=group, index=channel, samples_only=True, ignore_invalidation_bits=True, data=records
    )
    if samples.ndim != 1 or samples.dtype.kind not in "fiub":
        return np.full(len(samples), np.nan)
    values: NDArray[np.float64] = samples.astype(np.float64)
    if invalid is not None:
        values[np.asarray(invalid, dtype=bool)] = np.nan
    return values
