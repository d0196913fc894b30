"""Files of a check: its page, and drawings of the recordings, one per drop."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePath

from sprung.checking import Check, DropReport
from sprung.files import atomic_write
from sprung.report.check_page import CHECK_FILE, check_page
from sprung.report.pictures.recordings import near_picture, whole_picture
from sprung.report.sheet import sheet


def draw_check(check: Check) -> dict[str, str]:
    """Draw every drop: its channels one above the other, when what happened, which part is used, what is wrong where.

    Parameters
    ----------
    check
        From `sprung.check`.

    Returns
    -------
    dict
        SVG text by file name, in the campaign's order, of the recordings that could be read; the same for the same recordings.
    """
    drawn = {}
    for name, drop, recorded in zip(_names(check), check.drops, check.recorded, strict=False):
        pictures = [picture for picture in (whole_picture(drop, recorded), near_picture(drop, recorded)) if picture]
        drawn[name] = sheet(drop.label, list(_said(drop)), pictures)
    return drawn


def _said(drop: DropReport) -> Iterator[tuple[str, bool]]:
    """Say what a drop is, which part of it is used and why, each line with whether it tells of something wrong."""
    wheels = "" if drop.kind == " ".join(drop.wheels) else f" ({', '.join(drop.wheels)})"
    rate = "" if drop.rate is None else f", {drop.rate:.6g} samples per second"
    yield f"{drop.kind or 'wheels not known'}{wheels}, load {drop.load or 'not stated'}{rate}", False
    if drop.start is None or drop.end is None:
        yield f"left out: {', '.join(drop.faults)}", True
    else:
        yield f"decay from {drop.start:.3f} s: {drop.why_start}", False
        yield f"to {drop.end:.3f} s: {drop.why_end}", False
    if drop.contradicted:
        yield f"the release shows {', '.join(drop.wheels_seen or ()) or 'no wheel'} to have fallen", True


def write_check(
    check: Check, folder: Path, *, page: bool = True, drawings: bool = False, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write the page of a check, and drawings of its drops, into a folder: all files or none.

    Parameters
    ----------
    check
        From `sprung.check`.
    folder
        Made if it does not exist. Files that sprung wrote there are replaced.
    page
        Whether to write check.html.
    drawings
        Whether to draw each drop as an SVG file.
    overwrite
        Whether other files of the same names, and files that were changed since sprung wrote them, are replaced too.

    Returns
    -------
    tuple of Path
        The page first, then one for each drop.

    Raises
    ------
    InputError
        If such files would be overwritten, or the folder cannot be written.
    """
    files = ({CHECK_FILE: check_page(check)} if page else {}) | (draw_check(check) if drawings else {})
    atomic_write(folder, {name: text.encode() for name, text in files.items()}, overwrite=overwrite)
    return tuple(folder / name for name in files)


def _names(check: Check) -> Iterator[str]:
    """Name each drop's drawing after its recording, no two alike."""
    return file_names([drop.title or str(PurePath(drop.file).with_suffix("")) for drop in check.drops])


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
