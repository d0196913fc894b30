"""MDF files of versions 3 and 4, of measurement and calibration tools (ASAM)."""

from __future__ import annotations

import struct
import zlib
from contextlib import closing
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.recording.formats.axes import Clock, Column, one_table, stamped
from sprung.recording.formats.clock import TIME_UNITS
from sprung.recording.formats.optional import library
from sprung.recording.formats.refusals import allowance, contained, cut_short, refuse, refuse_too_large

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.recording.formats.table import Table

_SUFFIXES = frozenset((".mdf", ".mf3", ".mf4", ".dat"))
_MAGIC = (b"MDF     ", b"UnFinMF ")
_HEADER = 64
_SYNC_TIME = 1
_INVALIDATED = 1 << 1
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
        asammdf, file, content = library("asammdf", "mdf", path), path.name, path.read_bytes()
        _refuse_damaged(content, file)
        with contained(file, "MDF"):
            measurement = asammdf.MDF(BytesIO(content))
        with closing(measurement):
            columns: list[Column] = []
            timeless: list[str] = []
            for index in range(len(measurement.groups)):
                with contained(f"{file}: group {index + 1}", "MDF"):
                    clock = _clock(measurement, index, file, allowance(len(content)))
                    found = list(_columns(measurement, index, clock, file))
                    columns += found
                    if found and clock is None:
                        timeless += [f"{column.otherwise}" for column in found]
            columns = [column for column in columns if column.clock.count]
            notes = (f"left out, as they have no time: {', '.join(timeless)}",) if timeless else ()
            return one_table(columns, file, allowance(len(content)), notes)


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


def _columns(measurement: Any, index: int, clock: Clock | None, file: str) -> Iterator[Column]:
    group = measurement.groups[index]
    source = getattr(group.channel_group, "acq_name", "") or f"group {index + 1}"
    nothing = Clock(0.0, 0.0, 0, None, np.empty(0))
    for number, channel in enumerate(group.channels):
        if number == measurement.masters_db.get(index):
            continue
        name = str(channel.name).strip()
        read = _reader(measurement, index, number, f"{file}: channel '{name}'")
        yield Column(name, f"{source}.{name}", _unit(channel) or None, clock or nothing, read)


def _unit(channel: Any) -> str:
    stated = (getattr(channel.conversion, "unit", ""), getattr(channel, "unit", ""))
    return next((text.strip() for text in stated if isinstance(text, str) and text.strip()), "")


def _reader(measurement: Any, group: int, index: int, where: str) -> Callable[[], NDArray[np.float64] | None]:
    def read() -> NDArray[np.float64] | None:
        with contained(where, "MDF"):
            samples, invalid = measurement.get(
                group=group, index=index, samples_only=True, ignore_invalidation_bits=True
            )
            if samples.ndim != 1 or samples.dtype.kind not in "fiub":
                return None
            values: NDArray[np.float64] = samples.astype(np.float64)
            if invalid is not None:
                values[np.asarray(invalid, dtype=bool)] = np.nan
            return values

    return read


def _refuse_damaged(content: bytes, file: str) -> None:
    """Go through the blocks of a file, which the library would follow for ever where they lead back to themselves."""
    links = _links_3 if content[_HEADER : _HEADER + 2] == b"HD" else _links_4
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


def _links_4(content: bytes, address: int, where: str) -> tuple[list[int], list[int]]:
    """Give the blocks that a block of a version 4 file leads to, those of its own and those that others may share."""
    if address + 24 > len(content):
        raise cut_short(where, f"a file of {len(content)} bytes")
    kind, _, length, count = struct.unpack_from("<4sIQQ", content, address)
    if not kind.startswith(b"##") or (address == _HEADER) != (kind == b"##HD"):
        raise refuse(where, "something else", "the beginning of a block", _AGAIN)
    # Where recording was broken off, the last block of data does not know its length, which the library restores.
    unfinished = content.startswith(_MAGIC[1])
    if (not 24 <= length <= len(content) - address and not unfinished) or 24 + 8 * count > min(
        max(length, 24), len(content)
    ):
        raise cut_short(where, f"a block of {length} bytes with {count} links in a file of {len(content)}")
    if kind == b"##DZ":
        _refuse_misinflated(content, address, where)
    wanted = range(count) if kind in _LISTS_4 else [link for link in _LINKS_4.get(kind, ()) if link < count]
    targets = [struct.unpack_from("<Q", content, address + 24 + 8 * link)[0] for link in wanted]
    if kind == b"##CN" and len(targets) == 3 and content[targets[2] : targets[2] + 4] != b"##CG":
        return [target for target in targets[:2] if target], [target for target in targets[2:] if target]
    return [target for target in targets[: 2 if kind == b"##CN" else None] if target], []


def _links_3(content: bytes, address: int, where: str) -> tuple[list[int], list[int]]:
    """Give the blocks that a block of a version 3 file leads to."""
    if address + 12 > len(content):
        raise cut_short(where, f"a file of {len(content)} bytes")
    kind, length, *links = struct.unpack_from("<2sH2I", content, address)
    if kind not in _LINKS_3 or (address == _HEADER) != (kind == b"HD"):
        raise refuse(where, "something else", "the beginning of a block", _AGAIN)
    if address + length > len(content):
        raise cut_short(where, f"a block of {length} bytes in a file of {len(content)}")
    return [links[link] for link in _LINKS_3[kind] if links[link]], []


def _refuse_misinflated(content: bytes, address: int, where: str) -> None:
    """See that a compressed block holds what it declares: the library trusts that it does."""
    if address + 48 > len(content):
        raise cut_short(where, f"a file of {len(content)} bytes")
    kind, _, _, size, packed = struct.unpack_from("<BBIQQ", content, address + 26)
    if kind not in (0, 1):
        return  # compressed in another way than by deflation
    refuse_too_large(-(-size // 8), where, allowance(len(content)))
    try:
        held = len(zlib.decompressobj().decompress(content[address + 48 : address + 48 + packed], size + 1))
    except zlib.error as error:
        raise refuse(where, f"compressed data that is no such ({error})", "sound data", _AGAIN) from error
    if held != size:
        raise refuse(where, f"{held} bytes or more where {size} are declared", "as many", _AGAIN)
