"""The campaign file's JSON Schema, published with the package: with it editors complete keys and mark mistakes.

It is made from the models in `sprung.campaign.schema`, whose docstrings describe the keys, and kept as a file beside this
one, so that programs in other languages can have it too. What several entries must say together, and what only the
recordings tell, stays with `sprung.campaign.read`.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from pydantic.json_schema import GenerateJsonSchema

from sprung.campaign.key_examples import annotate
from sprung.campaign.schema import KNOWABLE, CampaignFile
from sprung.campaign.schema_file import SCHEMA
from sprung.vehicle import EXTRAS, PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import core_schema

_DERIVED = {
    "total_mass": "mass of the whole vehicle, empty",
    "front_axle_mass": "what the front wheels put on the scales together, empty",
    "rear_axle_mass": "what the rear wheels put on the scales together, empty",
}
_UNITS = ["m/s^2", "g", "mg", "mm/s^2", "cm/s^2", "gal", "ft/s^2", "in/s^2"]


def campaign_schema(of: type[CampaignFile] = CampaignFile) -> str:
    """Return the JSON Schema of campaign.toml, or of another file of its kind, generated from the models, as text."""
    document = of.model_json_schema(schema_generator=_Toml)
    entries: dict[str, dict[str, Any]] = document["$defs"]
    properties = document["properties"]
    properties["schema"]["const"] = SCHEMA
    # By name rather than by a pattern of names: only so do editors complete them.
    properties["known"] |= {
        "properties": {name: {"$ref": "#/$defs/Measured", "description": _meaning(name)} for name in KNOWABLE},
        "additionalProperties": False,
    }
    model, sensor, load, item, drop = (entries[name] for name in ("ModelChoice", "Sensor", "Load", "Item", "Drop"))
    model["properties"]["extras"]["items"]["enum"] = list(EXTRAS)
    model["properties"]["forbid"]["items"]["enum"] = list(EXTRAS)
    # Many spellings are understood, so the usual ones are offered and none is refused.
    sensor["properties"]["unit"]["anyOf"] = [{"enum": _UNITS}, {"type": sensor["properties"]["unit"].pop("type")}]
    sensor |= _where({"on": {"const": "body"}}, {"required": ["position"]})
    load |= _where({"name": {"const": "empty"}}, _neither("items", "added"), _one("items", "added"))
    load["properties"]["items"]["minItems"] = 1
    for part in (item, entries["Added"]):
        mass, std = part["properties"]["mass"], part["properties"].pop("mass_std")
        number = {key: value for key, value in mass.items() if key != "description"}
        measured = {"value": {"description": "kg.", **number}, "std": std}
        table = {"type": "object", "properties": measured, "required": ["value"], "additionalProperties": False}
        part["properties"]["mass"] = {"description": mass["description"], "anyOf": [number, table]}
    item |= _one("position", "on")
    drop["properties"]["wheels"]["uniqueItems"] = True
    drop |= _one("file", "files")
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:sprung:campaign:{SCHEMA}",
        "title": "campaign.toml",
    }
    annotate(document)
    document["description"] = "What a test engineer writes down at the drop test: lengths m, masses kg, times s."
    return json.dumps(head | document, indent=2, ensure_ascii=False).replace("``", "`") + "\n"


def _meaning(name: str) -> str:
    if name in _DERIVED:
        return f"{_DERIVED[name].capitalize()}, kg."
    parameter = PARAMETERS[name]
    meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
    return f"{meaning}, {parameter.unit.replace('^2', '²')}."


def _one(*names: str) -> dict[str, Any]:
    """Ask for one of some keys and no more."""
    return {"oneOf": [{"required": [name]} for name in names]}


def _neither(*names: str) -> dict[str, Any]:
    return {"not": {"anyOf": [{"required": [name]} for name in names]}}


def _where(properties: Mapping[str, Any], then: Mapping[str, Any], otherwise: Mapping[str, Any] | None = None) -> Any:
    """Ask for something where some keys have the values given, and perhaps for something else where they have not."""
    asked = {"if": {"properties": properties, "required": list(properties)}, "then": then}
    return asked if otherwise is None else asked | {"else": otherwise}


class _Toml(GenerateJsonSchema):
    """What TOML can hold: no null, so what may be None is left out instead."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002 (pydantic's)
        return False

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        default = schema.get("default")
        plain = isinstance(default, str | int | float) or (isinstance(default, tuple) and len(default) > 0)
        return super().default_schema(schema) if plain else self.generate_inner(schema["schema"])

    def tuple_schema(self, schema: core_schema.TupleSchema) -> JsonSchemaValue:
        written = super().tuple_schema(schema)
        # Vectors of one kind of number, in words that every draft of JSON Schema has.
        numbers = written.pop("prefixItems", None)
        return written if numbers is None else written | {"items": numbers[0]}

    def dataclass_schema(self, schema: core_schema.DataclassSchema) -> JsonSchemaValue:
        written = super().dataclass_schema(schema)
        written.pop("title", None)
        return written

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        written = super().model_schema(schema)
        written.pop("title", None)  # a class's name means nothing to who writes a file
        if schema["cls"].__name__ != "Measured":
            return written
        about = {"description": written.pop("description")}
        return about | {"anyOf": [{"type": "number"}, written]}
