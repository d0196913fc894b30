"""MATLAB's files of version 4, read here: SciPy's reader makes room for what they declare before it looks for it.

A file is a row of matrices: five integers, which say what numbers it is made of, its two sides, whether it is complex and
how long its name is; then the name and the numbers, column by column. After "MAT-File Format" (The MathWorks, 2019).
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

from sprung.formats.mat5 import Bytes, Element, numbers, words
from sprung.formats.nested import Foreign, Node

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats.reading_errors import MemoryBudget

_HEADER = 20
_KINDS = (("f8", 9), ("f4", 7), ("i4", 5), ("i2", 3), ("u2", 4), ("u1", 2))
"""What numbers there are, and what version 5 calls them."""
_FULL, _WORDS, _SPARSE = 0, 1, 2


def variables(path: Path, budget: MemoryBudget) -> dict[str, Node]:
    """Find all variables; their numbers stay where they are.

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
    ValueError, struct.error
        If the file is damaged.
    """
    found: dict[str, Node] = {}
    size, place = path.stat().st_size, 0
    with path.open("rb") as stream:
        order = "<" if struct.unpack("<i", stream.read(4))[0] in range(1000) else ">"
        source = Bytes(stream, lambda: path.open("rb"), order, path)
        while place < size:
            stream.seek(place)
            sort, rows, columns, is_complex, letters = struct.unpack(order + "5i", stream.read(_HEADER))
            made_of, what = sort // 10 % 100, sort % 10
            sound = sort // 1000 == (order == ">") and made_of < len(_KINDS) and what <= _SPARSE
            if not (sound and min(rows, columns) >= 0 and is_complex in (0, 1) and 0 < letters < size):
                raise ValueError("something else where a variable should begin")
            name = stream.read(letters).partition(b"\0")[0].decode("latin-1")
            dtype, kind = _KINDS[made_of]
            values = Element(kind, place + _HEADER + letters, rows * columns * int(dtype[1]))
            # A sparse matrix keeps its imaginary parts in a column of their own.
            place = values.start + values.size * (1 + (is_complex and what != _SPARSE))
            if place > size:
                raise ValueError("it ends within a variable")
            if what == _SPARSE or is_complex:
                found[name] = Foreign("a sparse matrix" if what == _SPARSE else "complex numbers")
            elif what == _WORDS:
                budget.take(values.size * 8)
                codes = np.frombuffer(source.content(values), order + dtype).astype(np.int64)
                found[name] = words("".join(map(chr, codes % 0x110000)), (rows, columns))
            else:
                found[name] = numbers(source, values, (rows, columns), budget)
    return found
