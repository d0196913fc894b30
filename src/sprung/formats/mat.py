"""MATLAB's files: version 4 by `mat4`, versions 5 to 7 by `mat5`, version 7.3, which is HDF5 inside, by h5py."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats import mat4, mat5
from sprung.formats.hdf5 import PER_OBJECT, SIGNATURE, is_elsewhere, named
from sprung.formats.hdf5_datasets import lazy_numbers, read_dataset
from sprung.formats.libraries import load_library
from sprung.formats.nested import DEEPEST, Foreign, Node
from sprung.formats.reading_errors import MemoryBudget, reading
from sprung.formats.vectors import table_from_nested

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from sprung.formats.table import SampleTable

_KIND = "a MATLAB file of vectors"
_DO = "In MATLAB, save the time in s and the channels as plain vectors, such as t = seconds(tt.Time) and a = tt.a."
_BYTE_ORDERS = frozenset((b"IM", b"MI"))
_KINDS = frozenset(("", "double", "single", "logical", "int8", "int16", "int32", "int64", "uint8", "uint16"))
_KINDS |= {"uint32", "uint64", "char", "cell", "struct"}


class MatFormat:
    """MATLAB's files of every version; version 7.3 needs h5py."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and either MATLAB's header or, of version 4, which has none, a sound first number."""
        version = int.from_bytes(head[:4], "little"), int.from_bytes(head[:4], "big")
        old = len(head) >= 20 and any(number < 5000 and number % 10 < 3 for number in version)
        named = head.startswith(b"MATLAB") or head[126:128] in _BYTE_ORDERS
        signed = head.startswith(SIGNATURE)
        return path.suffix.lower() == ".mat" and (named or old) and not signed

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If it is damaged, holds no recording, or is of version 7.3 and h5py is missing.
        """
        with path.open("rb") as file:
            head = file.read(mat5.HEADER)
        if head[126:128] not in _BYTE_ORDERS:
            return table_from_nested(_read(mat4.variables, path), path, _DO)
        new = head[124:126] in {b"\0\x02", b"\x02\0"}
        return table_from_nested(_read_7_3(path) if new else _read(mat5.variables, path), path, _DO)


def _read(variables: Callable[[Path, MemoryBudget], dict[str, Node]], path: Path) -> Node:
    with reading(path.name, _KIND):
        return variables(path, MemoryBudget(path))


def _words(rows: list[str]) -> Node:
    return rows[0].strip() if len(rows) == 1 else [row.strip() for row in rows]


def _read_7_3(path: Path) -> Node:
    h5py = load_library("h5py", "hdf5", path)
    budget = MemoryBudget(path)
    with reading(path.name, _KIND), h5py.File(path, "r") as file:
        items = {name: _linked(file, name) for name in named(file) if not name.startswith("#")}
        return {name: _item(h5py, path, item, budget, 0) for name, item in items.items()}


def _linked(group: Any, name: str) -> Any:
    """Return an object that a group names; MATLAB writes no links, and one to another file is not followed."""
    item = group[name]
    if is_elsewhere(item, group):
        raise ValueError(f"{name} is a link to another file")
    return item


def _item(h5py: Any, path: Path, item: Any, budget: MemoryBudget, depth: int) -> Node:
    """Bring what h5py gives into plain form: what MATLAB calls it stands in an attribute."""
    budget.take(PER_OBJECT)
    said = item.attrs.get("MATLAB_class", b"")
    kind = said.decode("utf-8", "replace") if isinstance(said, bytes) else str(said)
    foreign = "MATLAB_object_decode" in item.attrs or "MATLAB_sparse" in item.attrs or kind not in _KINDS
    if foreign or depth > DEEPEST:
        return Foreign(f"an object of class {kind}, which only MATLAB can read")
    if isinstance(item, h5py.Group):
        return _struct({name: _item(h5py, path, _linked(item, name), budget, depth + 1) for name in named(item)})
    if item.shape is None or "MATLAB_empty" in item.attrs:
        return np.empty(0)
    is_list = h5py.check_ref_dtype(item.dtype) is not None
    if item.external or item.is_virtual or not (is_list or kind == "char"):
        return Foreign("complex numbers") if item.dtype.names else lazy_numbers(item, path, budget, transposed=True)
    values = read_dataset(item, budget)
    if is_list:
        children = [_item(h5py, path, item.file[ref], budget, depth + 1) for ref in values.flat if ref]
        return children if kind == "cell" else _Array(children)
    rows = np.atleast_2d(values.T).astype(np.uint16).tolist()
    return _words(["".join(map(chr, row)) for row in rows])


class _Array(list[Node]):
    """One field of an array of structs: a value for each."""


def _struct(fields: dict[str, Node]) -> Node:
    """Turn an array of structs, which such files keep field by field, into structs."""
    lengths = {len(field) if isinstance(field, _Array) else 0 for field in fields.values()}
    if len(lengths) != 1 or lengths == {0}:
        return fields
    columns = {name: field for name, field in fields.items() if isinstance(field, _Array)}
    return [{name: column[index] for name, column in columns.items()} for index in range(lengths.pop())]
