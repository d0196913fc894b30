"""Drawings of the recordings, one per drop, where matplotlib is installed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from sprung.errors import InputError, Problem
from sprung.recording import write_whole

if TYPE_CHECKING:
    from sprung.pipeline import Check


def draw_check(check: Check) -> dict[str, str]:
    """Draw every drop: its channels one above the other, when what happened, which part is used, what is wrong where.

    Parameters
    ----------
    check
        From `sprung.check`.

    Returns
    -------
    dict
        SVG text by file name, in the campaign's order; the same for the same recordings.

    Raises
    ------
    InputError
        If matplotlib, which draws, is not installed.
    """
    figure = drawer("figure")
    drawn = zip(_names(check), check.drops, check.recorded, strict=True)
    return {name: figure.svg_of(drop, recorded) for name, drop, recorded in drawn}


def drawer(module: str) -> Any:
    """Load a module of this room that draws.

    Parameters
    ----------
    module
        Its name.

    Raises
    ------
    InputError
        If matplotlib, which draws, is not installed.
    """
    try:
        # The only library of this room that not everybody has.
        return import_module(f"sprung.report.{module}")
    except ImportError as error:
        if (error.name or "").partition(".")[0] != "matplotlib":
            raise
        found = f"no library matplotlib, which draws them ({error})"
        do = 'Install it with: pip install "sprung[plot]"'
        raise InputError([Problem("drawings", found, "an installation that can draw", do)]) from error


def write_check(check: Check, folder: Path) -> tuple[Path, ...]:
    """Draw every drop into a folder, all of them or none.

    Parameters
    ----------
    check
        From `sprung.check`.
    folder
        Made if it does not exist. Files of the same names in it are replaced.

    Returns
    -------
    tuple of Path
        One for each drop.

    Raises
    ------
    InputError
        If matplotlib is not installed, or the folder cannot be written.
    """
    drawings = draw_check(check)
    write_whole(folder, {name: text.encode() for name, text in drawings.items()})
    return tuple(folder / name for name in drawings)


def _names(check: Check) -> Iterator[str]:
    """Name each drop's drawing after its recording, no two alike."""
    return file_names([str(PurePath(drop.file).with_suffix("")) for drop in check.drops])


def file_names(drops: Iterable[str]) -> Iterator[str]:
    """Name a drawing after each drop, no two alike."""
    taken: set[str] = set()
    for drop in drops:
        plain = re.sub(r'[\\/:*?"<>|\s]+', "_", drop).lstrip("._")
        name, count = f"{plain}.svg", 1
        while name.lower() in taken:  # some file systems take A.svg for a.svg
            count += 1
            name = f"{plain}_{count}.svg"
        taken.add(name.lower())
        yield name
