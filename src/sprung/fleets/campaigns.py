"""The campaigns of a fleet: found below a folder or listed, each with a key from its content."""

from __future__ import annotations

import hashlib
import json
import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeAlias

from sprung.batch import content_key
from sprung.campaign import CAMPAIGN_FILE
from sprung.errors import InputError, Problem

FleetSource: TypeAlias = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
"""A folder, a text file with one path in each line, or paths."""


def find_campaigns(source: FleetSource) -> tuple[Path, ...]:
    """Return the campaign files of a fleet, each once.

    Parameters
    ----------
    source
        A folder: every file ``campaign.toml`` below it, in the order of the paths. A text file: one campaign file or its folder
        in each line, relative to the text file; empty lines and those that begin with ``#`` are ignored. Or a sequence of
        campaign files and folders.

    Returns
    -------
    tuple of Path
        Absolute paths. Those of a list need not exist.

    Raises
    ------
    InputError
        If the folder or list does not exist or contains no campaign.
    """
    if not isinstance(source, str | os.PathLike):
        found = [_file(Path(path)) for path in source]
        where = "the list"
    else:
        path = Path(source)
        where = str(path)
        if path.is_dir():
            found = list(_below(path))
        elif path.name == CAMPAIGN_FILE or path.suffix == ".toml":
            found = [path]
        else:
            found = list(_listed(path))
    if not found:
        do = f"Each campaign is a folder with its recordings and {CAMPAIGN_FILE}; `sprung new` drafts that file."
        raise InputError([Problem(where, "no campaign", f"one {CAMPAIGN_FILE} or more", do)])
    return tuple(dict.fromkeys(path.resolve() for path in found))


def campaign_key(path: Path, options: Mapping[str, Any]) -> str:
    """Return the key of a campaign: the checksum of its file, its recordings, the options and the version of sprung.

    Parameters
    ----------
    path
        The campaign file. What cannot be read counts as missing, so that the key changes when it appears.
    options
        Of the identification, as JSON can contain them.

    Returns
    -------
    str
    """
    parts: list[str | bytes] = [version("sprung"), json.dumps(options, sort_keys=True)]
    try:
        content = path.read_bytes()
    except OSError as error:
        return content_key([*parts, f"unreadable: {error.errno}"])
    parts.append(content)
    for name in _recordings(content):
        parts += [name, _checksum(path.parent / name)]
    return content_key(parts)


def _below(folder: Path) -> Iterator[Path]:
    for parent, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        if CAMPAIGN_FILE in files:
            yield Path(parent) / CAMPAIGN_FILE


def _listed(path: Path) -> Iterator[Path]:
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        found = (
            "no such file or folder" if isinstance(error, FileNotFoundError) else f"a file that is no text ({error})"
        )
        do = "Name a folder, or a text file with the path of one campaign in each line."
        raise InputError([Problem(str(path), found, "a folder with campaigns, or a list of them", do)]) from error
    for line in lines:
        if line.strip() and not line.lstrip().startswith("#"):
            yield _file(path.parent / line.strip())


def _file(path: Path) -> Path:
    return path / CAMPAIGN_FILE if path.is_dir() else path


def _recordings(content: bytes) -> list[str]:
    """Return the names of the recordings in a campaign file, as far as it can be understood."""
    try:
        drops = tomllib.loads(content.decode("utf-8-sig")).get("drop", [])
    except ValueError:
        return []
    entries = [drop for drop in drops if isinstance(drop, dict)] if isinstance(drops, list) else []
    names = [name for drop in entries for name in (drop.get("file"), *_as_list(drop.get("files")))]
    return list(dict.fromkeys(name for name in names if isinstance(name, str)))


def _as_list(value: object) -> list[object]:
    return list(value) if isinstance(value, list) else []


def _checksum(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError):
        return "missing"
