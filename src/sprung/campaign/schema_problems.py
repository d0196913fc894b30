"""Faults of a file in plain words.

pydantic finds the faults; this file says them. What should stand in a place is read off the schema itself, so a new key
needs no new sentence.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from sprung.campaign.file_kind import VEHICLE_SECTIONS
from sprung.errors import Problem, did_you_mean
from sprung.vehicle import FULL, LAYOUTS, STATIONS, UNKNOWN_KEY

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from pydantic import BaseModel
    from pydantic_core import ErrorDetails

Place = tuple[str | int, ...]
"""Where in the document: keys, and indices that count from 0."""

_LABELS = {"sensor": "channel", "load": "name", "drop": "file"}
_LENGTHS = {"position": "[x, y, z] in m", "inertia": "[I_xx, I_yy] in kg m²"}
_SEVERAL_LOGGERS = (
    "a list of files",
    "file = ..., the one recording of the drop",
    "Several loggers per drop are not read yet: merge their recordings into one file.",
)


def problems_from_validation(
    model: type[BaseModel], details: Sequence[ErrorDetails], file: str, document: Mapping[str, Any]
) -> list[Problem]:
    """Yield a problem for every error that pydantic found in a document.

    Parameters
    ----------
    model
        The file's schema.
    details
        The faults.
    file
        The file's name.
    document
        What the file holds.
    """
    schema = _with_stations_of(document, model.model_json_schema())
    said = {
        detail["loc"]: _problem(schema, detail, file, document, _contradicted_default(model, schema, detail, document))
        for detail in details
    }
    # A key that is misspelt is not missing as well, nor does a list lack what is faulty in it.
    meant = [(place[:-1], problem.do) for place, problem in said.items() if "Did you mean" in problem.do]
    inside = {place[:depth] for place in said for depth in range(len(place))}
    kept = [
        problem
        for place, problem in said.items()
        if place not in inside and not any(place[:-1] == of and f"'{place[-1]}'" in do for of, do in meant)
    ]
    return list(dict.fromkeys(kept))  # two faults of one vector are one


def _with_stations_of(document: Mapping[str, Any], node: Any) -> Any:
    """Return a JSON schema without the wheel stations that the vehicle of a document does not have."""
    vehicle = document.get("vehicle")
    stated = vehicle.get("model", FULL.model) if isinstance(vehicle, dict) else FULL.model
    wheels = next((layout.wheels for model, layout in LAYOUTS.items() if model == stated), tuple(STATIONS))
    return _without_words(node, {name for wheel in STATIONS if wheel not in wheels for name in (wheel, f"pad {wheel}")})


def _contradicted_default(
    model: type[BaseModel], schema: dict[str, Any], detail: ErrorDetails, document: Mapping[str, Any]
) -> str | None:
    """Return the default of a faulty key that has a word from a list, if that contradicts the other keys of its entry."""
    place = detail["loc"]
    default = _node(schema, place).get("default") if detail["type"] == "literal_error" else None
    if default is None:
        return None
    try:
        model.model_validate_json(json.dumps(_without(document, place), default=str), strict=True)
    except ValidationError as error:
        if any(one["type"] == "value_error" and one["loc"] == place[:-1] for one in error.errors()):
            return str(default)
    return None


def _without(part: Any, place: Place) -> Any:
    """Return a part of a document without the key at a place."""
    first, *rest = place
    if isinstance(part, list):
        return [_without(inner, tuple(rest)) if index == first else inner for index, inner in enumerate(part)]
    if rest:
        return {**part, first: _without(part[first], tuple(rest))}
    return {key: inner for key, inner in part.items() if key != first}


def _without_words(node: Any, words: Collection[str | None]) -> Any:
    """Return a JSON schema with some words taken out of its lists of allowed ones."""
    if isinstance(node, list):
        return [_without_words(inner, words) for inner in node]
    if not isinstance(node, dict):
        return node
    return {
        key: [word for word in inner if word not in words] if key == "enum" else _without_words(inner, words)
        for key, inner in node.items()
    }


def _problem(
    schema: dict[str, Any], detail: ErrorDetails, file: str, document: Mapping[str, Any], excluded: str | None
) -> Problem:
    place, kind = _written(document, detail["loc"]), detail["type"]
    if kind in {"extra_forbidden", UNKNOWN_KEY}:
        where = format_place(file, place, document)
        if place[0] == "drop" and place[-1] == "files":
            return Problem(where, *_SEVERAL_LOGGERS)
        if place[0] in VEHICLE_SECTIONS and len(place) == 1:
            do = "Remove it: only a simulation needs it."
            return Problem(where, f"[{place[0]}], a section of a vehicle file", "a section of a campaign file", do)
        allowed = _node(schema, place[:-1]).get("properties", {})
        found = f"the unknown key '{place[-1]}'"
        return Problem(where, found, "a key that sprung knows", did_you_mean(str(place[-1]), allowed))
    if kind == "value_error":
        sentence = detail["msg"].removeprefix("Value error, ")
        do = f"{sentence[0].upper()}{sentence[1:]}."
        return Problem(
            format_place(file, place, document), quote_value(detail["input"]), "an entry that holds together", do
        )
    if isinstance(place[-1], int) and "prefixItems" in _node(schema, place[:-1]):
        place = place[:-1]  # a vector is corrected as a whole
    where, node = format_place(file, place, document), _without_words(_node(schema, place), {excluded})
    expected = _LENGTHS.get(str(place[-1]), _described(node))
    if kind == "missing" and place == detail["loc"]:
        return Problem(where, "nothing", expected, f"Add {place[-1]} = ... to it.")
    value = _value(document, place)
    do = "Correct it."
    if isinstance(value, dict) and node.get("type") == "array" and len(place) == 1:
        do = f"Write [[{place[0]}]] in double brackets, once for each."
    elif "enum" in node and isinstance(value, str):
        do = did_you_mean(value, node["enum"], listed=True)
    elif isinstance(value, str) and node.get("type") == "number":
        do = "Write a number, without quotes."
    return Problem(where, quote_value(value), expected, do)


def format_place(file: str, place: Sequence[str | int], document: Mapping[str, Any]) -> str:
    """Return a place in a file as text: ``campaign.toml: sensor[3].position (body_rl)``, counting from 1."""
    path = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")
    label = None
    if len(place) > 1 and place[0] in _LABELS and isinstance(place[1], int):
        entry = document[str(place[0])][place[1]]
        label = entry.get(_LABELS[str(place[0])]) if isinstance(entry, dict) else None
    return f"{file}: {path} ({label})" if isinstance(label, str) else f"{file}: {path}"


def _written(document: Any, place: Place) -> Place:
    """Cut a place off where the document has no tables or lists any more: a number counts as its own value."""
    for depth, part in enumerate(place):
        if isinstance(document, dict):
            document = document.get(part)
        elif isinstance(document, list) and isinstance(part, int):
            document = document[part] if part < len(document) else None
        else:
            return place[:depth]
    return place


def _value(document: Any, place: Place) -> Any:
    for part in place:
        document = document[part]
    return document


def _node(schema: dict[str, Any], place: Sequence[str | int]) -> dict[str, Any]:
    """Find the part of a JSON schema that rules a place."""
    node = schema
    for part in (None, *place):
        if isinstance(part, str):
            node = node.get("properties", {}).get(part) or node.get("additionalProperties") or {}
        elif isinstance(part, int):
            node = (
                node["prefixItems"][min(part, len(node["prefixItems"]) - 1)] if "prefixItems" in node else node["items"]
            )
        node = next((choice for choice in node.get("anyOf", ()) if choice.get("type") != "null"), node)
        if "$ref" in node:
            node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
    return node


def _described(node: dict[str, Any]) -> str:
    """Return what a part of a JSON schema allows, in words."""
    match node:
        case {"enum": words}:
            what = "one of " + ", ".join(json.dumps(word) for word in words)
        case {"type": "number", "exclusiveMinimum": 0}:
            what = "a positive number"
        case {"type": "number", "minimum": 0}:
            what = "a number, 0 or more"
        case {"type": "number"}:
            what = "a number"
        case {"type": "string", **more}:
            what = "text in double quotes" + (", not empty" if more.get("minLength") == 1 else "")
            if more.get("format") == "date":
                what = "a date without quotes, year-month-day: 2026-11-22"
        case {"type": "array", "items": items}:
            of = "tables" if "$ref" in items else _described(items).removeprefix("one of ")
            what = f"a list in [ ] of {of}" + (", not empty" if node.get("minItems") else "")
        case {"properties": {"value": _, "std": _}}:
            what = "a number, or { value = ..., std = ... }"
        case {"type": "integer"}:
            what = "a whole number"
        case _:
            what = "a table of keys and values"
    return what


def quote_value(value: Any) -> str:
    """Write a value as TOML would, shortened."""
    if isinstance(value, dict):
        text = "{ " + ", ".join(f"{key} = {quote_value(inner)}" for key, inner in value.items()) + " }"
    elif isinstance(value, list):
        text = "[" + ", ".join(map(quote_value, value)) + "]"
    else:
        text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= 100 else text[:97] + "..."
