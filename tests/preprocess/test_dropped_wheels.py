"""Which wheels fell, held against what the campaign says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign, Drop
from sprung.errors import Fault
from sprung.preprocess import prepare
from sprung.preprocess.dropped_wheels import find_contradicted_drops
from sprung.simulation import simulate
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, WHEELS, Wheel

FRONT, REAR, LEFT, RIGHT = WHEELS[:2], WHEELS[2:], WHEELS[::2], WHEELS[1::2]
WAYS = (WHEELS, FRONT, REAR, LEFT, RIGHT)


def told(campaign: Campaign) -> list[Fault]:
    return [fault for fault in sprung.check(campaign).faults if fault.code == "wheels"]


def stated(campaign: Campaign, number: int, wheels: tuple[Wheel, ...]) -> Campaign:
    """State other wheels for a drop."""
    drops = list(campaign.drops)
    drops[number] = replace(drops[number], wheels=wheels)
    return replace(campaign, drops=tuple(drops))


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS], ids=["car", "bus"])
@pytest.mark.parametrize("high_pass", [None, 0.5])
def test_what_fell_as_stated_is_not_told(vehicle: sprung.Vehicle, high_pass: float | None) -> None:
    sensors = [replace(sensor, high_pass=high_pass) for sensor in simulate(vehicle, drops=[{}], seed=1).sensors]
    for height in (0.02, 0.12):
        drops = [{"wheels": wheels, "height": height} for wheels in (*WAYS, ("fl",), ("fl", "rr"))]
        assert told(simulate(vehicle, sensors=sensors, drops=drops, noise=0.05, seed=2)) == []


@pytest.mark.parametrize("number", range(5))
@pytest.mark.parametrize("wheels", WAYS)
def test_other_wheels_are_named_and_taken_as_they_fell(number: int, wheels: tuple[Wheel, ...]) -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.05, seed=number)
    fell = campaign.drops[number].wheels
    wrong = stated(campaign, number, wheels)
    if wheels == fell:
        assert told(wrong) == []
        return
    [fault] = told(wrong)
    assert fault.where == campaign.drops[number].file
    assert f"shows {', '.join(fell)} to have fallen, the campaign states {', '.join(wheels)}" in fault.what
    assert f'wheels = ["{fell[0]}", "{fell[1]}"' in fault.do
    assert set(prepare(wrong).observations[number].wheels) == set(fell)
    # Where a wheel's landing is not waited for, the decay would begin before it.
    for one, right in zip(prepare(wrong).decays, prepare(campaign).decays, strict=True):
        assert (one.start, one.end) == (right.start, right.end)


def exchanged(campaign: Campaign, one: int, other: int) -> Campaign:
    """Exchange two channels in all drops."""
    order = np.arange(len(campaign.sensors))
    order[[one, other]] = other, one
    return campaign.with_recordings(replace(r, values=r.values[order]) for r in campaign.recordings)


def test_exchanged_channels_and_a_weak_one_are_not_wheels_that_fell_otherwise() -> None:
    campaign = simulate(TABLE_1_CAR, noise=0.05, seed=1)
    fl, rr = (next(i for i, sensor in enumerate(campaign.sensors) if sensor.on == wheel) for wheel in ("fl", "rr"))
    assert told(exchanged(campaign, fl, rr)) == []
    weak = np.ones((len(campaign.sensors), 1))
    weak[fl] = 0.05
    rest = campaign.recordings[0].values[:, :100].mean(axis=1, keepdims=True)
    recordings = tuple(replace(one, values=rest + weak * (one.values - rest)) for one in campaign.recordings)
    assert told(campaign.with_recordings(recordings)) == []


@pytest.mark.parametrize(
    ("fell", "expected"),
    [
        ([{"fl": True, "fr": True, "rl": True, "rr": True}, {"fl": True, "fr": True, "rl": False, "rr": False}], ()),
        ([{"fl": True, "fr": True, "rl": False, "rr": False}, {"fl": True, "fr": True, "rl": False, "rr": False}], (0,)),
        ([{"fl": True, "fr": True}, {"fl": False, "fr": False, "rl": True, "rr": True}], (1,)),
        # Three wheels, and two across: rather the channels.
        ([{"fl": True, "fr": True, "rl": True, "rr": False}, {"fl": True, "fr": True, "rl": False, "rr": False}], ()),
        ([{}, {"fl": True, "fr": False, "rl": False, "rr": True}], ()),
        ([{}, {}], ()),
    ],
)  # fmt: skip
def test_what_is_taken_for_another_drop(fell: list[Mapping[Wheel, bool]], expected: tuple[int, ...]) -> None:
    assert find_contradicted_drops([Drop(), Drop(wheels=FRONT)], fell) == expected
