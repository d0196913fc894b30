"""Style sheets of pictures and sketches: with the colours of a page, or standalone."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.resources import files
from typing import get_args

from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.picture import Role


def role_styles() -> Iterator[str]:
    """Yield the style rules that give marks the colour of their role."""
    for role in get_args(Role):
        kinds = ", ".join(f".picture .{kind}.{role}" for kind in ("curve", "points", "rule", "bars"))
        yield f"{kinds} {{ stroke: var(--{role}); }}"
        yield f".picture .area.{role} {{ fill: var(--{role}); }}"


def standalone_style(halo: bool = True) -> str:
    """Return the light style of a picture in a file of its own, or where the style of the page does not apply.

    Parameters
    ----------
    halo
        Whether text has a rim in the colour of the ground; programs that cannot paint it below the text would hide the text.
    """
    styles = files("sprung.report.drawing").joinpath("styles")
    sheets = [styles.joinpath(name).read_text(encoding="utf-8") for name in ("picture.css", "sketch.css")]
    rules = "\n".join([*role_styles(), *sheets])
    if not halo:
        rules = re.sub(r"paint-order: stroke;[^}]*(?=})", "", rules)
    light = re.sub(r"var\(--(\w+)\)", lambda match: LIGHT[match[1]], rules)
    return f"<style>{light}</style>"
