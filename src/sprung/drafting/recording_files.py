"""Files of a folder that may be recordings, and which of them are copies of another."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

from sprung.drafting.names import tokens
from sprung.files import NO_RECORDINGS


def find_recording_files(folder: Path) -> Iterator[str]:
    """Yield the files that may be recordings, in the order of their names; without hidden files and results.

    Parameters
    ----------
    folder
        Where to look, in its subfolders too.

    Yields
    ------
    str
        Path relative to the folder.
    """
    found = []
    for path in folder.rglob("*"):
        relative = path.relative_to(folder)
        hidden = any(part.startswith((".", "~")) for part in relative.parts)
        results = any((parent / "results.json").exists() for parent in path.parents if folder in parent.parents)
        if path.is_file() and not hidden and not results and path.suffix.lower() not in NO_RECORDINGS:
            found.append(relative)
    # The channel files of ISO-MME, which end in a number, belong to the descriptor beside them or above.
    descriptors = {folder / path.parent for path in found if path.suffix.lower() in {".mme", ".chn"}}
    for relative in sorted(found, key=lambda path: [part.casefold() for part in path.parts]):
        part_of = relative.suffix[1:].isdecimal() and any(
            parent in descriptors for parent in (folder / relative).parents
        )
        if not part_of:
            yield relative.as_posix()


def find_copies(folder: Path, names: Sequence[str]) -> dict[str, str]:
    """Find the files that are identical to another.

    Parameters
    ----------
    folder
        Where they are.
    names
        Paths relative to it.

    Returns
    -------
    dict
        By the name of each copy the file that it is a copy of: of identical files that with the
        shortest path, unless another one's path says something else: ``left/try_2.csv`` rather than ``copy.csv``.
    """
    sizes: defaultdict[int, list[str]] = defaultdict(list)
    for name in names:
        sizes[(folder / name).stat().st_size].append(name)
    alike: defaultdict[str, list[str]] = defaultdict(list)
    for size, own in sizes.items():
        for name in own if size and len(own) > 1 else ():
            with (folder / name).open("rb") as file:
                alike[hashlib.file_digest(file, "sha256").hexdigest()].append(name)
    found: dict[str, str] = {}
    for own in alike.values():
        said = set(tokens(max(own, key=lambda name: len(tokens(name)))))
        original = min(
            (name for name in own if set(tokens(name)) <= said), key=lambda name: (name.count("/"), len(name), name)
        )
        found |= {name: original for name in own if name != original}
    return found
