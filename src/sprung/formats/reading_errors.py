"""Refusing a file: with one problem, before it fills the memory, and whatever a library raises over it."""

from __future__ import annotations

import errno
import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem

if TYPE_CHECKING:
    from pathlib import Path


LARGEST = 10
"""How many times the file's size its content may take up in memory..."""

SPARE = 50_000_000
"""...besides this many bytes, which any machine has."""


def memory_limit(size: int) -> int:
    """Return the bytes of memory that reading a file may take, from its size in bytes."""
    return LARGEST * size + SPARE


def check_declared_size(numbers: int, file: str, largest: float) -> None:
    """Refuse a file that declares more numbers than it can hold, before they are read.

    Raises
    ------
    InputError
        If they would take more than the largest number of bytes.
    """
    if 8.0 * numbers > largest:
        found, do = f"{numbers} declared samples", "It is damaged: export the recording again."
        raise input_error(file, found, "no more samples than a file of its size can hold", do)


def input_error(where: str, found: str, expected: str, do: str) -> InputError:
    """Return the error of a single problem."""
    return InputError([Problem(where, found, expected, do)])


def truncation_error(where: str, found: str) -> InputError:
    """Return the error of a file that ends too early."""
    return input_error(where, found, "a complete file", "It is cut short: copy or export the recording again.")


@contextmanager
def reading(where: str, kind: str) -> Iterator[None]:
    """Turn whatever a library raises over a file into an `InputError`; its warnings and log messages are silenced.

    Parameters
    ----------
    where
        Name of the file, or of a part of it.
    kind
        What the file should be, such as ``a WAV file``.

    Raises
    ------
    InputError
        If the block raises anything.
    """
    level = logging.root.manager.disable
    with warnings.catch_warnings(), np.errstate(invalid="ignore"):
        warnings.simplefilter("ignore")
        logging.disable(logging.CRITICAL)
        try:
            yield
        except InputError:
            raise
        except Exception as error:
            if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
                found = "content for which the memory is not sufficient"
                do = "Cut the recording to a few seconds before and after each drop, or lower its sampling rate."
                raise input_error(where, found, f"{kind} that fits into the memory", do) from error
            reason = " ".join(str(error).split()) or type(error).__name__
            found = f"a damaged file ({reason[:200]})"
            raise input_error(where, found, kind, "Copy or export it again, or in another format.") from error
        finally:
            logging.disable(level)


class MemoryBudget:
    """Memory that the content of one file may take up.

    Parameters
    ----------
    path
        The file.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.name
        self._size = path.stat().st_size
        self._left = memory_limit(self._size)

    def take(self, count: int) -> None:
        """Reserve some bytes.

        Raises
        ------
        InputError
            If so much is not left.
        """
        self._left -= count
        if self._left < 0:
            found = f"{self._size} bytes that declare content of more than {LARGEST} times their size"
            do = "Export it again, uncompressed and with this recording only."
            raise input_error(self._file, found, "a file about as large as its recording", do)
