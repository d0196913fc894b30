"""Which files of a folder sprung wrote, and whether they are still as it wrote them: a list of checksums beside them.

Only such files are replaced without being asked. The list is hidden and belongs to one folder; it says nothing of any file
that it does not name, and a file that was edited is the user's from then on.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Mapping
from typing import TYPE_CHECKING

from sprung.errors import InputError, Problem

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

MANIFEST = ".sprung-files.json"
"""Name of the list, in every folder that sprung writes into."""

_INSIST = "Choose another folder, move them away, or replace them on purpose: --force, in Python overwrite=True."


def checksum(content: bytes) -> str:
    """Return the SHA-256 of the content of a file, as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def read_manifest(folder: Path) -> dict[str, str]:
    """Return the checksum of every file that sprung wrote into a folder, by name; empty where there is no readable list."""
    try:
        files = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"]
        return {name: entry for name, entry in files.items() if isinstance(entry, str)}
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return {}  # a file that is not in the list counts as the user's, which is safe


def manifest_text(files: Mapping[str, str]) -> str:
    """Return the list of checksums as it is written."""
    about = "Files that sprung wrote here, with SHA-256: those that are unchanged may be replaced by another run."
    return json.dumps({"about": about, "files": dict(sorted(files.items()))}, indent=1, ensure_ascii=False) + "\n"


def is_unchanged(folder: Path, name: str) -> bool:
    """Return whether a file exists, was written by sprung, and has not been changed since."""
    try:
        return read_manifest(folder).get(name) == checksum((folder / name).read_bytes())
    except OSError:
        return False


def overwriting_problems(folder: Path, files: Collection[str] | Mapping[str, bytes]) -> Iterator[Problem]:
    """Yield the problems that forbid writing some files into a folder.

    Parameters
    ----------
    folder
        Where they are to be written; need not exist.
    files
        Their names, relative to the folder, with or without the content that they are to have: a file that has it already
        may be replaced by it.

    Yields
    ------
    Problem
        The files that sprung did not write, or that were changed since; or that the folder cannot be written to.
    """
    contents = files if isinstance(files, Mapping) else {}
    known, foreign = read_manifest(folder), []
    for name in files:
        try:
            there = (folder / name).read_bytes()
        except OSError:
            continue  # none there, or one that cannot be replaced either: writing will say why
        if known.get(name) != checksum(there) and contents.get(name) != there:
            foreign.append(f"{name} ({'changed since sprung wrote it' if name in known else 'not written by sprung'})")
    if foreign:
        found = f"{len(foreign)} file{'s' * (len(foreign) > 1)} that would be overwritten: {', '.join(foreign)}"
        yield Problem(str(folder), found, "only files that sprung wrote and that are unchanged", _INSIST)
    place = next((path for path in (folder, *folder.absolute().parents) if path.exists()), folder)
    if not place.is_dir() or not os.access(place, os.W_OK):
        yield unwritable_folder(folder, "no permission")
        return
    try:
        with tempfile.TemporaryFile(dir=place):
            pass  # some file systems refuse new files whatever the permissions say
    except OSError as error:
        yield unwritable_folder(folder, error.strerror or str(error))


def unwritable_folder(folder: Path, why: str) -> Problem:
    """Return the problem of a folder that cannot be written to."""
    found = f"a place that cannot be written to ({why})"
    if any(path.is_file() for path in (folder, *folder.parents)):
        found = "a file where the folder should be"
    return Problem(str(folder), found, "a folder to write to", "Choose another folder, or check its permissions.")


def check_overwriting(folder: Path, files: Collection[str] | Mapping[str, bytes]) -> None:
    """Check, before any work is done, that only files written by sprung would be overwritten.

    Parameters
    ----------
    folder, files
        As for `overwriting_problems`.

    Raises
    ------
    InputError
        With the list of the files that would be overwritten.
    """
    problems = tuple(overwriting_problems(folder, files))
    if problems:
        raise InputError(problems)
