"""The commands that the page runs, as they would be typed in its folder.

A page composes nothing else: what a job runs and what "Show as commands" shows is the same list of arguments. Files are named
relative to the folder and lie in it, as do the recordings that a campaign names; an option of a command is only what is
listed here, never a text from a form that begins with a dash.
"""

from __future__ import annotations

import itertools
import shlex
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from sprung.app.jobs import Job, Jobs
from sprung.app.workspace import OutsideError, Workspace

Value: TypeAlias = str | float | bool | Sequence[str] | None
"""Value of an option: True for a flag, False for its opposite, None to leave it out, several for a repeated one."""

_OPTIONS: dict[str, frozenset[str]] = {
    "new": frozenset({"settings", "force", "json"}),
    "check": frozenset({"page", "drawings", "force", "json"}),
    "identify": frozenset({"profile", "fall", "report", "force", "json"}),
    "validate": frozenset({"force", "json"}),
    "modal": frozenset({"method", "order", "amplitude", "start", "diagram", "json"}),
    "plan": frozenset({"wanted", "rate", "noise", "terms", "json"}),
    "report": frozenset({"pdf", "force", "json"}),
    "compare": frozenset({"json"}),
    "export": frozenset({"to", "load", "amplitude", "frequency", "approximate", "number", "seed", "force", "json"}),
    "ride": frozenset({"road", "speed", "seat", "load", "tracks", "hours", "json"}),
}
"""Options of each command that a page may state; ``-o`` is a name in the folder and stated apart."""

_TWO_WAY = frozenset({"settings", "page", "drawings", "fall", "report"})
"""Flags with an opposite, such as ``--no-fall``."""


def arguments(
    workspace: Workspace,
    command: str,
    *names: str,
    output: str | None = None,
    options: Mapping[str, Value] | None = None,
) -> tuple[str, ...]:
    """Return the arguments of ``sprung`` for a command in the folder.

    Parameters
    ----------
    workspace
        The folder.
    command
        Such as ``identify``.
    *names
        Files and folders that it reads, by their names in the folder.
    output
        File or folder that it writes (``-o``); its default is beside what it reads.
    options
        By their names without dashes.

    Raises
    ------
    OutsideError
        If a file lies outside the folder, also one that a campaign names.
    ValueError
        If the page does not offer the command or an option of it.

    Examples
    --------
    >>> workspace = Workspace(".")
    >>> arguments(workspace, "identify", "car", output="car/results", options={"fall": False})
    ('identify', 'car', '-o', 'car/results', '--no-fall')
    """
    if command not in _OPTIONS:
        raise ValueError(f"the page does not offer the command {command}")
    for name in names:
        check_sources(workspace, name)
    found = [command, *(_place(workspace, name) for name in names)]
    if output is not None:
        found += ["-o", _place(workspace, output)]
    for option, value in (options or {}).items():
        if option not in _OPTIONS[command]:
            raise ValueError(f"the page does not offer --{option} of {command}")
        found += _option(option, value)
    return tuple(found)


def output_of(arguments: Sequence[str]) -> str:
    """Return the file or folder that a command writes, by its name in the folder of the page; empty where it is the default.

    Examples
    --------
    >>> output_of(["identify", "car/campaign.toml", "-o", "./-results"])
    '-results'
    """
    return dict(itertools.pairwise(arguments)).get("-o", "").removeprefix("./")


def as_typed(arguments: Sequence[str]) -> str:
    """Return a command as it would be typed in a shell, in the folder of the page.

    Examples
    --------
    >>> as_typed(["identify", "my car/campaign.toml"])
    "sprung identify 'my car/campaign.toml'"
    """
    return shlex.join(("sprung", *arguments))


def start(jobs: Jobs, workspace: Workspace, arguments: Sequence[str], title: str) -> Job:
    """Start a command in the folder of the page, as `Jobs.start` does."""
    return jobs.start(arguments, workspace.folder, title)


def check_sources(workspace: Workspace, name: str) -> None:
    """Check that a file or folder refers to nothing outside the folder of the page: what a command reads, and writes beside it.

    Parameters
    ----------
    workspace
        The folder of the page.
    name
        A campaign file, a folder with one, a folder of recordings, a results folder.

    Raises
    ------
    OutsideError
        If a file that the campaign names, or a link in the folder, leads out.
    """
    check_links(workspace, name)
    path = workspace.path(name)
    file = path / "campaign.toml" if path.is_dir() else path
    if file.suffix != ".toml":
        return
    text, _ = workspace.read_text(workspace.name(file))
    try:
        document = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):
        return  # the command says what is wrong, and reads nothing else
    for recording in _files(document):
        if not _is_inside(workspace, file.parent / recording):
            raise _outside(workspace, f"{workspace.name(file)}: {recording}")


def check_links(workspace: Workspace, name: str) -> None:
    """Check that no link in a folder, or beside a file, leads out: a recording may consist of several files.

    Parameters
    ----------
    workspace
        The folder of the page.
    name
        A file or folder in it.

    Raises
    ------
    OutsideError
        If one does.
    """
    path = workspace.path(name)
    folder = path if path.is_dir() else path.parent
    for link in workspace.listing(workspace.name(folder)).links_out:
        raise _outside(workspace, link)


def _is_inside(workspace: Workspace, path: Path) -> bool:
    try:
        return path.resolve().is_relative_to(workspace.folder)
    except (OSError, RuntimeError, ValueError):  # a link to itself, a name that is too long
        return False


def _outside(workspace: Workspace, what: str) -> OutsideError:
    do = f"Copy the file into {workspace.folder.name}, or start sprung app in a folder above both."
    return OutsideError(f"{what} leads out of the folder {workspace.folder.name}. {do}")


def _files(document: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of the recordings in a campaign file."""
    drops = document.get("drop")
    for drop in drops if isinstance(drops, list) else ():
        if isinstance(drop, dict):
            several = drop.get("files")
            for file in (drop.get("file"), *(several if isinstance(several, list) else ())):
                if isinstance(file, str):
                    yield file


def _place(workspace: Workspace, name: str) -> str:
    """Return a name in the folder as an argument, which cannot be taken for an option."""
    place = workspace.name(workspace.path(name)) or "."
    return f"./{place}" if place.startswith("-") else place


def _option(option: str, value: Value) -> list[str]:
    if value is None:
        return []
    if isinstance(value, bool):
        opposite = [f"--no-{option}"] if option in _TWO_WAY else []
        return [f"--{option}"] if value else opposite
    values = (
        [f"{value:.12g}" if isinstance(value, float) else str(value)] if isinstance(value, str | float | int) else value
    )
    return [argument for each in values for argument in (f"--{option}", each)]
