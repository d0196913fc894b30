"""Places measured from another point than the front axle, and left and right or front and rear taken for each other."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.statements.cause import CommonCause, join_names, with_opposite_places, with_places


def other_origin(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:
    """Measure x of the body's sensors from the rear axle forward instead, and exchange those in front with those behind."""
    changed, channels = with_places(campaign, lambda place: (place[0] - wheelbase, place[1], place[2]))
    what = (
        f"the positions of all body sensors are measured from the rear axle: the body moves as if each were {wheelbase:g} m "
        "further back, which is the wheelbase; x counts from the front axle. The wheelbase was taken off x of all of them"
    )
    do = f"Take the wheelbase, {wheelbase:g} m, off x in their position = [x, y, z] in the campaign file."
    yield Fault("position", join_names(channels), what, do), changed

    changed, channels = with_opposite_places(campaign, lambda place: (-wheelbase - place[0], place[1], place[2]))
    what = (
        "the body sensors in front and those behind are exchanged: the body goes down at the other end than their positions "
        "say. All of them were put at the other end"
    )
    do = "Exchange the front and the rear body channels in the campaign file, or x in their position = [x, y, z]."
    yield Fault("mirrored", join_names(channels), what, do), changed
