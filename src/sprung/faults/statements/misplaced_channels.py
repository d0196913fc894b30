"""A wheel's sensor that is exchanged with another one, or stated on another wheel: which wheels fall tells in each drop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.correction import exchange_channels
from sprung.faults.statements.cause import CommonCause


def exchanged_channels(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:  # noqa: ARG001 (one form for all)
    """Exchange each two channels of which one at least is on a wheel."""
    sensors = campaign.sensors
    for first, second in combinations(range(len(sensors)), 2):
        one, other = sensors[first], sensors[second]
        if one.wheel == other.wheel or one.relative_to or other.relative_to:
            continue
        what = "the two channels are exchanged, as the first motion after the releases shows; corrected"
        do = "Exchange the two in the campaign file, or their cables."
        fault = Fault("exchanged", f"{one.channel}, {other.channel}", what, do)
        yield fault, exchange_channels(first, second, sensors).of_campaign(campaign)


def wrong_wheels(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:  # noqa: ARG001 (one form for all)
    """Put each wheel's sensor on each other wheel."""
    for channel, sensor in enumerate(campaign.sensors):
        for station in campaign.layout.wheels if sensor.wheel is not None else ():
            if station == sensor.wheel:
                continue
            what = (
                f"the channel shows the fall of wheel {station}, not of {sensor.wheel}, as the drops state it; taken to be "
                f"on {station}"
            )
            do = "Correct on = ... in the campaign file, or move the sensor."
            sensors = list(campaign.sensors)
            sensors[channel] = replace(sensor, on=station, position=None)
            yield Fault("wrong-wheel", sensor.channel, what, do), replace(campaign, sensors=tuple(sensors))
