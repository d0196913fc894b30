"""The style of the local page: that of the report, and readable for everybody."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

import sprung.app
from sprung.report import page_style

STYLES = Path(sprung.app.__file__).parent / "styles"
COMMAND = "SPRUNG_WRITE_STYLE=1 python -m pytest -n 0 tests/app/test_style.py"


def test_the_look_is_that_of_the_report() -> None:
    """The server does not load the report's room, which needs NumPy and SciPy, only for its style sheet."""
    stored = STYLES / "report.css"
    if os.environ.get("SPRUNG_WRITE_STYLE"):
        stored.write_text(page_style(), encoding="utf-8")
    assert stored.read_text(encoding="utf-8") == page_style(), f"write it anew: {COMMAND}"


@pytest.mark.parametrize("ground", ["light", "dark"])
def test_text_and_buttons_have_the_contrast_that_wcag_asks_for(ground: str) -> None:
    """WCAG 2.2: 1.4.3 asks for 4.5 of text, 1.4.11 for 3 of the borders of fields and buttons."""
    colours = _palette(ground)
    for below in ("paper", "raised"):
        for text in ("text", "subdued", "link", "accept", "doubtful", "reject", "fault"):
            assert contrast(colours[text], colours[below]) >= 4.5, (text, below)
    assert contrast(colours["paper"], colours["link"]) >= 4.5  # the main button


def _palette(ground: str) -> dict[str, str]:
    style = (STYLES / "report.css").read_text(encoding="utf-8")
    light, dark = re.findall(r":root \{ (--[^}]*)\}", style)
    return dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", light if ground == "light" else dark))


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours, as WCAG 2.2 defines it."""
    high, low = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("path", sorted(STYLES.with_name("scripts").glob("*.js")), ids=lambda path: path.name)
def test_no_script_writes_markup_or_loads_anything_from_elsewhere(path: Path) -> None:
    """Texts of files become text nodes; drawings of the server are parsed as documents, in which nothing runs."""
    forbidden = r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|srcdoc|https?://(?!www\.w3\.org/)"
    assert re.findall(forbidden, path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("path", sorted(STYLES.with_name("templates").glob("*.html")), ids=lambda path: path.name)
def test_no_template_has_scripts_or_styles_of_its_own(path: Path) -> None:
    """The policy of the pages, `default-src 'self'`, would refuse them; nothing switches the escaping off."""
    text = path.read_text(encoding="utf-8")
    assert re.findall(r"<script(?![^>]*\bsrc=)|<style|\bstyle=|\son\w+=|javascript:|\|\s*safe\b|autoescape", text) == []
