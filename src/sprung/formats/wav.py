"""WAV files, as sound recorders and some vibration loggers write them."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from sprung.errors import InputError, Problem
from sprung.formats.reading_errors import reading
from sprung.formats.sample_store import Store, samples_per_read, store_by_ranges
from sprung.formats.table import Table

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_KIND = "a WAV file of plain samples"
_ORDERS = {b"RIFF": "<", b"RF64": "<", b"RIFX": ">"}
_INTEGERS, _FLOATS, _EXTENSIBLE = 1, 3, 0xFFFE
_IN_64_BITS = 0xFFFFFFFF
"""The size that stands in a chunk whose size is given in 64 bits elsewhere."""


class WavFormat:
    """WAV files of integers or floating-point numbers, any number of channels, called ch1, ch2 and so on."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim RIFF files of sound by their ending and first bytes."""
        return head[:4] in _ORDERS and head[8:12] == b"WAVE" and path.suffix.lower() in {".wav", ".wave"}

    def read(self, path: Path) -> Table:
        """Read one file; integers become parts of full scale.

        Raises
        ------
        InputError
            If it is damaged or compressed, or holds no samples.
        """
        with reading(path, _KIND), path.open("rb") as stream:
            sound = _sound(stream, path.stat().st_size)
        if not sound.count or not sound.rate:
            found = f"{sound.count} samples at {sound.rate} Hz"
            raise InputError([Problem(path.name, found, _KIND, "Copy or export it again.")])
        note = "integers were divided by full scale; a WAV file does not say what full scale is in m/s²"
        return Table(
            channels=tuple(f"ch{index}" for index in range(1, sound.channels + 1)),
            units=(None,) * sound.channels,
            store=_store(path, sound),
            clock=float(sound.rate),
            notes=() if sound.floats else (note,),
        )


@dataclass(frozen=True)
class _Sound:
    """How the samples of a file are written, and where: width in bytes of one sample of one channel."""

    order: str
    floats: bool
    signed: bool
    width: int
    channels: int
    rate: int
    start: int
    count: int


def _sound(stream: BinaryIO, size: int) -> _Sound:
    """Go from chunk to chunk: one says how the samples are written, one holds them."""
    order = _ORDERS[stream.read(12)[:4]]
    form = b""
    long_size = 0
    place = 12
    while place + 8 <= size:
        stream.seek(place)
        name, length = struct.unpack(f"{order}4sI", stream.read(8))
        place += 8
        if name == b"ds64":
            long_size = struct.unpack(f"{order}QQ", stream.read(16))[1]
        elif name == b"fmt ":
            form = stream.read(min(length, 40))
        elif name == b"data":
            length = long_size if length == _IN_64_BITS and long_size else length
            if place + length > size:
                raise ValueError(f"{size - place} of {length} bytes of samples")
            return _written(order, form, place, length)
        place += length + length % 2
    raise ValueError("no samples in it")


def _written(order: str, form: bytes, start: int, length: int) -> _Sound:
    tag, channels, rate, _, block, bits = struct.unpack(f"{order}HHIIHH", form[:16])
    if tag == _EXTENSIBLE:
        (tag,) = struct.unpack(f"{order}H", form[24:26])
    if tag not in (_INTEGERS, _FLOATS) or not channels or block < channels or block % channels:
        raise ValueError(f"samples of kind {tag}, {block} bytes for {channels} channels")
    width = block // channels
    sound = (
        bits == 8 * width in (32, 64) if tag == _FLOATS else 1 <= bits <= 8 * width <= 64 and (bits > 8) == (width > 1)
    )
    if not sound:
        raise ValueError(f"samples of {bits} bits in {width} bytes")
    if length % block:
        raise ValueError("it ends within a sample")
    return _Sound(order, tag == _FLOATS, bits > 8, width, channels, rate, start, length // block)


def _store(path: Path, sound: _Sound) -> Store:
    block = sound.channels * sound.width

    def get(columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        with reading(path, _KIND), path.open("rb") as stream:
            stream.seek(sound.start + first * block)
            raw = _raw(stream.read((last - first) * block), sound).reshape(last - first, sound.channels)
            values = np.array([raw[:, column] for column in columns], dtype=np.float64)
        if sound.floats:
            return values
        # Unsigned samples lie around the middle of their range; those of 24 bits come in the upper ones of 32.
        half = 2.0 ** (8 * raw.itemsize - 1)
        values -= 0.0 if sound.signed else half
        values /= half
        return values

    return store_by_ranges(sound.channels, sound.count, get, samples_per_read(block))


def _raw(content: bytes, sound: _Sound) -> NDArray[np.generic]:
    """Take bytes for numbers; integers of other widths than computers have are put into the next larger ones."""
    kind = "f" if sound.floats else "i" if sound.signed else "u"
    container = next(size for size in (1, 2, 4, 8) if size >= sound.width)
    if container == sound.width:
        return np.frombuffer(content, f"{sound.order}{kind}{container}")
    narrow = np.frombuffer(content, np.uint8).reshape(-1, sound.width)
    padded = np.zeros((len(narrow), container), np.uint8)
    padded[:, slice(container - sound.width, None) if sound.order == "<" else slice(0, sound.width)] = narrow
    return padded.view(f"{sound.order}i{container}")[:, 0]
