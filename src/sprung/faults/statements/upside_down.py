"""Sensors upside down: all of them, those of the body, or those of the wheels."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.correction import scale_channel
from sprung.faults.statements.cause import CommonCause, join_names

_GROUPS = (("all sensors", "body wheel"), ("all body sensors", "body"), ("all wheel sensors", "wheel"))


def upside_down(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:  # noqa: ARG001 (one form for all)
    """Turn over the sensors of the body, of the wheels, and all."""
    for name, of in _GROUPS:
        which = [i for i, one in enumerate(campaign.sensors) if ("body" if one.on == "body" else "wheel") in of.split()]
        changed = campaign
        for channel in which:
            changed = scale_channel(channel, -1.0).of_campaign(changed)
        channels = tuple(campaign.sensors[i].channel for i in which)
        if not channels:
            continue
        ways = {"down" if campaign.sensors[i].direction == "up" else "up" for i in which}
        now = f'Set direction = "{ways.pop()}" for them' if len(ways) == 1 else "Turn the direction of each of them"
        what = (
            f"{name} read upside down: after the release they show a rise, where a vehicle falls. They were turned over"
        )
        do = f"{now} in the campaign file."
        yield Fault("sign", join_names(channels), what, do), changed
