"""The report as PDF, where WeasyPrint is installed."""

from __future__ import annotations

from importlib import import_module

from sprung.errors import InputError, Problem
from sprung.report.page.report import report_html
from sprung.results import Result

PDF_FILE = "report.pdf"
"""File name of the report as PDF."""


def pdf_of(result: Result) -> bytes:
    """Return the report as PDF on A4 pages, with everything unfolded.

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
        If WeasyPrint, or a library that it needs, is not installed.
    """
    try:
        # An optional dependency, which needs libraries of the system.
        weasyprint = import_module("weasyprint")
    except (ImportError, OSError) as error:
        found = f"no library weasyprint ({error})"
        do = 'Install it with: pip install "sprung[pdf]"; or print report.html from a browser.'
        raise InputError([Problem("report.pdf", found, "an installation that can write PDF", do)]) from error
    page = weasyprint.HTML(string=report_html(result, unfolded=True), url_fetcher=_refuse_url)
    written: bytes = page.write_pdf()
    return written


def _refuse_url(url: str) -> dict[str, object]:
    """Refuse every address: the report is self-contained."""
    if url.startswith("data:"):
        return {"string": b"", "mime_type": "text/plain"}
    raise ValueError(f"the report must not load {url}")
