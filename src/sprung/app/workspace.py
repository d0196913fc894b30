"""The folder that the page works in: names of its files in, checked paths out.

A name is relative to the folder, with ``/`` between its parts. Nothing outside the folder is read or written, whatever a name
contains and wherever a link leads.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from sprung.errors import InputError, Problem, SprungError
from sprung.files import new_token, recover, temporary_path

NEW = ""
"""Version of a file that does not exist."""

LARGEST_TEXT = 4_000_000
"""Largest text file that is read or written, bytes."""

_MOST = 20_000
"""Most entries of a listing."""

_DEEPEST = 5
"""Most folders between the workspace and an entry of a listing."""

_FORBIDDEN = re.compile(r'[\x00-\x1f\x7f\\<>:"|?*]')
"""Control characters, and what Windows does not permit in a name or takes for a drive, a stream or a separator."""


class OutsideError(SprungError, ValueError):
    """A name that leads out of the folder, or cannot be a name in it."""


class ChangedError(SprungError):
    """A file that was changed since the version to be replaced was read."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A file or folder of the workspace.

    Attributes
    ----------
    name
        Relative to the workspace, with ``/``.
    is_folder
        Whether it is a folder.
    size
        In bytes; 0 for a folder.
    modified
        Time of the last change, s since 1970.
    """

    name: str
    is_folder: bool
    size: int
    modified: float


@dataclass(frozen=True, slots=True)
class Listing:
    """Files and folders, each folder before its content.

    Attributes
    ----------
    entries
        In alphabetical order.
    is_complete
        Whether these are all: a folder with very many files, or very deep ones, is not listed to the end.
    """

    entries: tuple[Entry, ...]
    is_complete: bool


class Workspace:
    """A folder.

    Parameters
    ----------
    folder
        Must exist.

    Attributes
    ----------
    folder
        Absolute, without links.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder).resolve(strict=True)
        self._lock = threading.Lock()

    def path(self, name: str) -> Path:
        """Return the absolute path of a name; it need not exist.

        Parameters
        ----------
        name
            Relative to the folder; empty for the folder itself.

        Raises
        ------
        OutsideError
            If it leads out of the folder, also by a link; if a part of it is hidden; if it is no name on every system.
        """
        parts = name.split("/") if name else []
        if any(not _is_plain(part) for part in parts):
            raise OutsideError(
                f"{name!r} is not the name of a file in {self.folder.name}. Choose a file from the page."
            )
        try:
            path = self.folder.joinpath(*parts).resolve()
        except (OSError, RuntimeError, ValueError) as error:  # a link to itself, a name that is too long
            raise OutsideError(f"{name!r} cannot be a file in {self.folder.name} ({error}).") from error
        if not path.is_relative_to(self.folder):
            raise OutsideError(
                f"{name!r} leads out of the folder {self.folder.name}. Start sprung in a folder above both."
            )
        return path

    def name(self, path: Path) -> str:
        """Return the name of a path in the folder."""
        return path.relative_to(self.folder).as_posix() if path != self.folder else ""

    def listing(self, folder: str = "", deepest: int = _DEEPEST) -> Listing:
        """Return the files and folders in a folder and below it; hidden ones, and links that lead out, are left out.

        Parameters
        ----------
        folder
            Its name.
        deepest
            Number of folders below it that are opened, one in the other; 0 lists only the folder itself.
        """
        entries: list[Entry] = []
        is_complete = True
        for entry in self._entries(self.path(folder), folder, deepest):
            if entry is None or len(entries) == _MOST:
                is_complete = False
                if entry is not None:
                    break
                continue
            entries.append(entry)
        return Listing(tuple(entries), is_complete)

    def _entries(self, place: Path, name: str, deepest: int) -> Iterator[Entry | None]:
        """Yield the entries; None for a folder that is too deep."""
        try:
            with os.scandir(place) as found:
                items = sorted(found, key=lambda item: item.name)
        except OSError:  # no permission, or removed meanwhile
            return
        for item in items:
            inside = f"{name}/{item.name}" if name else item.name
            try:
                if not _is_plain(item.name) or (item.is_symlink() and self.path(inside) is None):
                    continue
                state = item.stat()
                is_folder = item.is_dir()
            except (OSError, OutsideError):
                continue
            yield Entry(inside, is_folder, 0 if is_folder else state.st_size, state.st_mtime)
            if is_folder and not item.is_symlink():
                if deepest:
                    yield from self._entries(Path(item.path), inside, deepest - 1)
                else:
                    yield None

    def read_text(self, name: str) -> tuple[str, str]:
        """Return the text of a file as it stands there, and its version.

        Parameters
        ----------
        name
            Of the file.

        Returns
        -------
        text, version
            An empty text and ``NEW`` if there is no such file.

        Raises
        ------
        OutsideError
            As for `path`.
        InputError
            If it is no text file in UTF-8, or too large.
        """
        path = self.path(name)
        content = _content(path, name)
        try:
            return (content or b"").decode("utf-8"), _version(content)
        except UnicodeDecodeError as error:
            found = f"a byte that is no text in UTF-8 (position {error.start})"
            raise InputError([Problem(name, found, "text in UTF-8", "Save it again in UTF-8.")]) from error

    def write_text(self, name: str, text: str, version: str) -> str:
        """Replace the text of a file, whole or not at all, unless it was changed meanwhile.

        Parameters
        ----------
        name
            Of the file.
        text
            New content.
        version
            As `read_text` returned it with the text that was edited; ``NEW`` for a file that must not exist.

        Returns
        -------
        str
            The version of the new content.

        Raises
        ------
        ChangedError
            If the file has another version.
        OutsideError
            As for `path`.
        InputError
            If the file cannot be written.
        """
        path, content = self.path(name), text.encode()
        new = temporary_path(path, new_token(), "new")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with new.open("xb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            with self._lock:
                self.install(new, path, version)
        except OSError as error:
            raise unwritable(name, error) from error
        finally:
            with suppress(OSError):
                new.unlink(missing_ok=True)
        return _version(content)

    def install(self, new: Path, path: Path, version: str | None) -> None:
        """Give a complete temporary file its name.

        Parameters
        ----------
        new, path
            Temporary path and final one, in the same folder.
        version
            The version that it may replace; ``NEW`` for none.

        Raises
        ------
        ChangedError
            If the file has another version.
        OSError
            If the system refuses.
        """
        name = self.name(path)
        if version == NEW:
            try:
                os.link(new, path)  # unlike renaming, this never replaces a file
            except FileExistsError:
                raise ChangedError(f"{name} exists already. Load it, or choose another name.") from None
            except OSError:  # a file system without links
                if path.exists():
                    raise ChangedError(f"{name} exists already. Load it, or choose another name.") from None
                new.replace(path)
            return
        if _version(_content(path, name)) != version:
            raise ChangedError(
                f"{name} was changed by another program or another tab since it was read. Load it again."
            )
        shutil.copymode(path, new)
        new.replace(path)

    def recover(self) -> None:
        """Finish or undo what a killed process was writing in the folder and those below it."""
        folders = [self.path(entry.name) for entry in self.listing().entries if entry.is_folder]
        for folder in (self.folder, *folders):
            with suppress(OSError, ValueError, LookupError):
                recover(folder, ())


def unwritable(name: str, error: OSError) -> InputError:
    """Return the error of a file that cannot be written."""
    found = f"a place that cannot be written to ({error.strerror or error})"
    return InputError([Problem(name, found, "a folder to write to", "Check its permissions and the free space.")])


def _is_plain(part: str) -> bool:
    """Whether a text can name a file on every system: neither hidden nor ``..``, no separator or control character."""
    return bool(part) and not part.startswith(".") and not part.endswith((" ", ".")) and not _FORBIDDEN.search(part)


def _content(path: Path, name: str) -> bytes | None:
    """Return the content of a text file; None if there is none."""
    try:
        if path.exists() and not path.is_file():  # opening a pipe would wait for its other end
            raise OSError(0, "a folder or a device")
        with path.open("rb") as file:
            content = file.read(LARGEST_TEXT + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        found = f"a file that cannot be read ({error.strerror or error})"
        raise InputError([Problem(name, found, "a text file", "Check its permissions.")]) from error
    if len(content) > LARGEST_TEXT:
        found = f"more than {LARGEST_TEXT} bytes"
        raise InputError([Problem(name, found, "a text file such as campaign.toml", "Choose another file.")])
    return content


def _version(content: bytes | None) -> str:
    return NEW if content is None else hashlib.sha256(content).hexdigest()
