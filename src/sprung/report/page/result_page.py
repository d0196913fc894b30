"""The report: one page that says everything of a result, and needs nothing but itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.resources import files
from typing import NamedTuple

from markupsafe import Markup

from sprung.errors import Omissions
from sprung.report.drawing.palette import DARK, LIGHT
from sprung.report.drawing.picture import Picture
from sprung.report.drawing.style import alone_style, role_rules
from sprung.report.drawing.svg import lower, svg_of
from sprung.report.page import sections
from sprung.report.page.embedded import figure_json
from sprung.report.page.environment import ENVIRONMENT
from sprung.report.page.sections.context import Context
from sprung.report.page.summary import facts_of, record_of, verdict_words
from sprung.report.sketch.shapes import Drawing
from sprung.report.sketch.svg import drawing_svg
from sprung.results import TRACE_TITLE, Result

FILE = "report.html"
"""The report's name beside results.json."""

_SCRIPTS = ("data", "save", "scope", "figures", "modes", "main")
"""What the page's script is put together from, in order."""


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
    page = ENVIRONMENT.get_template("page.html")
    record = list(record_of(result))
    omissions = Omissions(result.omissions)
    sections = list(_sections(result, unfolded, omissions))
    text = page.render(
        result=result,
        omissions=omissions.sentences,
        verdict=verdict_words(result),
        record=record,
        running_head=_css_text(" · ".join([result.name, *(told for name, told in record if name == "Date")])),
        facts=facts_of(result),
        sections=sections,
        light=LIGHT,
        dark=DARK,
        roles=Markup("\n".join(role_rules())),  # noqa: S704 (made here)
        script=Markup("" if unfolded else _script()),  # noqa: S704 (made here)
    )
    return text, omissions.sentences


def _script() -> str:
    folder = files("sprung.report.page").joinpath("scripts")
    return "\n".join(folder.joinpath(f"{name}.js").read_text(encoding="utf-8") for name in _SCRIPTS)


def _css_text(text: str) -> Markup:
    """Write text as a string of a style sheet, every letter that could mean something there by its number."""
    letters = (one if one.isascii() and one.isalnum() else f"\\{ord(one):x} " for one in text if one.isprintable())
    return Markup('"{}"').format(Markup("".join(letters)))  # noqa: S704 (nothing is left in it that means something)


def _sections(result: Result, unfolded: bool, omissions: Omissions) -> Iterator[Section]:
    style = alone_style(halo=False) if unfolded else ""
    parts: tuple[tuple[str, str, str, Callable[[], Context | None]], ...] = (
        (
            "characteristics",
            "Masses, ride and wheel hop",
            "characteristics.html",
            lambda: sections.characteristics(result),
        ),
        ("parameters", "Parameters", "parameters.html", lambda: sections.parameters(result)),
        ("geometry", "Geometry, sensors and loads", "geometry.html", lambda: sections.geometry(result)),
        ("known", "Known beforehand", "known.html", lambda: sections.known(result)),
        ("recordings", "Recordings", "recordings.html", lambda: sections.recordings(result, unfolded)),
        ("spectra", "Spectra", "pictures.html", lambda: sections.spectra(result)),
        ("stabilisation", "Stabilisation diagram", "pictures.html", lambda: sections.stabilisation(result)),
        ("modes", "Modes", "modes.html", lambda: sections.modes(result)),
        ("comparison", "Measured and simulated", "motions.html", lambda: sections.motions(result, unfolded)),
        ("amplitude", "Frequency and damping against amplitude", "pictures.html", lambda: sections.amplitude(result)),
        ("correlation", "Correlation of the parameters", "correlation.html", lambda: sections.correlation(result)),
        ("next", "What to measure next", "next.html", lambda: sections.next_step(result)),
        ("trace", TRACE_TITLE, "trace.html", lambda: sections.trace(result, unfolded)),
        ("settings", "Settings, versions and files", "settings.html", lambda: sections.settings(result)),
        ("literature", "Literature", "literature.html", lambda: sections.literature(result)),
    )

    def draw(picture: Picture) -> Markup:
        picture = lower(picture) if unfolded else picture
        data = "" if unfolded else f'<script type="application/json" class="data">{figure_json(picture)}</script>'
        return Markup(svg_of(picture, style) + data)  # noqa: S704 (they escape their words)

    def sketch(drawing: Drawing) -> Markup:
        return Markup(drawing_svg(drawing, style))  # noqa: S704 (it escapes its words)

    macros = ENVIRONMENT.get_template("macros.html").module
    tools = {"macros": macros, "draw": draw, "sketch": sketch, "style": Markup(style)}  # noqa: S704 (made here)
    for anchor, title, template, context in parts:
        body = None
        # A part that fails costs no other: the reason why it is missing stands at the top.
        with omissions.noting(f'The part "{title}" of the report'):
            shown = context()
            if shown is not None:
                body = ENVIRONMENT.get_template(template).render(**tools, **shown)
        if body is not None:
            yield Section(anchor, title, Markup(body))  # noqa: S704 (a template that escapes wrote it)
