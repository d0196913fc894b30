"""What came of a campaign with something wrong, beside the same campaign without."""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from zlib import crc32

import numpy as np
from campaigns import Measure, white
from coloured import coarse, low_passed
from fleet import FLEET
from injuries import OF_SENSORS, Injured, Injury, Lines
from mistakes import OF_TESTS
from numpy.typing import NDArray
from spoilt_files import OF_RECORDINGS

import sprung
from sprung.errors import Fault, InputError

INJURIES = {one.name: one for one in (*OF_SENSORS, *OF_RECORDINGS, *OF_TESTS)}
"""Everything that is done, by name."""


@dataclass(frozen=True)
class Outcome:
    """What came of one campaign with something wrong.

    Attributes
    ----------
    injury, vehicle, seed
        What was done, to which campaign.
    noticed
        Whether a fault has the code, or names what was spoilt.
    named
        Whether one has the code and names all that was spoilt.
    verdict
        Of the result; ``refused`` where there is none, and ``crash`` where there is no reason either.
    left_out
        Whether a channel or drop was left out that is not without the injury.
    worst, rms
        Of the parameters' distances from those of the sound campaign, in its standard uncertainties; NaN without any.
    beyond
        The worst distance in standard uncertainties of its own.
    lost
        How many parameters are no longer there.
    said
        The faults: code and where.
    reason
        The verdict's first, or why the campaign was refused.
    """

    injury: str
    vehicle: str
    seed: int
    noticed: bool
    named: bool
    verdict: str
    left_out: bool
    worst: float
    rms: float
    beyond: float
    lost: int
    said: tuple[str, ...]
    reason: str

    @property
    def put_right(self) -> bool:
        """Whether it was noticed, and everything used and accepted all the same."""
        return self.noticed and not self.left_out and self.verdict == "accept"


@dataclass(frozen=True)
class Clean:
    """What came of one campaign without anything wrong; `kind` is its noise's.

    The other attributes are those of `Outcome`.
    """

    vehicle: str
    kind: str
    seed: int
    verdict: str
    said: tuple[str, ...]
    reason: str

    @property
    def alarm(self) -> bool:
        """Whether anything was found wrong with it."""
        return bool(self.said) or self.verdict != "accept"


@lru_cache(maxsize=4)
def _sound(number: int, seed: int) -> tuple[sprung.Campaign, sprung.Result]:
    campaign = FLEET[number].campaign(seed)
    return campaign, sprung.identify(campaign)


def try_clean(number: int, seed: int, kind: str) -> Clean:
    """Identify one vehicle of the fleet from a sound campaign, with noise of a kind."""
    rate = FLEET[number].rate
    measures: dict[str, Measure] = {"low-passed": partial(low_passed, rate=rate), "12 bits over ±10 g": coarse}
    result = sprung.identify(FLEET[number].campaign(seed, measures.get(kind, white)))
    said, state, reasons = _said(result.faults), result.verdict.state, result.verdict.reasons
    return Clean(FLEET[number].vehicle.name, kind, seed, state, said, reasons[0])


def try_all(number: int, seed: int, names: Sequence[str]) -> list[Outcome]:
    """Do everything named to one campaign of one vehicle, one after the other."""
    done = (try_one(number, seed, INJURIES[name]) for name in names)
    return [one for one in done if one is not None]


def try_one(number: int, seed: int, injury: Injury) -> Outcome | None:
    """Do something to one campaign; None where that cannot be done to it."""
    test = FLEET[number]
    campaign, sound = _sound(number, seed)
    injured = injury.act(test, campaign, np.random.default_rng([number, seed, crc32(injury.name.encode())]))
    if injured is None:
        return None
    try:
        result = sprung.identify(read_back(injured))
    except InputError as refusal:
        text = str(refusal)
        noticed = any(name in text for name in injured.names)
        named = injury.refused is not None and injury.refused in text and all(name in text for name in injured.names)
        return Outcome(injury.name, test.vehicle.name, seed, noticed, named, "refused", *_NOTHING, (), text)
    except Exception as crash:  # noqa: BLE001 (a crash is just what this study would have to tell)
        text = f"{type(crash).__name__}: {crash}"
        return Outcome(injury.name, test.vehicle.name, seed, False, False, "crash", *_NOTHING, (), text)
    before = {(one.code, one.where) for one in sound.faults}
    new = [one for one in result.faults if (one.code, one.where) not in before]
    right = [one for one in new if one.code in injury.codes]
    noticed = bool(right) or any(name in one.where for one in new for name in injured.names)
    named = any(names_all(one, injured.names) for one in right)
    out = bool(np.any(_out(result) & ~_out(sound)))
    state, reason = result.verdict.state, result.verdict.reasons[0]
    said = _said(new)
    far = _distances(result, sound)
    return Outcome(injury.name, test.vehicle.name, seed, noticed, named, state, out, *far, said, reason)


_NOTHING = (False, np.nan, np.nan, np.nan, 0)


def _said(faults: Sequence[Fault]) -> tuple[str, ...]:
    return tuple(f"{one.code} ({one.where})" for one in faults)


def names_all(fault: Fault, names: Sequence[str]) -> bool:
    """Whether a fault names everything that was damaged, and part of it as its place."""
    everything = f"{fault.where} {fault.what}"
    return all(name in everything for name in names) and (not names or any(name in fault.where for name in names))


def _out(result: sprung.Result) -> NDArray[np.bool_]:
    """Return the mask of excluded data, shape (drop, channel)."""
    channels = len(result.fit.noise)
    rows = []
    for drop in result.drops:
        series = result.series.get(Path(drop.file).stem)
        gone = drop.start is None or series is None
        rows.append(np.ones(channels, bool) if gone or series is None else np.isnan(series.measured).any(axis=1))
    return np.array(rows)


def _distances(result: sprung.Result, sound: sprung.Result) -> tuple[float, float, float, int]:
    """Return largest, root-mean-square and largest own deviation of the parameters, and how many are missing."""
    off, own, lost = [], [], 0
    for name, one in sound.parameters.items():
        other = result.parameters.get(name)
        if one.value is None or not one.std:
            continue
        if other is None or other.value is None or not other.std:
            lost += 1
        else:
            off.append(abs(other.value - one.value) / one.std)
            own.append(abs(other.value - one.value) / other.std)
    if not off:
        return np.nan, np.nan, np.nan, lost
    return float(np.max(off)), float(np.sqrt(np.mean(np.square(off)))), float(np.max(own)), lost


def read_back(injured: Injured) -> sprung.Campaign:
    """Write a campaign, change the one file, and read it again, where that is how it is spoilt."""
    if injured.rewrite is None or injured.file is None:
        return injured.campaign
    with tempfile.TemporaryDirectory() as folder:
        path = sprung.write(injured.campaign, folder)
        file = Path(folder) / injured.file
        lines: Lines = list(csv.reader(file.read_text(encoding="utf-8").splitlines()))
        text = io.StringIO(newline="")
        csv.writer(text, lineterminator="\n").writerows(injured.rewrite(lines))
        file.write_text(text.getvalue(), encoding="utf-8")
        return sprung.read(path)
