"""Bytes of a sound file written over or cut off, and what its reader may make of that: a table, or a refusal in words."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from hypothesis import strategies as st

from sprung.errors import InputError
from sprung.formats.registry import Format


class Spoiling(NamedTuple):
    """What happens to a file.

    Attributes
    ----------
    changes
        Where, as a part of the file, which bytes are written over what stands there.
    end
        The part that is left of it; None for all.
    """

    changes: list[tuple[float, bytes]]
    end: float | None

    def of(self, content: bytes) -> bytes:
        """Return what is left of a sound file."""
        spoilt = bytearray(content)
        for place, by in self.changes:
            start = int(place * len(content))
            spoilt[start : start + len(by)] = by
        return bytes(spoilt if self.end is None else spoilt[: int(self.end * len(spoilt))])


def spoilings(until: float = 1.0) -> st.SearchStrategy[Spoiling]:
    """Return anything that may happen, nothing written over after some part of the file."""
    places = st.floats(0, until, exclude_max=True)
    changes = st.lists(st.tuples(places, st.binary(min_size=1, max_size=8)), max_size=4)
    return st.builds(Spoiling, changes, st.one_of(st.none(), st.floats(0, 1)))


def read_or_refused(reader: Format, path: Path) -> None:
    """Check that a file gives a whole table, or problems that name it and say what to do."""
    try:
        table = reader.read(path)
        values = table.take()
    except InputError as error:
        problems = error.problems
    else:
        assert values.shape == (len(set(table.channels)), len(table.time))
        return
    assert all(problem.where.startswith(path.name) and problem.do for problem in problems)
