"""Colours: every one that writes stands out from every ground it may be on, as WCAG 2.2 AA asks of small text."""

from __future__ import annotations

import pytest

from sprung.report.drawing.palette import DARK, LIGHT

WRITTEN = ("text", "subdued", "link", "accept", "doubtful", "reject", "fault", "release", "landing", "mode")
GROUNDS = ("paper", "raised", "band")
DRAWN = ("simulated", "residual", "signal", "first", "second", "fault", "mode", "release", "landing")


def luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours (WCAG 2.2, 1.4.3)."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_words_stand_out_from_their_ground(palette: dict[str, str]) -> None:
    found = {(one, ground): contrast(palette[one], palette[ground]) for one in WRITTEN for ground in GROUNDS}
    assert {pair: ratio for pair, ratio in found.items() if ratio < 4.5} == {}


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_curves_stand_out_from_their_ground(palette: dict[str, str]) -> None:
    """Graphics need 3 to 1 (WCAG 2.2, 1.4.11)."""
    found = {(one, ground): contrast(palette[one], palette[ground]) for one in DRAWN for ground in ("paper", "band")}
    assert {pair: ratio for pair, ratio in found.items() if ratio < 3} == {}
