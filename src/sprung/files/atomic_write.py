"""Files are written whole or not at all, however many belong together, and only over files that sprung wrote itself.

Writing is a transaction. All new files are prepared under hidden names beside their places. A journal then says that they
are complete; from there on the transaction can be finished by another process. The old files are put aside, the new ones
take their names, the list of checksums is replaced, and the old files and the journal are removed. An error before the list
is replaced undoes everything. What a process that was killed leaves is put in order by the next one that writes there.
"""

from __future__ import annotations

import errno
import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sprung.errors import InputError
from sprung.files.interrupts import hold_interrupts
from sprung.files.ownership import (
    MANIFEST,
    check_overwriting,
    checksum,
    is_unchanged,
    manifest_text,
    read_manifest,
    unwritable_folder,
)
from sprung.files.recovery import JOURNAL, new_token, recover, temporary_path

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence


def atomic_write(
    folder: str | os.PathLike[str],
    files: Mapping[str, bytes],
    *,
    overwrite: bool = False,
    obsolete: Collection[str] = (),
) -> None:
    """Write several files: all of them, or none, with the previous files unchanged.

    Parameters
    ----------
    folder
        Folder to write to; created if it does not exist.
    files
        Content by name, relative to the folder. The file that refers to the others comes last: it never stands beside files
        of another write.
    overwrite
        Whether files that sprung did not write, or that were changed since, may be replaced.
    obsolete
        Names of files that the new ones make obsolete: removed with the old ones where sprung wrote them and nobody has
        changed them since, kept where not.

    Raises
    ------
    InputError
        If a file of the user's would be overwritten, or the folder cannot be made or written to.
    ValueError
        If a name leads out of the folder.
    """
    folder = Path(folder)
    token = new_token()
    targets = [_FileTarget.of(folder, name, token) for name in files]
    with suppress(OSError):
        recover(folder, {place.target.parent for place in targets})
    if not overwrite:
        check_overwriting(folder, files)
    obsolete_targets = [
        _FileTarget.of(folder, name, token) for name in obsolete if name not in files and is_unchanged(folder, name)
    ]
    made = [path for place in targets for path in _missing(place.target.parent)]
    transaction = _Transaction(folder, token, targets, obsolete_targets)
    try:
        for place, content in zip(targets, files.values(), strict=True):
            place.prepare(content)
        with hold_interrupts():
            transaction.commit({name: checksum(content) for name, content in files.items()})
    except BaseException as error:
        with hold_interrupts():
            transaction.undo()
            _remove_empty(made)
        if isinstance(error, OSError):
            raise InputError([unwritable_folder(folder, error.strerror or str(error))]) from error
        raise


@dataclass(frozen=True, slots=True)
class _FileTarget:
    """Path of a file to write, and two temporary paths beside it: of the new content, and of the old."""

    target: Path
    new: Path
    old: Path

    @classmethod
    def of(cls, folder: Path, name: str, token: str) -> _FileTarget:
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise ValueError(f"'{name}' leads out of the folder it should be written to")
        target = folder / name
        return cls(target, temporary_path(target, token, "new"), temporary_path(target, token, "old"))

    def prepare(self, content: bytes) -> None:
        if self.target.is_dir():
            raise IsADirectoryError(errno.EISDIR, f"a folder has the name {self.target.name}")
        self.target.parent.mkdir(parents=True, exist_ok=True)
        _write_through(self.new, content)

    def set_aside(self) -> None:
        if self.target.exists():
            self.target.replace(self.old)

    def install(self) -> None:
        self.new.replace(self.target)


@dataclass(frozen=True, slots=True)
class _Transaction:
    """New files that are prepared, and old ones to be removed."""

    folder: Path
    token: str
    targets: Sequence[_FileTarget]
    obsolete_targets: Sequence[_FileTarget]

    @property
    def journal(self) -> Path:
        return self.folder / JOURNAL.format(token=self.token)

    def commit(self, checksums: Mapping[str, str]) -> None:
        """Rename the new files to their names; this can be undone until the list of checksums is replaced."""
        everything = [*self.targets, *self.obsolete_targets]
        before = {
            str(place.target.relative_to(self.folder)): checksum(place.target.read_bytes())
            for place in everything
            if place.target.exists()
        }
        journal = {"files": dict(checksums), "before": before}
        _replace(self.journal, json.dumps(journal).encode(), self.token)
        # First the file that refers to the others: killed at any moment, this leaves all the old, all the new, or none.
        for place in reversed(everything):
            place.set_aside()
        for place in self.targets:
            place.install()
        removed = {str(place.target.relative_to(self.folder)) for place in self.obsolete_targets}
        kept = {name: entry for name, entry in read_manifest(self.folder).items() if name not in removed}
        _replace(self.folder / MANIFEST, manifest_text(kept | dict(checksums)).encode(), self.token)
        for place in everything:
            with suppress(OSError):
                place.old.unlink(missing_ok=True)
        with suppress(OSError):
            self.journal.unlink()

    def undo(self) -> None:
        """Restore the previous state; killed at any moment, this leaves what `recover` puts in order."""
        if self.journal.exists():
            for place in self.targets:
                if not place.new.exists() and place.target.exists():
                    place.target.replace(place.new)
            self.journal.unlink()
        for place in (*self.targets, *self.obsolete_targets):
            if place.old.exists():
                place.old.replace(place.target)
            place.new.unlink(missing_ok=True)
        for own in (self.journal, self.folder / MANIFEST):
            temporary_path(own, self.token, "new").unlink(missing_ok=True)


def _write_through(path: Path, content: bytes) -> None:
    with path.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())  # a name must never stand for content that a power cut would lose


def _replace(path: Path, content: bytes, token: str) -> None:
    """Write one file of sprung's own under its name at once."""
    new = temporary_path(path, token, "new")
    _write_through(new, content)
    new.replace(path)


def _missing(folder: Path) -> list[Path]:
    """Return the folders that would have to be made."""
    return [path for path in (folder, *folder.parents) if not path.exists()]


def _remove_empty(folders: Sequence[Path]) -> None:
    for folder in sorted(set(folders), key=lambda path: len(path.parts), reverse=True):
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
