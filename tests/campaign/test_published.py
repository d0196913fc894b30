"""The JSON Schema of campaign.toml: up to date, and agreeing with what is read about what is right and what is wrong."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

import sprung
from sprung.campaign import SCHEMA_FILE, SCHEMA_LINE, schema_text
from sprung.campaign.json_schema import campaign_schema
from sprung.campaign.key_examples import KEYS, without_example
from sprung.campaign.schema import VehicleFileSchema
from sprung.errors import InputError

DATA = Path(__file__).resolve().parents[1] / "data"
VALIDATOR = Draft202012Validator(json.loads(campaign_schema()))


def faults_of(document: Any) -> list[str]:
    return [fault.message for fault in VALIDATOR.iter_errors(document)]


def test_the_file_is_what_the_models_say(regenerate: bool) -> None:
    if regenerate:
        Path(str(files("sprung.campaign") / SCHEMA_FILE)).write_text(campaign_schema(), encoding="utf-8")
    assert schema_text() == campaign_schema(), "write it anew: pytest tests/campaign/test_published.py --regenerate"


def test_it_is_a_schema() -> None:
    Draft202012Validator.check_schema(json.loads(schema_text()))


def nodes(node: Any) -> list[dict[str, Any]]:
    inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return [*([node] if isinstance(node, dict) else []), *(found for one in inner for found in nodes(one))]


def test_every_key_is_described() -> None:
    schema = json.loads(schema_text())
    for section in (schema, *schema["$defs"].values(), schema["$defs"]["Measured"]["anyOf"][1]):
        for key, node in section.get("properties", {}).items():
            assert node["description"].endswith("."), key
    assert not any("null" in (node.get("type"), *node.get("enum", ())) for node in nodes(schema))  # TOML has none


def test_every_key_has_an_example_that_holds_to_it() -> None:
    schema = json.loads(campaign_schema(VehicleFileSchema))  # which has all of them
    assert list(without_example(schema)) == []
    for model, own in KEYS.items():
        entry = schema["$defs"][model] if model else schema
        for key in own:
            node = next(one[key] for one in (part.get("properties", {}) for part in nodes(entry)) if key in one)
            for example in node["examples"]:
                found = Draft202012Validator(node | {"$defs": schema["$defs"]}).iter_errors(example)
                assert [fault.message for fault in found] == [], key


@pytest.mark.parametrize("path", sorted(DATA.glob("*/campaign.toml")), ids=lambda path: path.parent.name)
def test_the_examples_here_hold_to_it(path: Path) -> None:
    assert faults_of(tomllib.loads(path.read_text(encoding="utf-8"))) == []


@pytest.mark.shared
def test_the_contract_holds_to_it(shared: Path) -> None:
    text = (shared / "campaign.toml").read_text(encoding="utf-8")
    assert faults_of(tomllib.loads(text)) == []
    named = {line.lstrip("# ").partition("=")[0].strip() for line in text.splitlines() if "=" in line}
    for key in ("cg_height", "tracks", "extras", "forbid", "direction", "start", "end"):
        assert key in named  # what the contract only mentions is in the schema all the same
        assert any(key in node.get("properties", {}) for node in nodes(json.loads(schema_text())))


def test_what_is_written_holds_to_it_and_names_it(tmp_path: Path) -> None:
    campaign = sprung.study.demo_campaign()
    path = sprung.write(campaign, tmp_path)
    text = path.read_text(encoding="utf-8")
    assert text.startswith(SCHEMA_LINE)
    assert faults_of(tomllib.loads(text)) == []
    beside = path.parent / SCHEMA_LINE.partition(" ")[2].strip()
    assert beside.read_text(encoding="utf-8") == schema_text()


BODY = 'channel = "body_fl"\non = "body"\nposition = [0.1, 0.7, 0.5]'
WRONG = {
    "unknown section": ("[known]", "[knwon]"),
    "newer schema": ("schema = 1", "schema = 2"),
    "misspelt quantity": ("[known]", "[known]\ntotal_mas = 5"),
    "quantity in text": ("[known]", '[known]\ntotal_mass = "5"'),
    "negative uncertainty": ("[known]", "[known]\ntotal_mass = { value = 5, std = -1 }"),
    "uncertainty alone": ("[known]", "[known]\ntotal_mass = { std = 1 }"),
    "unknown extra": ("[known]", '[model]\nextras = ["turbo"]'),
    "half a vector": ("[0.1, 0.7, 0.5]", "[0.1, 0.7]"),
    "body sensor nowhere": ("position = [0.1, 0.7, 0.5]", ""),
    "sensor on nothing": ('on = "body"', 'on = "bonnet"'),
    "sideways": (BODY, f'{BODY}\ndirection = "left"'),
    "no range": (BODY, f"{BODY}\nrange = 0"),
    "load of nothing": ("items = [{ mass = 140, position = [-1, 0, 0.5] }]", ""),
    "load of no items": ("items = [{ mass = 140, position = [-1, 0, 0.5] }]", "items = []"),
    "load said twice": ('name = "ballast"', 'name = "ballast"\nadded = { mass = 140 }'),
    "empty that is not": ('name = "ballast"', 'name = "empty"'),
    "item of no mass": ("mass = 140", "mass = 0"),
    "item in two places": ("mass = 140", 'on = "fl", mass = 140'),
    "item nowhere": (", position = [-1, 0, 0.5]", ""),
    "drop without a recording": ('file = "one.csv"', ""),
    "drop of a fifth wheel": ('file = "one.csv"', 'file = "one.csv"\nwheels = ["spare"]'),
    "drop of no wheel": ('file = "one.csv"', 'file = "one.csv"\nwheels = []'),
    "wheel dropped twice": ('file = "one.csv"', 'file = "one.csv"\nwheels = ["fl", "fl"]'),
    "height below the ground": ('file = "one.csv"', 'file = "one.csv"\nheight = -0.05'),
}
RIGHT = {
    "as it is": ("", ""),
    "number with its uncertainty": ("[known]", "[known]\ntotal_mass = { value = 1500, std = 1 }"),
    "exact number": ("[known]", "[known]\nt_f = 1"),
    "extras": ("[known]", '[model]\nextras = ["anti-roll", "rebound"]\nforbid = ["friction"]\ntracks = "shared"'),
    "totals": ("items = [{ mass = 140, position = [-1, 0, 0.5] }]", "added = { mass = 140, I_xx = 3 }"),
    "item on a wheel": ("position = [-1, 0, 0.5]", 'on = "rr"'),
    "unit spelt otherwise": (BODY, f'{BODY}\nunit = "m/s²"'),
    "named empty": ("[[load]]", '[[load]]\nname = "empty"\n[[load]]'),
    "start and end": ('file = "one.csv"', 'file = "one.csv"\nstart = 0.01\nend = 0.15'),
}


Sound = Callable[..., Path]
"""The fixture that gives a sound campaign folder with some texts replaced."""


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_read_holds_to_it(folder: Sound, name: str) -> None:
    path = folder(RIGHT[name]) / "campaign.toml"
    sprung.read(path)
    assert faults_of(tomllib.loads(path.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize("name", WRONG)
def test_what_is_refused_does_not(folder: Sound, name: str) -> None:
    path = folder(WRONG[name]) / "campaign.toml"
    with pytest.raises(InputError):
        sprung.read(path)
    assert faults_of(tomllib.loads(path.read_text(encoding="utf-8"))) != []


@pytest.mark.parametrize("section", ["vehicle", "model", "sensor", "load", "drop"])
def test_keys_of_no_meaning_are_marked(folder: Sound, section: str) -> None:
    document: dict[str, Any] = tomllib.loads((folder() / "campaign.toml").read_text(encoding="utf-8"))
    entry = document.setdefault(section, {})
    (entry[0] if isinstance(entry, list) else entry)["colour"] = "red"
    assert any("colour" in fault for fault in faults_of(document))
