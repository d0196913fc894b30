"""The report on paper, where WeasyPrint, which sets pages, is installed."""

from __future__ import annotations

from importlib import import_module

from sprung.errors import InputError, Problem
from sprung.report.page.result_page import page_of
from sprung.results import Result

PDF_FILE = "report.pdf"
"""The name of the report for paper."""


def pdf_of(result: Result) -> bytes:
    """Set the report on A4 pages, with everything unfolded.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.

    Returns
    -------
    bytes
        A PDF file.

    Raises
    ------
    InputError
        If WeasyPrint is not installed, or the libraries that it draws text with.
    """
    try:
        # Not everybody needs paper, and it draws with libraries of the system.
        weasyprint = import_module("weasyprint")
    except (ImportError, OSError) as error:
        found = f"no library weasyprint, which sets its pages ({error})"
        do = 'Install it with: pip install "sprung[pdf]"; or print report.html from a browser.'
        raise InputError([Problem("report.pdf", found, "an installation that can write PDF", do)]) from error
    page = weasyprint.HTML(string=page_of(result, unfolded=True), url_fetcher=_nothing_else)
    written: bytes = page.write_pdf()
    return written


def _nothing_else(url: str) -> dict[str, object]:
    """Refuse whatever a page might load: this one needs nothing."""
    if url.startswith("data:"):
        return {"string": b"", "mime_type": "text/plain"}
    raise ValueError(f"the report loads nothing, but asked for {url}")
