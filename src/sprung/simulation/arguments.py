"""Sensors, loads and drops: the default ones, and those made from mappings as they stand in a campaign file."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar, cast

from pydantic import ValidationError

from sprung.campaign import Drop
from sprung.errors import Problems
from sprung.units import SI_UNITS, Quantity
from sprung.vehicle import (
    FULL,
    PADS,
    STATIONS,
    Layout,
    Load,
    Sensor,
    SensorPlace,
    Vehicle,
    Wheel,
    parameter_name,
    parse_record,
    problems_of_record,
)

Record = TypeVar("Record")

_OF_PADS: Mapping[str, Quantity] = {"pad": "displacement", "force": "force"}
"""What a pad measures, by the name of its channel."""


def default_sensors(vehicle: Vehicle, *, on_pads: bool = False) -> tuple[Sensor, ...]:
    """Return accelerometers as in the paper: one at each corner of the body, one on each wheel.

    Parameters
    ----------
    vehicle
        The corners are 0.1 m ahead of its front and behind its rear axle, at the wider of its half-distances; of a part of a
        vehicle above its wheel stations.
    on_pads
        Whether it stands on pads that measure their displacements and the forces under its tyres.

    Returns
    -------
    tuple of Sensor
    """
    corners = []
    for wheel in vehicle.layout.wheels:
        _, axle, side, end = STATIONS[wheel]
        x = {1.0: 0.1, -1.0: -vehicle.wheelbase - 0.1, 0.0: 0.0}[end]
        half = max(getattr(vehicle, parameter_name("t", axle, number)) for number in "12") if side else 0.0
        corners.append(Sensor(channel=_channel("body", wheel), on="body", position=(x, side * half, 0.5)))
    wheels = [Sensor(channel=_channel("wheel", wheel), on=wheel) for wheel in vehicle.layout.wheels]
    pads = [
        Sensor(channel=_channel(name, wheel), on=cast("SensorPlace", pad), quantity=quantity, unit=SI_UNITS[quantity])
        for name, quantity in _OF_PADS.items()
        for pad, wheel in PADS.items()
        if on_pads and wheel in vehicle.layout.wheels
    ]
    return (*corners, *wheels, *pads)


def has_pads(drops: Iterable[Drop | Mapping[str, Any]]) -> bool:
    """Return whether pads drive the vehicle in any of some drops, records or mappings."""
    return any(
        (drop.excitation if isinstance(drop, Drop) else drop.get("excitation", "drop")) == "pads" for drop in drops
    )


def _channel(what: str, wheel: Wheel) -> str:
    return what if wheel == "wheel" else f"{what}_{wheel}"


def default_drops(loads: Iterable[Load], layout: Layout = FULL) -> tuple[Drop, ...]:
    """Return the paper's drops of all, front, rear, left and right wheels with each load.

    Parameters
    ----------
    loads
        All of them, ``empty`` among them where it is wanted.
    layout
        Of the vehicle.

    Returns
    -------
    tuple of Drop
    """
    sides = [tuple(one for one in layout.wheels if STATIONS[one].side == side) for side in (1.0, -1.0)]
    ends = [layout.wheels_of(axle) for axle in layout.axles]
    which = dict.fromkeys((layout.wheels, *ends, *(wheels for wheels in sides if wheels)))
    return tuple(Drop(load=load.name, wheels=wheels) for load in loads for wheels in which)


def records(
    model: type[Record], kind: str, given: Sequence[Record | Mapping[str, Any]], problems: Problems
) -> tuple[Record, ...]:
    """Return records of one kind; invalid ones are left out and added to the problems."""
    made = [record(model, f"{kind}[{i}]", entry, problems) for i, entry in enumerate(given)]
    return tuple(entry for entry in made if entry is not None)


def record(model: type[Record], where: str, given: Record | Mapping[str, Any], problems: Problems) -> Record | None:
    """Return the record of a mapping; None, with the problems noted, where it is invalid."""
    try:
        return given if isinstance(given, model) else parse_record(model, cast("Mapping[str, Any]", given))
    except ValidationError as error:
        for problem in problems_of_record(model, error, f"simulate: {where}"):
            problems.add(problem.where, problem.found, problem.expected, problem.do)
        return None


def name_files(drops: Sequence[Drop], what: str | None = None) -> tuple[Drop, ...]:
    """Return the drops with a unique file name each, numbered where it repeats.

    Parameters
    ----------
    drops
        The drops.
    what
        Follows the name of the load; None for the drop's own name, which tells the wheels.
    """
    taken = {drop.file for drop in drops}
    named = []
    for drop in drops:
        stem = re.sub(r"[^\w.-]+", "_", drop.label if what is None else f"{drop.load}_{what}")
        numbered = (f"{stem}{end}.csv" for end in itertools.chain([""], map("_{}".format, itertools.count(2))))
        file = drop.file or next(name for name in numbered if name not in taken)
        taken.add(file)
        named.append(replace(drop, file=file))
    return tuple(named)


def check_unique(kind: str, key: str, names: Iterable[str], problems: Problems) -> None:
    """Add a problem for every name that is used twice."""
    for name, count in Counter(names).items():
        if count > 1:
            found = f"'{name}' {count} times"
            problems.add(f"simulate: {kind}", found, f"a {key} of its own for each", "Rename all but one.")
