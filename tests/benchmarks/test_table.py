"""The page of benchmarks says what was measured, and what was missed."""

from __future__ import annotations

import json
from typing import Any

import table


def result_with(**one: float) -> dict[str, Any]:
    return {"benchmarks": [{"extra_info": {"ratios": {"this / that": one}}}]}


def test_the_page_is_made_of_the_result() -> None:
    result = json.loads((table.HERE / "result.json").read_text(encoding="utf-8"))
    assert (table.HERE / "README.md").read_text(encoding="utf-8") == table.page(result)


def test_what_is_not_as_wanted_is_told() -> None:
    assert table.missed(result_with(ratio=99.0, least=100)) == ["this / that: 99.0, required ≥ 100"]
    assert table.missed(result_with(ratio=61.0, most=60)) == ["this / that: 61.0, required ≤ 60"]
    assert table.missed(result_with(ratio=100.0, least=100)) == table.missed(result_with(ratio=3.0)) == []
