"""Pictures side by side in an SVG file of their own, with a title and what is to be said above them."""

from __future__ import annotations

from collections.abc import Sequence

from sprung.report.drawing.legend import WIDTH
from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.picture import Picture
from sprung.report.drawing.style import alone_style
from sprung.report.drawing.svg import drawn
from sprung.tables import escaped

_GAP, _EDGE, _LINE = 24, 14, 15
"""Units: between pictures, around the sheet, from line to line."""

_ACROSS = 3
"""Pictures beside each other at the most."""

_LETTERS = 1 / 5.4
"""Letters of a line in one unit."""


def sheet(title: str, lines: Sequence[tuple[str, bool]], pictures: Sequence[Picture]) -> str:
    """Put pictures beside each other.

    Parameters
    ----------
    title
        Above everything.
    lines
        Below it, each with whether it tells of something wrong; long ones are parted.
    pictures
        At least one.

    Returns
    -------
    str
        The content of an SVG file; the same for the same pictures.
    """
    across = min(len(pictures), _ACROSS)
    width = 2 * _EDGE + across * WIDTH + (across - 1) * _GAP
    said = [(part, wrong) for text, wrong in lines for part in _parted(text, int((width - 2 * _EDGE) * _LETTERS))]
    parts = [f'<text class="title" x="{_EDGE}" y="{_EDGE + 10}">{escaped(title)}</text>']
    y = _EDGE + 12.0
    for text, wrong in said:
        y += _LINE
        kind = "said wrong" if wrong else "said"
        parts.append(f'<text class="{kind}" x="{_EDGE}" y="{y:.0f}">{escaped(text)}</text>')
    y += _LINE
    for first in range(0, len(pictures), across):
        row = [(picture, *drawn(picture)) for picture in pictures[first : first + across]]
        for column, (picture, inside, _) in enumerate(row):
            x = _EDGE + column * (WIDTH + _GAP)
            if picture.title != title:
                parts.append(f'<text class="head" x="{x}" y="{y + 8:.0f}">{escaped(picture.title)}</text>')
            told = f"<desc>{escaped(picture.told)}</desc>" if picture.told else ""
            parts.append(f'<g class="picture" transform="translate({x} {y + 14:.0f})">{told}{inside}</g>')
        y += 14 + max(height for *_, height in row) + _GAP
    font = "system-ui, -apple-system, Segoe UI, Roboto, Helvetica Neue, Arial, DejaVu Sans, sans-serif"
    own = (
        f"text {{ font: 10.5px {font}; }} .title {{ font-size: 15px; font-weight: 600; fill: {LIGHT['text']}; }} "
        f".said {{ fill: {LIGHT['subdued']}; }} .said.wrong {{ fill: {LIGHT['fault']}; }} .head {{ font-weight: 600; }}"
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {y:.0f}" width="{width}" height="{y:.0f}">'
        f"<title>{escaped(title)}</title><style>{own}</style>{alone_style()}"
        f'<rect width="100%" height="100%" fill="{LIGHT["paper"]}"/>{"".join(parts)}</svg>\n'
    )


def _parted(text: str, most: int) -> list[str]:
    """Part a line between words where it is too long."""
    lines = [""]
    for word in text.split(" "):
        fits = len(lines[-1]) + len(word) < most or not lines[-1]
        lines[-1:] = [f"{lines[-1]} {word}".strip()] if fits else [lines[-1], word]
    return lines
