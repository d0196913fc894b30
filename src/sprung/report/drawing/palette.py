"""Colours by their meaning, on light and on dark ground; distinguishable with colour-vision deficiencies too."""

from __future__ import annotations

from collections.abc import Mapping

LIGHT: Mapping[str, str] = {
    "paper": "#ffffff",
    "raised": "#f5f7f8",
    "text": "#1b262c",
    "subdued": "#5a6770",
    "hair": "#dbe1e4",
    "grid": "#e9edef",
    "band": "#e3eef6",
    "link": "#00649d",
    "accept": "#00664f",
    "doubtful": "#875a00",
    "reject": "#b3380b",
    "measured": "#aeb9c0",
    "simulated": "#0072b2",
    "residual": "#c8501e",
    "signal": "#33424d",
    "unused": "#b3bcc2",
    "release": "#8a5f00",
    "landing": "#00649d",
    "fault": "#a83f10",
    "mode": "#8d4a9b",
    "first": "#c8501e",
    "second": "#8a5f00",
    "reference": "#97a3aa",
}
"""On light ground and on paper: hexadecimal red, green and blue by meaning."""

DARK: Mapping[str, str] = {
    "paper": "#11181c",
    "raised": "#192227",
    "text": "#e4eaed",
    "subdued": "#9aa8b0",
    "hair": "#33414a",
    "grid": "#222d33",
    "band": "#182b38",
    "link": "#6cbcf2",
    "accept": "#4cc9a4",
    "doubtful": "#e0b050",
    "reject": "#f58b64",
    "measured": "#66757e",
    "simulated": "#58b2ee",
    "residual": "#f08a5d",
    "signal": "#c5d0d6",
    "unused": "#55626a",
    "release": "#d9a94a",
    "landing": "#58b2ee",
    "fault": "#f08a5d",
    "mode": "#cf96dd",
    "first": "#f08a5d",
    "second": "#d9a94a",
    "reference": "#74828a",
}
"""On dark ground: hexadecimal red, green and blue by meaning."""
