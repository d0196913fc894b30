"""The reference of campaign.toml and VEHICLE.toml, generated from their schema, and the sketch of their axes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from typing import Any

import tomli_w

from sprung.campaign.json_schema import campaign_schema
from sprung.campaign.key_examples import EXAMPLES, UNIT
from sprung.campaign.schema import VehicleFileSchema
from sprung.report import sketch_svg, vehicle_sketch
from sprung.report.drawing.style import standalone_style
from sprung.study import demo_campaign
from sprung.vehicle import PARAMETERS

FILE = "campaign"
"""Name of the table of keys before the first section."""


@cache
def _schema() -> Any:
    return json.loads(campaign_schema(VehicleFileSchema))


def sections() -> tuple[str, ...]:
    """Return the names of the models whose keys the reference lists."""
    return (FILE, *_schema()["$defs"])


def key_table(model: str) -> str:
    """Return a table of the keys of one section: type, unit, default, example, meaning.

    Parameters
    ----------
    model
        A name from `sections`.
    """
    entry = _schema() if model == FILE else _schema()["$defs"][model]
    for option in (entry, *entry.get("anyOf", ())):
        if "properties" in option:
            return _table(_rows(option, ["schema"] if model == FILE else list(option["properties"])))
    raise KeyError(model)


def _rows(entry: Mapping[str, Any], names: Iterable[str]) -> Iterator[list[str]]:
    for name in names:
        one = entry["properties"][name]
        default = f"`{_toml(one['default'])}`" if "default" in one else ""
        needed = "**required**" if name in entry.get("required", ()) else default
        example = _toml(one[EXAMPLES][0])
        if one.get("format") == "date":  # which TOML has as a type of its own
            example = example.strip('"')
        example = f"`{name} = {example}`"
        yield [f"`{name}`", kind_of(one), one.get(UNIT, ""), needed, example, _text(one["description"])]


def known_table() -> str:
    """Return a table of the keys of ``[known]``: name, unit, meaning."""
    rows = []
    for name, one in _schema()["properties"]["known"]["properties"].items():
        meaning, _, unit = one["description"].removesuffix(".").rpartition(", ")
        rows.append([f"`{name}`", unit, _text(meaning)])
    return _table(rows, ("key", "unit", "meaning"))


def parameter_rows() -> str:
    """Return a table of the keys of ``[parameters]`` of a vehicle file: name, unit, meaning."""
    rows = [[f"`{name}`", one.unit.replace("^2", "²"), _text(one.meaning)] for name, one in PARAMETERS.items()]
    return _table(rows, ("key", "unit", "meaning"))


def kind_of(one: Mapping[str, Any]) -> str:
    """Return a description of the values that a key accepts.

    Parameters
    ----------
    one
        Its schema.
    """
    if "$ref" in one:
        model = one["$ref"].rpartition("/")[2]
        return "number, or { value, std }" if model == "Measured" else "table"
    if "anyOf" in one:
        return ", or ".join(dict.fromkeys(kind_of(option) for option in one["anyOf"]))
    if allowed := [one["const"]] if "const" in one else one.get("enum", ()):
        return " ".join(f"`{_toml(value)}`" for value in allowed)
    if one["type"] == "array":
        count = f"{one['minItems']} " if one.get("minItems") == one.get("maxItems") and "minItems" in one else ""
        return f"list of {count}{_plural(kind_of(one['items']))}"
    limit = ", not below 0" if one.get("minimum") == 0 else " above 0" if one.get("exclusiveMinimum") == 0 else ""
    plain = {"string": one.get("format", "text"), "boolean": "`true` `false`"}
    return plain.get(one["type"], f"number{limit}")


def _plural(kind: str) -> str:
    return {"text": "texts", "table": "tables"}.get(kind, kind.replace("number", "numbers", 1))


def _toml(value: Any) -> str:
    """Return a value as TOML on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{name} = {_toml(one)}" for name, one in value.items()) + " }"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return tomli_w.dumps({"x": value}).removeprefix("x = ").strip()


def _text(text: str) -> str:
    return text.replace("|", "\\|").replace("[", "\\[")


def _table(
    rows: Iterable[list[str]], head: tuple[str, ...] = ("key", "value", "unit", "default", "example", "meaning")
) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def sketch() -> str:
    """Draw the axes, with the sensors, the load and the dimensions of the example that `sprung demo` writes."""
    drawn = vehicle_sketch(demo_campaign())
    style = standalone_style()
    pictures = "".join(
        f'<div style="background: #fff; padding: 0.5em">{sketch_svg(one, style)}</div>' for one in drawn.drawings
    )
    return f"```{{raw}} html\n{pictures}\n```\n\n{_text(drawn.key)}"


WRITTEN: Mapping[str, Callable[[], str]] = {
    "<!-- sketch of the axes -->": sketch,
    "<!-- keys of known -->": known_table,
    "<!-- keys of parameters -->": parameter_rows,
    **{f"<!-- keys of {model} -->": partial(key_table, model) for model in sections()},
}
