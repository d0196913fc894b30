"""What an identification needs and a campaign file does not say yet; judging the recordings needs none of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sprung.display import shown
from sprung.errors import Problem
from sprung.vehicle import EMPTY, LAYOUTS

if TYPE_CHECKING:
    from sprung.campaign.parsing import ParsedFile
    from sprung.campaign.schema import CampaignFile
    from sprung.campaign.schema_problems import Place
    from sprung.vehicle import VehicleModel

_ITEMS = {
    ("vehicle", "wheelbase"): "wheelbase",
    ("known", "total_mass"): "total mass",
    ("sensor", "position"): "sensor positions",
    ("sensor", "on"): "wheel stations of sensors",
    ("sensor", "unit"): "sensor units",
    ("sensor", "axis"): "axes of gyroscopes",
    ("sensor", "relative_to"): "wheels of suspension travels",
    ("sensor", "high_pass"): "lower limits of AC-coupled sensors",
    ("load", "items"): "load items",
    ("drop", "load"): "loads of drops",
    ("drop", "wheels"): "dropped wheels",
    ("drop", "excitation"): "excitations",
}
"""What a place in a campaign file holds, by its section and key."""


@shown
@dataclass(frozen=True, slots=True)
class MissingEntry:
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


def find_missing_entries(parsed: ParsedFile[CampaignFile]) -> Iterator[MissingEntry]:
    """List what a campaign file does not say yet.

    Parameters
    ----------
    parsed
        What was understood of the file.

    Yields
    ------
    Missing
        Its gaps, and what was left out.
    """
    for place, problem in parsed.placeholders.items():
        yield MissingEntry(_item(place), problem)
    file = parsed.file
    for index, sensor in zip(parsed.numbered("sensor"), file.sensor, strict=True):
        if (
            sensor.needs_position
            and sensor.position is None
            and not {("sensor", index, key) for key in ("position", "relative_to")} & parsed.placeholders.keys()
        ):
            do = f"A body sensor needs its position = [x, y, z]{_zeros(file.vehicle.model)}."
            where = parsed.where("sensor", index)
            yield MissingEntry(
                _item(("sensor", index, "position")), Problem(where, "no position", "where it sits, m", do)
            )
    for index, load in zip(parsed.numbered("load"), file.load, strict=True):
        if load.name != EMPTY.name and not load.is_described and ("load", index, "items") not in parsed.placeholders:
            where, do = parsed.where("load", index), "A load needs items = [...] or added = {...}."
            yield MissingEntry(
                _item(("load", index, "items")), Problem(where, "neither items nor added", "what it is", do)
            )
    for index, drop in zip(parsed.numbered("drop"), file.drop, strict=True):
        for key, found, known, expected in (
            ("load", '""', bool(drop.load), "'empty' or the name of a [[load]], not empty"),
            ("wheels", "[]", bool(drop.wheels), "a list of the wheels that fell, not empty"),
        ):
            if not known and ("drop", index, key) not in parsed.placeholders:
                problem = Problem(parsed.where("drop", index, key), found, expected, "Correct it.")
                yield MissingEntry(_item(("drop", index, key)), problem)
    placed = (
        not LAYOUTS[file.vehicle.model].pitches or file.vehicle.wheelbase is not None or {"a", "b"} <= file.known.keys()
    )
    if not placed and parsed.complete("vehicle") and ("vehicle", "wheelbase") not in parsed.placeholders:
        where, do = parsed.where("vehicle", "wheelbase"), "Measure it with a tape and add wheelbase = ... to [vehicle]."
        problem = Problem(where, "nothing", "front axle to rear axle, m", do)
        yield MissingEntry(_item(("vehicle", "wheelbase")), problem, needed=False)


def _zeros(model: VehicleModel) -> str:
    """Return which coordinates are 0 in a part of a vehicle that does not pitch or roll."""
    layout = LAYOUTS[model]
    zeros = [axis for axis, turns in (("x", layout.pitches), ("y", layout.rolls)) if not turns]
    return f", with {' = '.join((*zeros, '0'))} where model is {model}" if zeros else ""


def _item(place: Place) -> str:
    keys = [part for part in place if isinstance(part, str)]
    return _ITEMS.get((keys[0], keys[-1]), keys[-1].replace("_", " "))
