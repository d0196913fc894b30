"""Every example that is printed somewhere runs and says what is printed with it."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
from pathlib import Path

import pytest

import sprung
from documents import blocks_of, indented_code, run_page

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("README.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")))
SLOW = {"README.md", "docs/exports.md", "docs/fleets.md", "docs/tutorial.md"}
MODULES = ["sprung", *(module.name for module in pkgutil.walk_packages(sprung.__path__, "sprung."))]


def examples_of(name: str) -> list[doctest.DocTest]:
    return [test for test in doctest.DocTestFinder().find(importlib.import_module(name)) if test.examples]


@pytest.mark.parametrize("name", [name for name in MODULES if name != "sprung.__main__"])
def test_docstrings(name: str) -> None:
    for test in examples_of(name):
        runner = doctest.DocTestRunner(optionflags=doctest.REPORT_NDIFF)
        found: list[str] = []
        assert runner.run(test, out=found.append).failed == 0, "".join(found)


def test_there_are_examples() -> None:
    for name in ("sprung.analysis.identify", "sprung.units", "sprung.simulation.drops"):
        assert examples_of(name)


@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=pytest.mark.slow) if page in SLOW else page for page in PAGES]
)
def test_pages(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every block of a page runs, in order, in an empty folder; what is shown below it is what it prints."""
    text = (ROOT / page).read_text(encoding="utf-8")
    assert indented_code(text) == []
    monkeypatch.chdir(tmp_path)
    run_page(text)


def test_there_are_pages_that_run_something() -> None:
    running = [name for name in PAGES if any(one.language in ("sh", "python") for one in blocks_of(read(name)))]
    assert {"README.md", "docs/tutorial.md", "docs/results.md"} <= set(running)


def read(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def test_a_page_that_says_something_else_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = "```python\nprint('k_sf', 17000.0)\nprint('more')\nprint('end')\n```\n\n```text\n{}\n```\n"
    run_page(page.format("k_sf 17100.0\n...\nend"))
    for wrong in ("k_sf 18000.0", "k_sr 17000.0", "end\n...\nmore", "k_sf 17000.0\nend"):
        with pytest.raises(AssertionError, match="but what was printed is"):
            run_page(page.format(wrong))
    with pytest.raises(AssertionError, match="nobody knows how to run"):
        run_page("```basic\n10 PRINT\n```\n")
    assert indented_code("Text\n\n    sprung demo\n") == ["    sprung demo"]
