"""What an identification needs and a campaign file does not say yet; judging the recordings needs none of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sprung.display import shown
from sprung.errors import Problem
from sprung.vehicle import EMPTY

if TYPE_CHECKING:
    from sprung.campaign.schema import CampaignFile
    from sprung.campaign.sentences import Place
    from sprung.campaign.understanding import Draft

_ITEMS = {
    ("vehicle", "wheelbase"): "wheelbase",
    ("known", "total_mass"): "total mass",
    ("sensor", "position"): "sensor positions",
    ("sensor", "on"): "wheel stations of sensors",
    ("sensor", "unit"): "sensor units",
    ("sensor", "high_pass"): "lower limits of AC-coupled sensors",
    ("load", "items"): "load items",
    ("drop", "load"): "loads of drops",
    ("drop", "wheels"): "dropped wheels",
}
"""What a place in a campaign file holds, by its section and key."""


@shown
@dataclass(frozen=True, slots=True)
class Missing:
    """Something that a campaign file does not say.

    Attributes
    ----------
    item
        What it is, such as ``sensor positions``.
    problem
        Where it is missing, and what to write there.
    needed
        Whether nothing can be identified without it.
    """

    item: str
    problem: Problem
    needed: bool = True

    def document(self) -> dict[str, Any]:
        """Return what JSON holds of it."""
        problem = self.problem
        return {
            "item": self.item,
            "where": problem.where,
            "what": problem.expected,
            "do": problem.do,
            "needed": self.needed,
        }


def missing_in_file(draft: Draft[CampaignFile]) -> Iterator[Missing]:
    """List what a campaign file does not say yet.

    Parameters
    ----------
    draft
        What was understood of the file.

    Yields
    ------
    Missing
        Its gaps, and what was left out.
    """
    for place, problem in draft.gaps.items():
        yield Missing(_item(place), problem)
    file = draft.file
    for index, sensor in zip(draft.numbered("sensor"), file.sensor, strict=True):
        if sensor.on == "body" and sensor.position is None and ("sensor", index, "position") not in draft.gaps:
            do = "A body sensor needs its position = [x, y, z]."
            where = draft.where("sensor", index)
            yield Missing(_item(("sensor", index, "position")), Problem(where, "no position", "where it sits, m", do))
    for index, load in zip(draft.numbered("load"), file.load, strict=True):
        if load.name != EMPTY.name and not load.is_described and ("load", index, "items") not in draft.gaps:
            where, do = draft.where("load", index), "A load needs items = [...] or added = {...}."
            yield Missing(_item(("load", index, "items")), Problem(where, "neither items nor added", "what it is", do))
    for index, drop in zip(draft.numbered("drop"), file.drop, strict=True):
        for key, found, known, expected in (
            ("load", '""', bool(drop.load), "'empty' or the name of a [[load]], not empty"),
            ("wheels", "[]", bool(drop.wheels), "a list of the wheels that fell, not empty"),
        ):
            if not known and ("drop", index, key) not in draft.gaps:
                problem = Problem(draft.where("drop", index, key), found, expected, "Correct it.")
                yield Missing(_item(("drop", index, key)), problem)
    placed = file.vehicle.wheelbase is not None or {"a", "b"} <= file.known.keys()
    if not placed and draft.complete("vehicle") and ("vehicle", "wheelbase") not in draft.gaps:
        where, do = draft.where("vehicle", "wheelbase"), "Measure it with a tape and add wheelbase = ... to [vehicle]."
        problem = Problem(where, "nothing", "front axle to rear axle, m", do)
        yield Missing(_item(("vehicle", "wheelbase")), problem, needed=False)


def _item(place: Place) -> str:
    keys = [part for part in place if isinstance(part, str)]
    return _ITEMS.get((keys[0], keys[-1]), keys[-1].replace("_", " "))
