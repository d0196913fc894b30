"""A small campaign folder, whose texts and recordings a test may replace."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from car import CAR

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CAMPAIGN = """schema = 1
[vehicle]
name = "car"
wheelbase = 2.76
[known]
[[sensor]]
channel = "body_fl"
on = "body"
position = [0.1, 0.7, 0.5]
[[sensor]]
channel = "body_fr"
on = "body"
position = [0.1, -0.7, 0.5]
[[sensor]]
channel = "body_rl"
on = "body"
position = [-2.9, 0.7, 0.5]
[[load]]
name = "ballast"
items = [{ mass = 140, position = [-1, 0, 0.5] }]
[[drop]]
file = "one.csv"
[[drop]]
file = "two.csv"
load = "ballast"
"""

PARAMETERS = CAR[CAR.index("[parameters]") :] + "[known]\n"


def recording_text(names: str = "time,body_fl,body_fr,body_rl", samples: int = 100, step: float = 0.002) -> str:
    rows = (f"{i * step:.4f},{9 + i % 5},{9 + i % 3}.5,{-1 - i % 2}.25" for i in range(samples))
    return "\n".join((names, *rows, ""))


@pytest.fixture
def text() -> Callable[..., str]:
    """Return a recording of 100 samples at 500 Hz as text: body_fl 9 to 13, body_fr 9.5 to 11.5, body_rl -1.25, -2.25."""
    return recording_text


@pytest.fixture
def folder(tmp_path: Path) -> Callable[..., Path]:
    """Return a sound campaign folder in which some texts are replaced, pair by pair, and some recordings are others."""

    def make(*replacements: tuple[str, str], **recordings: str | bytes) -> Path:
        content = CAMPAIGN
        for old, new in replacements:
            assert old in content, f"the test replaces {old!r}, which is not there"
            content = content.replace(old, new, 1)
        (tmp_path / "campaign.toml").write_text(content, encoding="utf-8")
        for name in ("one", "two"):
            recording = recordings.get(name, recording_text())
            data = recording if isinstance(recording, bytes) else recording.encode()
            (tmp_path / f"{name}.csv").write_bytes(data)
        return tmp_path

    return make


@pytest.fixture
def vehicle_file(tmp_path: Path) -> Callable[..., Path]:
    """Return a sound vehicle file in which some texts are replaced, pair by pair."""

    def make(*replacements: tuple[str, str]) -> Path:
        content = CAMPAIGN.replace("[known]\n", PARAMETERS)
        for old, new in (('file = "one.csv"\n', 'wheels = ["fl", "fr"]\n'), ('file = "two.csv"\n', ""), *replacements):
            assert old in content, f"the test replaces {old!r}, which is not there"
            content = content.replace(old, new, 1)
        path = tmp_path / "VEHICLE.toml"
        path.write_text(content, encoding="utf-8")
        return path

    return make
