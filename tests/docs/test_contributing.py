"""CONTRIBUTING.md agrees with the program: rooms, stages, classes and files that it names."""

from __future__ import annotations

import importlib
import itertools
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")

CLASSES = re.findall(r"^\| `(\w+)` \| (\w+) \| \S.* \|$", TEXT, re.MULTILINE)


def section(heading: str) -> str:
    """Return the text below a heading of the second level."""
    return TEXT.split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]


def layers() -> list[str]:
    """Return the rooms in the order of the import contract, from the top."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    (found,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    return [room for layer in found for room in re.split(r"\s*[|:]\s*", layer)]


def test_the_picture_shows_every_room_in_the_order_of_the_contract() -> None:
    order = layers()
    picture = section("The house in one picture").split("```")[1]
    bands = [
        [room for line in band.splitlines() for room in re.findall(r"[a-z_]+", line[:61]) if room in order]
        for band in re.split(r"-{20,}", picture)
    ]
    assert sorted(room for band in bands for room in band) == sorted(order)
    for upper, lower in itertools.pairwise(bands):
        assert max(map(order.index, upper)) < min(map(order.index, lower))


@pytest.mark.parametrize(("name", "room"), CLASSES)
def test_every_class_to_know_exists_in_its_room(name: str, room: str) -> None:
    folder = ROOT / "src" / "sprung" / room
    sources = [*folder.rglob("*.py")] if folder.is_dir() else [folder.with_suffix(".py")]
    assert any(re.search(rf"^class {name}\b", path.read_text(encoding="utf-8"), re.MULTILINE) for path in sources)


def test_there_are_some_thirty_classes_to_know() -> None:
    assert 25 <= len(CLASSES) <= 35
    assert len({name for name, _ in CLASSES}) == len(CLASSES)


def test_the_stages_are_those_of_the_program() -> None:
    stages = importlib.import_module("sprung.analysis.stages").STAGES
    drawn = re.findall(r"^     ([a-z_]+)", section("`identify`, call by call"), re.MULTILINE)
    assert drawn == [stage.__name__ for stage in stages]


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`((?:src|tests|docs|benchmarks)/[\w./-]+)`", TEXT))))
def test_every_file_that_is_named_exists(path: str) -> None:
    assert (ROOT / path).exists()


RECIPES = re.split(r"^### ", section("How to add"), flags=re.MULTILINE)[1:]


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.partition("\n")[0])
def test_every_name_in_a_recipe_is_in_a_file_that_it_names(recipe: str) -> None:
    prose = re.sub(r"```.*?```", "", recipe, flags=re.DOTALL)
    named = [ROOT / path for path in re.findall(r"`((?:src|tests|docs)/[\w./-]+)`", prose)]
    files = [*(path for path in named if path.is_file()), *(one for path in named for one in path.glob("*.py"))]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    quoted = {
        word for name in re.findall(r"`([\w.]+)(?:\([^`]*\)|\[[^`]*\]|=\w+)?`", prose) for word in name.split(".")
    }
    names = {name for name in quoted if re.search(r"_|[a-z][A-Z]|^[A-Z]", name)}
    assert sorted(name for name in names if not re.search(rf"\b{name}\b", text)) == []
