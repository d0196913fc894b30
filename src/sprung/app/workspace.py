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

LARGEST_TEXT = 500_000
"""Largest text file that is read or written, bytes."""

_MOST = 20_000
"""Most entries of a listing."""

_SHOWN = 200
"""Most characters of a name that are shown where it is refused."""

_LONGEST = 255
"""Longest name of a file, bytes."""

_DEEPEST = 5
"""Most folders between the workspace and an entry of a listing."""

_FORBIDDEN = re.compile(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff\u202a-\u202e\u2066-\u2069\\/]")
"""Control characters also of the direction of writing, bytes that are no text, and separators of any system."""

_UNPORTABLE = re.compile(r'[<>:"|?*]|[ .]$|^(con|prn|aux|nul|com\d|lpt\d)(\.|$)', re.IGNORECASE)
"""What Windows does not permit in a name or takes for a drive, a stream or a device."""


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
    links_out
        Names of links that lead out of the workspace; they are left out.
    unreadable_names
        Names that are no text, in printable form; they are left out.
    """

    entries: tuple[Entry, ...]
    is_complete: bool
    links_out: tuple[str, ...]
    unreadable_names: tuple[str, ...]


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
            If it leads out of the folder, also by a link; if a part of it is hidden; if it cannot be a name.
        """
        parts = name.split("/") if name else []
        shown = repr(name if len(name) <= _SHOWN else f"{name[:_SHOWN]}...")
        if any(len(part.encode(errors="surrogatepass")) > _LONGEST for part in parts):
            raise OutsideError(f"{shown} is too long: a name has at most {_LONGEST} bytes. Choose a shorter one.")
        if any(not _is_plain(part) for part in parts):
            raise OutsideError(f"{shown} is not the name of a file in {self.folder.name}. Choose a file from the page.")
        try:
            path = self.folder.joinpath(*parts).resolve()
            with suppress(FileNotFoundError, NotADirectoryError, PermissionError):
                path.lstat()  # nothing else finds that the whole is too long
        except (OSError, RuntimeError, ValueError) as error:  # a link to itself, a name that is too long
            why = getattr(error, "strerror", None) or type(error).__name__
            raise OutsideError(f"{shown} cannot be a file in {self.folder.name} ({why}).") from error
        if not path.is_relative_to(self.folder):
            raise OutsideError(
                f"{shown} leads out of the folder {self.folder.name}. Start sprung in a folder above both."
            )
        return path

    def new_path(self, name: str) -> Path:
        """Return the absolute path of a file to be made, in an existing folder, with a name that every system permits.

        Raises
        ------
        OutsideError
            As for `path`, or if the name cannot be used elsewhere or the folder does not exist.
        """
        if any(part.startswith(".") for part in name.split("/")):
            raise OutsideError(f"{name!r} would be hidden, as its name begins with a full stop. Rename the file first.")
        path = self.path(name)
        if path == self.folder or _UNPORTABLE.search(name.rpartition("/")[2]):
            raise OutsideError(f"{name!r} is not a name that every system permits. Rename the file first.")
        if not path.parent.is_dir():
            raise OutsideError(f"{self.folder.name} has no folder {self.name(path.parent)!r}. Make it first.")
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
        links_out: list[str] = []
        unreadable: list[str] = []
        is_complete = True
        for entry in self._entries(self.path(folder), folder, deepest):
            if isinstance(entry, str):
                (unreadable if _FORBIDDEN.search(entry.replace("/", "")) else links_out).append(entry)
            elif entry is None:
                is_complete = False
            elif len(entries) < _MOST:
                entries.append(entry)
            else:
                is_complete = False
                break
        return Listing(tuple(entries), is_complete, tuple(links_out), tuple(ascii(name)[1:-1] for name in unreadable))

    def _entries(self, place: Path, name: str, deepest: int) -> Iterator[Entry | str | None]:
        """Yield the entries; the name of one that is left out; None for a folder that is too deep."""
        try:
            with os.scandir(place) as found:
                items = sorted(found, key=lambda item: item.name)
        except OSError:  # no permission, or removed meanwhile
            return
        for item in items:
            if item.name.startswith("."):
                continue
            inside = f"{name}/{item.name}" if name else item.name
            try:
                if item.is_symlink() or not _is_plain(item.name):
                    self.path(inside)
                state = item.stat()
                is_folder = item.is_dir()
            except OutsideError:
                yield inside
                continue
            except OSError:  # removed meanwhile, or a link to nothing
                continue
            yield Entry(inside, is_folder, 0 if is_folder else state.st_size, state.st_mtime)
            if is_folder and not item.is_symlink():
                if deepest:
                    yield from self._entries(Path(item.path), inside, deepest - 1)
                else:
                    yield None

    def read_text(self, name: str, largest: int = LARGEST_TEXT) -> tuple[str, str]:
        """Return the text of a file as it stands there, and its version.

        Parameters
        ----------
        name
            Of the file.
        largest
            Largest file that is read, bytes.

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
        content = _content(path, name, largest)
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
        """Rename a complete temporary file to its final name.

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


def parent_of(name: str) -> str:
    """Return the name of the folder of a file or folder; empty for the folder of the page."""
    return name.rpartition("/")[0]


def inside(folder: str, name: str) -> str:
    """Return the name of a file by the name of its folder, which is empty for the folder of the page."""
    return f"{folder}/{name}" if folder else name


def unwritable(name: str, error: OSError) -> InputError:
    """Return the error of a file that cannot be written."""
    found = f"a place that cannot be written to ({error.strerror or error})"
    return InputError([Problem(name, found, "a folder to write to", "Check its permissions and the free space.")])


def _is_plain(part: str) -> bool:
    """Whether a text can name a file that is not hidden: not ``..``, no separator or control character."""
    is_name = bool(part) and not part.startswith(".") and not _FORBIDDEN.search(part) and len(part.encode()) <= _LONGEST
    return is_name and not (os.name == "nt" and _UNPORTABLE.search(part))


def _content(path: Path, name: str, largest: int = LARGEST_TEXT) -> bytes | None:
    """Return the content of a text file; None if there is none."""
    try:
        if path.exists() and not path.is_file():  # opening a pipe would wait for its other end
            raise OSError(0, "a folder or a device")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        found = f"a file that cannot be read ({error.strerror or error})"
        raise InputError([Problem(name, found, "a text file", "Check its permissions.")]) from error
    if len(content) > largest:
        found = f"more than {largest} bytes"
        raise InputError([Problem(name, found, "a text file such as campaign.toml", "Choose another file.")])
    return content


def _version(content: bytes | None) -> str:
    return NEW if content is None else hashlib.sha256(content).hexdigest()
