"""Motion ratios of springs and dampers: read, written, checked in a file and in memory."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sprung.campaign import read, require_plausible, write
from sprung.errors import InputError
from sprung.uncertainty import KnownValue

Folder = Callable[..., Path]

STATED = "wheelbase = 2.76\nmotion_ratio = { spring_front = 0.7, damper_rear = { value = 0.9, std = 0.01 } }"
RATIOS = {"spring_front": KnownValue(0.7), "damper_rear": KnownValue(0.9, 0.01)}


def test_ratios_are_read_and_written(folder: Folder, tmp_path: Path) -> None:
    campaign = read(folder(("wheelbase = 2.76", STATED)))
    assert campaign.motion_ratio == RATIOS
    assert read(write(campaign, tmp_path / "written")).motion_ratio == RATIOS
    assert not read(folder()).motion_ratio


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        (
            "{ spring_front = 70 }",
            "found 70; expected 0.2 to 3 m per m.* Write it in m per m: 0.7 if it was stated in percent",
        ),
        ("{ spring_front = -0.7 }", "found -0.7"),
        ("{ spring_fornt = 0.7 }", "Did you mean .*spring_front"),
        ("0.7", "motion_ratio"),
    ],
)
def test_what_no_suspension_has_is_refused(folder: Folder, stated: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(folder(("wheelbase = 2.76", f"wheelbase = 2.76\nmotion_ratio = {stated}")))
    assert re.search(message, str(caught.value)), caught.value


def test_in_memory_the_same_holds(folder: Folder) -> None:
    campaign = read(folder())
    number: Any = 0.7  # as Python code may give it
    assert replace(campaign, motion_ratio={"spring_front": number}).motion_ratio == {"spring_front": KnownValue(0.7)}
    with pytest.raises(InputError, match="Did you mean 'spring_front'"):
        replace(campaign, motion_ratio={"spring_fornt": number})
    with pytest.raises(InputError, match="m per m"):
        require_plausible(replace(campaign, motion_ratio={"spring_front": KnownValue(70)}))
