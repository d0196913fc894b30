"""Files that are not what they say: refused as bad input, whatever a library raises, and before they fill the memory."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from sprung.errors import InputError, Problem

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

LARGEST = 10
"""How many times the file's size its content may take up in memory..."""

SPARE = 50_000_000
"""...besides this many bytes, which any machine has."""


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """Turn whatever a library raises over a file into bad input.

    Parameters
    ----------
    path
        The file.
    kind
        What it should be, ``a WAV file``.

    Raises
    ------
    InputError
        If the block raises anything.
    """
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        found = f"a damaged file ({reason[:200]})"
        raise InputError([Problem(path.name, found, kind, "Copy or export it again.")]) from error


class Allowance:
    """Memory that the content of one file may take up.

    Parameters
    ----------
    path
        The file.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.name
        self._size = path.stat().st_size
        self._left = LARGEST * self._size + SPARE

    def take(self, count: int) -> None:
        """Take some bytes of it.

        Raises
        ------
        InputError
            If so much is not left.
        """
        self._left -= count
        if self._left < 0:
            found = f"{self._size} bytes that say they hold more than {LARGEST} times as many"
            do = "Export it again, uncompressed and with this recording only."
            raise InputError([Problem(self._file, found, "a file about as large as its recording", do)])
