"""Places of a load's items that are stated in another frame: signs, axes or origin."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction
from sprung.faults.hypothesis import Hypothesis
from sprung.vehicle import Load

Place = tuple[float, float, float]


def load_frames(base: CandidateFit) -> Iterator[Hypothesis]:
    """State the places of each load in each other frame."""
    campaign = base.campaign
    for load in campaign.loads:
        for what, do, transform in _frames(campaign):
            if not any(item.position is not None and transform(item.position) != item.position for item in load.items):
                continue
            fault = Fault(
                "load-position",
                f"load '{load.name}'",
                f"in the places of its items {what}; corrected",
                f"{do} in the campaign file.",
            )
            correction = _in_frame(load, transform)
            candidate = base.step(correction, base.fit)
            yield Hypothesis(fault, "corrected", correction, candidate.table, candidate)


def _frames(campaign: Campaign) -> Iterator[tuple[str, str, Callable[[Place], Place]]]:
    yield (
        "x has the wrong sign: x is positive forward of the front axle, negative behind it",
        "Change the sign of x of its items",
        lambda place: (-place[0], place[1], place[2]),
    )
    yield (
        "y has the wrong sign: y is positive on the left",
        "Change the sign of y of its items",
        lambda place: (place[0], -place[1], place[2]),
    )
    yield (
        "x and y are exchanged: x is forward of the front axle, y to the left",
        "Exchange x and y of its items",
        lambda place: (place[1], place[0], place[2]),
    )
    if campaign.wheelbase is not None:
        length = campaign.wheelbase.value
        yield (
            f"x is measured from the rear axle: it counts from the front axle, {length:g} m further forward",
            f"Subtract the wheelbase, {length:g} m, from x of its items",
            lambda place: (place[0] - length, place[1], place[2]),
        )


def _in_frame(load: Load, transform: Callable[[Place], Place]) -> Correction:
    items = tuple(
        item if item.position is None else replace(item, position=transform(item.position)) for item in load.items
    )
    moved = replace(load, items=items)

    def described(campaign: Campaign) -> Campaign:
        return replace(campaign, loads=tuple(moved if one.name == load.name else one for one in campaign.loads))

    return Correction(description=described)
