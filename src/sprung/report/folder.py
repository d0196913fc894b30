"""Files in folders: results and report, check, cross-validation; all files of a call or none."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from sprung.checking import Check
from sprung.errors import InputError, record_failure
from sprung.files import atomic_write
from sprung.fleets import Fleet
from sprung.report.drawings import draw_check
from sprung.report.page.check import CHECK_FILE, check_html
from sprung.report.page.fleet import FLEET_FILE, fleet_html
from sprung.report.page.pdf import PDF_FILE, pdf_of
from sprung.report.page.report import FILE, render_report
from sprung.results import Result, load
from sprung.study import Validation

RESULT_FILES = ("results.json", "series.npz")
"""Files for programs, from which the report is made."""

REPORT_FILES = (*RESULT_FILES, FILE)
"""All files of an identification."""


class SavedResult(NamedTuple):
    """A result and its files.

    Attributes
    ----------
    result
        With every part that could not be written in its ``omissions``.
    files
        Paths, results.json first.
    """

    result: Result
    files: tuple[Path, ...]


def save_result(result: Result, folder: Path, *, overwrite: bool = False) -> SavedResult:
    """Write results.json and series.npz.

    Parameters
    ----------
    result
        From `sprung.identify`.
    folder
        Made if it does not exist. An earlier result of sprung is replaced, and its report deleted, because it would not belong
        to this result.
    overwrite
        Whether files that sprung did not write, or that were changed since, are replaced too.

    Returns
    -------
    Saved

    Raises
    ------
    InputError
        If such files would be overwritten, with their list, or the folder cannot be written.
    """
    files = result.files()
    atomic_write(folder, files, overwrite=overwrite, obsolete=(FILE, PDF_FILE))
    return SavedResult(result, tuple(folder / name for name in reversed(files)))


def add_report(result: Result, folder: Path, *, overwrite: bool = False) -> SavedResult:
    """Write the report beside a saved result; parts that cannot be drawn are listed in results.json too.

    Parameters
    ----------
    result, folder, overwrite
        As for `save_result`.

    Returns
    -------
    Saved

    Raises
    ------
    InputError
        As `save_result`.
    """
    omissions, page = list(result.omissions), ""
    with record_failure(omissions, "The report", "written"):
        page, missing = render_report(result)
        omissions += [sentence for sentence in missing if sentence not in omissions]
    result = replace(result, omissions=tuple(omissions))
    files = ({FILE: page.encode()} if page else {}) | result.files()
    atomic_write(folder, files, overwrite=overwrite, obsolete=(FILE, PDF_FILE))
    return SavedResult(result, tuple(folder / name for name in reversed(files)))


def write_report(folder: Path, pdf: bool = False, *, overwrite: bool = False) -> SavedResult:
    """Write the report of a saved result.

    Parameters
    ----------
    folder
        With results.json and series.npz, as `Result.save` writes it.
    pdf
        Whether to write it as PDF too.
    overwrite
        Whether a report that sprung did not write, or that was changed since, is replaced too.

    Returns
    -------
    Saved
        report.html, and report.pdf where requested and possible.

    Raises
    ------
    InputError
        If the result cannot be read, other files would be overwritten, the folder cannot be written, or the library for PDF
        is not installed.
    """
    result = load(folder)
    page, missing = render_report(result)
    omissions = list(missing)
    files = {FILE: page.encode()}
    if pdf:
        with record_failure(omissions, "The report as PDF", "written", unless=(InputError,)):
            files[PDF_FILE] = pdf_of(result)
    atomic_write(folder, files, overwrite=overwrite)
    written = tuple(folder / name for name in files)
    return SavedResult(replace(result, omissions=tuple(omissions)), written)


def write_check(
    check: Check, folder: Path, *, page: bool = True, drawings: bool = False, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write the page of a check, and drawings of its drops, into a folder.

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
    files = ({CHECK_FILE: check_html(check)} if page else {}) | (draw_check(check) if drawings else {})
    atomic_write(folder, {name: text.encode() for name, text in files.items()}, overwrite=overwrite)
    return tuple(folder / name for name in files)


def write_fleet(fleet: Fleet, folder: str | os.PathLike[str], *, overwrite: bool = False) -> tuple[Path, ...]:
    """Write the page of a fleet, and its numbers, into a folder.

    Parameters
    ----------
    fleet
        From `sprung.fleet`.
    folder
        Made if it does not exist. Files that sprung wrote there are replaced.
    overwrite
        Whether other files of the same names, and files that were changed since sprung wrote them, are replaced too.

    Returns
    -------
    tuple of Path
        fleet.html and fleet.json.

    Raises
    ------
    InputError
        If such files would be overwritten, or the folder cannot be written.
    """
    document = json.dumps(fleet.document(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    files = {FLEET_FILE: fleet_html(fleet).encode(), "fleet.json": document.encode()}
    atomic_write(folder, files, overwrite=overwrite)
    return tuple(Path(folder) / name for name in files)


def write_validation(
    validation: Validation, folder: Path, drawings: Mapping[str, str], *, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write numbers, series and drawings of a cross-validation into a folder.

    Parameters
    ----------
    validation
        From `sprung.validate`.
    folder
        Made if it does not exist. Files that sprung wrote there are replaced.
    drawings
        From `draw_validation`.
    overwrite
        Whether other files of the same names, and files that were changed since sprung wrote them, are replaced too.

    Returns
    -------
    tuple of Path
        Every file.

    Raises
    ------
    InputError
        If such files would be overwritten, or the folder cannot be written.
    """
    files = {name: text.encode() for name, text in drawings.items()} | validation.files()
    atomic_write(folder, files, overwrite=overwrite)
    return tuple(folder / name for name in files)
