"""The report: one self-contained page with everything about a result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.resources import files
from typing import NamedTuple

from markupsafe import Markup

from sprung.errors import record_failure
from sprung.report.drawing.picture import Picture
from sprung.report.drawing.style import standalone_style
from sprung.report.drawing.svg import picture_svg, reduce_height
from sprung.report.excitations import excitations_text
from sprung.report.page import sections
from sprung.report.page.embedded import figure_json
from sprung.report.page.environment import ENVIRONMENT
from sprung.report.page.sections.context import Context
from sprung.report.page.summary import summary_of, test_record_of, verdict_text
from sprung.report.sketch.shapes import Drawing
from sprung.report.sketch.svg import sketch_svg
from sprung.results import TRACE_TITLE, Result

FILE = "report.html"
"""File name of the report."""

_SCRIPTS = ("data", "save", "scope", "figures", "modes", "main")
"""Parts of the script of the page, in order."""


class Section(NamedTuple):
    """One part of the page."""

    anchor: str
    title: str
    body: Markup


def report_html(result: Result, unfolded: bool = False) -> str:
    """Return the report; parts that cannot be drawn are listed at its top.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    unfolded
        Whether every picture is visible, as on paper.

    Returns
    -------
    str
        HTML; identical for identical results.
    """
    return render_report(result, unfolded)[0]


def render_report(result: Result, unfolded: bool = False) -> tuple[str, tuple[str, ...]]:
    """Return the report, and the parts that could not be drawn.

    Parameters
    ----------
    result, unfolded
        As for `report_html`.

    Returns
    -------
    tuple
        HTML, and a sentence for each omission, those of the result first.
    """
    page = ENVIRONMENT.get_template("page.html")
    record = list(test_record_of(result))
    omissions = list(result.omissions)
    sections = list(_sections(result, unfolded, omissions))
    html = page.render(
        result=result,
        omissions=tuple(omissions),
        verdict=verdict_text(result),
        record=record,
        running_head=_css_text(" · ".join([result.name, *(text for name, text in record if name == "Date")])),
        summary=summary_of(result),
        tests=excitations_text(result.drops),
        sections=sections,
        script=Markup("" if unfolded else _script()),  # noqa: S704 (made here)
    )
    return html, tuple(omissions)


def _script() -> str:
    folder = files("sprung.report.page").joinpath("scripts")
    return "\n".join(folder.joinpath(f"{name}.js").read_text(encoding="utf-8") for name in _SCRIPTS)


def _css_text(text: str) -> Markup:
    """Return text as a string of a style sheet, special characters as escapes."""
    letters = (c if c.isascii() and c.isalnum() else f"\\{ord(c):x} " for c in text if c.isprintable())
    return Markup('"{}"').format(Markup("".join(letters)))  # noqa: S704 (escaped above)


def _sections(result: Result, unfolded: bool, omissions: list[str]) -> Iterator[Section]:
    style = standalone_style(halo=False) if unfolded else ""
    parts: tuple[tuple[str, str, str, Callable[[], Context | None]], ...] = (
        (
            "characteristics",
            "Masses, ride and wheel hop",
            "characteristics.html",
            lambda: sections.characteristics(result),
        ),
        ("parameters", "Parameters", "parameters.html", lambda: sections.parameters(result)),
        ("curves", "Force curves", "pictures.html", lambda: sections.curves(result)),
        ("geometry", "Geometry, sensors and loads", "geometry.html", lambda: sections.geometry(result)),
        ("known", "Known beforehand", "known.html", lambda: sections.known(result)),
        ("recordings", "Recordings", "recordings.html", lambda: sections.recordings(result, unfolded)),
        ("spectra", "Spectra", "pictures.html", lambda: sections.spectra(result)),
        ("stabilisation", "Stabilisation diagram", "pictures.html", lambda: sections.stabilisation(result)),
        ("modes", "Modes", "modes.html", lambda: sections.modes(result)),
        ("comparison", "Measured and simulated", "motions.html", lambda: sections.motions(result, unfolded)),
        ("ride", "Ride and inspection", "pictures.html", lambda: sections.riding(result)),
        ("amplitude", "Frequency and damping against amplitude", "pictures.html", lambda: sections.amplitude(result)),
        ("correlation", "Correlation of the parameters", "correlation.html", lambda: sections.correlation(result)),
        ("next", "What to measure next", "next.html", lambda: sections.next_step(result)),
        ("trace", TRACE_TITLE, "trace.html", lambda: sections.trace(result, unfolded)),
        ("settings", "Settings, versions and files", "settings.html", lambda: sections.settings(result)),
        ("literature", "Literature", "literature.html", lambda: sections.literature(result)),
    )

    def draw(picture: Picture) -> Markup:
        picture = reduce_height(picture) if unfolded else picture
        data = "" if unfolded else f'<script type="application/json" class="data">{figure_json(picture)}</script>'
        return Markup(picture_svg(picture, style) + data)  # noqa: S704 (escaped there)

    def sketch(drawing: Drawing) -> Markup:
        return Markup(sketch_svg(drawing, style))  # noqa: S704 (escaped there)

    macros = ENVIRONMENT.get_template("macros.html").module
    tools = {"macros": macros, "draw": draw, "sketch": sketch, "style": Markup(style)}  # noqa: S704 (made here)
    for anchor, title, template, context in parts:
        body = None
        # A section that fails does not affect the others: the reason is given at the top.
        with record_failure(omissions, f'The part "{title}" of the report'):
            shown = context()
            if shown is not None:
                body = ENVIRONMENT.get_template(template).render(**tools, **shown)
        if body is not None:
            yield Section(anchor, title, Markup(body))  # noqa: S704 (escaped by the template)
