"""SVG elements and files around the content of a drawing."""

from __future__ import annotations

from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.style import standalone_style
from sprung.tables import escaped


def svg_element(kind: str, size: tuple[float, float], title: str, description: str, content: str) -> str:
    """Return an ``svg`` element for a page.

    Parameters
    ----------
    kind
        Class of the element: ``picture`` or ``sketch``.
    size
        Width and height, units.
    title, description
        For tooltips and screen readers; the description may be empty.
    content
        SVG elements, with a style element where the style of the page does not apply.

    Returns
    -------
    str
    """
    described = f"<desc>{escaped(description)}</desc>" if description else ""
    return (
        f'<svg class="{kind}" viewBox="0 0 {size[0]:.0f} {size[1]:.0f}" role="img" aria-label="{escaped(title)}">'
        f"<title>{escaped(title)}</title>{described}{content}</svg>"
    )


def svg_file(title: str, size: tuple[float, float], rules: str, content: str, kind: str = "", margin: int = 0) -> str:
    """Return an SVG file on light ground.

    Parameters
    ----------
    title
        Of the document.
    size
        Width and height without margins, units.
    rules
        Style rules beside those of pictures and sketches.
    content
        SVG elements.
    kind
        Class of the root element; empty for none.
    margin
        On all sides, units.

    Returns
    -------
    str
    """
    (width, height), own_class = size, f' class="{kind}"' if kind else ""
    box = f"{-margin} {-margin} {width + 2 * margin:.0f} {height + 2 * margin:.0f}"
    ground = f'<rect x="{-margin}" y="{-margin}" width="100%" height="100%" fill="{LIGHT["paper"]}"/>'
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg"{own_class} viewBox="{box}" width="{width:.0f}" height="{height:.0f}">'
        f"<title>{escaped(title)}</title>{standalone_style()}<style>{rules}</style>{ground}{content}</svg>\n"
    )
