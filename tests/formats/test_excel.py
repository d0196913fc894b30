"""Excel workbooks: read like text tables of the same cells, or refused by name with what to do."""

from __future__ import annotations

import datetime as dt
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pytest

import sprung
from command_line import copy_sedan
from sprung.errors import InputError
from sprung.formats import SampleTable, libraries, read_table
from sprung.formats.excel import ExcelFormat
from zip_bomb import write_zip_bomb

openpyxl = pytest.importorskip("openpyxl")

TIME = 2 + np.arange(70) / 500
A, B = np.random.default_rng(3).normal(size=(2, 70))
COLUMNS = list(zip(TIME.tolist(), A.tolist(), B.tolist(), strict=True))
HEAD = ("time [s]", "front [g]", "rear")


def written(path: Path, **sheets: Iterable[Sequence[object]]) -> Path:
    workbook = openpyxl.Workbook()
    workbook.remove(workbook.active)
    for name, rows in sheets.items():
        sheet = workbook.create_sheet(name)
        for row in rows:
            sheet.append(list(row))
    workbook.save(path)
    return path


def read(path: Path) -> SampleTable:
    return read_table(path)


def test_columns_come_back_as_they_were(tmp_path: Path) -> None:
    table = read(written(tmp_path / "x.xlsx", data=[HEAD, *COLUMNS]))
    assert table.channels == ("front", "rear")
    assert table.units == ("g", None)
    # A workbook keeps sixteen digits of a number.
    np.testing.assert_allclose(table.take(), [A, B], rtol=1e-15)
    np.testing.assert_allclose(table.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(table.take([1], 3, 5), [B[3:5]], rtol=1e-15)
    assert table.place(0) == "sheet 'data', row 2"


def test_titles_units_and_gaps_are_understood_as_in_text(tmp_path: Path) -> None:
    rows = [["Prüfstand 3"], ["Operator", "A. Engineer"], [], ["Zeit", "front", "rear"], ["ms", "g", "m/s²"]]
    samples = [[1e3 * t, a, None if i == 5 else b] for i, (t, a, b) in enumerate(COLUMNS)]
    table = read(written(tmp_path / "x.xlsx", data=[*rows, *samples]))
    assert (table.channels, table.units) == (("front", "rear"), ("g", "m/s²"))
    np.testing.assert_allclose(table.time, TIME, rtol=1e-12)
    assert np.flatnonzero(np.isnan(table.take([1])[0])).tolist() == [5]


def test_german_numbers_that_stand_as_text(tmp_path: Path) -> None:
    samples = [[f"{value:.6f}".replace(".", ",") for value in row] for row in COLUMNS]
    table = read(written(tmp_path / "x.xlsx", data=[HEAD, *samples]))
    np.testing.assert_allclose(table.take(), [A, B], atol=1e-6)
    np.testing.assert_allclose(table.time, TIME, atol=1e-6)


def test_dates_with_times(tmp_path: Path) -> None:
    first = dt.datetime(2026, 11, 22, 9, 30)
    samples = [[first + dt.timedelta(milliseconds=2 * i), a, b] for i, (_, a, b) in enumerate(COLUMNS)]
    table = read(written(tmp_path / "x.xlsx", data=[("Date", "front", "rear"), *samples]))
    assert table.channels == ("front", "rear")
    np.testing.assert_allclose(np.diff(table.time), 0.002, atol=1e-6)


def test_a_cover_and_notes_are_no_recordings(tmp_path: Path) -> None:
    table = read(written(tmp_path / "x.xlsm", cover=[["Drop test"], ["tyres", 2.4]], data=[HEAD, *COLUMNS], notes=[]))
    np.testing.assert_allclose(table.take(), [A, B], rtol=1e-15)


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(path)
    (problem,) = caught.value.problems
    assert path.name in problem.where
    return str(problem)


def test_several_recordings_are_named(tmp_path: Path) -> None:
    said = refusal(written(tmp_path / "x.xlsx", one=[HEAD, *COLUMNS], two=[HEAD, *COLUMNS]))
    assert "2 sheets with recordings: 'one', 'two'; expected one. Save each sheet" in said


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([], "a workbook without content"),
        ([HEAD], "a header and no samples"),
        (COLUMNS, "numbers in the first line; expected the names of the columns"),
        ([["front"], *([value] for value in A.tolist())], "a single column, 'front'"),
    ],
)
def test_what_is_no_recording(tmp_path: Path, rows: list[Sequence[object]], words: str) -> None:
    assert words in refusal(written(tmp_path / "x.xlsx", data=rows))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("x.xlsx", b"", "an empty file"),
        (
            "x.xls",
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
            "a workbook of old Excel (.xls), or one with a password",
        ),
        ("x.xlsx", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), "or one with a password"),
        (
            "x.xls",
            b"time\ta\n0\t1\n",
            "text under the name of a workbook (.xls); expected an Excel workbook. Rename it",
        ),
        ("x.ods", b"PK\x03\x04" + bytes(100), "a workbook of another kind (.ods)"),
        ("x.xlsx", b"\x01\x00" * 100, "a file that is no workbook (.xlsx)"),
        ("x.xlsx", b"PK\x03\x04" + bytes(100), "a damaged file"),
    ],
)
def test_other_files_are_refused_by_name(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    assert words in refusal(path)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.9, 0.99])
def test_a_file_that_is_cut_off(tmp_path: Path, share: float) -> None:
    whole = written(tmp_path / "x.xlsx", data=[HEAD, *COLUMNS]).read_bytes()
    (tmp_path / "x.xlsx").write_bytes(whole[: int(share * len(whole))])
    assert "a damaged file" in refusal(tmp_path / "x.xlsx")


def test_without_the_library_it_says_how_to_install_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "x.xlsx", data=[HEAD, *COLUMNS])

    def missing(name: str) -> None:
        raise ImportError(f"No module named '{name}'")

    monkeypatch.setattr(libraries, "import_module", missing)
    assert 'pip install "sprung[excel]"' in refusal(path)


def test_a_campaign_of_workbooks(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / "campaign", ("empty_bounce",))
    plain = sprung.read(folder.path)
    lines = [line.split(",") for line in (folder.path / "empty_bounce.csv").read_text().splitlines()]
    written(folder.path / "empty_bounce.xlsx", data=[lines[0], *([float(cell) for cell in row] for row in lines[1:])])
    folder.edit('"empty_bounce.csv"', '"empty_bounce.xlsx"')
    again = sprung.read(folder.path).recordings[0]
    np.testing.assert_allclose(again.values, plain.recordings[0].values, rtol=1e-15)
    assert again.rate == pytest.approx(plain.recordings[0].rate)


def test_it_is_claimed_by_its_ending(tmp_path: Path) -> None:
    assert ExcelFormat().claims(tmp_path / "A.XLSX", b"")
    assert not ExcelFormat().claims(tmp_path / "a.csv", b"PK\x03\x04")


def test_a_workbook_that_unpacks_to_many_times_its_size_is_refused_at_once(tmp_path: Path) -> None:
    """Without the size of a sheet, openpyxl would build 100 MB of rows in memory first."""
    path = write_zip_bomb(tmp_path / "x.xlsx", 100)
    begun = time.monotonic()
    with pytest.raises(
        InputError, match=r"x\.xlsx: found \d+ bytes that unpack to 1025\d{5}; .*save it as \.xlsx, or better as CSV"
    ):
        read(path)
    assert time.monotonic() - begun < 2
