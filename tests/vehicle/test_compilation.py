"""Compiled loops are kept for other runs, as long as nothing that they are made of has changed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import sprung.vehicle.compilation
from sprung.vehicle.compilation import RECORDS, SOURCES, compiled

FOLDER = Path(sprung.vehicle.compilation.__file__).parent


def test_loops_are_compiled_where_nothing_can_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a container that can only be read."""
    options: list[bool] = []

    def compile_function(function: object, cache: bool = False, **_: object) -> object:
        options.append(cache)
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return function

    def some() -> None:
        pass

    monkeypatch.setattr("sprung.vehicle.compilation.njit", compile_function)
    assert compiled(some) is some
    assert options == [True, False]


def test_what_is_kept_is_named_after_all_that_it_is_made_of() -> None:
    """A constant that is imported counts as much as the loop itself, and so do the records that it takes."""
    loops = sorted(path.stem for path in FOLDER.glob("compiled_*.py"))
    imported = {
        name
        for loop in loops
        for name in re.findall(r"from sprung\.vehicle\.(\w+) import", (FOLDER / f"{loop}.py").read_text())
    }
    assert imported | set(loops) == {*SOURCES, *RECORDS, "compilation"}


def test_another_content_has_another_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    names = []
    for content in ("a = 1", "a = 2"):
        for source in (*SOURCES, *RECORDS):
            (tmp_path / f"{source}.py").write_text(content)
        monkeypatch.setattr("sprung.vehicle.compilation.__file__", str(tmp_path / "compilation.py"))
        sprung.vehicle.compilation._digest.cache_clear()
        names.append(sprung.vehicle.compilation._digest())
    monkeypatch.undo()
    sprung.vehicle.compilation._digest.cache_clear()
    assert len({*names, sprung.vehicle.compilation._digest()}) == 3
