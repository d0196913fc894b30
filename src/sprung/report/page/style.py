"""Style sheet of the pages: colours on light and dark ground, pictures, sketches, text and tables."""

from __future__ import annotations

from markupsafe import Markup

from sprung.report.drawing.palette import DARK, LIGHT
from sprung.report.drawing.style import role_styles
from sprung.report.page.environment import ENVIRONMENT


def page_style() -> str:
    """Return the style sheet of the pages without the rules for printing, for other pages of the same look.

    Returns
    -------
    str
        CSS; colours are custom properties by their meaning, such as ``--accept``.
    """
    roles = Markup("\n".join(role_styles()))  # noqa: S704 (made here)
    return ENVIRONMENT.get_template("style.css").render(light=LIGHT, dark=DARK, roles=roles)
