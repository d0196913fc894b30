"""Which files a campaign was read from, and what was in them: their checksums."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from sprung.display import shown


@shown
@dataclass(frozen=True, slots=True)
class SourceFile:
    """One file as it was read.

    Attributes
    ----------
    name
        As the campaign file has it.
    size
        Bytes.
    sha256
        Of its content, in hexadecimal digits.
    """

    name: str
    size: int
    sha256: str

    @classmethod
    def of(cls, folder: Path, name: str) -> SourceFile:
        """Return the name, size and checksum of a file.

        Parameters
        ----------
        folder, name
            Where it is.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        with (folder / name).open("rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            return cls(name, file.tell(), digest)
