"""Unit and example of every key of campaign.toml, for its JSON Schema and the reference that is generated from it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

UNIT, EXAMPLES = "x-unit", "examples"
"""Keywords of the JSON Schema that hold them; the first is our own, by the rule for such keywords."""


@dataclass(frozen=True, slots=True)
class Key:
    """What the type of a key does not tell.

    Attributes
    ----------
    example
        A value, as TOML holds it.
    unit
        Of its numbers; empty for text and plain numbers.
    """

    example: Any
    unit: str = ""


KEYS: Mapping[str, Mapping[str, Key]] = {
    "": {"schema": Key(1)},
    "VehicleSection": {
        "name": Key("School bus"),
        "identification": Key("WDB 906 1234"),
        "model": Key("roll-plane"),
        "wheelbase": Key({"value": 3.95, "std": 0.005}, "m"),
        "cg_height": Key(0.9, "m"),
        "wheel_height": Key(0.34, "m"),
        "roll_axis_height": Key(0.4, "m"),
        "motion_ratio": Key({"spring_front": 0.7, "damper_front": {"value": 0.68, "std": 0.01}}),
    },
    "MotionRatioSection": {
        "spring_front": Key(0.7),
        "spring_rear": Key(0.95),
        "damper_front": Key({"value": 0.68, "std": 0.01}),
        "damper_rear": Key(0.9),
        "spring": Key(0.95),
        "damper": Key(0.9),
    },
    "TestRecord": {
        "date": Key("2026-11-22"),
        "operator": Key("A. Engineer"),
        "place": Key("hall 3"),
        "remarks": Key("tyres at 2.4 bar, tank half full"),
    },
    "Measured": {"value": Key(5240), "std": Key(5)},
    "ModelChoice": {
        "tracks": Key("shared"),
        "extras": Key(["friction", "rebound"]),
        "forbid": Key(["tyre-damping"]),
        "fall": Key(True),
    },
    "Sensor": {
        "channel": Key("body_fl"),
        "on": Key("body"),
        "quantity": Key("displacement"),
        "axis": Key("roll"),
        "relative_to": Key("fl"),
        "position": Key([0.12, 0.69, 0.55], "m"),
        "unit": Key("g"),
        "direction": Key("down"),
        "range": Key(4.0, "unit of the sensor"),
        "resolution": Key(0.000122, "unit of the sensor"),
        "high_pass": Key(0.3, "Hz"),
        "logger": Key("left"),
        "gain_std": Key(0.005),
        "tilt_std": Key(1.0, "degrees"),
        "position_std": Key(0.005, "m"),
        "delay_std": Key(0.0002, "s"),
    },
    "Load": {
        "name": Key("sandbags"),
        "items": Key([{"mass": 235, "position": [-1.2, 0.4, 1.1]}, {"mass": 20, "on": "fl"}]),
        "added": Key({"mass": 470, "I_yy": 1057.5, "I_xx": 339.6}),
    },
    "Item": {
        "mass": Key(235, "kg"),
        "position": Key([-1.2, 0.4, 1.1], "m"),
        "inertia": Key([12.0, 20.0], "kg m²"),
        "on": Key("fl"),
    },
    "Added": {
        "mass": Key(470, "kg"),
        "I_yy": Key(1057.5, "kg m²"),
        "I_xx": Key(339.6, "kg m²"),
        "m_uf": Key(10.0, "kg"),
        "m_ur": Key(10.0, "kg"),
        "m_u": Key(10.0, "kg"),
    },
    "Drop": {
        "file": Key("empty_bounce.csv"),
        "files": Key(["left/bounce.csv", "right/bounce.csv"]),
        "name": Key("bounce, second try"),
        "window": Key([12.0, 18.5], "s"),
        "load": Key("empty"),
        "wheels": Key(["fl", "fr"]),
        "excitation": Key("pass"),
        "speed": Key(5.0, "m/s"),
        "height": Key(0.05, "m"),
        "start": Key(1.32, "s"),
        "end": Key(4.0, "s"),
    },
    "Push": {
        "shape": Key("rope"),
        "force": Key(900.0, "N"),
        "count": Key(6),
        "frequency": Key(1.3, "Hz"),
        "position": Key([-3.4, 0.0], "m"),
    },
    "Bump": {
        "shape": Key("plank"),
        "height": Key(0.04, "m"),
        "length": Key(0.3, "m"),
        "edge": Key(0.1, "m"),
    },
}
"""By the model of the section, the file itself under an empty name."""


def annotate(document: dict[str, Any]) -> None:
    """Add unit and example to every key of a JSON Schema.

    Parameters
    ----------
    document
        The schema; changed in place.
    """
    for model, own in KEYS.items():
        properties = _properties(document["$defs"].get(model, {}) if model else document)
        for name, key in own.items():
            if name in properties:
                properties[name] |= {EXAMPLES: [key.example]} | ({UNIT: key.unit} if key.unit else {})


def without_example(document: Mapping[str, Any]) -> Iterator[str]:
    """Return the keys of a JSON Schema that have no example; sections need none.

    Parameters
    ----------
    document
        The schema.
    """
    for model, entry in {"": document, **document["$defs"]}.items():
        for name, value in _properties(entry).items():
            section = not model and name != "schema"
            if not section and EXAMPLES not in value:
                yield f"{model}.{name}".lstrip(".")


def _properties(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of an entry, also of one that may be a plain number instead."""
    options = [entry, *entry.get("anyOf", ())]
    return next((option["properties"] for option in options if "properties" in option), {})
