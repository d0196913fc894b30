"""MATLAB's files of versions 5 to 7, read here: SciPy's reader trusts what they say and ends the process over damage.

A file is a row of elements, type and size and then so many bytes; an array is an element made of elements: what kind
of array it is, its sides, its name, and then its numbers, its letters or the arrays in it. After "MAT-File Format"
(The MathWorks, 2019).
"""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

from sprung.recording.formats.nested import DEEPEST, Foreign, Node

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sprung.recording.formats.refusals import Allowance

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


def variables(content: bytes, allowance: Allowance) -> dict[str, Node]:
    """Read all variables.

    Parameters
    ----------
    content
        The whole file.
    allowance
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
    order = "<" if content[126:128] == b"IM" else ">"
    found: dict[str, Node] = {}
    for kind, part in _elements(memoryview(content)[HEADER:], order):
        inside = _elements(_inflated(part, order, allowance), order) if kind == _COMPRESSED else [(kind, part)]
        for inner, array in inside:
            if inner != _ARRAY:
                raise ValueError(f"a variable of unknown type {inner}")
            name, node = _array(array, order, allowance, 0)
            if name:  # what has none is MATLAB's own
                found[name] = node
    return found


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Give the types and contents of elements that follow each other."""
    place = 0
    while place < len(data):
        kind, size = struct.unpack_from(order + "II", data, place)
        start, step = place + 8, 8 + (size if kind == _COMPRESSED else -(-size // 8) * 8)
        if kind >> 16:  # the short form: size and type in one word, up to four bytes in the other
            kind, size, start, step = kind & 0xFFFF, kind >> 16, place + 4, 8
        if start + size > min(len(data), place + step):
            raise ValueError("it ends within a variable")
        yield kind, data[start : start + size]
        place += step


def _inflated(data: memoryview, order: str, allowance: Allowance) -> memoryview:
    zipped = zlib.decompressobj()
    head = zipped.decompress(data, 8)
    size = struct.unpack(order + "II", head)[1]
    allowance.take(size)
    rest = zipped.decompress(zipped.unconsumed_tail, size + 1)
    if len(rest) != size:
        raise ValueError("a variable is not as long as it says")
    return memoryview(head + rest)


def _array(data: memoryview, order: str, allowance: Allowance, depth: int) -> tuple[str, Node]:
    """Give the name and the content of an array."""
    allowance.take(_PER_ARRAY)
    if not data:
        return "", np.empty(0)
    if depth > DEEPEST:
        raise ValueError("its structs are nested too deeply")
    parts = _elements(data, order)
    flags = struct.unpack_from(order + "I", next(parts)[1])[0]
    kind = flags & 0xFF
    sides = () if kind == _OPAQUE else _integers(next(parts)[1], order)
    name = bytes(next(parts)[1]).decode("latin-1")
    if kind in _OTHERS or flags & _COMPLEX:
        return name, Foreign(_OTHERS.get(kind, "complex numbers"))
    if min(sides, default=0) < 0:
        raise ValueError("an array with a negative side")
    if kind == _STRUCT:
        return name, _structs(parts, order, allowance, depth)
    if kind == _CELL:
        return name, [_array(part, order, allowance, depth + 1)[1] for _, part in parts]
    written, values = next(parts, (2, memoryview(b"")))
    if kind == _CHAR:
        return name, _words(_decoded(bytes(values), written, order), sides)
    if kind not in _NUMERIC:
        raise ValueError(f"an array of unknown kind {kind}")
    numbers = np.frombuffer(values, dtype=order + _NUMBERS[written])
    allowance.take(8 * numbers.size)
    return name, numbers.reshape(sides, order="F")


def _decoded(letters: bytes, written: int, order: str) -> str:
    encoding = _LETTERS.get(written) or _LONG_LETTERS[written] + ("-le" if order == "<" else "-be")
    return letters.decode(encoding, "replace")


def _integers(data: memoryview, order: str) -> tuple[int, ...]:
    return struct.unpack(f"{order}{len(data) // 4}i", data)


def _structs(parts: Iterator[tuple[int, memoryview]], order: str, allowance: Allowance, depth: int) -> Node:
    [width] = _integers(next(parts)[1], order)
    if width < 1:
        raise ValueError("names of no length")
    names = bytes(next(parts)[1])
    fields = [names[at : at + width].split(b"\0")[0].decode("latin-1") for at in range(0, len(names), width)]
    nodes = [_array(part, order, allowance, depth + 1)[1] for _, part in parts]
    if not fields:
        return {}
    starts = range(0, len(nodes), len(fields))
    structs: list[Node] = [dict(zip(fields, nodes[at : at + len(fields)], strict=True)) for at in starts]
    return structs[0] if len(structs) == 1 else structs


def _words(letters: str, sides: tuple[int, ...]) -> Node:
    """Take letters apart that stand column by column, as those of a matrix do."""
    rows = sides[0] if sides and sides[0] > 1 else 1
    words = [letters[row::rows].strip() for row in range(min(rows, len(letters)))]
    return words if len(words) > 1 else "".join(words)
