"""The report: one page that says everything of a result, and needs nothing but itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from jinja2 import Environment, PackageLoader
from markupsafe import Markup

from sprung.pipeline import Result
from sprung.report import sections
from sprung.report.palette import DARK, LIGHT
from sprung.report.picture import Picture
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
    """Write the report.

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
    page = _ENVIRONMENT.get_template("page.html")
    return page.render(
        result=result,
        verdict=verdict_words(result),
        facts=facts_of(result),
        sections=list(_sections(result, unfolded)),
        light=LIGHT,
        dark=DARK,
        roles=Markup("\n".join(role_rules())),  # noqa: S704 (made here)
    )


def _sections(result: Result, unfolded: bool) -> Iterator[Section]:
    few = unfolded or len(result.drops) <= _FEW
    style = alone_style() if unfolded else ""
    parts = (
        ("parameters", "Parameters", "parameters.html", sections.parameters(result)),
        ("known", "What was known, and what was found", "known.html", sections.known(result)),
        ("recordings", "Recordings", "recordings.html", sections.recordings(result, few, unfolded)),
        ("spectra", "Spectra", "pictures.html", sections.spectra(result)),
        ("stabilisation", "Stabilisation diagram", "pictures.html", sections.stabilisation(result)),
        ("modes", "Modes", "modes.html", sections.modes(result)),
        ("comparison", "Measured and simulated", "motions.html", sections.motions(result, few)),
        ("amplitude", "Frequency and damping against amplitude", "pictures.html", sections.amplitude(result)),
        ("correlation", "Correlation of the parameters", "correlation.html", sections.correlation(result)),
        ("next", "What to measure next", "next.html", sections.next_step(result)),
        ("settings", "Settings, versions and files", "settings.html", sections.settings(result)),
        ("literature", "Literature", "literature.html", sections.literature(result)),
    )

    def draw(picture: Picture) -> Markup:
        return Markup(svg_of(picture, style))  # noqa: S704 (it escapes its words)

    macros = _ENVIRONMENT.get_template("macros.html").module
    for anchor, title, template, context in parts:
        if context is not None:
            body = _ENVIRONMENT.get_template(template).render(macros=macros, draw=draw, style=Markup(style), **context)  # noqa: S704 (made here)
            yield Section(anchor, title, Markup(body))  # noqa: S704 (a template that escapes wrote it)
