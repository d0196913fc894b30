"""One change of a whole campaign that would put several of its statements right at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import dist

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.vehicle import Sensor, Wheel

Place = tuple[float, float, float]

_PAIRED = 0.5
"""m by which the place of a sensor may miss that opposite to another one."""

SIDES: Mapping[Wheel, Wheel] = {"fl": "fr", "fr": "fl", "rl": "rr", "rr": "rl", "left": "right", "right": "left"}
"""Left and right exchanged."""

ENDS: Mapping[Wheel, Wheel] = {"fl": "rl", "fr": "rr", "rl": "fl", "rr": "fr", "front": "rear", "rear": "front"}
"""Front and rear exchanged."""

CommonCause = tuple[Fault, Campaign]
"""What may be wrong with a whole campaign, and the campaign with it put right."""


def with_places(
    campaign: Campaign, moved: Callable[[Place], Place], which: Callable[[Sensor], bool] = lambda _: True
) -> tuple[Campaign, tuple[str, ...]]:
    """Put the body's sensors, or some of them, elsewhere; give the campaign and the channels that moved."""
    sensors, channels = [], []
    for sensor in campaign.sensors:
        if sensor.position is None or not which(sensor):
            sensors.append(sensor)
            continue
        place = moved(sensor.position)
        if place != sensor.position:
            channels.append(sensor.channel)
        sensors.append(replace(sensor, position=place))
    return replace(campaign, sensors=tuple(sensors)), tuple(channels)


def with_opposite_places(campaign: Campaign, opposite: Callable[[Place], Place]) -> tuple[Campaign, tuple[str, ...]]:
    """Exchange the places of opposite body sensors; a sensor without one near gets the opposite place."""
    places = [one.position for one in campaign.sensors if one.position is not None]
    nearest = {place: _nearest(opposite(place), places) for place in places}
    paired = all(
        nearest[other] == place and dist(other[:2], opposite(place)[:2]) < _PAIRED for place, other in nearest.items()
    )
    return with_places(campaign, nearest.__getitem__ if paired else opposite)


def _nearest(place: Place, places: Sequence[Place]) -> Place:
    return min(places, key=lambda one: dist(one[:2], place[:2]))


def with_stations(campaign: Campaign, other: Mapping[Wheel, Wheel]) -> tuple[Campaign, tuple[str, ...]]:
    """Put the wheels' sensors on other wheels; give the campaign and the channels."""

    def elsewhere(one: Sensor) -> Sensor:
        on = one.on if one.wheel is None else other.get(one.wheel, one.wheel)
        relative_to = None if one.relative_to is None else other.get(one.relative_to, one.relative_to)
        return replace(one, on=on, relative_to=relative_to)

    sensors = tuple(elsewhere(one) for one in campaign.sensors)
    changed = tuple(one.channel for one in campaign.sensors if one.on != "body" or one.relative_to is not None)
    return replace(campaign, sensors=sensors), changed


def join_names(channels: tuple[str, ...]) -> str:
    """Return the names of several channels as text."""
    return ", ".join(channels)
