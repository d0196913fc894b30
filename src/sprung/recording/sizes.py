"""Sizes that no road vehicle has: millimetres written for metres, and slips of the pen."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from sprung.recording.schema import CampaignFile
from sprung.vehicle import PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sprung.errors import Problems
    from sprung.recording.sentences import Place
    from sprung.recording.understanding import Draft

LARGEST = {"kg": 1e6, "kg m^2": 1e8, "m": 100.0, "N/m": 1e10, "N s/m": 1e9, "N": 1e8}
"""By unit: more than any road vehicle has."""

SMALLEST = 1e-6
"""SI: less than any part of even a model vehicle has, where zero is not allowed."""


def too_large(value: float, unit: str) -> str | None:
    """Say what is expected in place of a size that no vehicle has; None where one may have it.

    Parameters
    ----------
    value, unit
        The size, in SI.
    """
    return None if abs(value) <= LARGEST[unit] else f"at most {LARGEST[unit]:g} {unit}, as a road vehicle has it"


def check_sizes(draft: Draft[CampaignFile], problems: Problems) -> None:
    """Check the sizes of everything but ``[known]``.

    Parameters
    ----------
    draft
        What was understood of the file.
    problems
        Takes up what is too large.
    """
    parameters = getattr(draft.file, "parameters", {})
    given = [
        (("parameters", name), PARAMETERS[name].unit, value) for name, value in parameters.items() if name in PARAMETERS
    ]
    for place, unit, value in (*given, *_of_the_vehicle(draft), *_of_loads(draft)):
        expected = too_large(value, unit)
        if place[0] == "parameters" and 0 < value < SMALLEST:
            expected = f"at least {SMALLEST:g} {unit}, or 0 where there is none"
        if expected is not None:
            problems.add(draft.where(*place), f"{value:g}", expected, f"Write it in {unit}.")


def _of_the_vehicle(draft: Draft[CampaignFile]) -> Iterator[tuple[Place, str, float]]:
    for key in ("cg_height", "wheel_height", "roll_axis_height"):
        yield ("vehicle", key), "m", getattr(draft.file.vehicle, key) or 0.0
    for index, sensor in zip(draft.numbered("sensor"), draft.file.sensor, strict=True):
        yield ("sensor", index, "position"), "m", max(map(abs, sensor.position or (0.0,)))
    for index, drop in zip(draft.numbered("drop"), draft.file.drop, strict=True):
        yield ("drop", index, "height"), "m", drop.height or 0.0


def _of_loads(draft: Draft[CampaignFile]) -> Iterator[tuple[Place, str, float]]:
    for index, load in zip(draft.numbered("load"), draft.file.load, strict=True):
        for number, item in enumerate(load.items):
            place = ("load", index, "items", number)
            yield (*place, "mass"), "kg", item.mass
            yield (*place, "position"), "m", max(map(abs, item.position or (0.0,)))
            yield (*place, "inertia"), "kg m^2", max(item.inertia)
        for name, value in (asdict(load.added) if load.added else {}).items():
            yield ("load", index, "added", name), "kg m^2" if name.startswith("I_") else "kg", value
