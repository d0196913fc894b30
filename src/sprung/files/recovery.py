"""Recovery of a write whose process was killed: it is finished, or undone.

Where a journal says that all new files were complete, they take their places; where there is none, they go, and old files that
were put aside come back. A file that somebody else has put there since is never touched. Files of a process that still runs
are left alone.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from sprung.files.ownership import MANIFEST, checksum, manifest_text, read_manifest

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

JOURNAL = ".sprung-{token}.journal"
"""Name of a journal, with a token from `new_token`."""

_RUN = secrets.token_hex(4)
"""This process, which may have the number of one that is gone, as in a container."""

_TOKENS = r"(?P<token>(?P<process>[0-9a-f]+-[0-9a-f]{8})-[0-9a-f]{8})"
_JOURNAL = re.compile(JOURNAL.replace(".", r"\.").format(token=_TOKENS))
_HIDDEN = re.compile(rf"\.(?P<name>.+)\.{_TOKENS}\.(?P<state>new|old)")

_LONGEST = 600.0
"""Seconds that a write may last where the system does not say whether its process still runs."""


def new_token() -> str:
    """Return the token of one write, which marks its temporary files: its process, and eight random digits."""
    return f"{os.getpid():x}-{_RUN}-{secrets.token_hex(4)}"


def temporary_path(target: Path, token: str, state: str) -> Path:
    """Return the temporary path beside a file.

    Parameters
    ----------
    target
        The file.
    token
        From `new_token`.
    state
        ``new`` for its new content, ``old`` for its previous one.

    Returns
    -------
    Path
    """
    return target.with_name(f".{target.name}.{token}.{state}")


def recover(folder: Path, within: Iterable[Path]) -> None:
    """Finish or undo the writes into a folder whose processes are gone.

    Parameters
    ----------
    folder
        Folder that was written to.
    within
        Those of its subfolders in which there may be temporary files.

    Raises
    ------
    OSError
        If something cannot be read or moved.
    """
    if not folder.is_dir():
        return
    for path in sorted(folder.iterdir()):
        journal = _JOURNAL.fullmatch(path.name)
        if journal is not None and _abandoned(path, journal["process"]):
            _finish(folder, path, journal["token"])
    for place in {folder, *within}:
        for path in sorted(place.iterdir()) if place.is_dir() else ():
            match = _HIDDEN.fullmatch(path.name)
            if match is None or not _abandoned(path, match["process"]):
                continue
            target = path.with_name(match["name"])
            if match["state"] == "old" and not target.exists():
                path.replace(target)
            else:
                path.unlink()


def _finish(folder: Path, path: Path, token: str) -> None:
    """Do what a journal says: all the new files are there, under their hidden names or their own."""
    journal = json.loads(path.read_text(encoding="utf-8"))
    files, before = journal["files"], journal["before"]
    written: dict[str, str] = {}
    for name in dict.fromkeys((*files, *before)):
        target = folder / name
        new, old = temporary_path(target, token, "new"), temporary_path(target, token, "old")
        there = checksum(target.read_bytes()) if target.exists() else None
        if there is None or there == before.get(name):
            if name in files and new.exists():
                new.replace(target)
                there = files[name]
            elif name not in files and there is not None:
                target.unlink()
        if name in files and there == files[name]:
            written[name] = files[name]
        for left in (new, old):
            left.unlink(missing_ok=True)
    kept = {name: entry for name, entry in read_manifest(folder).items() if name in files or name not in before}
    manifest = temporary_path(folder / MANIFEST, token, "new")
    manifest.write_text(manifest_text(kept | written), encoding="utf-8")
    manifest.replace(folder / MANIFEST)
    path.unlink()


def _abandoned(path: Path, process: str) -> bool:
    """Whether the process that made a file is gone."""
    number, run = process.split("-")
    if os.name == "nt":  # there, asking a process whether it runs would end it
        with suppress(OSError):
            return time.time() - path.stat().st_mtime > _LONGEST
        return False
    if int(number, 16) == os.getpid():
        return run != _RUN
    try:
        os.kill(int(number, 16), 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False  # it runs, for somebody else
    return False
