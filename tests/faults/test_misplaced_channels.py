"""Wheel sensors that are exchanged, or stated on another wheel, are named from which wheels fall, whatever the vehicle is."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign
from sprung.faults import examine
from sprung.faults.channel.wheel import wheel
from sprung.faults.correction import exchange_channels
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, WHEELS, Sensor, Vehicle, Wheel

RUBBING = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"F_f": 150.0, "F_r": 200.0, "r_f": 2.5, "r_r": 2.0})
CAMPAIGNS = {
    name: sprung.simulate(vehicle, noise=0.05, seed=3, duration=1.0)
    for name, vehicle in {"car": TABLE_1_CAR, "bus": SCHOOL_BUS, "with friction": RUBBING}.items()
}
NAMES = [sensor.channel for sensor in CAMPAIGNS["car"].sensors]
BODY, WHEEL = NAMES[:4], NAMES[4:]


def said(campaign: Campaign) -> list[tuple[str, str]]:
    """Code and place of each fault that is named before anything is fitted."""
    return [(fault.code, fault.where) for fault in examine(campaign)[0].faults]


def exchanged(campaign: Campaign, first: str, second: str) -> Campaign:
    """State each of two sensors in the place of the other one."""
    return exchange_channels(NAMES.index(first), NAMES.index(second), campaign.sensors).of_campaign(campaign)


def on_wheel(campaign: Campaign, channel: str, wheel: Wheel) -> Campaign:
    """State a sensor on another wheel."""
    sensors = [replace(one, on=wheel) if one.channel == channel else one for one in campaign.sensors]
    return replace(campaign, sensors=tuple(sensors))


@pytest.mark.parametrize("campaign", CAMPAIGNS.values(), ids=CAMPAIGNS)
def test_nothing_is_named_where_nothing_is_wrong(campaign: Campaign) -> None:
    assert examine(campaign)[0] is campaign


@pytest.mark.parametrize(("first", "second"), [*combinations(WHEEL, 2), (BODY[0], WHEEL[3]), (BODY[3], WHEEL[1])])
def test_exchanged_channels_are_named_and_corrected(first: str, second: str) -> None:
    for campaign in CAMPAIGNS.values():
        (fault,) = (corrected := examine(exchanged(campaign, first, second))[0]).faults
        assert (fault.code, fault.where) == ("exchanged", f"{first}, {second}")
        assert corrected.sensors == campaign.sensors


@pytest.mark.parametrize(("channel", "wheel"), [(WHEEL[0], "fr"), (WHEEL[1], "rl"), (WHEEL[3], "fr")])
def test_a_sensor_on_another_wheel_is_named_and_corrected(channel: str, wheel: Wheel) -> None:
    """Where it is stated another sensor sits: the two do not agree whether that wheel falls."""
    for campaign in CAMPAIGNS.values():
        (fault,) = (corrected := examine(on_wheel(campaign, channel, wheel))[0]).faults
        assert (fault.code, fault.where) == ("wrong-wheel", channel)
        assert corrected.sensors == campaign.sensors


def test_what_drops_do_not_tell_is_left_to_the_fit() -> None:
    """Where all wheels fall, or both of an axle, those of an axle are alike."""
    campaign = sprung.simulate(
        TABLE_1_CAR, drops=[{"wheels": wheels} for wheels in (WHEELS, WHEELS[:2], WHEELS[2:])], noise=0.05, seed=3
    )
    assert said(exchanged(campaign, "wheel_fl", "wheel_fr")) == []
    assert said(exchanged(campaign, "wheel_fl", "wheel_rr")) != [("exchanged", "wheel_fl, wheel_fr")]


def test_two_sensors_on_each_wheel_agree() -> None:
    campaign = CAMPAIGNS["with friction"]
    more = [replace(one, channel=f"second_{one.channel}") for one in campaign.sensors[4:]]
    twice = sprung.simulate(RUBBING, sensors=[*campaign.sensors, *more], noise=0.05, seed=3, duration=1.0)
    assert said(twice) == []


def test_a_channel_that_shows_nothing_is_not_put_elsewhere() -> None:
    """A sensor that reads a hundredth shows no fall: no other place of it, nor another sensor in its place, explains that."""
    campaign = CAMPAIGNS["car"]
    for channel in (4, 7):
        recordings = []
        for one in campaign.recordings:
            values = one.values.copy()
            values[channel] = values[channel].mean() + 0.01 * (values[channel] - values[channel].mean())
            recordings.append(replace(one, values=values))
        assert said(campaign.with_recordings(recordings)) == []


@pytest.mark.parametrize(
    ("sensor", "remedy"),
    [
        (Sensor(channel="a", on="fl"), "Correct on = ..."),
        (Sensor(channel="a", on="body", relative_to="fl", quantity="displacement"), "Correct relative_to = ..."),
    ],
)
def test_the_remedy_names_the_key_that_is_wrong(sensor: Sensor, remedy: str) -> None:
    prediction: Any = SimpleNamespace(
        sensor=sensor,
        channel=0,
        candidate=SimpleNamespace(campaign=CAMPAIGNS["car"]),
        row=lambda _: np.zeros(1),
        motion=np.zeros((1, 4)),
        residual_of=lambda predicted: predicted,
    )
    hypotheses = list(wheel(prediction))
    assert len(hypotheses) == 3
    assert all(hypothesis.fault((), ()).do.startswith(remedy) for hypothesis in hypotheses)
