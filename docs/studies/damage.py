"""What can happen to a file on its way, done to files that were sound."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Sequence
from random import Random

LARGEST = 1 << 16
"""Bytes of a spoilt file, at the most."""

_NUMBERS: tuple[int, ...] = (
    0,
    1,
    2,
    3,
    7,
    8,
    127,
    128,
    255,
    256,
    4096,
    10**6,
    10**7,
    2**15,
    2**16 - 1,
    2**31 - 1,
    2**31,
    2**32 - 1,
    2**40,
)
_NUMBERS += (2**62, 2**63 - 1, 2**63, 2**64 - 8, 2**64 - 1)
_DOUBLES = (0.0, -0.0, 1.0, -1.0, 1e-310, 1e-30, 1e9, 1e30, 1e300, float("inf"), float("-inf"), float("nan"))
_WORDS = (
    *("nan", "inf", "-inf", "1e999", "-1e308", "1e-320", "0", "-1", "99999999999999999999", "1_0", "0x10", "١", "1,5", "1.5"),
    *("", " ", ",", ";", "\t", "|", "\n", "\r\n", "\r", "\0", '"', "'", "#", "%", ":", "[", "]", "[ms]", "(g)", "\ufeff", "\x1b[2J"),  # noqa: E501
    *("time", "t", "Zeit", "fs", "dt", "unit", "name", "g", "m/s²", "ms", "V", "Sample rate: 500 Hz", "Abtastrate 2,048 kHz"),
    *("12:00:00.5", "23:59:59", "2026-11-20 10:00:00", "NOVALUE", "n/a", "MATLAB", "{", "}", "é", "\u2028", "ß" * 300),
)  # fmt: skip
_DIGITS = re.compile(rb"\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")


def _place(data: bytearray, random: Random) -> int:
    """Choose a place, at the beginning more often than elsewhere, for headers stand there."""
    return int(len(data) * random.random() ** random.choice((1, 1, 3)))


def _flip(data: bytearray, random: Random) -> None:
    for _ in range(random.choice((1, 1, 2, 5))):
        if data:
            data[min(_place(data, random), len(data) - 1)] ^= 1 << random.randrange(8)


def _byte(data: bytearray, random: Random) -> None:
    if data:
        data[min(_place(data, random), len(data) - 1)] = random.randrange(256)


def _integer(data: bytearray, random: Random) -> None:
    size = random.choice((1, 2, 4, 8))
    value = (random.choice(_NUMBERS) + random.choice((0, 0, 0, 1, -1))) % (1 << 8 * size)
    place = _place(data, random) // random.choice((1, size)) * random.choice((1, size))
    data[place : place + size] = value.to_bytes(size, random.choice(("little", "little", "big")))


def _double(data: bytearray, random: Random) -> None:
    place = _place(data, random) // 8 * random.choice((1, 8))
    written = struct.pack(random.choice(("<d", ">d", "<f")), random.choice((*_DOUBLES[:4], *_DOUBLES[-3:])))
    data[place : place + len(written)] = written


def _number(data: bytearray, random: Random) -> None:
    """Write another number where one stands as text."""
    found = list(_DIGITS.finditer(bytes(data)))
    if found:
        match = random.choice(found[: random.choice((10, len(found)))])
        other = random.choice((str(random.choice(_NUMBERS)), repr(random.choice(_DOUBLES)), random.choice(_WORDS)))
        data[match.start() : match.end()] = other.encode()


def _word(data: bytearray, random: Random) -> None:
    place = _place(data, random)
    word = random.choice(_WORDS).encode(random.choice(("utf-8", "utf-8", "utf-16-le", "cp1252")), "ignore")
    data[place : place + random.choice((0, len(word)))] = word


def _cut(data: bytearray, random: Random) -> None:
    del data[_place(data, random) :]


def _gone(data: bytearray, random: Random) -> None:
    place = _place(data, random)
    del data[place : place + random.choice((1, 2, 4, 8, 64, 512))]


def _again(data: bytearray, random: Random) -> None:
    """Repeat a part, once or many times."""
    place = _place(data, random)
    part = bytes(data[place : place + random.choice((1, 4, 16, 128, 1024))])
    times = random.choice((1, 2, 10, 200))
    if len(part) * times < LARGEST:
        data[place:place] = part * times


def _line(data: bytearray, random: Random) -> None:
    """Move a line, drop it or write it twice."""
    lines = bytes(data).split(b"\n")
    one = lines.pop(random.randrange(len(lines)))
    for _ in range(random.choice((0, 1, 1, 2))):
        lines.insert(random.randrange(len(lines) + 1), one)
    data[:] = b"\n".join(lines)


def _noise(data: bytearray, random: Random) -> None:
    """Write something random over all that follows a place, or a part of it."""
    place = _place(data, random)
    length = min(random.choice((4, 16, 256, 4096)), len(data) - place)
    data[place : place + length] = random.randbytes(length)


_KINDS: Sequence[Callable[[bytearray, Random], None]] = (
    *(_flip, _flip, _byte, _integer, _integer, _double, _number, _number, _word, _word),
    *(_cut, _gone, _again, _line, _noise),
)


def spoilt(files: Sequence[bytes], random: Random) -> bytes:
    """Return a damaged copy of a sound file.

    Parameters
    ----------
    files
        Those to start from.
    random
        Chooses what happens.
    """
    data = bytearray(random.choice(files))
    if random.random() < 0.1:  # the beginning of one, the end of another
        other = random.choice(files)
        data[_place(data, random) :] = other[_place(bytearray(other), random) :]
    for _ in range(random.choice((1, 1, 1, 2, 3, 6))):
        random.choice(_KINDS)(data, random)
    return bytes(data[:LARGEST])
