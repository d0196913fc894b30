"""The fault study in miniature: what is done is what is said, and the page tells what came of it."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from campaigns import Real
from fleet import FLEET, VehicleTest
from injuries import Injured, Injury
from mistakes import swapped_digits
from outcomes import INJURIES, names_all, try_one

import sprung
from sprung.errors import Fault
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import SCHOOL_BUS

STUDIES = Path(__file__).resolve().parents[2] / "docs" / "studies"
CAR, SMALL, VAN, BUS, TRUCK = FLEET

NOWHERE = {
    "sign, DC": [VAN],
    "sign, AC": [CAR],
    "corner, DC": [VAN],
    "corner, all DC": [VAN],
    "corner, AC": [CAR],
    "corner, all AC": [CAR],
    "corner, misstated": [CAR],
    "load exchanged, one": [BUS],
    "load exchanged, all": [BUS],
    "load position": [BUS],
}
"""The tests to which something cannot be done: without such sensors, without a load."""


def spoil(name: str, test: VehicleTest = SMALL, seed: int = 0) -> tuple[sprung.Campaign, Injured]:
    campaign = test.campaign(3)
    injured = INJURIES[name].act(test, campaign, np.random.default_rng(seed))
    assert injured is not None
    return campaign, injured


def spoilt_channel(name: str, test: VehicleTest = SMALL, seed: int = 0) -> list[tuple[Real, Real]]:
    """Return the damaged channel before and after, in every drop."""
    campaign, injured = spoil(name, test, seed)
    channel = [one.channel for one in campaign.sensors].index(injured.names[0])
    pairs = zip(campaign.recordings, injured.campaign.recordings, strict=True)
    return [(before.values[channel], after.values[channel]) for before, after in pairs]


def lines(recording: sprung.campaign.Recording) -> list[list[str]]:
    columns = np.vstack([recording.time, recording.values]).T
    return [["time", *recording.channels], *([f"{cell:.9g}" for cell in row] for row in columns)]


@pytest.mark.parametrize(
    "test",
    [pytest.param(test, marks=pytest.mark.long) if test.vehicle is SCHOOL_BUS else test for test in FLEET],
    ids=[test.vehicle.name for test in FLEET],
)
@pytest.mark.slow
def test_every_vehicle_of_the_fleet_is_found_and_accepted(test: VehicleTest) -> None:
    assert 5 <= len(test.drops) <= 10
    assert 200 <= test.rate <= 1000
    result = sprung.identify(test.campaign(1))
    assert result.verdict.state == "accept"
    assert result.faults == ()
    for name, truth in test.vehicle.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - truth) < 5 * found.std


def test_no_two_are_tested_alike() -> None:
    assert len({test.label for test in FLEET}) == len(FLEET) == 5
    assert {bool(test.weighed) for test in FLEET} == {True, False}
    assert VAN.label.startswith("8 drops, 3 of them with a load; 5 sensors on the body, 4 on the wheels, 9 of all AC")
    np.testing.assert_array_equal(SMALL.campaign(1).recordings[2].values, SMALL.campaign(1).recordings[2].values)
    assert np.any(SMALL.campaign(1).recordings[2].values != SMALL.campaign(2).recordings[2].values)


@pytest.mark.parametrize("injury", INJURIES.values(), ids=lambda injury: injury.name)
def test_only_what_is_named_is_changed(injury: Injury) -> None:
    for test in FLEET:
        campaign = test.campaign(3)
        injured, again = (injury.act(test, campaign, np.random.default_rng(5)) for _ in range(2))
        if injured is None or again is None:
            assert test in NOWHERE.get(injury.name, [])
            continue
        assert test not in NOWHERE.get(injury.name, [])
        assert injured.names == again.names
        channels, files = [one.channel for one in campaign.sensors], [one.name for one in campaign.recordings]
        assert {*injured.names} <= {*channels, *files, *(load.name for load in campaign.loads)}
        named = [i for i, channel in enumerate(channels) if channel in injured.names] or [*range(len(channels))]
        changes = injured.rewrite is not None
        for before, after in zip(campaign.recordings, injured.campaign.recordings, strict=True):
            may = not {*files} & {*injured.names} or before.name in injured.names
            same_size = before.values.shape == after.values.shape
            different = {i for i in named if not same_size or np.any(before.values[i] != after.values[i])}
            assert may or not different
            if same_size:
                untouched = [i for i in range(len(channels)) if i not in named]
                np.testing.assert_array_equal(before.values[untouched], after.values[untouched])
            changes |= bool(different) or before.rate != after.rate
        descriptions = [
            (one.sensors, one.drops, tuple(load.items for load in one.loads)) for one in (campaign, injured.campaign)
        ]
        assert changes != (descriptions[0] != descriptions[1])  # what was recorded, or what is said of it


@pytest.mark.parametrize(
    ("name", "factors"),
    [
        ("gain", (0.95, 1.05)),
        ("unit, g as m/s²", (1 / STANDARD_GRAVITY,)),
        ("unit, mm/s²", (1000.0,)),
        ("unit, m/s² as g", (STANDARD_GRAVITY,)),
        ("sign, DC", (-1.0,)),
        ("sign, AC", (-1.0,)),
    ],
)
def test_factors(name: str, factors: tuple[float, ...]) -> None:
    for before, after in spoilt_channel(name):
        assert np.median(after / before) == pytest.approx(
            min(factors, key=lambda one: abs(one - np.median(after / before)))
        )
        np.testing.assert_allclose(after, np.median(after / before) * before, rtol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_sizes(seed: int) -> None:
    for before, after in spoilt_channel("offset", CAR, seed):
        assert np.cos(np.deg2rad(25)) <= np.median(after / before) <= np.cos(np.deg2rad(15))
    for before, after in spoilt_channel("late", SMALL, seed):  # 1000 samples a second
        assert any(np.array_equal(after[by:], before[:-by]) for by in range(3, 11))
    for before, after in spoilt_channel("drift, straight", BUS, seed):
        assert abs(after[-1] - before[-1]) == pytest.approx(0.1)
        assert np.ptp(np.diff(after - before)) == pytest.approx(0, abs=1e-12)
    drops = spoilt_channel("clipped, wheel", TRUCK, seed)
    assert max(after.max() for _, after in drops) < max(before.max() for before, _ in drops)
    assert any((after[int((TRUCK.rest + 0.25) * TRUCK.rate) :] == after.max()).any() for _, after in drops)
    spikes = [after - before for before, after in spoilt_channel("spike", VAN, seed)]
    assert sum(bool(np.any(one)) for one in spikes) == 1
    (struck,) = (one[one != 0] for one in spikes if np.any(one))
    assert 1 <= struck.size <= 3
    assert np.all((np.abs(struck) >= 30) & (np.abs(struck) <= 300))


@pytest.mark.parametrize(("name", "empty"), [("missing, 5 samples", 5), ("missing, 0.3 s", 300)])
def test_cells_that_are_missing(name: str, empty: int) -> None:
    campaign, injured = spoil(name)
    assert injured.rewrite is not None
    before = lines(campaign.recordings[0])
    after = injured.rewrite(before)
    gone = [(i, j) for i, line in enumerate(after) for j, cell in enumerate(line) if not cell]
    assert len(gone) == empty
    (column,) = {j for _, j in gone}
    assert after[0][column] == injured.names[0]
    assert gone[-1][0] - gone[0][0] == empty - 1
    assert all(
        one == other
        for line, was in zip(after, before, strict=True)
        for one, other in zip(line, was, strict=True)
        if one
    )


def test_lines_and_times() -> None:
    recording = SMALL.campaign(3).recordings[0]
    before = lines(recording)
    done = {}
    for name in ("clock, lines lost", "rate", "clock, jitter", "missing column"):
        _, injured = spoil(name)
        assert injured.rewrite is not None
        done[name] = injured.rewrite(before)
    lost = [line for line in before if line not in done["clock, lines lost"]]
    assert len(lost) == 3
    assert all(float(line[0]) > SMALL.rest + 0.2 for line in lost)
    slow = np.array([float(line[0]) for line in done["rate"][1:]])
    np.testing.assert_allclose(np.diff(slow), 0.02, rtol=1e-6)
    off = 1000 * np.array(
        [float(line[0]) - float(was[0]) for line, was in zip(done["clock, jitter"][1:], before[1:], strict=True)]
    )
    assert 0.28 < np.abs(off).max() <= 0.3001
    assert {len(line) for line in done["missing column"]} == {len(before[0]) - 1}


def test_what_happened_otherwise_is_only_noticed_after_the_release() -> None:
    for name in ("brake", "passenger", "other wheels"):
        campaign, injured = spoil(name, TRUCK)
        i = [one.name for one in campaign.recordings].index(injured.names[0])
        before, after = campaign.recordings[i].values, injured.campaign.recordings[i].values
        release = round(TRUCK.rest * TRUCK.rate)
        np.testing.assert_array_equal(before[:, :release], after[:, :release])
        assert np.abs(before - after).max() > 10 * TRUCK.noise


def test_a_body_that_twists() -> None:
    campaign, injured = spoil("twist", CAR)
    motions, twists = [], []
    for before, after, exact in zip(
        campaign.recordings, injured.campaign.recordings, CAR.exact.recordings, strict=True
    ):
        motions.append(exact.values - exact.values[:, :1])
        twists.append(after.values - before.values)
    motion, twist = np.concatenate(motions, axis=1), np.concatenate(twists, axis=1)
    assert not twist[4:].any()
    assert twist[:4].std() == pytest.approx(0.1 * motion[:4].std(), rel=1e-6)
    # The car's corners are symmetrical, so that diagonal ones move alike and neighbours against each other.
    np.testing.assert_allclose(twist[1], -twist[0], atol=1e-9)
    np.testing.assert_allclose(twist[2], -twist[0], atol=0.2 * np.abs(twist[0]).max())
    np.testing.assert_allclose(twist[3], -twist[2], atol=1e-9)


def test_figures_that_are_swapped() -> None:
    random = np.random.default_rng(1)
    assert swapped_digits((0.1, 0.69, 0.5), random) == (0.1, 0.96, 0.5)
    assert swapped_digits((-2.86, -0.55, 0.5), random) == (-2.68, -0.55, 0.5)
    assert swapped_digits((1.11, 2.22, 0.5), random) == (1.11, -2.22, 0.5)


def test_loads_that_are_exchanged() -> None:
    campaign, injured = spoil("load exchanged, all", VAN)
    for before, after in zip(campaign.drops, injured.campaign.drops, strict=True):
        assert {before.load, after.load} == {"empty", "sacks"}
    campaign, injured = spoil("load exchanged, one", VAN, 2)
    other = [i for i, drop in enumerate(campaign.drops) if drop.load != injured.campaign.drops[i].load]
    assert {campaign.drops[i].load for i in other} == {"empty", "sacks"}
    assert {campaign.drops[i].file for i in other} == {*injured.names}
    assert len({campaign.drops[i].wheels for i in other}) == 1  # the one that is like it


def test_a_fault_names_all_or_not() -> None:
    fault = Fault("exchanged", "a.csv: body_fl", "body_fl and body_rr seem exchanged", "Look.")
    assert names_all(fault, ("body_fl", "body_rr"))
    assert names_all(fault, ())
    assert not names_all(fault, ("body_fl", "wheel_fl"))
    assert not names_all(fault, ("body_rr",))  # which is not where it is said to be


@pytest.mark.slow
def test_what_came_of_it() -> None:
    gone = try_one(1, 0, INJURIES["no decay"])
    assert gone is not None
    assert (gone.noticed, gone.named, gone.left_out, gone.verdict) == (True, True, True, "accept")
    assert 0 < gone.rms <= gone.worst < 6  # one drop of six is gone
    assert 0 < gone.beyond < gone.worst  # and its own uncertainties are larger
    assert not gone.put_right
    assert try_one(2, 0, INJURIES["sign, DC"]) is None

    def all_cut(_: VehicleTest, campaign: sprung.Campaign, __: np.random.Generator) -> Injured:
        short = tuple(replace(one, values=one.values[:, :50]) for one in campaign.recordings)
        return Injured(campaign.with_recordings(short), (short[0].name,))

    refused = try_one(1, 0, Injury("all cut", ("no-decay",), "all recordings end at once", all_cut))
    assert refused is not None
    assert (refused.verdict, refused.noticed, refused.named) == ("refused", True, False)
    assert np.isnan(refused.worst)


@pytest.mark.long
def test_the_study(tmp_path: Path) -> None:
    told = ("--faults", "flat", "copy", "sign, AC", "--vehicles", "2", "--seeds", "1", "--campaigns", "2")
    command = [sys.executable, str(STUDIES / "faults.py"), *told, "--to", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)  # noqa: S603 (our own script)
    page = (tmp_path / "faults.md").read_text(encoding="utf-8")
    numbers = json.loads((tmp_path / "faults.json").read_text(encoding="utf-8"))
    assert [one["fault"] for one in numbers["faults"]] == ["flat", "sign, AC", "copy"]
    assert [one["campaigns"] for one in numbers["faults"]] == [2, 1, 2]  # the car has no AC-coupled sensor
    for one in numbers["faults"]:
        assert one["named"] <= one["noticed"] <= one["campaigns"] == sum(one["verdicts"].values())
    assert numbers["faults"][0]["named"] == numbers["faults"][0]["left_out"] == 2
    assert "Of 5 faults" in page
    assert "2 sound campaigns were identified" in page
    assert "nan" not in page
