"""Measurement sessions as they lie in a folder: recordings with the logger's own channel names and no campaign file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign

NEUTRAL = tuple(f"ch{i}" for i in range(1, 9))


def write_table(
    path: Path, values: NDArray[np.float64], rate: float, names: Sequence[str] = NEUTRAL, start: float = 0.0
) -> None:
    """Write a text table with a time column, seven digits."""
    path.parent.mkdir(parents=True, exist_ok=True)
    time = start + np.arange(values.shape[1]) / rate
    header = ",".join(["time", *names])
    np.savetxt(path, np.vstack([time, values]).T, fmt="%.7g", delimiter=",", header=header, comments="")


def write_session(folder: Path, campaign: Campaign, names: Sequence[str] = NEUTRAL) -> None:
    """Write the recordings of a campaign, one file each, and nothing else."""
    for recording in campaign.recordings:
        write_table(folder / recording.name, recording.values, recording.rate, names)


def fill_in(path: Path, answers: Mapping[str, str]) -> None:
    """Fill in the gaps of a drafted campaign file, from top to bottom as a user does.

    An answer is given by its key; one for a sensor or load by ``key of name``. An empty one takes the line out.
    """
    filled: list[str] = []
    entry = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        named = re.fullmatch(r'(?:channel|name|file)\s*= "(.*)"', line)
        entry = named[1] if named else entry
        gap = re.fullmatch(r'(\w+)\s*= "TODO: .*"', line)
        if gap is None:
            filled.append(line)
            continue
        answer = answers[f"{gap[1]} of {entry}"] if f"{gap[1]} of {entry}" in answers else answers[gap[1]]
        if answer:
            filled.append(f"{gap[1]} = {answer}")
    path.write_text("\n".join(filled) + "\n", encoding="utf-8")
