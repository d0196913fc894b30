"""What README and the page of evidence say in figures is what the studies and the benchmarks have measured."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = {"README": ROOT / "README.md", "evidence": ROOT / "docs" / "evidence.md"}


def said(page: str) -> str:
    """A page in one line, without links."""
    return " ".join(re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", PAGES[page].read_text(encoding="utf-8")).split())


def measured(name: str) -> Any:
    return json.loads((ROOT / "docs" / "studies" / f"{name}.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("page", PAGES)
def test_errors_and_intervals(page: str) -> None:
    rows = measured("at-the-bound")["headline"]
    covered = [row["coverage_percent"] for row in rows]
    assert f"{min(covered):.1f} to {max(covered):.1f} % of the 95 % intervals" in said(page)
    coloured = measured("coloured")["cases"]
    assert f"up to {max(row['rmse_over_bound'] for row in coloured):.1f} times" in said(page)
    assert f"{min(row['coverage_percent'] for row in coloured):.1f} % of the intervals" in said(page)
    if page == "README":
        errors = [row["rmse_over_bound"] for row in rows]
        assert f"{sum(row['campaigns'] for row in rows):,}".replace(",", " ") + " simulated campaigns" in said(page)
        assert f"{min(errors):.2f} to {max(errors):.2f} times the bound" in said(page)


@pytest.mark.parametrize("page", PAGES)
def test_loggers(page: str) -> None:
    one_rate, _, unlike = measured("loggers")["kinds"]
    text = said(page)
    assert f"{one_rate['rmse_over_bound']:.2f} times" in text
    assert f"{one_rate['worst_rmse_over_bound']:.2f} times" in text
    assert f"{unlike['rmse_over_bound']:.2f}" in text
    assert f"{unlike['worst_rmse_over_bound']:.2f} times" in text
    assert f"{unlike['coverage_percent']:.0f} % of the 95 % intervals" in text
    assert "too small" in text


@pytest.mark.parametrize("page", PAGES)
def test_times(page: str) -> None:
    benchmarks = {
        one["name"]: one for one in json.loads((ROOT / "benchmarks" / "result.json").read_text())["benchmarks"]
    }
    seconds = benchmarks["test_beside_others"]["extra_info"]["seconds"]
    assert f"{seconds['identify']:.2f} s" in said(page)
    friction = benchmarks["test_with_friction_beside_a_general_solver"]["extra_info"]["seconds"]["with friction"]
    assert f"{friction:.1f} s" in said(page)
    assert "a fraction of a second" not in said(page)


@pytest.mark.parametrize("page", PAGES)
def test_counts(page: str) -> None:
    faults = measured("faults")["faults"]
    noticed, tried = (sum(one[key] for one in faults) for key in ("noticed", "campaigns"))
    assert str(noticed) in said(page)
    assert str(tried) in said(page)
    assert "100 of 100" in said(page)  # docs/studies/friction.md, row "friction"
    engines = measured("engine")["campaigns"]
    right = sum({*one["model"]} == {"engine", *one["kind"].split()} & {"engine", "friction"} for one in engines)
    assert f"{right} of {len(engines)}" in said(page)  # docs/studies/engine.md, column "correct model"


@pytest.mark.parametrize("page", PAGES)
def test_it_is_said_that_all_recordings_are_simulated(page: str) -> None:
    assert re.search(r"All recordings of whole vehicles so far are simulated", said(page))
