"""MDF files of versions 3 and 4, of measurement and calibration tools (ASAM)."""

from __future__ import annotations

import struct
import zlib
from contextlib import closing, contextmanager, suppress
from io import BytesIO
from traceback import walk_tb
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from sprung.recording.formats.axes import Clock, Column, one_table, stamped
from sprung.recording.formats.clock import TIME_UNITS
from sprung.recording.formats.optional import library
from sprung.recording.formats.refusals import allowance, contained, cut_short, refuse, refuse_too_large
from sprung.recording.formats.store import Samples, Store, steps

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.recording.formats.table import Table

_SUFFIXES = frozenset((".mdf", ".mf3", ".mf4", ".dat"))
_MAGIC = (b"MDF     ", b"UnFinMF ")
_HEADER = 64
_SYNC_TIME = 1
_INVALIDATED = 1 << 1
_WORDS_3, _LAST_NUMBER_4 = (7, 8), 5
"""Types of data: text and bytes of version 3, the last that is a real number of version 4."""
_AT_ONCE = 1 << 22
"""Bytes of records that are read together."""
_AGAIN = "The file is damaged: copy or export the recording again."
# Which links of a block lead on, by their index: to the next of its kind, to its parts, or to its data.
_LINKS_4 = {
    b"##HD": (0, 1, 2, 3, 4),
    b"##DG": (0, 1, 2),
    b"##CG": (0, 1, 4),
    b"##CN": (0, 1, 5),
    b"##CA": (0,),
    b"##CH": (0, 1),
    b"##FH": (0,),
    b"##AT": (0,),
    b"##EV": (0,),
    b"##SR": (0, 1),
    b"##HL": (0,),
}
_LISTS_4 = (b"##DL", b"##LD")
_LINKS_3 = {b"HD": (0,), b"DG": (0, 1), b"CG": (0, 1), b"CN": (0,)}


class MdfFormat:
    """MDF files with a time channel in every group."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the mark of the format."""
        return path.suffix.lower() in _SUFFIXES and head.startswith(_MAGIC)

    def read(self, path: Path) -> Table:
        """Read one file.

        Raises
        ------
        InputError
            If asammdf is not installed, if the file is cut short or damaged, or if it has no channel over time.
        """
        file, largest = path.name, allowance(path.stat().st_size)
        library("asammdf", "mdf", path)
        with path.open("rb") as stream:
            _refuse_damaged(_Content(stream, path.stat().st_size), file)
        with _measurement(path) as measurement:
            columns: list[Column] = []
            timeless: list[str] = []
            for index in range(len(measurement.groups)):
                with contained(f"{file}: group {index + 1}", "MDF"):
                    clock = _clock(measurement, index, file, largest)
                    found = list(_columns(measurement, index, clock, path))
                    columns += found
                    if found and clock is None:
                        timeless += [f"{column.otherwise}" for column in found]
            columns = [column for column in columns if column.clock.count]
            notes = (f"left out, as they have no time: {', '.join(timeless)}",) if timeless else ()
            return one_table(columns, file, largest, notes)


@contextmanager
def _measurement(path: Path) -> Iterator[Any]:
    """Open a file; one that was never finished is put right in memory."""
    with path.open("rb") as stream:
        unfinished = stream.read(8) == _MAGIC[1]
        stream.seek(0)
        with contained(path.name, "MDF"), _closing_what_was_begun():
            measurement = library("asammdf", "mdf", path).MDF(BytesIO(stream.read()) if unfinished else stream)
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
            begun: Any = frame.f_locals.get("self")
            if hasattr(begun, "_closed"):
                vars(begun).update({name: None for name in ("header", "identification") if not hasattr(begun, name)})
                with suppress(Exception):
                    begun.close()
        raise


def _clock(measurement: Any, index: int, file: str, largest: float) -> Clock | None:
    """Give the clock of a group; None if it has none or no samples."""
    group = measurement.groups[index]
    count, size = group.channel_group.cycles_nr, group.channel_group.samples_byte_nr
    if index not in measurement.masters_db or not count or not size:
        return None
    where = f"{file}: group {index + 1}"
    whole = size + getattr(group.channel_group, "invalidation_bytes_nr", 0)
    refuse_too_large(count * max(1, -(-whole // 8)), where, largest)
    _refuse_misfit(group, where)
    master = group.channels[measurement.masters_db[index]]
    if getattr(master, "sync_type", _SYNC_TIME) != _SYNC_TIME:
        return None  # over angle or distance
    times = np.asarray(measurement.get_master(index), dtype=np.float64)
    if len(times) < count:
        raise cut_short(where, f"the times of {len(times)} of {count} samples")
    return stamped(TIME_UNITS.get(_unit(master).lower(), 1.0) * times)


def _refuse_misfit(group: Any, where: str) -> None:
    """See that the channels lie within the records, and the records within the data: the library trusts that they do."""
    record = group.channel_group
    held = sum(int(block.original_size) for block in group.data_blocks)
    if held < record.cycles_nr * record.samples_byte_nr:
        raise cut_short(where, f"{held} bytes of {record.cycles_nr} samples")
    for channel in group.channels:
        if hasattr(channel, "start_offset"):  # version 3
            begin, bits = channel.additional_byte_offset + channel.start_offset // 8, channel.start_offset % 8
            within = True
        else:
            begin, bits = channel.byte_offset, channel.bit_offset
            within = not channel.flags & _INVALIDATED or channel.pos_invalidation_bit < 8 * record.invalidation_bytes_nr
        if not within or begin + (bits + channel.bit_count + 7) // 8 > record.samples_byte_nr:
            found = f"channel '{channel.name}' at byte {begin} of records of {record.samples_byte_nr} bytes"
            raise refuse(where, found, "channels within the records", _AGAIN)


def _columns(measurement: Any, index: int, clock: Clock | None, path: Path) -> Iterator[Column]:
    group = measurement.groups[index]
    source = getattr(group.channel_group, "acq_name", "") or f"group {index + 1}"
    nothing = Clock(0.0, 0.0, 0, None, np.empty(0))
    clock = clock or nothing
    numbers = [number for number in range(len(group.channels)) if number != measurement.masters_db.get(index)]
    store = _store(path, index, numbers, clock.count)
    for column, channel in enumerate(group.channels[number] for number in numbers):
        name = str(channel.name).strip()
        samples = Samples(store, column) if _is_number(channel, group, numbers[column]) else None
        yield Column(name, f"{source}.{name}", _unit(channel) or None, clock, samples)


def _is_number(channel: Any, group: Any, index: int) -> bool:
    """Say whether the samples of a channel are single numbers, from what it is and from what they are turned into."""
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
            for begin, end in steps(first, last, step):
                values = np.empty((len(columns), end - begin))
                own = [channels[column] for column in columns]
                with contained(f"{path.name}: group {group + 1}", "MDF"):
                    place = 0
                    for records in _records(measurement, group, begin, end - begin):
                        for row, channel in zip(values, own, strict=True):
                            samples = _samples(measurement, group, channel, records)[: end - begin - place]
                            row[place : place + len(samples)] = samples
                        place += len(samples)
                    if place < end - begin:
                        raise cut_short(f"{path.name}: group {group + 1}", f"{begin + place} of {length} samples")
                yield values

    return Store(len(channels), length, read)


def _records(measurement: Any, group: int, first: int, count: int) -> Iterator[Any]:
    """Give the records of a range once for all channels: its own way, the library reads all of them for each channel."""
    found: Iterator[Any] = measurement._mdf._load_data(
        measurement.groups[group], record_offset=first, record_count=count
    )
    return found


def _samples(measurement: Any, group: int, channel: int, records: Any) -> NDArray[np.float64]:
    """Take the samples of a channel out of records, NaN where they are invalid or were turned into words."""
    samples, invalid = measurement.get(
        group=group, index=channel, samples_only=True, ignore_invalidation_bits=True, data=records
    )
    if samples.ndim != 1 or samples.dtype.kind not in "fiub":
        return np.full(len(samples), np.nan)
    values: NDArray[np.float64] = samples.astype(np.float64)
    if invalid is not None:
        values[np.asarray(invalid, dtype=bool)] = np.nan
    return values


class _Content:
    """The bytes of a file, read where they are asked for."""

    def __init__(self, stream: BinaryIO, size: int) -> None:
        self._stream, self._size = stream, size

    def __len__(self) -> int:
        return self._size

    def at(self, address: int, count: int) -> bytes:
        """Give as many bytes from an address on, or those that there are."""
        self._stream.seek(min(address, self._size))
        return self._stream.read(min(count, self._size))


def _refuse_damaged(content: _Content, file: str) -> None:
    """Go through the blocks of a file, which the library would follow for ever where they lead back to themselves."""
    links = _links_3 if content.at(_HEADER, 2) == b"HD" else _links_4
    seen: set[int] = set()
    ahead = [_HEADER]
    while ahead:
        address = ahead.pop()
        where = f"{file}: byte {address}"
        if address in seen:
            raise refuse(where, "a block that is met twice", "blocks that do not lead back to themselves", _AGAIN)
        seen.add(address)
        own, shared = links(content, address, where)
        ahead += own
        ahead += (other for other in shared if other not in seen)


def _links_4(content: _Content, address: int, where: str) -> tuple[list[int], list[int]]:
    """Give the blocks that a block of a version 4 file leads to, those of its own and those that others may share."""
    if address + 24 > len(content):
        raise cut_short(where, f"a file of {len(content)} bytes")
    kind, _, length, count = struct.unpack("<4sIQQ", content.at(address, 24))
    if not kind.startswith(b"##") or (address == _HEADER) != (kind == b"##HD"):
        raise refuse(where, "something else", "the beginning of a block", _AGAIN)
    # Where recording was broken off, the last block of data does not know its length, which the library restores.
    unfinished = content.at(0, 8) == _MAGIC[1]
    if (not 24 <= length <= len(content) - address and not unfinished) or 24 + 8 * count > min(
        max(length, 24), len(content)
    ):
        raise cut_short(where, f"a block of {length} bytes with {count} links in a file of {len(content)}")
    if kind == b"##DZ":
        _refuse_misinflated(content, address, where)
    wanted = range(count) if kind in _LISTS_4 else [link for link in _LINKS_4.get(kind, ()) if link < count]
    targets = [struct.unpack("<Q", content.at(address + 24 + 8 * link, 8))[0] for link in wanted]
    if kind == b"##CN" and len(targets) == 3 and content.at(targets[2], 4) != b"##CG":
        return [target for target in targets[:2] if target], [target for target in targets[2:] if target]
    return [target for target in targets[: 2 if kind == b"##CN" else None] if target], []


def _links_3(content: _Content, address: int, where: str) -> tuple[list[int], list[int]]:
    """Give the blocks that a block of a version 3 file leads to."""
    if address + 12 > len(content):
        raise cut_short(where, f"a file of {len(content)} bytes")
    kind, length, *links = struct.unpack("<2sH2I", content.at(address, 12))
    if kind not in _LINKS_3 or (address == _HEADER) != (kind == b"HD"):
        raise refuse(where, "something else", "the beginning of a block", _AGAIN)
    if address + length > len(content):
        raise cut_short(where, f"a block of {length} bytes in a file of {len(content)}")
    return [links[link] for link in _LINKS_3[kind] if links[link]], []


def _refuse_misinflated(content: _Content, address: int, where: str) -> None:
    """See that a compressed block holds what it declares: the library trusts that it does."""
    if address + 48 > len(content):
        raise cut_short(where, f"a file of {len(content)} bytes")
    kind, _, _, size, packed = struct.unpack("<BBIQQ", content.at(address + 26, 22))
    if kind not in (0, 1):
        return  # compressed in another way than by deflation
    refuse_too_large(-(-size // 8), where, allowance(len(content)))
    try:
        held = len(zlib.decompressobj().decompress(content.at(address + 48, packed), size + 1))
    except zlib.error as error:
        raise refuse(where, f"compressed data that is no such ({error})", "sound data", _AGAIN) from error
    if held != size:
        raise refuse(where, f"{held} bytes or more where {size} are declared", "as many", _AGAIN)
