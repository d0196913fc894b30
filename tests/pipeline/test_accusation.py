"""One thing wrong with the campaign file or an instrument: named, sized, and doubted; nothing is named without need."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Load, Vehicle

Real = NDArray[np.float64]

GRAVITY = 9.80665


def campaign(vehicle: Vehicle = TABLE_1_CAR, noise: float = 0.02, seed: int = 1) -> sprung.Campaign:
    part = vehicle.m_s / 10
    items = [
        {"mass": part, "position": (-0.4 * vehicle.wheelbase, 0.0, 0.5)},
        {"mass": part / 2, "position": (-1.05 * vehicle.wheelbase, 0.0, 0.5)},
    ]
    load = Load.model_validate({"name": "ballast", "items": items})
    return sprung.simulate(vehicle, loads=[load], noise=noise, seed=seed, duration=3.2)


def spoilt(clean: sprung.Campaign, change: Callable[[Real], None]) -> sprung.Campaign:
    recordings = []
    for recording in clean.recordings:
        values = recording.values.copy()
        change(values)
        recordings.append(replace(recording, values=values))
    return replace(clean, recordings=tuple(recordings))


def accused(of: sprung.Campaign) -> tuple[str, str, str]:
    result = sprung.identify(of)
    assert result.verdict.state != "accept"
    (fault,) = result.faults
    assert any(fault.what in reason for reason in result.verdict.reasons)
    return fault.code, fault.where, fault.what


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS])
@pytest.mark.parametrize(("channel", "name"), [(2, "body_rl"), (5, "wheel_fr")])
def test_a_sensor_that_reads_too_much(vehicle: Vehicle, channel: int, name: str) -> None:
    def too_much(values: Real) -> None:
        values[channel] = GRAVITY + 1.05 * (values[channel] - GRAVITY)

    code, where, what = accused(spoilt(campaign(vehicle), too_much))
    assert (code, where) == ("gain", name)
    assert "% too much" in what
    assert float(what.split(" reads ")[1].split(" %")[0]) == pytest.approx(5.0, abs=0.6)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS])
def test_a_channel_that_is_late(vehicle: Vehicle) -> None:
    def late(values: Real) -> None:
        values[6, 1:] = values[6, :-1].copy()  # by one sample of 500 a second

    code, where, what = accused(spoilt(campaign(vehicle), late))
    assert (code, where) == ("late", "wheel_rl")
    assert float(what.split(" is ")[1].split(" ms late")[0]) == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize(("axis", "way"), [(0, "back"), (1, "to the right")])
def test_a_sensor_that_sits_elsewhere(axis: int, way: str) -> None:
    clean = campaign()
    sensors = list(clean.sensors)
    place = list(sensors[1].position or ())
    place[axis] += 0.1  # stated a hand's breadth too far forward, or left
    sensors[1] = sensors[1].model_copy(update={"position": tuple(place)})
    code, where, what = accused(replace(clean, sensors=tuple(sensors)))
    assert (code, where) == ("position", "body_fr")
    assert f"cm further {way} than" in what
    assert float(what.split(" sits ")[1].split(" cm")[0]) == pytest.approx(10.0, abs=1.5)


def test_a_load_that_lies_elsewhere() -> None:
    clean = campaign()
    load = clean.load("ballast")
    place = load.items[0].position
    assert place is not None
    stated = load.items[0].model_copy(update={"position": (place[0] - 0.1, *place[1:])})
    wrong = load.model_copy(update={"items": (stated, *load.items[1:])})
    loads = tuple(wrong if one.name == "ballast" else one for one in clean.loads)
    code, where, what = accused(replace(clean, loads=loads))
    assert (code, where) == ("load-position", "load 'ballast'")
    assert "further forward than" in what


def test_nothing_is_named_where_nothing_is_wrong() -> None:
    for vehicle in (TABLE_1_CAR, SCHOOL_BUS):
        for seed in range(8):
            result = sprung.identify(campaign(vehicle, noise=0.02 if seed % 2 else 0.1, seed=seed))
            assert result.faults == ()
            assert result.verdict.state == "accept"
