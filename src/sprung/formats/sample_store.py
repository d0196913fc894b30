"""Columns of numbers that stay in their file until they are read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, chain
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sprung.errors import Problem

Read: TypeAlias = Callable[[Sequence[int], int, int, int], Iterator[NDArray[np.float64]]]
"""``read(columns, first, last, step)``: the samples from first up to last, last excluded, of some columns in any order,
in pieces of step samples that follow one another, the last one shorter; each of shape (column, time)."""

BUDGET = 1 << 25
"""Bytes of the pieces in which a whole is read."""


def _find_none(column: int, first: int, last: int) -> None:
    """Return None: every sample is a number, or missing."""


@dataclass(frozen=True, eq=False)
class Store:
    """Columns of one length.

    Attributes
    ----------
    width, length
        Number of columns, and of the samples of each.
    read
        Gives samples, NaN where there is no number. Nothing of the file need be open between two calls. Raises an
        InputError if the file is damaged there.
    find_non_number
        ``find_non_number(column, first, last)``: what stands in that part of a column that is no number; None if nothing does.
    """

    width: int
    length: int
    read: Read
    find_non_number: Callable[[int, int, int], Problem | None] = _find_none


class Samples(NamedTuple):
    """One column of a store."""

    store: Store
    column: int

    def all(self) -> NDArray[np.float64]:
        """Return every sample; shape (time,)."""
        length = self.store.length
        return next(self.store.read([self.column], 0, length, length))[0] if length else np.empty(0)

    def pieces(self) -> Iterator[NDArray[np.float64]]:
        """Return an iterator over the samples, piece by piece, each of shape (time,)."""
        return (piece[0] for piece in self.store.read([self.column], 0, self.store.length, BUDGET // 8))


def split_range(first: int, last: int, step: int) -> Iterator[tuple[int, int]]:
    """Cut a range into parts of a length, the last one shorter."""
    return ((begin, min(begin + step, last)) for begin in range(first, last, step))


def store_by_ranges(
    width: int, length: int, get: Callable[[Sequence[int], int, int], NDArray[np.float64]], at_once: int = BUDGET // 8
) -> Store:
    """Return a store of which any range can be read at once.

    Parameters
    ----------
    width, length
        Number of columns and of samples.
    get
        ``get(columns, first, last)``: their samples, shape (column, time).
    at_once
        How many samples it is asked for at the most.
    """

    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        for begin, end in split_range(first, last, step):
            if end - begin <= at_once:
                yield get(columns, begin, end)
                continue
            values = np.empty((len(columns), end - begin))
            for low, high in split_range(begin, end, at_once):
                values[:, low - begin : high - begin] = get(columns, low, high)
            yield values

    return Store(width, length, read)


def samples_per_read(size: int) -> int:
    """Return the number of samples to read at once, from the bytes that one takes in the file."""
    return max((BUDGET >> 3) // max(size, 1), 1)


def store_in_memory(values: NDArray[np.generic]) -> Store:
    """Return a store of numbers in memory.

    Parameters
    ----------
    values
        Shape (column, time).
    """

    def get(columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        with np.errstate(invalid="ignore"):  # of what is no number
            return values[list(columns), first:last].astype(np.float64)

    return store_by_ranges(len(values), values.shape[1], get)


def missing_samples(length: int, problem: Problem) -> Samples:
    """Return a column without a single number.

    Parameters
    ----------
    length
        Number of samples.
    problem
        Why there is none.
    """
    missing = store_by_ranges(1, length, lambda columns, first, last: np.full((len(columns), last - first), np.nan))
    return Samples(Store(1, length, missing.read, lambda _column, _first, _last: problem), 0)


def join_samples(members: Sequence[Samples]) -> Store:
    """Return one store of columns of one length from any number of stores.

    Parameters
    ----------
    members
        The columns, one or more.
    """

    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        rows: dict[int, list[int]] = {}
        for row, column in enumerate(columns):
            rows.setdefault(id(members[column].store), []).append(row)
        reading = [
            (own, members[columns[own[0]]].store.read([members[columns[row]].column for row in own], first, last, step))
            for own in rows.values()
        ]
        for begin, end in split_range(first, last, step):
            values = np.empty((len(columns), end - begin))
            for own, pieces in reading:
                values[own] = next(pieces)
            yield values

    def find_non_number(column: int, first: int, last: int) -> Problem | None:
        return members[column].store.find_non_number(members[column].column, first, last)

    return Store(len(members), members[0].store.length, read, find_non_number)


def select_ranges(store: Store, ranges: Sequence[tuple[int, int]]) -> Store:
    """Return a store of the samples in some ranges of another, one range after the other.

    Parameters
    ----------
    store
        The other.
    ranges
        From which sample up to which, last excluded.
    """
    ends = list(accumulate(last - first for first, last in ranges))
    places = [(end - (high - low), low, high) for end, (low, high) in zip(ends, ranges, strict=True)]

    def within(first: int, last: int) -> list[tuple[int, int]]:
        cut = [(max(low, first - begin + low), min(high, last - begin + low)) for begin, low, high in places]
        return [(low, high) for low, high in cut if low < high]

    def get(columns: Sequence[int], first: int, last: int) -> NDArray[np.float64]:
        read = (store.read(columns, low, high, high - low) for low, high in within(first, last))
        return np.concatenate([np.empty((len(columns), 0)), *chain.from_iterable(read)], axis=1)

    def find_non_number(column: int, first: int, last: int) -> Problem | None:
        found = (store.find_non_number(column, low, high) for low, high in within(first, last))
        return next((problem for problem in found if problem is not None), None)

    length = ends[-1] if ends else 0
    return Store(store.width, length, store_by_ranges(store.width, length, get).read, find_non_number)


def regroup(pieces: Iterable[NDArray[np.float64]], step: int) -> Iterator[NDArray[np.float64]]:
    """Cut and join pieces of any lengths to ones of step samples, the last one shorter."""
    held: list[NDArray[np.float64]] = []
    count = 0
    for piece in pieces:
        held.append(piece)
        count += piece.shape[1]
        if count >= step:
            together = np.concatenate(held, axis=1) if len(held) > 1 else piece
            yield from (together[:, end - step : end] for end in range(step, count + 1, step))
            held, count = [together[:, count - count % step :]], count % step
    if count:
        yield np.concatenate(held, axis=1)
