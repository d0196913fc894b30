"""Channels upside down or in another unit, told by gravity at rest, against the same campaign without the mistake."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.preprocess import prepare
from sprung.vehicle import TABLE_1_CAR

CLEAN = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=4, known={"total_mass": TABLE_1_CAR.total_mass})


def changed(factors: dict[int, float], offset: float = 0.0) -> sprung.Campaign:
    factor = np.ones(8)
    factor[list(factors)] = list(factors.values())
    recordings = [replace(one, values=(one.values + offset) * factor[:, None]) for one in CLEAN.recordings]
    return CLEAN.with_recordings(recordings)


@pytest.mark.parametrize(
    ("factors", "codes"),
    [
        ({5: -1.0}, {"sign"}),
        ({0: 1 / 9.80665}, {"unit"}),
        ({7: 1000.0}, {"unit"}),
        ({2: -1 / 0.3048}, {"unit", "sign"}),
        (dict.fromkeys(range(8), 1 / 9.80665), {"unit"}),  # a file in g that nobody says is
        (dict.fromkeys(range(0, 8, 2), 1 / 9.80665), {"unit"}),  # one logger in g, the other not
        ({1: -1.0, 4: 1 / 9.80665, 6: 1000.0}, {"sign", "unit"}),
    ],
)
def test_they_are_put_right_and_named(factors: dict[int, float], codes: set[str]) -> None:
    result, clean = sprung.identify(changed(factors)), sprung.identify(CLEAN)
    assert {fault.code for fault in result.faults} == codes
    named = [
        name for fault in result.faults for name in fault.where.split(", ")
    ]  # one mistake with several is told once
    assert set(named) == {CLEAN.sensors[channel].channel for channel in factors}
    assert result.verdict.state == "accept"
    for name, one in clean.parameters.items():
        assert one.value is not None
        assert result.parameters[name].value == pytest.approx(one.value, rel=1e-4)


def test_nothing_is_changed_without_need() -> None:
    for campaign in (CLEAN, changed({}, offset=0.4)):
        assert all(decay.faults == () for decay in prepare(campaign).decays)
    # AC-coupled sensors read nothing at rest: they tell nothing of sign or unit.
    assert all(decay.faults == () for decay in prepare(changed({}, offset=-9.80665)).decays)


def ac_coupled(*channels: int, corner: float | None) -> sprung.Campaign:
    """Let channels feel no gravity; the sensors say their corner, if any."""
    sensors = [replace(sensor, high_pass=corner) if i in channels else sensor for i, sensor in enumerate(CLEAN.sensors)]
    campaign = sprung.simulate(
        TABLE_1_CAR, sensors=sensors, noise=0.02, seed=4, known={"total_mass": TABLE_1_CAR.total_mass}
    )
    if corner is None:
        level = np.zeros((8, 1))
        level[list(channels)] = 9.80665
        recordings = tuple(replace(one, values=one.values - level) for one in campaign.recordings)
        return campaign.with_recordings(recordings)
    return campaign


@pytest.mark.parametrize("channels", [(0,), (0, 1, 2, 5, 6), (0, 1, 2, 3, 4, 5, 6)])
def test_ac_coupled_sensors_do_not_vote(channels: tuple[int, ...]) -> None:
    """Channel 7, in g and upside down, feels gravity; most or all of the others may be AC-coupled."""
    campaign = ac_coupled(*channels, corner=0.3)
    factor = np.ones((8, 1))
    factor[7] = 1 / 9.80665
    recordings = tuple(replace(one, values=one.values * factor) for one in campaign.recordings)
    faults = [fault for decay in prepare(campaign.with_recordings(recordings)).decays for fault in decay.faults]
    assert [(fault.code, fault.where) for fault in faults] == [("unit", "wheel_rr")]


def test_an_offset_of_one_meter_per_second_squared_is_no_gravity_in_g() -> None:
    """An AC-coupled channel whose amplifier is off zero: it moves as much as its neighbours do."""
    campaign = ac_coupled(*range(8), corner=None)
    values = [one.values + (np.arange(8) == 2)[:, None] for one in campaign.recordings]
    recordings = tuple(replace(one, values=v) for one, v in zip(campaign.recordings, values, strict=True))
    assert all(decay.faults == () for decay in prepare(campaign.with_recordings(recordings)).decays)


def test_a_silent_channel_among_others_that_feel_gravity_is_named() -> None:
    (fault,) = prepare(ac_coupled(3, corner=None)).decays[0].faults
    assert (fault.code, fault.where) == ("coupling", "body_rr")
    assert "high_pass = ..." in fault.do
    assert prepare(ac_coupled(*range(8), corner=None)).decays[0].faults == ()


def test_a_high_pass_that_is_none_is_not_undone() -> None:
    sensors = tuple(
        replace(sensor, high_pass=0.5) if sensor.channel == "body_fr" else sensor for sensor in CLEAN.sensors
    )
    decay = prepare(replace(CLEAN, sensors=sensors)).decays[0]
    (fault,) = decay.faults
    assert (fault.code, fault.where) == ("coupling", "body_fr")
    np.testing.assert_array_equal(decay.values, prepare(CLEAN).decays[0].values)


@pytest.mark.parametrize(
    ("offset", "said"), [(0.6, r"1.60 g at rest, \+0.60 g off"), (-0.15, "a tilt, which would be 32°, .* to 85%")]
)
def test_an_offset_is_named_and_does_no_harm(offset: float, said: str) -> None:
    level = 9.80665 * offset * (np.arange(8) == 6)[:, None]
    recordings = tuple(replace(one, values=one.values + level) for one in CLEAN.recordings)
    result = sprung.identify(CLEAN.with_recordings(recordings))
    (fault,) = result.faults
    assert (fault.code, fault.where) == ("offset", "wheel_rl")
    assert re.search(said, fault.what)
    assert result.verdict.state == "accept"


def test_numbers_in_no_known_unit_are_left_out() -> None:
    decay = prepare(changed({1: 25.0})).decays[0]
    (fault,) = decay.faults
    assert (fault.code, fault.where) == ("unit", "body_fr")
    assert "the channel is left out" in fault.what
    assert list(np.flatnonzero(~decay.usable)) == [1]


def test_one_of_many_upside_down_ones_is_turned_to_agree() -> None:
    (fault,) = prepare(changed(dict.fromkeys(range(7), -1.0))).decays[0].faults
    assert (fault.code, fault.where) == ("sign", "wheel_rr")
    assert "reads gravity upward at rest, most other sensors downward" in fault.what


def test_where_all_are_upside_down_nobody_can_say_which() -> None:
    """It would be the frame, not one sensor: the fit sees the same motion either way, and nothing is changed."""
    upside_down = prepare(changed(dict.fromkeys(range(8), -1.0)))
    assert all(fault.code != "sign" for decay in upside_down.decays for fault in decay.faults)
