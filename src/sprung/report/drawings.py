"""Drawings of a check and of a validation, one SVG file per drop."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import PurePath

from sprung.assessment import DropValidation
from sprung.checking import Check, DropReport
from sprung.report.drawing.sheet import draw_sheet
from sprung.report.excitations import record_text
from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.motions import motion_picture
from sprung.report.pictures.recordings import landing_picture, recording_picture
from sprung.report.terminal.validation import AMPLITUDES
from sprung.study import Validation
from sprung.vehicle import layout_of


def draw_check(check: Check) -> dict[str, str]:
    """Return a drawing of every drop of a check: its recording with events, free decay and faulty samples.

    Parameters
    ----------
    check
        From `sprung.check`.

    Returns
    -------
    dict
        SVG text by file name, in the order of the campaign, of the readable recordings; identical for identical recordings.
    """
    drawn = {}
    for name, drop, recorded in zip(_names(check), check.drops, check.recorded, strict=False):
        pictures = [
            picture for picture in (recording_picture(drop, recorded), landing_picture(drop, recorded)) if picture
        ]
        drawn[name] = draw_sheet(drop.label, list(_drop_lines(drop)), pictures)
    return drawn


def _drop_lines(drop: DropReport) -> Iterator[tuple[str, bool]]:
    """Yield the description of a drop in lines, each with whether it is a warning."""
    wheels = "" if drop.kind == " ".join(drop.wheels) else f" ({', '.join(drop.wheels)})"
    rate = "" if drop.rate is None else f", {drop.rate:.6g} Hz"
    yield f"{drop.kind or 'wheels not known'}{wheels}, load {drop.load or 'not stated'}{rate}", False
    if drop.start is None or drop.end is None:
        yield f"left out: {', '.join(drop.faults)}", True
    else:
        yield f"{record_text(drop)} from {drop.start:.3f} s ({drop.why_start})", False
        yield f"to {drop.end:.3f} s ({drop.why_end})", False
    if drop.contradicted:
        yield f"wheels detected at the release: {', '.join(drop.wheels_seen or ()) or 'none'}", True


def draw_validation(validation: Validation) -> dict[str, str]:
    """Return the drawings of a cross-validation: the body's motion in each drop, and its modes against amplitude.

    Parameters
    ----------
    validation
        From `sprung.validate`.

    Returns
    -------
    dict
        SVG text by file name; identical for identical recordings.
    """
    result = validation.result
    drawn = {}
    if pictures := amplitude_pictures(validation.amplitudes):
        title = f"{result.name}, {validation.load}: modes of the body against amplitude"
        drawn["amplitude.svg"] = draw_sheet(title, [(AMPLITUDES, False)], pictures)
    names = file_names(["amplitude", *result.series])
    next(names)  # used by the drawing above
    for name, (drop, series) in zip(names, result.series.items(), strict=True):
        picture = motion_picture(drop, series, result.validation[drop], layout_of(result.parameters))
        drawn[name] = draw_sheet(drop, [(_error_text(result.validation[drop]), False)], [picture])
    return drawn


def _error_text(drop: DropValidation) -> str:
    text = f"all channels: error {100 * drop.fitted:.1f} % of the signal, {drop.residual:.2f} times the noise"
    if drop.predicted is not None and drop.predicted_residual is not None:
        text += f"; predicted by the other drops: {100 * drop.predicted:.1f} %, {drop.predicted_residual:.2f} times"
    return text


def _names(check: Check) -> Iterator[str]:
    """Yield a unique file name for the drawing of each drop, after its recording."""
    return file_names([drop.title or str(PurePath(drop.file).with_suffix("")) for drop in check.drops])


def file_names(drops: Iterable[str]) -> Iterator[str]:
    """Yield a unique file name for the drawing of each drop."""
    used: set[str] = set()
    for drop in drops:
        plain = re.sub(r'[\\/:*?"<>|\s]+', "_", drop).lstrip("._")
        name, count = f"{plain}.svg", 1
        while name.lower() in used:  # some file systems take A.svg for a.svg
            count += 1
            name = f"{plain}_{count}.svg"
        used.add(name.lower())
        yield name
