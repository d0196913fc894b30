"""How every drawing looks, and its way to SVG text that is the same for the same input."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable
from typing import Any

from matplotlib import style
from matplotlib.figure import Figure

from sprung.report.lanes import plain

# Told apart without colour vision too, and by their labels.
SIGNAL, FAINT, TEXT, QUIET = "#33424d", "#b3bcc2", "#1f2a31", "#6b7880"
ORANGE, BLUE, AMBER = "#c8501e", "#0072b2", "#9a6a00"

_STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
    "font.size": 8.0,
    "svg.fonttype": "none",
    "svg.hashsalt": "sprung",
    "axes.unicode_minus": True,
}


def svg_text(draw: Callable[[], Figure], title: str) -> str:
    """Turn a drawing into text.

    Parameters
    ----------
    draw
        Makes it.
    title
        What it is called.

    Returns
    -------
    str
        The same for the same drawing.
    """
    out = io.StringIO()
    # The same whatever anybody has set up for drawings of their own.
    with style.context(["default", _STYLE]), warnings.catch_warnings():
        # The font that measures text need not have every glyph that a viewer has.
        warnings.filterwarnings("ignore", message=r"Glyph .* missing")
        about = {"Date": None, "Creator": None, "Title": plain(title)}
        draw().savefig(out, format="svg", metadata=about)
    return out.getvalue()
