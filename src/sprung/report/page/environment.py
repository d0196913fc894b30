"""The template environment of all pages."""

from __future__ import annotations

from jinja2 import ChoiceLoader, Environment, PackageLoader
from markupsafe import Markup

from sprung.report.drawing.palette import DARK, LIGHT
from sprung.report.drawing.picture import Picture
from sprung.report.drawing.style import role_styles
from sprung.report.drawing.svg import picture_svg
from sprung.report.sketch.shapes import Drawing
from sprung.report.sketch.svg import sketch_svg


def _draw(picture: Picture) -> Markup:
    return Markup(picture_svg(picture))  # noqa: S704 (escaped there)


def _draw_sketch(drawing: Drawing) -> Markup:
    return Markup(sketch_svg(drawing))  # noqa: S704 (escaped there)


ENVIRONMENT = Environment(
    loader=ChoiceLoader([PackageLoader("sprung.report.page"), PackageLoader("sprung.report.drawing", "styles")]),
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)
"""Templates of the pages, and the style sheets of pictures and sketches that they include."""

ENVIRONMENT.globals.update(
    light=LIGHT,
    dark=DARK,
    roles=Markup("\n".join(role_styles())),  # noqa: S704 (made here)
    draw=_draw,
    draw_sketch=_draw_sketch,
)
