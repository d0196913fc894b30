"""A lock on an output folder, which ends with its process, however that ends."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from sprung.errors import InputError, Problem

LOCK = ".sprung-lock"
"""Name of the locked file; it stays, empty, where no process holds it."""

_PLACE = 1 << 30
"""Byte that is locked on Windows, where a locked byte cannot be read: far behind the text."""


@contextmanager
def folder_lock(folder: str | os.PathLike[str]) -> Iterator[None]:
    """Hold the lock of an output folder.

    The operating system holds it for the open file and releases it when the process ends, also by SIGKILL.

    Parameters
    ----------
    folder
        Made if it does not exist.

    Yields
    ------
    None
        The block that writes to the folder runs here.

    Raises
    ------
    InputError
        If another process holds it, with the number of that process; or if the folder cannot be written to.
    """
    path = Path(folder) / LOCK
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = path.open("a+", encoding="utf-8")
    except OSError as error:
        found = f"a place that cannot be written to ({error.strerror or error})"
        do = "Choose another folder, or check its permissions."
        raise InputError([Problem(str(folder), found, "a folder to write to", do)]) from error
    with file:
        try:
            _lock(file)
        except OSError as error:
            file.seek(0)
            found = f"another run that writes here ({file.read().strip() or 'its process is not known'})"
            do = "Wait until it has ended, stop it, or choose another output folder. What it has finished is kept."
            raise InputError([Problem(str(folder), found, "one run at a time", do)]) from error
        _replace_text(file, f"process {os.getpid()} on {socket.gethostname()}")
        try:
            yield
        finally:
            _replace_text(file, "")


def _replace_text(file: IO[str], text: str) -> None:
    """Write who holds the lock; a full disk does not prevent the lock."""
    try:
        file.seek(0)
        file.truncate()
        file.write(text)
        file.flush()
    except OSError:
        return


if sys.platform == "win32":  # pragma: no cover
    import msvcrt

    def _lock(file: IO[str]) -> None:
        file.seek(_PLACE)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[str]) -> None:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
