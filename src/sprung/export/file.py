"""An exported file: its content, a name for it, and what a reader has to know."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from sprung.display import shown
from sprung.errors import InputError, Problem
from sprung.files import atomic_write

_OF_OTHER_KINDS = frozenset(
    {
        *(".csv", ".parquet", ".mat", ".mo", ".xml", ".fmu", ".yaml", ".md", ".tex"),
        *(".json", ".toml", ".npz", ".html", ".pdf", ".xlsx", ".h5", ".hdf5", ".tdms", ".mf4", ".uff", ".wav", ".lvm"),
    }
)
"""Endings that say what a file is: of exports, of results, of campaigns and their recordings."""


@shown
@dataclass(frozen=True, slots=True)
class ExportedFile:
    """An exported file.

    Attributes
    ----------
    name
        A file name that fits the format.
    content
        Its bytes.
    notes
        What the export leaves out, averages or assumes, one sentence each.
    """

    name: str
    content: bytes
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The content as text; of a binary file a `UnicodeDecodeError`."""
        return self.content.decode("utf-8")

    def with_notes(self, *notes: str) -> ExportedFile:
        """Return the file with further notes.

        Parameters
        ----------
        notes
            Sentences.
        """
        return replace(self, notes=(*self.notes, *notes))

    def save(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write the file, whole or not at all.

        Parameters
        ----------
        path
            Of the file; a folder that exists gets it under its own name.
        overwrite
            Whether a file that sprung did not write, or that was changed since, may be replaced.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        InputError
            If the path has the ending of another kind of file, if a file of the user's would be overwritten, or if the folder
            cannot be written.
        """
        path = Path(path)
        path = path / self.name if path.is_dir() else path
        own, given = Path(self.name).suffix, path.suffix.lower()
        if given in _OF_OTHER_KINDS - {own}:
            found, expected = f"the ending {given}", f"the ending {own}, as of {self.name}"
            raise InputError([Problem(str(path), found, expected, f"Name it {path.stem}{own}.")])
        atomic_write(path.parent, {path.name: self.content}, overwrite=overwrite)
        return path
