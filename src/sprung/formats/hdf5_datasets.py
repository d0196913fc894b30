"""HDF5 datasets that stay unread until somebody asks for some of their columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats.libraries import load_library
from sprung.formats.nested import Foreign, Node, Numbers, non_numeric_kind
from sprung.formats.reading_errors import MemoryBudget, reading
from sprung.formats.sample_store import Samples, Store, samples_per_read, split_range

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_UNPACKED = 1 << 20
"""Bytes of every open dataset that its library keeps unpacked."""


def read_dataset(dataset: Any, budget: MemoryBudget) -> NDArray[Any]:
    """Read a whole dataset, of few numbers or of something else.

    Parameters
    ----------
    dataset
        Of h5py.
    budget
        What it may take up.

    Raises
    ------
    InputError
        If it takes up more.
    """
    if dataset.shape is None:
        return np.empty(0)
    budget.take(dataset.size * (dataset.dtype.itemsize + 8))
    chunk = dataset.chunks or ()
    budget.take(int(np.prod(chunk, dtype=object)) * dataset.dtype.itemsize)
    return np.asarray(dataset[()])


def lazy_numbers(dataset: Any, path: Path, budget: MemoryBudget, transposed: bool = False) -> Node:
    """Leave numbers in their file; single ones are read.

    Parameters
    ----------
    dataset
        Of h5py.
    path
        The file.
    budget
        What its numbers may take up together: a file that says it holds more is damaged.
    transposed
        Whether the file keeps the last side first, as MATLAB does.

    Returns
    -------
    Node
        Numbers; by name, where the dataset is a table with named fields.

    Raises
    ------
    InputError
        If they take up more.
    """
    if dataset.external or dataset.is_virtual:
        return Foreign("numbers in another file")
    if dataset.dtype.names:
        return _fields(dataset, path, budget)
    if (other := non_numeric_kind(dataset.dtype)) is not None:
        return Foreign(other)
    return read_dataset(dataset, budget) if dataset.size <= 1 else _numbers(dataset, path, budget, transposed)


def _numbers(dataset: Any, path: Path, budget: MemoryBudget, transposed: bool) -> Numbers:
    budget.take(8 * dataset.size)
    extent, chunks, size, name = tuple(dataset.shape), dataset.chunks, dataset.dtype.itemsize, dataset.name
    sides = [side for side, count in enumerate(extent) if count != 1]
    sides = sides[::-1] if transposed else sides

    def along(side: int) -> list[Samples]:
        time, across = sides[side], sides[1 - side] if len(sides) == 2 else None
        width = 1 if across is None else extent[across]
        # Columns that lie apart in the file are read one by one, others with whatever lies between them.
        apart = across is not None and (chunks[across] == 1 if chunks else across < time)

        def get(source: Any, columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
            window: list[Any] = [0] * len(extent)
            window[time] = slice(first, last)
            found: dict[int, NDArray[Any]] = {}
            spans = [(column, column + 1) for column in columns] if apart else [(min(columns), max(columns) + 1)]
            for begin, end in spans:
                if across is not None:
                    window[across] = slice(begin, end)
                block = np.atleast_2d(source[tuple(window)])
                found |= zip(range(begin, end), block.T if across is not None and across > time else block, strict=True)
            return np.array([found[column] for column in columns], dtype=np.float64)

        at_once = samples_per_read(size if apart else size * width)
        chunk = chunks[time] if chunks else 1
        store = _store(path, name, (width, extent[time]), get, max(at_once // chunk, 1) * chunk)
        return [Samples(store, column) for column in range(width)]

    return Numbers(tuple(extent[side] for side in sides), along)


def _fields(dataset: Any, path: Path, budget: MemoryBudget) -> Node:
    """Leave a table in its file, whose rows are samples and whose fields are one number or several."""
    rows = dataset.dtype
    if len(dataset.shape) != 1 or dataset.size <= 1:
        values = read_dataset(dataset, budget)
        return {name: values[name] for name in rows.names}
    budget.take(8 * dataset.size * sum(max(int(np.prod(rows[name].shape)), 1) for name in rows.names))
    places = [
        (name, place)
        for name in rows.names
        if non_numeric_kind(rows[name].base) is None
        for place in range(int(np.prod(rows[name].shape)))
    ]

    def get(source: Any, columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        read = source[first:last]
        found = [read[name].reshape(len(read), -1)[:, place] for name, place in (places[column] for column in columns)]
        return np.array(found, dtype=np.float64)

    store = _store(path, dataset.name, (len(places), dataset.size), get, samples_per_read(rows.itemsize))
    node: dict[str, Node] = {}
    for name in rows.names:
        own = [Samples(store, column) for column, (field, _) in enumerate(places) if field == name]
        vectors = [_vector(samples) for samples in own]
        foreign = Foreign(non_numeric_kind(rows[name].base) or "fields without numbers")
        node[name] = vectors[0] if len(vectors) == 1 else vectors or foreign
    return node


def _vector(samples: Samples) -> Numbers:
    return Numbers((samples.store.length,), lambda _side: [samples])


def _store(
    path: Path, name: str, size: tuple[int, int], get: Callable[..., NDArray[np.float64]], at_once: int
) -> Store:
    """Return a store of a dataset, which stays open from piece to piece: its library keeps what it unpacked that long."""

    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        kind = "an HDF5 file"
        with reading(path.name, kind):
            file = load_library("h5py", "hdf5", path).File(path, "r", rdcc_nbytes=_UNPACKED)
        with file:
            with reading(path.name, kind):
                source = file[name]
            for begin, end in split_range(first, last, step):
                values = np.empty((len(columns), end - begin))
                with reading(path.name, kind):
                    for low, high in split_range(begin, end, at_once):
                        values[:, low - begin : high - begin] = get(source, columns, low, high)
                yield values

    return Store(*size, read)
