"""The test record in a campaign file: date, operator, place, remarks, and the vehicle's identification."""

from __future__ import annotations

import datetime as dt
import tomllib
from dataclasses import asdict
from pathlib import Path

import pytest

import sprung
from sprung.campaign import SCHEMA_FILE
from sprung.errors import InputError
from sprung.vehicle import TABLE_1_CAR

WRITTEN = """\
[test]
date = 2026-11-22
operator = "A. Müller"
place = "Hall 3"
remarks = "tyres 2.4 bar, half a tank"

"""


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sprung.write(sprung.simulate(TABLE_1_CAR, seed=1), tmp_path_factory.mktemp("plain"))


def with_record(plain: Path, text: str = WRITTEN) -> Path:
    """Add a test record to a campaign file, beside the recordings of the plain one."""
    path = plain.with_name("recorded.toml")
    lines = plain.read_text(encoding="utf-8").replace("[vehicle]\n", '[vehicle]\nidentification = "WDB 123"\n')
    path.write_text(lines.replace("[vehicle]", f"{text}[vehicle]", 1), encoding="utf-8")
    return path


def test_it_is_read_and_written_back(plain: Path, tmp_path: Path) -> None:
    read = sprung.read(with_record(plain))
    assert read.identification == "WDB 123"
    assert asdict(read.test) == {
        "date": dt.date(2026, 11, 22), "operator": "A. Müller", "place": "Hall 3",
        "remarks": "tyres 2.4 bar, half a tank",
    }  # fmt: skip
    written = sprung.write(read, tmp_path)
    again = sprung.read(written)
    assert (again.test, again.identification) == (read.test, read.identification)
    assert tomllib.loads(written.read_text(encoding="utf-8"))["test"]["date"] == dt.date(2026, 11, 22)


def test_nothing_of_it_is_needed(plain: Path) -> None:
    read = sprung.read(plain)
    assert (read.identification, set(asdict(read.test).values())) == (None, {None})
    assert "[test]" not in plain.read_text(encoding="utf-8")


def test_a_date_that_is_none_is_refused_with_how_to_write_it(plain: Path) -> None:
    with pytest.raises(InputError) as caught:
        sprung.read(with_record(plain, '[test]\ndate = "22.11.2026"\nby = "me"\n\n'))
    said = {problem.where: problem for problem in caught.value.problems}
    assert said["recorded.toml: test.date"].expected == "a date without quotes, year-month-day: 2026-11-22"
    assert "a key that sprung knows" in said["recorded.toml: test.by"].expected


def test_editors_know_the_keys(plain: Path) -> None:
    assert '"operator"' in plain.with_name(SCHEMA_FILE).read_text(encoding="utf-8")
