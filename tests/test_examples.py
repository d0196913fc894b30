"""Every example that is printed somewhere runs and says what is printed with it."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import sprung

README = Path(__file__).resolve().parents[1] / "README.md"
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
    for name in ("sprung.pipeline.identify", "sprung.units", "sprung.simulation.drops"):
        assert examples_of(name)


def test_readme(capsys: pytest.CaptureFixture[str]) -> None:
    blocks = re.findall(r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, str(README), "exec"), {"__name__": "readme"})  # noqa: S102 (our own text)
    # The README's car has springs of 17000 N/m: what it prints must be that, and be accepted.
    printed = re.fullmatch(r"(\d+) ± (\d+) N/m, accept\n", capsys.readouterr().out)
    assert printed is not None
    assert abs(int(printed[1]) - 17000) < 5 * int(printed[2]) < 1000
