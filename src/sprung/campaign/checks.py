"""What the parts of a campaign file must say together."""

from __future__ import annotations

import math
from pathlib import PurePath
from typing import TYPE_CHECKING

import numpy as np

from sprung.campaign.pad_checks import check_pads
from sprung.campaign.plausibility import LIMITS, explain_implausible
from sprung.campaign.plausibility_checks import SMALLEST, check_relations, check_sizes
from sprung.campaign.schema import KNOWABLE, CampaignFile, VehicleFileSchema
from sprung.errors import Problems, did_you_mean
from sprung.uncertainty import KnownValue
from sprung.units import quantity_name
from sprung.vehicle import EXTRAS, LAYOUTS, PARAMETERS, STATIONS, WHEELS, Sensor, all_names, terms_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from sprung.campaign.parsing import ParsedFile
    from sprung.campaign.schema_problems import Place

CONTRADICTION = 4.0
"""Two statements contradict each other from this many combined standard uncertainties on."""

_APART = {
    "full": ", to distinguish bounce, pitch and roll",
    "pitch-plane": ", to distinguish bounce and pitch",
    "roll-plane": ", to distinguish bounce and roll",
    "quarter": "",
}
"""What the body's sensors are to distinguish, by the part of a vehicle."""

_SAME_PLACE = 0.01
"""m: sensors that are less apart tell nothing of rotation."""

ROUNDING = 1e-6
"""By how much, relatively, numbers given as exact may differ."""


def check(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Check everything that needs no recording.

    Parameters
    ----------
    parsed
        What was understood of the file.
    problems
        Takes up what is wrong.
    """
    _check_names(parsed, problems)
    _check_units(parsed, problems)
    check_body_sensors(parsed, problems)
    _check_loads(parsed, problems)
    _check_model(parsed, problems)
    _check_stations(parsed, problems)
    _check_drops(parsed, problems)
    check_pads(parsed, problems)
    check_quantities(parsed, problems)


def check_quantities(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Check every size by itself, and what several of them say together.

    Parameters
    ----------
    parsed
        What was understood of the file.
    problems
        Takes up what is wrong.
    """
    check_sizes(parsed, problems)
    known = _check_known(parsed, problems)
    check_relations(parsed, known, problems)
    _check_sums(parsed, known, problems)


def _check_names(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Nothing may be named twice."""
    file = parsed.file
    named: dict[tuple[str, str], list[tuple[str, str, object]]] = {
        ("sensor", "channel"): [("channel", sensor.channel, sensor.logger) for sensor in file.sensor],
        ("load", "name"): [("name", load.name, None) for load in file.load],
        # "./a.csv" is "a.csv"; one file may hold several drops, each in its window.
        ("drop", "file"): [
            (
                "files" if drop.files else "file",
                ", ".join(str(PurePath(one)) for one in drop.recording_files),
                drop.window,
            )
            for drop in file.drop
        ],
        ("drop", "name"): [("name", drop.name or "", None) for drop in file.drop],
    }
    remedies = {("drop", "file"): "Each drop has its own recording, or its own window of one."}
    for (section, kind), entries in named.items():
        first: dict[tuple[str, object], int] = {}
        for index, (key, name, beside) in zip(parsed.numbered(section), entries, strict=True):
            if not name or first.setdefault((name, beside), index) == index:
                continue
            found = f"'{name}', which {section}[{first[name, beside] + 1}] has too"
            expected = f"a {key} of its own for every {section}"
            problems.add(
                parsed.where(section, index, key),
                found,
                expected,
                remedies.get((section, kind), "Rename one, or remove it."),
            )


def find_wrong_unit(sensor: Sensor) -> str | None:
    """Return what is wrong with a sensor's unit; None where it is one of what it measures.

    Parameters
    ----------
    sensor
        The sensor.
    """
    try:
        sensor.si_factor  # noqa: B018 (asked whether there is one)
    except ValueError as error:
        return str(error)
    return None


def _check_units(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    for index, sensor in zip(parsed.numbered("sensor"), parsed.file.sensor, strict=True):
        reason = find_wrong_unit(sensor)
        if reason is not None:
            do, expected = reason.partition(". ")[2], f"a unit of {quantity_name(sensor.quantity)}"
            problems.add(parsed.where("sensor", index, "unit"), f"'{sensor.unit}'", expected, do)


def check_body_sensors(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Check that the body's sensors tell bounce, pitch and roll apart: as many unknowns, as many sensors apart from each other.

    Parameters
    ----------
    parsed
        What was understood of the file.
    problems
        Takes up what is wrong.
    """
    if not parsed.complete("sensor") or _left_to_defaults(parsed, "sensor") or ("vehicle", "model") in parsed.lost:
        return
    if any(sensor.needs_position and sensor.position is None for sensor in parsed.file.sensor):
        return  # said already
    if any(sensor.relative_to is not None or sensor.quantity == "angular-rate" for sensor in parsed.file.sensor):
        return  # they tell of the body, too, without a place
    placed = [
        sensor.position[:2] for sensor in parsed.file.sensor if sensor.on == "body" and sensor.position is not None
    ]
    if any(not LIMITS["x"].contain(length) for position in placed for length in position):
        return  # said already, and what they span is not worth saying
    layout = LAYOUTS[parsed.file.vehicle.model]
    turns = [layout.pitches, layout.rolls]
    needed = 1 + sum(turns)
    if len(placed) < needed:
        found, do = f"{len(placed)} sensors on the body", 'Add [[sensor]] entries with on = "body".'
        problems.add(parsed.where("sensor"), found, f"at least {needed}{_APART[layout.model]}", do)
        return
    spread = (np.array(placed) - np.mean(placed, axis=0))[:, turns]
    across = np.linalg.svd(spread, compute_uv=False) if spread.size else np.ones(1)
    if all(turns) and across[1] <= 0.01 * across[0]:
        found = "body sensors on one line, seen from above"
        do = "Correct their x and y; if they are right, pitch cannot be distinguished from roll: move a sensor off the line."
        problems.add(parsed.where("sensor"), found, "at least 3 that span an area", do)
    elif needed == 2 and across[0] < _SAME_PLACE:
        along = "x" if layout.pitches else "y"
        found, do = f"body sensors at one {along}", f"Correct their {along}; if it is right, move a sensor."
        problems.add(parsed.where("sensor"), found, f"at least 2 at different {along}", do)


def _left_to_defaults(parsed: ParsedFile[CampaignFile], section: str) -> bool:
    """Return whether a vehicle file leaves its sensors or drops to the simulation."""
    return isinstance(parsed.file, VehicleFileSchema) and section not in parsed.document


def _check_drops(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    if not parsed.file.drop and parsed.complete("drop") and not _left_to_defaults(parsed, "drop"):
        problems.add(parsed.where("drop"), "no drops", "at least one [[drop]]", "Add a [[drop]] for each recording.")


def _check_loads(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    if ("load",) in parsed.lost:
        return
    written = parsed.document.get("load", [])
    names = {"empty"} | {entry.get("name") for entry in written if isinstance(entry, dict)}
    for index, drop in zip(parsed.numbered("drop"), parsed.file.drop, strict=True):
        if drop.load and drop.load not in names and ("load" in parsed.document or parsed.complete("load")):
            do = did_you_mean(drop.load, [name for name in names if isinstance(name, str)])
            problems.add(parsed.where("drop", index, "load"), f"'{drop.load}'", "'empty' or the name of a [[load]]", do)


def _check_model(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    model = parsed.file.model
    of_layout = terms_of(LAYOUTS[parsed.file.vehicle.model])
    possible = [extra for extra in EXTRAS if extra in of_layout]
    for key, names in (("extras", model.extras or ()), ("forbid", model.forbid)):
        for name in names:
            if name not in possible:
                where, expected = parsed.where("model", key), f"any of {', '.join(possible)}"
                problems.add(where, f"'{name}'", expected, did_you_mean(name, possible, listed=True))
    for name in sorted(set(model.extras or ()) & set(model.forbid)):
        do = "Remove it from one of the two."
        problems.add(
            parsed.where("model", "forbid"), f"'{name}', which is in extras as well", "an extra not in extras", do
        )
    apart = [name for name in ("t_f1", "t_f2", "t_r1", "t_r2") if name in parsed.file.known]
    if model.tracks == "shared" and apart:
        found = f'"shared", and {apart[0]} in [known]'
        do = f'Give {apart[0][:-1]} instead of {apart[0]}, or tracks = "separate".'
        problems.add(parsed.where("model", "tracks"), found, "t_f and t_r, which springs and dampers share", do)


def _check_stations(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Check that everything is on a wheel that this part of a vehicle has."""
    if ("vehicle", "model") in parsed.lost:
        return
    layout = LAYOUTS[parsed.file.vehicle.model]
    named: list[tuple[Place, tuple[str | None, ...]]] = [
        (("sensor", index, key), () if wheel is None else (wheel,))
        for index, sensor in zip(parsed.numbered("sensor"), parsed.file.sensor, strict=True)
        for key, wheel in (("on", sensor.wheel or sensor.pad), ("relative_to", sensor.relative_to))
    ]
    named += [
        (("drop", index, "wheels"), drop.wheels if drop.wheels != WHEELS else ())
        for index, drop in zip(parsed.numbered("drop"), parsed.file.drop, strict=True)
    ]
    named += [
        (("load", index, "items", number, "on"), (item.on,) if item.on in STATIONS else ())
        for index, load in zip(parsed.numbered("load"), parsed.file.load, strict=True)
        for number, item in enumerate(load.items)
    ]
    for place, wheels in named:
        for wheel in (one for one in wheels if one not in layout.wheels):
            expected = f'any of {", ".join(layout.wheels)}, the wheels of a vehicle with model = "{layout.model}"'
            do = "Correct it, or state model = ... under [vehicle] if a part of a vehicle is tested."
            problems.add(parsed.where(*place), f"'{wheel}'", expected, do)


def _check_known(parsed: ParsedFile[CampaignFile], problems: Problems) -> dict[str, KnownValue]:
    """Return the known values that are valid, the wheelbase included."""
    known: dict[str, KnownValue] = {}
    model = parsed.file.vehicle.model
    of_model = [name for name in KNOWABLE if name not in PARAMETERS or name in all_names(model)]
    for name, measured in parsed.file.known.items():
        where = parsed.where("known", name)
        if name not in KNOWABLE:
            do = "Write it under [vehicle]." if name == "wheelbase" else did_you_mean(name, of_model)
            problems.add(where, f"the unknown quantity '{name}'", "the name of a parameter, or of a weighed mass", do)
            continue
        if name in PARAMETERS and name not in all_names(model):
            do = did_you_mean(name, sorted(all_names(model)))
            problems.add(where, f"'{name}'", f'a quantity of a vehicle with model = "{model}"', do)
            continue
        unit, meaning, positive, signed = "kg", name.replace("_", " "), True, False
        if name in PARAMETERS:
            about = PARAMETERS[name]
            unit, meaning, positive, signed = about.unit, about.meaning, about.positive, about.signed
        limits = explain_implausible(name, measured.value)
        if (measured.value < 0 and not signed) or (measured.value < SMALLEST and positive):
            sign = "positive" if positive else "not negative"
            problems.add(where, f"{measured.value:g}", f"a {sign} number: the {meaning} in {unit}", "Correct it.")
        elif limits is not None:
            expected, do = limits
            problems.add(where, f"{measured.value:g}", f"{expected}: the {meaning}", do)
        else:
            known[name] = measured.known
    wheelbase = parsed.file.vehicle.wheelbase
    if wheelbase is not None:
        where, length = parsed.where("vehicle", "wheelbase"), wheelbase.value
        limits = explain_implausible("wheelbase", length)
        if length < SMALLEST:
            expected = "a positive number: front axle to rear axle in m"
            problems.add(where, f"{length:g}", expected, "Correct it.")
        elif limits is not None:
            problems.add(where, f"{length:g}", *limits)
        else:
            known["wheelbase"] = wheelbase.known
    return known


def is_contradiction(one: KnownValue, other: KnownValue) -> bool:
    """Return whether two statements of one quantity contradict each other.

    Parameters
    ----------
    one, other
        The statements.
    """
    allowed = CONTRADICTION * math.hypot(one.std, other.std)
    return abs(one.value - other.value) > max(allowed, ROUNDING * abs(other.value))


def _sum(parts: Iterable[KnownValue]) -> KnownValue:
    parts = tuple(parts)
    return KnownValue(sum(part.value for part in parts), math.hypot(*(part.std for part in parts)))


def _said(known: KnownValue) -> str:
    return f"{known.value:.10g}" if known.is_exact else f"{known.value:.10g} ± {known.std:.3g}"


def _check_sums(parsed: ParsedFile[CampaignFile], known: Mapping[str, KnownValue], problems: Problems) -> None:
    """Two axles make a vehicle: in weight and in length."""
    parameters = getattr(parsed.file, "parameters", {})
    lengths = {name: KnownValue(parameters[name]) if name in parameters else known.get(name) for name in ("a", "b")}
    masses = {name: known.get(name) for name in ("front_axle_mass", "rear_axle_mass")}
    for section, name, unit, parts in (("known", "total_mass", "kg", masses), ("vehicle", "wheelbase", "m", lengths)):
        given = {part: value for part, value in parts.items() if value is not None}
        if name not in known or not given:
            continue
        whole, together = known[name], _sum(given.values())
        # With one part alone the other is missing: then only a whole that is too small is a contradiction.
        if is_contradiction(whole, together) and (len(given) == len(parts) or whole.value < together.value):
            found = f"{_said(whole)} {unit}, but {' + '.join(given)} = {_said(together)} {unit}"
            expected = f"the sum of {' and '.join(parts)}, to within their uncertainty"
            do = "Correct one of them, or state their uncertainty: { value = ..., std = ... }."
            problems.add(parsed.where(section, name), found, expected, do)
