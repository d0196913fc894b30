"""The fields of a campaign as a form, from the JSON schema of the campaign file: a new key of the file appears by itself."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from sprung.campaign import schema_text

Kind = Literal["text", "date", "lines", "choice", "several", "number", "measured", "vector"]
"""Text, a date, several texts, a word of some, several of them, a number, one with its uncertainty, several numbers."""

_LABELS = {
    "cg_height": "Height of the centre of gravity",
    "wheel_height": "Height of the wheel centres",
    "roll_axis_height": "Height of the roll axis",
    "model": "Part of a vehicle",
    "identification": "Chassis or test number",
    "on": "Place",
    "relative_to": "Measured from wheel",
    "high_pass": "Lower frequency limit",
    "gain_std": "Uncertainty of the gain",
    "tilt_std": "Uncertainty of the tilt",
    "position_std": "Uncertainty of the position",
    "delay_std": "Uncertainty of the delay",
    "fall": "Use the flight phase",
    "tracks": "Half-distances",
    "extras": "Exactly these model terms",
    "forbid": "Never these model terms",
    "file": "Recording",
    "files": "Recordings of several loggers",
    "start": "Free decay from",
    "end": "Free decay to",
    "window": "Part of the recording",
    "total_mass": "Total mass",
    "I_yy": "Pitch inertia",
    "I_xx": "Roll inertia",
    "m_uf": "Mass on each front wheel",
    "m_ur": "Mass on each rear wheel",
    "m_u": "Mass on each wheel",
    "spring_front": "Motion ratio, front springs",
    "spring_rear": "Motion ratio, rear springs",
    "damper_front": "Motion ratio, front dampers",
    "damper_rear": "Motion ratio, rear dampers",
    "spring": "Motion ratio, springs",
    "damper": "Motion ratio, dampers",
}
"""What a key is called where its name alone is no plain word."""

_RARE = {
    "VehicleSection": ("identification", "roll_axis_height", "wheel_height", "motion_ratio"),
    "Sensor": (
        *("quantity", "axis", "relative_to", "range", "resolution", "high_pass", "logger"),
        *("gain_std", "tilt_std", "position_std", "delay_std"),
    ),
    "Drop": ("files", "name", "excitation", "speed", "height"),
    "Item": ("inertia",),
}
"""Keys that most campaigns do without: shown where they are used, folded otherwise."""

_ORDER = ("file", "load", "wheels", "start", "end", "window", "files", "name", "excitation", "speed", "height")
"""Keys of a drop as its fields stand beside each other."""

_PARTS = {"position": ("x", "y", "z"), "inertia": ("I_xx", "I_yy"), "window": ("from", "to")}
"""Names of the numbers of a vector."""

_MODELS = {"vehicle": "VehicleSection", "test": "TestRecord", "model": "ModelChoice"}
ENTRIES = {"sensor": "Sensor", "load": "Load", "drop": "Drop"}
"""Sections in double brackets, by their models."""


@dataclass(frozen=True, slots=True)
class Spec:
    """A key of the campaign file as a field.

    Attributes
    ----------
    key
        Its name, with a dot before the key of a table in the section.
    kind
        Of its value.
    label, hint
        Name and explanation.
    unit
        Of its numbers, for people.
    choices
        Words that it may be.
    parts
        Names of the numbers of a vector.
    example
        As text.
    default
        What holds where the file states nothing; empty where that is not a word.
    required, rare
        Whether it must be stated; whether most campaigns do without.
    """

    key: str
    kind: Kind
    label: str
    hint: str = ""
    unit: str = ""
    choices: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()
    example: str = ""
    default: str = ""
    required: bool = False
    rare: bool = False


@cache
def section_specs(section: str) -> tuple[Spec, ...]:
    """Return the fields of a section of the campaign file, such as ``sensor``, or of an ``item`` of a load, in their order."""
    if section == "known":
        return tuple(_known_specs())
    model = {**_MODELS, **ENTRIES, "item": "Item"}[section]
    return tuple(_specs(model))


def _specs(model: str, prefix: str = "", rare: bool = False) -> list[Spec]:
    definition = _schema()["$defs"][model]
    found: list[Spec] = []
    for key, node in definition["properties"].items():
        seldom = rare or key in _RARE.get(model, ())
        inner = node.get("$ref", "").rpartition("/")[2]
        if inner in {"MotionRatioSection", "Added"}:
            found += _specs(inner, f"{key}.", seldom or inner == "Added")
        elif key != "items":
            found.append(_spec(f"{prefix}{key}", key, node, key in definition.get("required", ()), seldom))
    return sorted(found, key=lambda spec: _ORDER.index(spec.key)) if model == "Drop" else found


def _spec(name: str, key: str, node: Mapping[str, Any], required: bool, rare: bool) -> Spec:
    kind, choices = _kind(node)
    example = node.get("examples", [""])[0]
    label = _LABELS.get(key) or key.replace("_", " ")
    return Spec(
        name,
        kind,
        label[0].upper() + label[1:] if label[1:2].islower() or " " in label else label,
        node.get("description", "").replace("`", ""),
        node.get("x-unit", ""),
        choices,
        _PARTS.get(key, ()) if kind == "vector" else (),
        example if isinstance(example, str) else "",
        default if isinstance(default := node.get("default"), str) else "",
        required,
        rare,
    )


def _kind(node: Mapping[str, Any]) -> tuple[Kind, tuple[str, ...]]:
    """Return the kind of a key and the words that it may be, from its node of the schema."""
    options = [node, *node.get("anyOf", ())]
    if node.get("$ref", "").endswith("Measured") or any("value" in option.get("properties", {}) for option in options):
        return "measured", ()
    words = tuple(word for option in options for word in option.get("enum", ()))
    if words and all("enum" in option for option in node.get("anyOf", ())):
        return "choice", words
    plain: dict[str, tuple[Kind, tuple[str, ...]]] = {
        "boolean": ("choice", ("true", "false")),
        "number": ("number", ()),
        "integer": ("number", ()),
        "string": ("date" if node.get("format") == "date" else "text", words),
    }
    if node.get("type") != "array":
        return plain[node.get("type", "string")]
    if "minItems" in node and node["minItems"] == node.get("maxItems"):
        return "vector", ()
    of = tuple(node["items"].get("enum", ()))
    return ("several" if of else "lines"), of


def _known_specs() -> list[Spec]:
    found = []
    for name, node in _schema()["properties"]["known"]["properties"].items():
        meaning, _, unit = node["description"].removesuffix(".").rpartition(", ")
        label = f"{meaning} ({name})" if len(name) < 8 else _LABELS.get(name) or name.replace("_", " ").capitalize()
        unit = "" if unit == "1" else unit
        found.append(Spec(name, "measured", label, meaning, unit, rare=not name.endswith("_mass")))
    return found


@cache
def _schema() -> Any:
    return json.loads(schema_text())


def is_used(key: str, entry: Mapping[str, Any]) -> bool:
    """Return whether a section states a key, also one of a table in it."""
    node: Any = entry
    for part in key.split("."):
        if not isinstance(node, Mapping) or part not in node:
            return False
        node = node[part]
    return True


def restricted(spec: Spec, wheels: Sequence[str]) -> tuple[str, ...]:
    """Return the choices of a field for the wheel stations of a part of a vehicle."""
    stations = ("fl", "fr", "rl", "rr", "front", "rear", "left", "right", "wheel")
    others = [station for station in stations if station not in wheels]
    return tuple(word for word in spec.choices if word.removeprefix("pad ") not in others)
