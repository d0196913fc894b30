"""What every file format returns: columns of numbers, their names and units, and a clock."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from sprung.display import shown
from sprung.formats.sample_store import BUDGET, Store

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from sprung.errors import Problem
    from sprung.formats.resampling import ResampledChannel


def sample_number(sample: int) -> str:
    """Return the number of a sample, from 1, as its place in the file."""
    return f"sample {sample + 1}"


@shown
@dataclass(frozen=True, eq=False)
class SampleTable:
    """The columns of one file. Their samples stay in the file until `take` or `pieces` read them.

    `take` reads some columns at once, all of them or those of a range; `pieces` goes through the file from its beginning
    to its end, and holds no more than a piece at a time. Both give float64 in the units of the file, NaN where it
    holds no number; `find_non_number` returns what stands there instead. All three raise an InputError where the
    file is damaged.

    Attributes
    ----------
    channels
        Names of the columns other than time, without their units.
    units
        Unit of each channel as stated in the file; None without one.
    store
        Reads their samples: `store.store_in_memory(values)` where a format has them in memory, shape (channel, time).
    clock
        Time of every sample on the file's clock, s, shape (time,); or one number, the samples per second of a format
        that keeps no times, whose clock then starts at 0.
    place
        Returns where in the file a sample stands: ``line 57``.
    notes
        What was done to read the file, in words.
    resampled
        Columns sampled by another clock, by their positions; they were interpolated to the times of this one.

    Examples
    --------
    >>> from sprung.formats.sample_store import store_in_memory
    >>> table = SampleTable(("a", "b"), ("g", None), store_in_memory(np.arange(10.0).reshape(2, 5)), clock=100.0)
    >>> table.samples, table.take([1]).tolist(), table.take([1, 0], 3, 5).tolist()
    (5, [[5.0, 6.0, 7.0, 8.0, 9.0]], [[8.0, 9.0], [3.0, 4.0]])
    >>> [(first, piece.tolist()) for first, piece in table.pieces([0], 2)]
    [(0, [[0.0, 1.0]]), (2, [[2.0, 3.0]]), (4, [[4.0]])]
    """

    channels: tuple[str, ...]
    units: tuple[str | None, ...]
    store: Store
    clock: NDArray[np.float64] | float
    place: Callable[[int], str] = sample_number
    notes: tuple[str, ...] = ()
    resampled: Mapping[int, ResampledChannel] = field(default_factory=dict)

    @property
    def samples(self) -> int:
        """Number of samples of every column."""
        return self.store.length

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of every sample, s; shape (time,)."""
        return self._times(0, self.samples)

    def take(
        self, columns: Sequence[int] | None = None, first: int = 0, last: int | None = None
    ) -> NDArray[np.float64]:
        """Read some columns.

        Parameters
        ----------
        columns
            Indices of the columns, in any order; None for all.
        first, last
            From which sample up to which, last excluded; None for the end.

        Returns
        -------
        ndarray
            Shape (column, time).

        Raises
        ------
        InputError
            If the file is damaged there.
        """
        columns = range(len(self.channels)) if columns is None else columns
        last = self.samples if last is None else last
        values = np.empty((len(columns), last - first))
        place = 0
        for piece in self._read(columns, first, last, 1):
            values[:, place : place + piece.shape[1]] = piece
            place += piece.shape[1]
        return values

    def pieces(
        self, columns: Sequence[int] | None = None, samples: int = 1 << 14
    ) -> Iterator[tuple[int, NDArray[np.float64]]]:
        """Yield some columns piece by piece, in memory that does not grow with the file.

        Parameters
        ----------
        columns
            Indices of the columns, in any order; None for all.
        samples
            How many a piece has; the last one has fewer.

        Yields
        ------
        first
            The sample with which the piece begins.
        values
            The piece, shape (column, time).

        Raises
        ------
        InputError
            If the file is damaged there.
        """
        columns = range(len(self.channels)) if columns is None else columns
        first = 0
        for read in self._read(columns, 0, self.samples, samples):
            for begin in range(0, read.shape[1], samples):
                yield first + begin, read[:, begin : begin + samples]
            first += read.shape[1]

    def part(self, first: int, last: int) -> SampleTable:
        """Return the samples from first up to last, last excluded, as a table; nothing is read."""

        def read(columns: Sequence[int], begin: int, end: int, step: int) -> Iterator[NDArray[np.float64]]:
            return self.store.read(columns, first + begin, first + end, step)

        def find_non_number(column: int, begin: int, end: int) -> Problem | None:
            return self.store.find_non_number(column, first + begin, first + end)

        return replace(
            self,
            store=Store(self.store.width, last - first, read, find_non_number),
            clock=self._times(first, last),
            place=lambda sample: self.place(first + sample),
            resampled={column: one.within(first, last) for column, one in self.resampled.items()},
        )

    def find_non_number(self, column: int, first: int = 0, last: int | None = None) -> Problem | None:
        """Return a problem for text in a column that is not a number; None where there is none, or where cells are only empty.

        A problem only where somebody needs the column. It may read the file again: ask where samples are missing.

        Parameters
        ----------
        column
            Index of the column.
        first, last
            From which sample up to which, last excluded; None for the end.

        Raises
        ------
        InputError
            If the file is damaged there.
        """
        return self.store.find_non_number(column, first, self.samples if last is None else last)

    def _read(self, columns: Sequence[int], first: int, last: int, samples: int) -> Iterator[NDArray[np.float64]]:
        """Read in pieces of a multiple of some samples, as long as a read is worth it."""
        samples_per_read = BUDGET // (8 * max(len(columns), 1))
        return (
            self.store.read(columns, first, last, max(samples_per_read // samples, 1) * samples)
            if columns
            else iter(())
        )

    def _times(self, first: int, last: int) -> NDArray[np.float64]:
        if isinstance(self.clock, np.ndarray):
            return self.clock[first:last]
        return np.arange(first, last) / self.clock
