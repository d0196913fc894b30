"""HDF5 files: datasets in groups, with attributes beside them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats.hdf5_datasets import lazy_numbers
from sprung.formats.libraries import load_library
from sprung.formats.nested import DEEPEST, Foreign, Node
from sprung.formats.reading_errors import MemoryBudget, reading
from sprung.formats.vectors import table_from_nested

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats.table import SampleTable

SIGNATURE = b"\x89HDF\r\n\x1a\n"
PER_OBJECT = 1000
"""Bytes that one object in a file takes up at most, besides its numbers: a bound on files that lead in circles."""


_MOST_WORDS = 1000


class Hdf5Format:
    """HDF5 files of datasets that are vectors or matrices, in any groups; needs h5py."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the signature; MATLAB's files of version 7.3 are HDF5 too, and not claimed."""
        signed = any(head[start : start + len(SIGNATURE)] == SIGNATURE for start in (0, 512, 1024, 2048, 4096))
        endings = {".h5", ".hdf5", ".hdf", ".he5", ".h5py", ".nc", ".mat"}  # Octave writes plain HDF5 as .mat
        return signed and not head.startswith(b"MATLAB") and path.suffix.lower() in endings

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If it is damaged, holds no recording, or h5py is missing.
        """
        h5py = load_library("h5py", "hdf5", path)
        with reading(path.name, "an HDF5 file"), h5py.File(path, "r") as file:
            node = _group(h5py, file, MemoryBudget(path), {file}, path)
        return table_from_nested(node, path, "Write the time and the channels as one-dimensional datasets.")


def named(items: Any) -> list[str]:
    """Return the names in a group or among attributes, without those that are not text.

    Parameters
    ----------
    items
        Of h5py.
    """
    return [name for name in items if isinstance(name, str)]


def is_elsewhere(item: Any, group: Any) -> bool:
    """Return whether an object that a group names lies in another file: a soft link may lead through an external one."""
    return bool(item.file.filename != group.file.filename)


def _group(h5py: Any, group: Any, budget: MemoryBudget, seen: set[Any], path: Path, depth: int = 0) -> Node:
    budget.take(PER_OBJECT)
    if depth > DEEPEST:
        return Foreign("nested too deeply")
    node: dict[str, Node] = _attributes(h5py, group, budget)
    for name in named(group):
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            node[name] = Foreign("a link to another file")
            continue
        item = group.get(name)
        if item is not None and is_elsewhere(item, group):
            node[name] = Foreign("a link to another file")
            continue
        if item is None or item in seen:  # names may lead nowhere, in circles, or to one thing twice
            continue
        seen.add(item)
        if isinstance(item, h5py.Group):
            node[name] = _group(h5py, item, budget, seen, path, depth + 1)
        elif isinstance(item, h5py.Dataset):
            values = _dataset(h5py, item, budget, path)
            attributes = _attributes(h5py, item, budget)
            node[name] = {"": values, **attributes} if attributes else values
    return node


def _dataset(h5py: Any, dataset: Any, budget: MemoryBudget, path: Path) -> Node:
    budget.take(PER_OBJECT)
    if dataset.external or dataset.is_virtual:
        return Foreign("data in another file")
    if h5py.check_string_dtype(dataset.dtype) is not None:
        return _words(h5py, dataset, budget)
    if dataset.dtype.hasobject:
        return Foreign("references or lists of varying length")
    if dataset.shape is None:
        return np.empty(0)
    return lazy_numbers(dataset, path, budget)


def _words(h5py: Any, dataset: Any, budget: MemoryBudget) -> Node:
    if dataset.shape is None or len(dataset.shape) > 1:
        return Foreign("a table of text")
    if not dataset.shape:
        text: str = dataset.asstr("utf-8", "replace")[()]
        return text
    words: list[Node] = []
    if h5py.check_string_dtype(dataset.dtype).length is not None:
        budget.take(dataset.size * dataset.dtype.itemsize * 8)
        words.extend(dataset.asstr("utf-8", "replace")[()])
    else:
        for index in range(dataset.size):  # one by one, as nothing says how long they are
            budget.take(PER_OBJECT)
            words.append(dataset.asstr("utf-8", "replace")[index])
            budget.take(4 * len(str(words[-1])))
    return words


def _attributes(h5py: Any, item: Any, budget: MemoryBudget) -> dict[str, Node]:
    """Return the attributes that are text or single numbers."""
    node: dict[str, Node] = {}
    for name in named(item.attrs):
        identity = item.attrs.get_id(name)
        count = int(np.prod(identity.shape or (), dtype=object))
        budget.take(PER_OBJECT + 4 * count * identity.dtype.itemsize)
        is_text = h5py.check_string_dtype(identity.dtype) is not None
        if count > (_MOST_WORDS if is_text else 1) or not (is_text or identity.dtype.kind in "fiub"):
            continue
        value = item.attrs[name]
        if isinstance(value, h5py.Empty):
            continue
        values = np.asarray(value)
        if is_text:
            words = [word.decode("utf-8", "replace") if isinstance(word, bytes) else str(word) for word in values.flat]
            budget.take(4 * sum(map(len, words)))
            node[name] = words[0] if len(words) == 1 else list(words)
        else:
            node[name] = values
    return node
