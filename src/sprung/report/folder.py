"""The results folder: results.json and series.npz first, then the report beside them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from sprung.checking import Check
from sprung.errors import InputError, Omissions
from sprung.files import atomic_write
from sprung.report.drawings import draw_check
from sprung.report.page.check_page import CHECK_FILE, check_page
from sprung.report.page.pdf import PDF_FILE, pdf_of
from sprung.report.page.result_page import FILE, drawn_page
from sprung.results import Result, load
from sprung.study import Validation

RESULT_FILES = ("results.json", "series.npz")
"""What programs read; the report can be made from it."""

REPORT_FILES = (*RESULT_FILES, FILE)
"""What an identification writes with its report."""


class Saved(NamedTuple):
    """What was written.

    Attributes
    ----------
    result
        With everything that is missing named in its ``omissions``.
    files
        Every file, results.json first.
    """

    result: Result
    files: tuple[Path, ...]


def save_result(result: Result, folder: Path, *, overwrite: bool = False) -> Saved:
    """Write results.json and series.npz, before anything is drawn.

    Parameters
    ----------
    result
        From `sprung.identify`.
    folder
        Made if it does not exist. An earlier result of sprung's is replaced; a report of it goes, for it would be read as
        this one's.
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
    return Saved(result, tuple(folder / name for name in reversed(files)))


def add_report(result: Result, folder: Path, *, overwrite: bool = False) -> Saved:
    """Write the report beside a result that is saved; what of it cannot be drawn is named in results.json too.

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
    omissions, page = Omissions(result.omissions), ""
    with omissions.noting("The report", "written"):
        page, missing = drawn_page(result)
        omissions.add(missing)
    result = replace(result, omissions=omissions.sentences)
    files = ({FILE: page.encode()} if page else {}) | result.files()
    atomic_write(folder, files, overwrite=overwrite, obsolete=(FILE, PDF_FILE))
    return Saved(result, tuple(folder / name for name in reversed(files)))


def write_report(folder: Path, pdf: bool = False, *, overwrite: bool = False) -> Saved:
    """Write the report of a result again, from its folder alone.

    Parameters
    ----------
    folder
        With results.json and series.npz, as `Result.save` writes it.
    pdf
        Whether to write it for paper too.
    overwrite
        Whether a report that sprung did not write, or that was changed since, is replaced too.

    Returns
    -------
    Saved
        report.html, and report.pdf where it was asked for and could be written.

    Raises
    ------
    InputError
        If the result cannot be read, other files would be overwritten, the folder cannot be written, or there is no library
        that writes PDF.
    """
    result = load(folder)
    page, missing = drawn_page(result)
    omissions = Omissions(missing)
    files = {FILE: page.encode()}
    if pdf:
        with omissions.noting("The report for paper", "written", unless=(InputError,)):
            files[PDF_FILE] = pdf_of(result)
    atomic_write(folder, files, overwrite=overwrite)
    written = tuple(folder / name for name in files)
    return Saved(replace(result, omissions=omissions.sentences), written)


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


def write_validation(
    validation: Validation, folder: Path, drawings: Mapping[str, str], *, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write numbers, series and drawings into a folder, all of them or none.

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
