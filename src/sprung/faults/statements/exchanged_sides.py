"""Left and right, or front and rear, taken for each other: in the wheels' sensors, in all sensors, or in all drops."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.statements.cause import ENDS, SIDES, CommonCause, join_names, with_opposite_places, with_stations

_SEVERAL = 2
"""Drops from which a mistake with them is a common one."""


def exchanged_sides(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:
    """Exchange left and right, and front and rear, of the drops' wheels, of the wheels' sensors and of all sensors."""
    for one, two, other in (("left", "right", SIDES), ("front", "rear", ENDS)):
        drops = tuple(replace(drop, wheels=tuple(other[wheel] for wheel in drop.wheels)) for drop in campaign.drops)
        names = tuple(
            drop.recording.name
            for drop, exchanged in zip(campaign.drops, drops, strict=True)
            if set(drop.wheels) != set(exchanged.wheels)
        )
        if len(names) >= _SEVERAL:
            what = (
                f"the {one} and the {two} wheels are exchanged in all of these drops: both the body and the wheels' sensors "
                "show the others to have fallen. Their wheels were exchanged"
            )
            do = f"Exchange {one} and {two} in wheels = [...] of these drops."
            yield Fault("wheels", join_names(names), what, do), replace(campaign, drops=drops)
        changed, channels = with_stations(campaign, other)
        if channels:
            what = (
                f"the {one} and the {two} wheel sensors are exchanged: the body goes down where the drops say, and the sensors "
                "of the other wheels show the fall. They were exchanged"
            )
            do = f"Exchange {one} and {two} in on = ... of the wheel sensors, or their channels."
            yield Fault("mirrored", join_names(channels), what, do), changed
            changed, body = with_opposite_places(
                changed,
                (lambda place: (place[0], -place[1], place[2]))
                if other is SIDES
                else (lambda place: (-wheelbase - place[0], place[1], place[2])),
            )
            where = "side" if other is SIDES else "end"
            what = (
                f"{one} and {two} of all sensors are exchanged: the body and the wheels' sensors agree with each other and "
                f"show the other {where} to have fallen than the drops say. All sensors were exchanged"
            )
            do = f"Exchange {one} and {two} in the places (on, position) of all sensors."
            both = (*body, *channels)
            yield Fault("mirrored", join_names(both), what, do), changed
