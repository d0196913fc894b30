"""How pictures look: rules of style whose colours a page sets, or which stand alone in a file of their own."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.resources import files
from typing import get_args

from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.picture import Role


def role_rules() -> Iterator[str]:
    """Give the rules by which what is drawn has the colour of what it stands for."""
    for role in get_args(Role):
        kinds = ", ".join(f".picture .{kind}.{role}" for kind in ("curve", "points", "rule", "bars"))
        yield f"{kinds} {{ stroke: var(--{role}); }}"


def alone_style(halo: bool = True) -> str:
    """Give the style of a picture that stands alone, or where that of its page does not reach: the light one.

    Parameters
    ----------
    halo
        Whether words have a rim of the ground's colour. Where nothing knows how to paint that below them, it would hide them.
    """
    styles = files("sprung.report.drawing").joinpath("styles")
    own = [styles.joinpath(name).read_text(encoding="utf-8") for name in ("picture.css", "sketch.css")]
    rules = "\n".join([*role_rules(), *own])
    if not halo:
        rules = re.sub(r"paint-order: stroke;[^}]*(?=})", "", rules)
    light = re.sub(r"var\(--(\w+)\)", lambda found: LIGHT[found[1]], rules)
    return f"<style>{light}</style>"
