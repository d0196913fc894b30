"""Sizes that no road vehicle has, and sizes that do not go together: another unit, or a slip of the pen."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from sprung.campaign.excitation_checks import excitation_sizes
from sprung.campaign.plausibility import LIMITS, Limits, explain_implausible, suggest_unit
from sprung.campaign.schema import CampaignFile
from sprung.units import quantity_of_unit, si_factor
from sprung.vehicle import LAYOUTS, PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sprung.campaign.parsing import ParsedFile
    from sprung.campaign.schema_problems import Place
    from sprung.errors import Problems
    from sprung.uncertainty import KnownValue
    from sprung.vehicle import Load

SMALLEST = 1e-6
"""SI: where zero is not allowed, what is less counts as zero."""

_BEYOND = 1.2
"""Wheelbases ahead of the front axle, and behind the rear one, beyond which there is no vehicle any more."""

_AXLE = 0.1, 0.9
"""Part of the total mass that an axle may carry."""

_UNSPRUNG = 0.5
"""Part of the total mass that the wheels may make up."""

_LARGEST_LOAD = 2.5
"""Times the vehicle's own mass that a load may have."""

_GYRATION = {"I_yy": (0.1, 5.0), "I_xx": (0.05, 2.5), "load inertia": (0.0, 6.0)}
"""m: radii of gyration that go with a mass and a moment of inertia."""

Sized = tuple["Place", str, float]
"""A place in the file, the quantity that stands there, and its value, SI."""


def check_sizes(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Check the sizes of everything but ``[known]`` and the wheelbase, which are checked with their signs.

    Parameters
    ----------
    parsed
        What was understood of the file.
    problems
        Takes up what no vehicle has.
    """
    excitations = (getattr(parsed.file, name, None) for name in ("push", "bump"))
    for place, quantity, value in (
        *_parameters(parsed),
        *_of_the_vehicle(parsed),
        *_of_loads(parsed),
        *(sized for excitation in excitations if excitation is not None for sized in excitation_sizes(excitation)),
    ):
        found = explain_implausible(quantity, value)
        if found is not None:
            problems.add(parsed.where(*place), f"{value:g}", *found)
    sections = (("sensor", parsed.file.sensor), ("drop", parsed.file.drop))
    for section, entries in sections:
        indices = list(parsed.numbered(section))
        stated = [_of_sensor(entry) if section == "sensor" else _of_drop(entry) for entry in entries]
        for key in dict.fromkeys(key for quantities in stated for key in quantities):
            _check_alike(parsed, section, key, dict(zip(indices, stated, strict=True)), problems)


def _check_alike(
    parsed: ParsedFile[CampaignFile],
    section: str,
    key: str,
    entries: Mapping[int, Mapping[str, tuple[tuple[str, float], ...]]],
    problems: Problems,
) -> None:
    """Check what sensors, or drops, state alike: one unit mistaken in all of them is one problem."""
    wrong: dict[int, tuple[float, ...]] = {}
    limits: dict[float, Limits] = {}
    for index, stated in entries.items():
        sized = stated.get(key, ())
        if any(not LIMITS[quantity].contain(value) for quantity, value in sized):
            wrong[index] = tuple(value for _, value in sized)
            limits |= {value: LIMITS[quantity] for quantity, value in sized}
    if not wrong:
        return
    first, *others = wrong
    where = parsed.where(section, first, key) + (f" and {len(others)} more" if others else "")
    values = wrong[first]
    found = f"{values[0]:g}" if len(values) == 1 else f"[{', '.join(f'{value:g}' for value in values)}]"
    quantities = entries[first][key]
    expected = (
        LIMITS[quantities[0][0]].expected
        if len(values) == 1
        else ", ".join(f"{name} from {LIMITS[name].low:g} to {LIMITS[name].high:g}" for name, _ in quantities) + " m"
    )
    problems.add(where, found, expected, suggest_unit(limits, first=values))


def _parameters(parsed: ParsedFile[CampaignFile]) -> Iterator[Sized]:
    for name, value in getattr(parsed.file, "parameters", {}).items():
        if name in PARAMETERS and value > 0:  # what is not positive, the vehicle refuses itself
            yield ("parameters", name), name, value


def _of_the_vehicle(parsed: ParsedFile[CampaignFile]) -> Iterator[Sized]:
    for key, value in parsed.file.vehicle.heights.by_key.items():
        if value is not None:
            yield ("vehicle", key), key, value
    for name, ratio in parsed.file.vehicle.motion_ratio.known.items():
        yield ("vehicle", "motion_ratio", name), "motion ratio", ratio.value


def _of_sensor(sensor: object) -> dict[str, tuple[tuple[str, float], ...]]:
    position = getattr(sensor, "position", None)
    stated: dict[str, tuple[tuple[str, float], ...]] = {}
    if position is not None:
        stated["position"] = tuple(zip(("x", "y", "z"), position, strict=True))
    high_pass, unit = getattr(sensor, "high_pass", None), getattr(sensor, "unit", None)
    if high_pass is not None:
        stated["high_pass"] = (("corner frequency", high_pass),)
    for key, quantity in (("range", "full scale"), ("resolution", "resolution")):
        size = getattr(sensor, key, None)
        if size is not None and unit is not None and quantity_of_unit(unit) == "acceleration":
            stated[key] = ((quantity, size * si_factor(unit)),)
    return stated


def _of_drop(drop: object) -> dict[str, tuple[tuple[str, float], ...]]:
    stated = {
        "height": ("block height", getattr(drop, "height", None)),
        "speed": ("speed over a bump", getattr(drop, "speed", None)),
    }
    return {key: ((name, value),) for key, (name, value) in stated.items() if value is not None}


def _of_loads(parsed: ParsedFile[CampaignFile]) -> Iterator[Sized]:
    for index, load in zip(parsed.numbered("load"), parsed.file.load, strict=True):
        for number, item in enumerate(load.items):
            place = ("load", index, "items", number)
            yield (*place, "mass"), "load mass" if item.position is not None else "load mass on a wheel", item.mass
            for name, value in zip(("x", "y", "z"), item.position or (), strict=False):
                yield (*place, "position"), name, value
            for value in item.inertia:
                yield (*place, "inertia"), "load inertia", value
        for name, value in (asdict(load.added) if load.added else {}).items():
            quantity = "load inertia" if name.startswith("I_") else "load mass on a wheel"
            yield ("load", index, "added", name), "load mass" if name == "mass" else quantity, value


def check_relations(parsed: ParsedFile[CampaignFile], known: Mapping[str, KnownValue], problems: Problems) -> None:
    """Check what sizes say of each other: masses of masses, inertias of masses, and places of the wheelbase.

    Parameters
    ----------
    parsed
        What was understood of the file.
    known
        What is known and possible by itself, the wheelbase too.
    problems
        Takes up what does not go together.
    """
    stated = getattr(parsed.file, "parameters", {})
    parameters = {name: value for name, value in stated.items() if name in LIMITS and LIMITS[name].contain(value)}
    values = {**parameters, **{name: value.value for name, value in known.items()}}
    sections = {**dict.fromkeys(known, "known"), **dict.fromkeys(parameters, "parameters")}
    total = values.get("total_mass")
    for name, (low, high) in {
        **dict.fromkeys(("front_axle_mass", "rear_axle_mass"), _AXLE),
        "m_s": (1 - _UNSPRUNG, 1.0),
        **dict.fromkeys(("m_uf", "m_ur", "m_u"), (0.0, _UNSPRUNG / 2)),
    }.items():
        value = values.get(name)
        # What is more than the whole, the sums of the parts contradict already.
        if total is not None and value is not None and value <= total and not low * total <= value <= high * total:
            what = PARAMETERS[name].meaning if name in PARAMETERS else name.replace("_", " ")
            problems.add(
                parsed.where(sections[name], name),
                f"{value:g} kg beside a total mass of {total:g} kg",
                f"a {what} of {low * total:.4g} to {high * total:.4g} kg" if low else f"at most {high * total:.4g} kg",
                "Correct one of the two; see that both are in kg.",
            )
    mass = values.get("m_s", total)
    for name in ("I_yy", "I_xx"):
        if mass is not None and name in values and name in sections:
            _check_gyration(parsed.where(sections[name], name), name, values[name], mass, problems)
    for index, load in zip(parsed.numbered("load"), parsed.file.load, strict=True):
        _check_load(parsed, index, load, total, problems)
    if "wheelbase" in values:
        _check_places(parsed, values["wheelbase"], problems)


def _check_gyration(where: str, name: str, inertia: float, mass: float, problems: Problems) -> None:
    low, high = (mass * radius**2 for radius in _GYRATION[name])
    if not low <= inertia <= high:
        found = f"{inertia:g} kg m^2 for {mass:g} kg, a radius of gyration of {(inertia / mass) ** 0.5:.3g} m"
        expected = f"{low:.3g} to {high:.3g} kg m^2, the range for such a mass"
        problems.add(where, found, expected, "Correct it; check that it is in kg m^2 and the mass in kg.")


def _check_load(
    parsed: ParsedFile[CampaignFile], index: int, load: Load, total: float | None, problems: Problems
) -> None:
    mass = load.total_mass(LAYOUTS[parsed.file.vehicle.model])
    if total is not None and mass > _LARGEST_LOAD * total:
        found = f"a load of {mass:g} kg on a vehicle of {total:g} kg"
        expected = f"at most {_LARGEST_LOAD * total:.4g} kg"
        problems.add(
            parsed.where("load", index), found, expected, "Correct the load's mass or the vehicle's, both in kg."
        )
    for number, item in enumerate(load.items):
        for inertia in item.inertia:
            if LIMITS["load inertia"].contain(inertia):
                where = parsed.where("load", index, "items", number, "inertia")
                _check_gyration(where, "load inertia", inertia, item.mass, problems)


def _check_places(parsed: ParsedFile[CampaignFile], wheelbase: float, problems: Problems) -> None:
    """Whatever lies more than a vehicle's length off it was measured from somewhere else, or in another unit."""
    first, last = -(1 + _BEYOND) * wheelbase, _BEYOND * wheelbase
    places: list[tuple[Place, tuple[float, float, float]]] = [
        (("sensor", index, "position"), sensor.position)
        for index, sensor in zip(parsed.numbered("sensor"), parsed.file.sensor, strict=True)
        if sensor.position is not None
    ]
    places += [
        (("load", index, "items", number, "position"), item.position)
        for index, load in zip(parsed.numbered("load"), parsed.file.load, strict=True)
        for number, item in enumerate(load.items)
        if item.position is not None
    ]
    for place, (x, y, z) in places:
        said = not all(LIMITS[name].contain(value) for name, value in zip("xyz", (x, y, z), strict=True))
        if not said and not first <= x <= last:
            found = f"x = {x:g} m, with a wheelbase of {wheelbase:g} m"
            expected = f"x from {first:.3g} to {last:.3g} m: 0 at the front axle, {-wheelbase:g} at the rear one"
            problems.add(parsed.where(*place), found, expected, "Measure x forward from the front axle, in m.")
