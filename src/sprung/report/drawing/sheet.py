"""Pictures side by side in one SVG file, with a title and lines of text above them."""

from __future__ import annotations

from collections.abc import Sequence

from sprung.report.drawing.elements import svg_file
from sprung.report.drawing.legend import WIDTH
from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.picture import Picture
from sprung.report.drawing.svg import draw_content
from sprung.tables import escaped

_GAP, _EDGE, _LINE = 24, 14, 15
"""Units: gap between pictures, margin of the sheet, line spacing."""

_ACROSS = 3
"""Largest number of pictures in a row."""

_LETTERS = 1 / 5.4
"""Letters of a line per unit."""


def draw_sheet(title: str, lines: Sequence[tuple[str, bool]], pictures: Sequence[Picture]) -> str:
    """Return an SVG file with pictures side by side.

    Parameters
    ----------
    title
        Above everything.
    lines
        Below it, each with whether it is a warning; long ones are wrapped.
    pictures
        At least one.

    Returns
    -------
    str
        The content of an SVG file; the same for the same pictures.
    """
    across = min(len(pictures), _ACROSS)
    width = 2 * _EDGE + across * WIDTH + (across - 1) * _GAP
    wrapped = [(line, warning) for text, warning in lines for line in _wrap(text, int((width - 2 * _EDGE) * _LETTERS))]
    parts = [f'<text class="title" x="{_EDGE}" y="{_EDGE + 10}">{escaped(title)}</text>']
    y = _EDGE + 12.0
    for text, warning in wrapped:
        y += _LINE
        kind = "line warning" if warning else "line"
        parts.append(f'<text class="{kind}" x="{_EDGE}" y="{y:.0f}">{escaped(text)}</text>')
    y += _LINE
    for first in range(0, len(pictures), across):
        row = [(picture, *draw_content(picture)) for picture in pictures[first : first + across]]
        for column, (picture, inside, _) in enumerate(row):
            x = _EDGE + column * (WIDTH + _GAP)
            if picture.title != title:
                parts.append(f'<text class="head" x="{x}" y="{y + 8:.0f}">{escaped(picture.title)}</text>')
            description = f"<desc>{escaped(picture.description)}</desc>" if picture.description else ""
            parts.append(f'<g class="picture" transform="translate({x} {y + 14:.0f})">{description}{inside}</g>')
        y += 14 + max(height for *_, height in row) + _GAP
    font = "system-ui, -apple-system, Segoe UI, Roboto, Helvetica Neue, Arial, DejaVu Sans, sans-serif"
    rules = (
        f"text {{ font: 10.5px {font}; }} .title {{ font-size: 15px; font-weight: 600; fill: {LIGHT['text']}; }} "
        f".line {{ fill: {LIGHT['subdued']}; }} .line.warning {{ fill: {LIGHT['fault']}; }} .head {{ font-weight: 600; }}"
    )
    return svg_file(title, (width, y), rules, "".join(parts))


def _wrap(text: str, most: int) -> list[str]:
    """Return the lines of a text, wrapped between words."""
    lines = [""]
    for word in text.split(" "):
        fits = len(lines[-1]) + len(word) < most or not lines[-1]
        lines[-1:] = [f"{lines[-1]} {word}".strip()] if fits else [lines[-1], word]
    return lines
