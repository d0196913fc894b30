"""x and y of positions exchanged: y forward, x to the left or, as many drawings have it, to the right."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.statements.cause import CommonCause, join_names, with_places


def exchanged_axes(campaign: Campaign, wheelbase: float) -> Iterator[CommonCause]:  # noqa: ARG001 (one form for all)
    """Exchange x and y of all sensors of the body."""
    for side, sign in (("left", 1.0), ("right", -1.0)):
        changed, channels = with_places(campaign, lambda place, sign=sign: (place[1], sign * place[0], place[2]))  # type: ignore[misc]
        what = (
            f"x and y of the positions of all body sensors are exchanged: the body moves as if x were to the {side} and y "
            "forward; here x is forward of the front axle and y to the left. They were exchanged"
        )
        turned = "" if sign > 0 else " and change the sign of the new y"
        do = f"Exchange x and y in their position = [x, y, z]{turned} in the campaign file."
        yield Fault("mirrored", join_names(channels), what, do), changed
