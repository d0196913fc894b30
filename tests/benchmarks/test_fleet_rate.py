"""The rate of a fleet: of the time when all workers run, and with every row counted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fleet_rate import Timed, page, settled_rate, timed, write_campaigns
from sprung.batch import read_rows

ONE = Timed(1, 400, 4.0, 100.0, 110.0, 130.0, 330.0, 200.0)
TWO = Timed(2, 2000, 7.6, 264.0, 300.0, 131.0, 360.0, 201.0)
ROWS = [{"campaign": f"{number}", "status": "done"} for number in range(2000)]


def test_the_rate_leaves_out_the_start_of_the_workers() -> None:
    # Five seconds until the first campaign, then ten in every second.
    assert settled_rate([(0.0, 0), *((5.0 + second, 10 * second) for second in range(11))]) == pytest.approx(10)


def test_the_page_tells_whether_two_workers_are_as_fast_as_required() -> None:
    assert "is 0.950 of twice that of one; 0.9 are required: met." in page(ONE, TWO, ROWS)
    assert "is 0.875 of twice that of one; 0.9 are required: not met." in page(ONE, replace(TWO, rate=7.0), ROWS)


def test_rows_that_are_twice_there_are_told() -> None:
    text = page(ONE, TWO, [*ROWS, {"campaign": "7", "status": "input"}])
    assert "There are 2001 rows of\n2000 campaigns: 2000 done, 1 input." in text


@pytest.mark.long
def test_a_small_fleet_is_timed(tmp_path: Path) -> None:
    campaigns = write_campaigns(tmp_path / "campaigns", 4)
    before = [path.stat().st_mtime_ns for path in campaigns]
    assert [path.stat().st_mtime_ns for path in write_campaigns(tmp_path / "campaigns", 4)] == before
    found = timed(campaigns, tmp_path / "rows", 2)
    assert (found.workers, found.campaigns) == (2, 4)
    assert 0 < found.identification <= found.whole
    assert 30 < found.driver <= found.comparison  # NumPy alone
    assert found.worker > 30
    assert {row["status"] for row in read_rows(tmp_path / "rows", ("status",))} == {"done"}
