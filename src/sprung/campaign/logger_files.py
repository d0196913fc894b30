"""Which of a drop's files a logger wrote, by their names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import PurePath


def find_logger_files(files: Iterable[str], logger: str) -> list[str]:
    """Return the files whose names contain a logger's name: as a word of its own, otherwise as any part.

    Parameters
    ----------
    files
        The recordings.
    logger
        Its name.

    Returns
    -------
    list of str
    """
    stems = {file: PurePath(file).stem.casefold() for file in files}
    name = logger.casefold()
    word = re.compile(rf"(?<![^\W_]){re.escape(name)}(?![^\W_])")
    return [file for file, stem in stems.items() if word.search(stem)] or [
        f for f, stem in stems.items() if name in stem
    ]
