"""Style sheet of the pages: colours on light and dark ground, pictures, sketches, text and tables."""

from __future__ import annotations

from sprung.report.page.environment import ENVIRONMENT


def page_style() -> str:
    """Return the style sheet of the pages without the rules for printing, for other pages of the same look.

    Returns
    -------
    str
        CSS; colours are custom properties by their meaning, such as ``--accept``.
    """
    return ENVIRONMENT.get_template("style.css").render()
