"""The blocks of an MDF file: followed from one to the next before the library does, which trusts them."""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

from sprung.formats.reading_errors import check_declared_size, input_error, memory_limit, truncation_error

MAGIC = (b"MDF     ", b"UnFinMF ")
"""What a file begins with: one that was finished, and one that was not."""

AGAIN = "The file is damaged: copy or export the recording again."
_HEADER = 64
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


class Content:
    """The bytes of a file, read where they are asked for.

    Parameters
    ----------
    stream
        The file.
    size
        How many bytes it has.
    """

    def __init__(self, stream: BinaryIO, size: int) -> None:
        self._stream, self._size = stream, size

    def __len__(self) -> int:
        return self._size

    def at(self, address: int, count: int) -> bytes:
        """Return the bytes from an address on; fewer at the end of the file."""
        self._stream.seek(min(address, self._size))
        return self._stream.read(min(count, self._size))


def check_blocks(content: Content, file: str) -> None:
    """Check the blocks of a file, which the library would follow for ever where they refer to themselves.

    Parameters
    ----------
    content
        The file.
    file
        Name of the file, for messages.

    Raises
    ------
    InputError
        Where a block is damaged or cut short, with its place.
    """
    links = _links_3 if content.at(_HEADER, 2) == b"HD" else _links_4
    seen: set[int] = set()
    ahead = [_HEADER]
    while ahead:
        address = ahead.pop()
        where = f"{file}: byte {address}"
        if address in seen:
            raise input_error(where, "a block that is met twice", "blocks that do not lead back to themselves", AGAIN)
        seen.add(address)
        own, shared = links(content, address, where)
        ahead += own
        ahead += (other for other in shared if other not in seen)


def _links_4(content: Content, address: int, where: str) -> tuple[list[int], list[int]]:
    """Return the addresses to which a block of a version 4 file refers: its own blocks, and those that others may share."""
    if address + 24 > len(content):
        raise truncation_error(where, f"a file of {len(content)} bytes")
    kind, _, length, count = struct.unpack("<4sIQQ", content.at(address, 24))
    if not kind.startswith(b"##") or (address == _HEADER) != (kind == b"##HD"):
        raise input_error(where, "something else", "the beginning of a block", AGAIN)
    # Where recording was broken off, the last block of data does not know its length, which the library restores.
    unfinished = content.at(0, 8) == MAGIC[1]
    if (not 24 <= length <= len(content) - address and not unfinished) or 24 + 8 * count > min(
        max(length, 24), len(content)
    ):
        raise truncation_error(where, f"a block of {length} bytes with {count} links in a file of {len(content)}")
    if kind == b"##DZ":
        _refuse_misinflated(content, address, where)
    wanted = range(count) if kind in _LISTS_4 else [link for link in _LINKS_4.get(kind, ()) if link < count]
    targets = [struct.unpack("<Q", content.at(address + 24 + 8 * link, 8))[0] for link in wanted]
    if kind == b"##CN" and len(targets) == 3 and content.at(targets[2], 4) != b"##CG":
        return [target for target in targets[:2] if target], [target for target in targets[2:] if target]
    return [target for target in targets[: 2 if kind == b"##CN" else None] if target], []


def _links_3(content: Content, address: int, where: str) -> tuple[list[int], list[int]]:
    """Return the addresses to which a block of a version 3 file refers."""
    if address + 12 > len(content):
        raise truncation_error(where, f"a file of {len(content)} bytes")
    kind, length, *links = struct.unpack("<2sH2I", content.at(address, 12))
    if kind not in _LINKS_3 or (address == _HEADER) != (kind == b"HD"):
        raise input_error(where, "something else", "the beginning of a block", AGAIN)
    if address + length > len(content):
        raise truncation_error(where, f"a block of {length} bytes in a file of {len(content)}")
    return [links[link] for link in _LINKS_3[kind] if links[link]], []


def _refuse_misinflated(content: Content, address: int, where: str) -> None:
    """Check that a compressed block holds what it declares; the library does not."""
    if address + 48 > len(content):
        raise truncation_error(where, f"a file of {len(content)} bytes")
    kind, _, _, size, packed = struct.unpack("<BBIQQ", content.at(address + 26, 22))
    if kind not in (0, 1):
        return  # compressed in another way than by deflation
    check_declared_size(-(-size // 8), where, memory_limit(len(content)))
    try:
        held = len(zlib.decompressobj().decompress(content.at(address + 48, packed), size + 1))
    except zlib.error as error:
        raise input_error(where, f"compressed data that is no such ({error})", "sound data", AGAIN) from error
    if held != size:
        raise input_error(where, f"{held} bytes or more where {size} are declared", "as many", AGAIN)
