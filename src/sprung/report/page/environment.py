"""The template environment of both pages."""

from __future__ import annotations

from jinja2 import ChoiceLoader, Environment, PackageLoader

ENVIRONMENT = Environment(
    loader=ChoiceLoader([PackageLoader("sprung.report.page"), PackageLoader("sprung.report.drawing", "styles")]),
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)
"""Templates of the pages, and the style sheets of pictures and sketches that they include."""
