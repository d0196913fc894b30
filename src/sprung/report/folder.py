"""The results folder: results.json, series.npz and the report beside them, written together."""

from __future__ import annotations

from pathlib import Path

from sprung.pipeline import Result, load
from sprung.recording import write_whole
from sprung.report.page import FILE, page_of
from sprung.report.paper_copy import PDF_FILE, pdf_of


def write_results(result: Result, folder: Path, report: bool = True) -> tuple[Path, ...]:
    """Write a result into a folder, with its report or without, all of the files or none.

    Parameters
    ----------
    result
        From `sprung.identify`.
    folder
        Made if it does not exist. Files of the same names in it are replaced.
    report
        Whether to write report.html too. What an earlier result left there and this one does not write anew is taken away: it
        would be read as this one's.

    Returns
    -------
    tuple of Path
        Every file, results.json first.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    page = {FILE: page_of(result).encode()} if report else {}
    files = page | result.files()
    write_whole(folder, files)
    for stale in (PDF_FILE,) if report else (FILE, PDF_FILE):
        (folder / stale).unlink(missing_ok=True)
    return tuple(folder / name for name in reversed(files))


def write_report(folder: Path, pdf: bool = False) -> tuple[Path, ...]:
    """Write the report of a result again, from its folder alone.

    Parameters
    ----------
    folder
        With results.json and series.npz, as `Result.save` writes it.
    pdf
        Whether to write it for paper too.

    Returns
    -------
    tuple of Path
        report.html, and report.pdf where it was asked for.

    Raises
    ------
    InputError
        If the result cannot be read, the folder cannot be written, or there is no library that writes PDF.
    """
    result = load(folder)
    files = {FILE: page_of(result).encode()}
    if pdf:
        files[PDF_FILE] = pdf_of(result)
    write_whole(folder, files)
    return tuple(folder / name for name in files)
