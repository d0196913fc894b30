"""Signs of positions: y counted to the right, x counted backward, for all sensors of the body or for those behind."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.statements.cause import CommonCause, join_names, with_opposite_places, with_places


def mirrored_positions(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:
    """Turn the sign of y of all sensors of the body, of x of all of them, and of x of those more than half a wheelbase off."""
    changed, channels = with_places(campaign, lambda place: (place[0], -place[1], place[2]))
    what = (
        "the positions of all body sensors are mirrored: the body goes down on the side on which y says that it should not; y "
        "is positive on the left. The sign of y of all of them was changed"
    )
    do = "Change the sign of y in their position = [x, y, z], or exchange the left and right body channels."
    yield Fault("mirrored", join_names(channels), what, do), changed

    exchanged, channels = with_opposite_places(campaign, lambda place: (place[0], -place[1], place[2]))
    if exchanged.sensors != changed.sensors:
        what = (
            "the left and the right body sensors are exchanged: the body goes down on the side on which their positions say "
            "that it should not. They were exchanged"
        )
        do = "Exchange the left and the right body channels in the campaign file, or their cables."
        yield Fault("mirrored", join_names(channels), what, do), exchanged

    changed, channels = with_places(campaign, lambda place: (-place[0], place[1], place[2]))
    what = (
        "the positions of all body sensors have the wrong sign of x: the body goes down at the other end than they say; x is "
        "positive forward of the front axle, negative behind it. The sign of x of all of them was changed"
    )
    do = "Change the sign of x in their position = [x, y, z] in the campaign file."
    yield Fault("mirrored", join_names(channels), what, do), changed

    changed, channels = with_places(
        campaign, lambda place: (-place[0], place[1], place[2]), lambda one: _ahead(one.position, wheelbase)
    )
    if channels and len(channels) < sum(one.position is not None for one in campaign.sensors):
        what = (
            "they are said to be ahead of the front axle and move like the rear of the body: x is positive forward of the "
            "front axle, negative behind it. The sign of x of these sensors was changed"
        )
        yield Fault("mirrored", join_names(channels), what, do), changed


def _ahead(place: tuple[float, float, float] | None, wheelbase: float) -> bool:
    return place is not None and place[0] > wheelbase / 2
