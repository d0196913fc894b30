"""One campaign, in every format: the parameters do not know how the recordings were written."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from every_format import WAYS, Signals, WritingMethod, wav24

import sprung
from sprung.simulation import default_sensors
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR

if TYPE_CHECKING:
    from pathlib import Path

# pyuff's writer leaves its file to be closed by chance.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

NOISE = 0.02
"""m/s² root-mean-square, of the simulated sensors."""

DROPS = [{"wheels": wheels} for wheels in (["fl", "fr", "rl", "rr"], ["fl", "fr"], ["rl", "rr"], ["fl", "rl"])]


@pytest.fixture(scope="module")
def campaign() -> sprung.Campaign:
    """Four drops of a car whose mass is known."""
    known = {"total_mass": TABLE_1_CAR.total_mass}
    return sprung.simulate(TABLE_1_CAR, drops=DROPS, known=known, noise=NOISE, seed=3)


@pytest.fixture(scope="module")
def truth(campaign: sprung.Campaign) -> sprung.Result:
    """What is identified from the doubles in memory."""
    result = sprung.identify(campaign)
    assert result.verdict.state == "accept"
    return result


def in_g(recording: sprung.campaign.Recording) -> Signals:
    return Signals(recording.channels, recording.values / STANDARD_GRAVITY, recording.rate)


def written(campaign: sprung.Campaign, folder: Path, way: WritingMethod) -> Path:
    """Write a campaign whose recordings are in some format."""
    text = sprung.write(campaign, folder).read_text(encoding="utf-8")
    for recording in campaign.recordings:
        (folder / recording.name).unlink()
        path = way.write(in_g(recording), folder / recording.name.removesuffix(".csv"))
        text = text.replace(f'"{recording.name}"', f'"{path.name}"')
    if way.nameless:
        numbered = iter(range(1, 100))
        text = re.sub(r'channel *= "\w+"', lambda _: f'channel = "ch{next(numbered)}"\nunit = "g"', text)
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    return folder


def off_by(read: sprung.Campaign, campaign: sprung.Campaign) -> float:
    """Return the largest error of the samples, m/s²."""
    pairs = zip(read.recordings, campaign.recordings, strict=True)
    return max(float(np.abs(one.values - other.values).max()) for one, other in pairs)


def check(result: sprung.Result, truth: sprung.Result, off: float) -> None:
    """Compare parameters; samples that are off by so many times their noise move them as that noise would."""
    assert result.parameters.keys() == truth.parameters.keys()
    assert result.verdict == truth.verdict
    for name, exact in truth.parameters.items():
        found = result.parameters[name]
        assert exact.value is not None
        assert exact.std is not None
        allowed = 1e-9 * abs(exact.value) + 5 * exact.std * off
        assert found.value == pytest.approx(exact.value, rel=0, abs=allowed), name
        assert found.status == exact.status


@pytest.mark.parametrize("name", WAYS)
@pytest.mark.slow
def test_the_same_parameters(tmp_path: Path, campaign: sprung.Campaign, truth: sprung.Result, name: str) -> None:
    way = WAYS[name]
    if way.needs:
        pytest.importorskip(way.needs)
    read = sprung.read(written(campaign, tmp_path, way))
    assert read.faults == ()
    assert [one.rate for one in read.recordings] == pytest.approx([500] * 4, rel=1e-12)
    largest = max(float(np.abs(one.values).max()) for one in campaign.recordings)
    off = off_by(read, campaign)
    assert off <= 2 * way.off * largest
    check(sprung.identify(read), truth, off / NOISE if way.off > 1e-15 else 0.0)


def test_the_same_parameters_from_memory(tmp_path: Path, campaign: sprung.Campaign, truth: sprung.Result) -> None:
    path = sprung.write(campaign, tmp_path)
    signals = {one.name: sprung.to_sep005(one) for one in campaign.recordings}
    for name in signals:
        (tmp_path / name).unlink()
    check(sprung.identify(sprung.read(path, signals=signals)), truth, 0.0)


@pytest.mark.long
def test_the_same_parameters_from_24_bits(tmp_path: Path) -> None:
    # A WAV file of integers holds parts of a full scale, here 1 g: wheels that fall 2 mm, and sensors without gravity.
    sensors = [replace(sensor, high_pass=0.2) for sensor in default_sensors(TABLE_1_CAR)]
    drops = [{**drop, "height": 0.002} for drop in DROPS]
    known = {"total_mass": TABLE_1_CAR.total_mass}
    campaign = sprung.simulate(TABLE_1_CAR, sensors=sensors, drops=drops, known=known, noise=NOISE, seed=3)
    read = sprung.read(written(campaign, tmp_path, WritingMethod(wav24, nameless=True)))
    off = off_by(read, campaign)
    assert off <= STANDARD_GRAVITY * 2.0**-24 * (1 + 1e-9)
    check(sprung.identify(read), sprung.identify(campaign), off / NOISE)
