"""A comparison that a command printed as JSON, as people read it; runs in the process that answers questions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter
from rich.console import Console

from sprung.report import comparison_view, differences_picture, picture_svg, text_of
from sprung.study import Comparison

_WIDTH = 110
"""Columns of the text."""


def show(document: Mapping[str, Any]) -> dict[str, str]:
    """Return the text that a terminal shows of a comparison, and the picture of its differences.

    Parameters
    ----------
    document
        As `sprung compare --json` prints it.

    Returns
    -------
    dict
        ``text``, and ``picture``, an SVG element; empty where no difference can be drawn.
    """
    comparison = TypeAdapter(Comparison).validate_python(document)
    picture = differences_picture(comparison)
    return {
        "text": text_of(comparison_view(comparison), Console(width=_WIDTH, highlight=False, no_color=True)),
        "picture": "" if picture is None else picture_svg(picture),
    }
