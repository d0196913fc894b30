"""Files are written whole or not at all, however many belong together."""

from __future__ import annotations

import errno
import os
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sprung.errors import InputError, Problem

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


def write_whole(folder: str | os.PathLike[str], files: Mapping[str, bytes]) -> None:
    """Write several files that belong together: all of them, or none, leaving what was there as it was.

    Every file is written under a temporary name beside its place first; only when all of them are on the disk are the old
    ones put aside, the last one first, and do the new ones take their names, in the order given. Put the file last by which
    others find the rest: it is never there beside files that do not belong to it.

    Parameters
    ----------
    folder
        Where to; made if it does not exist.
    files
        Content by name, relative to the folder.

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    ValueError
        If a name leads out of the folder.
    """
    folder = Path(folder)
    places = [_Place.of(folder, name) for name in files]
    made = [path for place in places for path in _missing(place.target.parent)]
    placed: list[_Place] = []
    try:
        for place, content in zip(places, files.values(), strict=True):
            place.prepare(content)
        # First the one by which others find the rest: killed at any moment, this leaves all the old, all the new, or none.
        for place in reversed(places):
            place.put_aside()
        for place in places:
            place.take()
            placed.append(place)
    except BaseException as error:
        _undo(places, placed, made)
        if isinstance(error, OSError):
            raise InputError([_problem(folder, error)]) from error
        raise
    for place in places:
        place.old.unlink(missing_ok=True)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where one file goes, and its two temporary names beside it: of the new content, and of what was there."""

    target: Path
    new: Path
    old: Path

    @classmethod
    def of(cls, folder: Path, name: str) -> _Place:
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise ValueError(f"'{name}' leads out of the folder it should be written to")
        target = folder / name
        hidden = f".{target.name}.{secrets.token_hex(4)}"
        return cls(target, target.with_name(f"{hidden}.new"), target.with_name(f"{hidden}.old"))

    def prepare(self, content: bytes) -> None:
        if self.target.is_dir():
            raise IsADirectoryError(errno.EISDIR, f"a folder has the name {self.target.name}")
        self.target.parent.mkdir(parents=True, exist_ok=True)
        with self.new.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())  # a name must never stand for content that a power cut would lose

    def put_aside(self) -> None:
        if self.target.exists():
            self.target.replace(self.old)

    def take(self) -> None:
        self.new.replace(self.target)


def _undo(places: Sequence[_Place], placed: Sequence[_Place], made: Iterable[Path]) -> None:
    for place in placed:
        place.target.unlink()
    for place in places:
        if place.old.exists():
            place.old.replace(place.target)
        if place.new.exists():
            place.new.unlink()
    for folder in sorted(set(made), key=lambda path: len(path.parts), reverse=True):
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()


def _missing(folder: Path) -> list[Path]:
    """Give the folders that would have to be made."""
    return [path for path in (folder, *folder.parents) if not path.exists()]


def _problem(folder: Path, error: OSError) -> Problem:
    found = f"a place that cannot be written to ({error.strerror or error})"
    if any(path.is_file() for path in (folder, *folder.parents)):
        found = "a file where the folder should be"
    return Problem(str(folder), found, "a folder to write to", "Choose another folder, or see to its permissions.")
