"""Text files, read in blocks of whole lines."""

from __future__ import annotations

import codecs
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

BLOCK = 1 << 20
"""Bytes of a block; a longer line makes a longer one."""


class Encoding(NamedTuple):
    """What letters the bytes of a file are, and where they begin."""

    name: str
    start: int


class LineBlock(NamedTuple):
    """Whole lines of a file."""

    start: int
    """The byte with which they begin."""
    lines: list[str]
    """Without their ends."""


def detect_encoding(path: Path) -> Encoding:
    """Recognise UTF-16 by its mark, UTF-8 with or without; anything else is the Windows or the Latin alphabet.

    Parameters
    ----------
    path
        The file, which is gone through once.

    Raises
    ------
    UnicodeDecodeError
        If it is marked as UTF-16 and is none.
    """
    with path.open("rb") as stream:
        head = stream.read(4)
    for mark, name in ((codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")):
        if head.startswith(mark):
            _decode(path, name, len(mark))
            return Encoding(name, len(mark))
    start = len(codecs.BOM_UTF8) if head.startswith(codecs.BOM_UTF8) else 0
    for name in ("utf-8", "cp1252"):
        try:
            _decode(path, name, start if name == "utf-8" else 0)
        except UnicodeDecodeError:
            continue
        return Encoding(name, start if name == "utf-8" else 0)
    return Encoding("latin-1", 0)  # every byte is a character of it


def _decode(path: Path, encoding: str, start: int) -> None:
    """Check that a file can be decoded."""
    decoder = codecs.getincrementaldecoder(encoding)()
    plain = not encoding.startswith("utf-16")
    with path.open("rb") as stream:
        stream.seek(start)
        while data := stream.read(1 << 20):
            if not (plain and data.isascii() and decoder.getstate() == (b"", 0)):
                decoder.decode(data)
        decoder.decode(b"", final=True)


def read_blocks(path: Path, encoding: Encoding, start: int | None = None, size: int = BLOCK) -> Iterator[LineBlock]:
    r"""Yield the lines of a file block by block; ends of lines are ``\n``, ``\r\n`` or ``\r``.

    Parameters
    ----------
    path
        The file.
    encoding
        Its.
    start
        The byte to begin with, where a line begins; None for the beginning.
    size
        Bytes to read at once.
    """
    place = encoding.start if start is None else start
    rest = b""
    with path.open("rb") as stream:
        stream.seek(place)
        while True:
            wanted = max(size, len(rest))
            data = stream.read(wanted)
            whole = len(data) < wanted
            data = rest + data
            end = len(data) if whole else _last_end(data, encoding.name)
            if end:
                yield LineBlock(place, _lines(data[:end], encoding.name))
            if whole:
                return
            place, rest = place + end, data[end:]


def _last_end(data: bytes, encoding: str) -> int:
    r"""Return where the last line ends in some bytes; a last ``\r`` may yet be followed by ``\n``."""
    unit = len("\n".encode(encoding))
    for mark, spare in (("\n", 0), ("\r", unit)):
        end = len(data) - spare
        place = data.rfind(mark.encode(encoding), 0, end)
        while place > 0 and place % unit:
            place = data.rfind(mark.encode(encoding), 0, place + unit - 1)
        if place >= 0:
            return place + unit
    return 0


def _lines(data: bytes, encoding: str) -> list[str]:
    text = data.decode(encoding)
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    if not lines[-1]:
        lines.pop()
    return lines
