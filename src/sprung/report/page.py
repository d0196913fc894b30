"""The report: one page that says everything of a result, and needs nothing but itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

from jinja2 import Environment, PackageLoader
from markupsafe import Markup

from sprung.errors import Omissions
from sprung.pipeline import Result
from sprung.report import sections
from sprung.report.palette import DARK, LIGHT
from sprung.report.picture import Picture
from sprung.report.sections.context import Context
from sprung.report.style import alone_style, role_rules
from sprung.report.svg import svg_of
from sprung.report.words import facts_of, verdict_words

FILE = "report.html"
"""The report's name beside results.json."""

_FEW = 12
"""Drops up to which their pictures are unfolded."""

_ENVIRONMENT = Environment(
    loader=PackageLoader("sprung.report"),
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


class Section(NamedTuple):
    """One part of the page."""

    anchor: str
    title: str
    body: Markup


def page_of(result: Result, unfolded: bool = False) -> str:
    """Write the report; a part that cannot be drawn is named at its top.

    Parameters
    ----------
    result
        From `sprung.identify` or `sprung.load`.
    unfolded
        Whether every picture is to be seen at once, as on paper.

    Returns
    -------
    str
        HTML; the same for the same result.
    """
    return drawn_page(result, unfolded)[0]


def drawn_page(result: Result, unfolded: bool = False) -> tuple[str, tuple[str, ...]]:
    """Write the report, and say which parts of it could not be drawn.

    Parameters
    ----------
    result, unfolded
        As for `page_of`.

    Returns
    -------
    tuple
        HTML, and a sentence for each thing that is missing, those of the result first.
    """
    page = _ENVIRONMENT.get_template("page.html")
    omissions = Omissions(result.omissions)
    sections = list(_sections(result, unfolded, omissions))
    text = page.render(
        result=result,
        omissions=omissions.sentences,
        verdict=verdict_words(result),
        facts=facts_of(result),
        sections=sections,
        light=LIGHT,
        dark=DARK,
        roles=Markup("\n".join(role_rules())),  # noqa: S704 (made here)
    )
    return text, omissions.sentences


def _sections(result: Result, unfolded: bool, omissions: Omissions) -> Iterator[Section]:
    few = unfolded or len(result.drops) <= _FEW
    style = alone_style() if unfolded else ""
    parts: tuple[tuple[str, str, str, Callable[[], Context | None]], ...] = (
        ("parameters", "Parameters", "parameters.html", lambda: sections.parameters(result)),
        ("known", "What was known, and what was found", "known.html", lambda: sections.known(result)),
        ("recordings", "Recordings", "recordings.html", lambda: sections.recordings(result, few, unfolded)),
        ("spectra", "Spectra", "pictures.html", lambda: sections.spectra(result)),
        ("stabilisation", "Stabilisation diagram", "pictures.html", lambda: sections.stabilisation(result)),
        ("modes", "Modes", "modes.html", lambda: sections.modes(result)),
        ("comparison", "Measured and simulated", "motions.html", lambda: sections.motions(result, few)),
        ("amplitude", "Frequency and damping against amplitude", "pictures.html", lambda: sections.amplitude(result)),
        ("correlation", "Correlation of the parameters", "correlation.html", lambda: sections.correlation(result)),
        ("next", "What to measure next", "next.html", lambda: sections.next_step(result)),
        ("settings", "Settings, versions and files", "settings.html", lambda: sections.settings(result)),
        ("literature", "Literature", "literature.html", lambda: sections.literature(result)),
    )

    def draw(picture: Picture) -> Markup:
        return Markup(svg_of(picture, style))  # noqa: S704 (it escapes its words)

    macros = _ENVIRONMENT.get_template("macros.html").module
    for anchor, title, template, context in parts:
        body = None
        # A part that fails costs no other: the reason why it is missing stands at the top.
        with omissions.noting(f'The part "{title}" of the report'):
            shown = context()
            if shown is not None:
                sheet = _ENVIRONMENT.get_template(template)
                body = sheet.render(macros=macros, draw=draw, style=Markup(style), **shown)  # noqa: S704 (made here)
        if body is not None:
            yield Section(anchor, title, Markup(body))  # noqa: S704 (a template that escapes wrote it)
