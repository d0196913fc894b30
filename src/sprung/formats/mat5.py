"""MATLAB's files of versions 5 to 7, read here: SciPy's reader trusts what they say and ends the process over damage.

A file is a row of elements, type and size and then so many bytes; an array is an element made of elements: what kind
of array it is, its sides, its name, and then its numbers, its letters or the arrays in it. After "MAT-File Format"
(The MathWorks, 2019).
"""

from __future__ import annotations

import struct
import zlib
from contextlib import nullcontext
from tempfile import SpooledTemporaryFile
from typing import TYPE_CHECKING, BinaryIO, NamedTuple, cast

import numpy as np

from sprung.formats.nested import DEEPEST, Foreign, Node, Numbers
from sprung.formats.reading_errors import reading
from sprung.formats.sample_store import Samples, Store, samples_per_read, store_by_ranges

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.reading_errors import MemoryBudget

HEADER = 128
_ARRAY, _COMPRESSED = 14, 15
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_LETTERS = {1: "latin-1", 2: "latin-1", 16: "utf-8"}
_LONG_LETTERS = {4: "utf-16", 17: "utf-16", 18: "utf-32"}
_CELL, _STRUCT, _CHAR, _OPAQUE, _NUMERIC = 1, 2, 4, 17, range(6, 16)
_OBJECT = "an object, which only MATLAB can read"
_OTHERS = {3: _OBJECT, 5: "a sparse matrix", 16: "a function", _OPAQUE: _OBJECT}
_COMPLEX = 0x0800
_PER_ARRAY = 300
"""Bytes that an array takes up besides its numbers: an empty one in a file takes up 8."""


_IN_MEMORY = 1 << 22
"""Bytes of unpacked variables that are kept in memory; more of them go to a temporary file."""
_KIND = "a MATLAB file of vectors"


def variables(path: Path, budget: MemoryBudget) -> dict[str, Node]:
    """Find all variables; their numbers stay where they are, those of compressed ones are unpacked.

    Parameters
    ----------
    path
        The file.
    budget
        What they may take up.

    Returns
    -------
    dict
        By name.

    Raises
    ------
    InputError
        If they take up more.
    ValueError, KeyError, IndexError, struct.error, zlib.error
        If the file is damaged.
    """
    found: dict[str, Node] = {}
    unpacked = _Unpacked()
    with path.open("rb") as stream:
        order = "<" if stream.read(HEADER)[126:] == b"IM" else ">"
        plain = Bytes(stream, lambda: path.open("rb"), order, path)
        packed = plain._replace(stream=unpacked.stream, again=lambda: nullcontext(unpacked.stream))
        for element in _elements(plain, HEADER, path.stat().st_size):
            inside = [(plain, element)]
            if element.kind == _COMPRESSED:
                begin, end = unpacked.add(plain, element, budget)
                inside = [(packed, inner) for inner in _elements(packed, begin, end)]
            for source, inner in inside:
                if inner.kind != _ARRAY:
                    raise ValueError(f"a variable of unknown type {inner.kind}")
                name, node = _array(source, inner, budget, 0)
                if name:  # what has none is MATLAB's own
                    found[name] = node
    return found


class Element(NamedTuple):
    """What kind of element, and where its content stands."""

    kind: int
    start: int
    size: int


class Bytes(NamedTuple):
    """Where elements stand: open now, and to be opened again when numbers are asked for."""

    stream: BinaryIO
    again: Callable[[], AbstractContextManager[BinaryIO]]
    order: str
    path: Path

    def content(self, element: Element) -> bytes:
        """Read what an element holds."""
        self.stream.seek(element.start)
        return self.stream.read(element.size)

    def integers(self, element: Element) -> tuple[int, ...]:
        """Read an element of 32-bit integers."""
        return struct.unpack(f"{self.order}{element.size // 4}i", self.content(element))


class _Unpacked:
    """What was compressed, one variable after the other."""

    def __init__(self) -> None:
        # Closed when nobody holds a variable of it any more.
        self.stream = cast("BinaryIO", SpooledTemporaryFile(_IN_MEMORY))  # noqa: SIM115

    def __del__(self) -> None:
        self.stream.close()

    def add(self, source: Bytes, element: Element, budget: MemoryBudget) -> tuple[int, int]:
        """Unpack a variable, and say where it begins and ends."""
        begin = self.stream.seek(0, 2)
        size = held = 0
        for piece in _inflated(source.stream, element):
            if not held:
                size = 8 + struct.unpack(source.order + "II", piece[:8])[1]
                budget.take(size)
            held += len(piece)
            if held > size:
                break
            self.stream.write(piece)
        if held != size:
            raise ValueError("a variable is not as long as it says")
        return begin, begin + held


def _inflated(stream: BinaryIO, element: Element) -> Iterator[bytes]:
    """Unpack an element piece by piece."""
    zipped, left, most = zlib.decompressobj(), element.size, 1 << 20
    stream.seek(element.start)
    while not zipped.eof:
        data = zipped.unconsumed_tail
        if not data:
            data = stream.read(min(left, most))
            left -= len(data)
        piece = zipped.decompress(data, most)
        if piece:
            yield piece
        elif not data:
            break


def _elements(source: Bytes, place: int, end: int) -> Iterator[Element]:
    """Yield the elements that follow each other."""
    while place < end:
        source.stream.seek(place)
        kind, size = struct.unpack(source.order + "II", source.stream.read(8))
        start, step = place + 8, 8 + (size if kind == _COMPRESSED else -(-size // 8) * 8)
        if kind >> 16:  # the short form: size and type in one word, up to four bytes in the other
            kind, size, start, step = kind & 0xFFFF, kind >> 16, place + 4, 8
        if start + size > min(end, place + step):
            raise ValueError("it ends within a variable")
        yield Element(kind, start, size)
        place += step


def _array(source: Bytes, element: Element, budget: MemoryBudget, depth: int) -> tuple[str, Node]:
    """Return the name and the content of an array."""
    budget.take(_PER_ARRAY)
    if not element.size:
        return "", np.empty(0)
    if depth > DEEPEST:
        raise ValueError("its structs are nested too deeply")
    parts = _elements(source, element.start, element.start + element.size)
    flags = struct.unpack_from(source.order + "I", source.content(next(parts)))[0]
    kind = flags & 0xFF
    sides = () if kind == _OPAQUE else source.integers(next(parts))
    name = source.content(next(parts)).decode("latin-1")
    if kind in _OTHERS or flags & _COMPLEX:
        return name, Foreign(_OTHERS.get(kind, "complex numbers"))
    if min(sides, default=0) < 0:
        raise ValueError("an array with a negative side")
    if kind == _STRUCT:
        return name, _structs(source, parts, budget, depth)
    if kind == _CELL:
        return name, [_array(source, part, budget, depth + 1)[1] for part in parts]
    values = next(parts, Element(2, element.start, 0))
    if kind == _CHAR:
        budget.take(values.size)
        return name, words(_decoded(source.content(values), values.kind, source.order), sides)
    if kind not in _NUMERIC:
        raise ValueError(f"an array of unknown kind {kind}")
    return name, numbers(source, values, sides, budget)


def numbers(source: Bytes, values: Element, sides: Sequence[int], budget: MemoryBudget) -> Node:
    """Return an array of numbers: read where it is small, otherwise its rows and columns, still in the file."""
    dtype = np.dtype(source.order + _NUMBERS[values.kind])
    count, rest = divmod(values.size, dtype.itemsize)
    if rest or count != int(np.prod(sides, dtype=object)):
        raise ValueError(f"{values.size} bytes of an array of sides {sides}")
    budget.take(8 * count)
    if count <= 1:
        return np.frombuffer(source.content(values), dtype)
    shape = tuple(side for side in sides if side != 1)
    again, path = source.again, source.path

    def along(side: int) -> list[Samples]:
        store = _store(again, path, (values.start, dtype), shape if side == 0 else shape[::-1], upright=side == 0)
        return [Samples(store, column) for column in range(store.width)]

    return Numbers(shape, along)


def _store(
    again: Callable[[], AbstractContextManager[BinaryIO]],
    path: Path,
    written: tuple[int, np.dtype[np.generic]],
    shape: tuple[int, ...],
    upright: bool,
) -> Store:
    """Return a store of numbers that stand column after column, or with the samples of all columns side by side."""
    (start, dtype), length, width = written, shape[0], shape[1] if len(shape) == 2 else 1

    def taken(stream: BinaryIO, place: int, count: int) -> NDArray[np.generic]:
        stream.seek(start + place * dtype.itemsize)
        return np.frombuffer(stream.read(count * dtype.itemsize), dtype, count)

    def get(columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        with reading(path.name, _KIND), again() as stream:
            if upright:
                rows = [taken(stream, column * length + first, last - first) for column in columns]
                return np.array(rows, dtype=np.float64)
            block = taken(stream, first * width, (last - first) * width).reshape(last - first, width)
            return block.T[list(columns)].astype(np.float64)

    return store_by_ranges(width, length, get, samples_per_read(dtype.itemsize * (1 if upright else width)))


def _decoded(letters: bytes, written: int, order: str) -> str:
    encoding = _LETTERS.get(written) or _LONG_LETTERS[written] + ("-le" if order == "<" else "-be")
    return letters.decode(encoding, "replace")


def _structs(source: Bytes, parts: Iterator[Element], budget: MemoryBudget, depth: int) -> Node:
    [width] = source.integers(next(parts))
    if width < 1:
        raise ValueError("names of no length")
    names = source.content(next(parts))
    fields = [names[at : at + width].split(b"\0")[0].decode("latin-1") for at in range(0, len(names), width)]
    nodes = [_array(source, part, budget, depth + 1)[1] for part in parts]
    if not fields:
        return {}
    starts = range(0, len(nodes), len(fields))
    structs: list[Node] = [dict(zip(fields, nodes[at : at + len(fields)], strict=True)) for at in starts]
    return structs[0] if len(structs) == 1 else structs


def words(letters: str, sides: tuple[int, ...]) -> Node:
    """Return the rows of a matrix of letters, which stand column by column."""
    rows = sides[0] if sides and sides[0] > 1 else 1
    words = [letters[row::rows].strip() for row in range(min(rows, len(letters)))]
    return words if len(words) > 1 else "".join(words)
