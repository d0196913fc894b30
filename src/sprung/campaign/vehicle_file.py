"""Vehicle files: a vehicle, and the campaign to simulate with it."""

from __future__ import annotations

from dataclasses import astuple, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from sprung.campaign.campaign import ModelChoice, TestRecord
from sprung.campaign.checks import check
from sprung.campaign.completeness import find_missing_entries
from sprung.campaign.drop import Drop
from sprung.campaign.excitation import Bump, Push
from sprung.campaign.file_reading import stated_loads
from sprung.campaign.parsing import ParsedFile, parse_document
from sprung.campaign.schema import VehicleFileSchema
from sprung.campaign.toml_document import read_toml
from sprung.display import shown
from sprung.errors import InputError, Problems
from sprung.vehicle import Load, Sensor, Vehicle

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sprung.uncertainty import KnownValue


@shown
@dataclass(frozen=True, eq=False)
class VehicleFile:
    """What a vehicle file says: a vehicle to simulate, and the campaign to simulate with it.

    Attributes
    ----------
    vehicle
        Its parameters.
    sensors, loads, drops
        As in a `Campaign`; the drops have no recordings.
    wheelbase, wheel_height, roll_axis_height, known, model, identification, test, motion_ratio
        As in a `Campaign`: what the simulated campaign may say about itself.
    path
        Where the file is.
    push, bump
        How the body is pushed in every push, and what is driven over in every pass.
    """

    vehicle: Vehicle
    sensors: tuple[Sensor, ...]
    loads: tuple[Load, ...]
    drops: tuple[Drop, ...]
    wheelbase: KnownValue | None = None
    wheel_height: float | None = None
    roll_axis_height: float | None = None
    known: Mapping[str, KnownValue] = field(default_factory=dict)
    model: ModelChoice = field(default_factory=ModelChoice)
    path: Path | None = None
    identification: str | None = None
    test: TestRecord = field(default_factory=TestRecord)
    motion_ratio: Mapping[str, KnownValue] = field(default_factory=dict)
    push: Push = field(default_factory=Push)
    bump: Bump = field(default_factory=Bump)

    @property
    def all_known(self) -> dict[str, KnownValue]:
        """What is known beforehand, the wheelbase included where the file gives it."""
        return dict(self.known) if self.wheelbase is None else {**self.known, "wheelbase": self.wheelbase}


def read_vehicle_file(path: Path) -> VehicleFile:
    """Read a vehicle file; see `sprung.campaign.read_vehicle`."""
    problems = Problems()
    parsed = parse_document(VehicleFileSchema, read_toml(path), path.name, problems)
    for entry in find_missing_entries(parsed):
        if entry.needed:
            problems.add(*astuple(entry.problem))
    check(parsed, problems)
    section = parsed.file.vehicle
    name = section.name or path.stem
    vehicle = _vehicle(parsed, name, problems)
    problems.raise_if_any()
    assert vehicle is not None  # noqa: S101 (its problems were raised; for the type checker)
    return VehicleFile(
        vehicle=vehicle,
        sensors=parsed.file.sensor,
        loads=stated_loads(parsed.file),
        drops=parsed.file.drop,
        wheelbase=section.wheelbase.known if section.wheelbase else None,
        wheel_height=section.wheel_height,
        roll_axis_height=section.roll_axis_height,
        known={name: measured.known for name, measured in parsed.file.known.items()},
        model=parsed.file.model,
        path=path,
        identification=section.identification,
        test=parsed.file.test,
        motion_ratio=section.motion_ratio.known,
        push=parsed.file.push,
        bump=parsed.file.bump,
    )


def _vehicle(parsed: ParsedFile[VehicleFileSchema], name: str, problems: Problems) -> Vehicle | None:
    """Return the vehicle of a file; None, with the problems noted, where it is invalid."""
    if ("parameters",) in parsed.lost or ("parameters" not in parsed.document and not parsed.complete("parameters")):
        return None  # the section is faulty as a whole, or misspelt
    # What was written but not understood is a problem already: it must not be called missing as well.
    held = {str(place[1]): 1.0 for place in parsed.lost if place[0] == "parameters"}
    parameters = {**held, **parsed.file.parameters}
    try:
        section = parsed.file.vehicle
        return Vehicle(parameters, name=name, model=section.model, **section.heights.by_key)
    except InputError as error:
        for problem in error.problems:
            where = problem.where.replace(f"vehicle {name}: ", f"{parsed.name}: parameters.")
            where = where.replace(f"vehicle {name}", f"{parsed.name}: parameters")
            problems.add(where, problem.found, problem.expected, problem.do)
    return None
