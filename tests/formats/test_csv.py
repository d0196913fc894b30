from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sprung.errors import InputError
from sprung.formats import SampleTable, read_table
from sprung.units import split_unit

if TYPE_CHECKING:
    from pathlib import Path

Text = Callable[..., str]


def table_of(folder: Path, content: str | bytes, name: str = "x.csv") -> SampleTable:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_table(path)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=60, deadline=None
)
@given(
    values=st.lists(
        st.lists(st.floats(-1e4, 1e4).map(lambda x: round(x, 5)), min_size=3, max_size=3), min_size=1, max_size=5
    ),
    dialect=st.sampled_from([(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ",")]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "latin-1"]),
    line_end=st.sampled_from(["\n", "\r\n", "\r"]),
    quoted=st.booleans(),
    blank=st.sampled_from(["", "\n", "\n\n  \n", "\n;;;\n"]),
)
def test_the_dialect_changes_no_number(
    tmp_path: Path,
    values: list[list[float]],
    dialect: tuple[str, str],
    encoding: str,
    line_end: str,
    quoted: bool,
    blank: str,
) -> None:
    delimiter, decimal = dialect
    quote = '"' if quoted else ""
    rows = [
        ["Zeit", "Stoß [m/s²]", "a b", "c"],
        *([f"{0.01 * i:.2f}", *map(repr, row)] for i, row in enumerate(values)),
    ]
    lines = [delimiter.join(f"{quote}{cell}{quote}" for cell in row) for row in rows]
    lines[1:] = [line.replace(".", decimal) for line in lines[1:]]
    content = ("\n".join(lines) + blank).replace("\n", line_end).encode(encoding)
    table = table_of(tmp_path, content)
    assert table.channels == ("Stoß", "a b", "c")
    assert table.units == ("m/s²", None, None)
    np.testing.assert_allclose(table.take(), np.array(values).T, rtol=1e-15)
    np.testing.assert_allclose(table.time, 0.01 * np.arange(len(values)), rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("body_fl [g]", ("body_fl", "g")),
        ("body_fl[ m/s^2 ]", ("body_fl", "m/s^2")),
        ("body_fl (m/s^2)", ("body_fl", "m/s^2")),
        ("body (left)", ("body (left)", None)),
        ("volts [V]", ("volts", "V")),
        (" body_fl ", ("body_fl", None)),
        ("[g]", ("[g]", None)),
    ],
)
def test_units_in_names(text: str, expected: tuple[str, str | None]) -> None:
    assert split_unit(text) == expected


@pytest.mark.parametrize(
    ("name", "factor"), [("time", 1), ("T [s]", 1), ("ZEIT (ms)", 1e-3), ("time [µs]", 1e-6), ("stamp", 1)]
)
def test_the_time_column_by_name_or_by_being_first_and_increasing(
    tmp_path: Path, text: Text, name: str, factor: float
) -> None:
    table = table_of(tmp_path, text(f"{name},a,b,c"))
    np.testing.assert_allclose(table.time, factor * 0.002 * np.arange(100), rtol=1e-12)


def test_the_time_column_need_not_be_first(tmp_path: Path) -> None:
    table = table_of(tmp_path, "a,b,time\n1,2,0.5\n3,4,0.6\n")
    assert table.channels == ("a", "b")
    np.testing.assert_array_equal(table.take(), [[1, 3], [2, 4]])
    np.testing.assert_array_equal(table.time, [0.5, 0.6])


def test_names_may_hold_other_delimiters(tmp_path: Path) -> None:
    table = table_of(tmp_path, 'time,"a;b;c","d, e"\n0,1,2\n1,3,4\n')
    assert table.channels == ("a;b;c", "d, e")


def test_a_last_line_cut_short_is_left_out_and_noted(tmp_path: Path) -> None:
    table = table_of(tmp_path, "time,a,b\n0,1,2\n1,3,4\n2,5")
    assert table.take().shape == (2, 2)
    assert table.notes == ("line 4, the last, is cut short and was left out",)


def test_blank_lines_keep_the_line_numbers(tmp_path: Path) -> None:
    table = table_of(tmp_path, "\ntime,a,b\n0,1,2\n\n1,3,4\n")
    assert table.place(0) == "line 3"
    assert table.place(1) == "line 5"


def test_text_among_numbers_is_noted_per_channel_and_named_by_line(tmp_path: Path, text: Text) -> None:
    content = text("time,a,b,c").replace("0.0100,9,11.5", "0.0100,OVLD,11.5").replace("0.0120,10", "0.0120,OVLD")
    table = table_of(tmp_path, content)
    assert [table.find_non_number(column) is not None for column in range(3)] == [True, False, False]
    assert str(table.find_non_number(0)).startswith(
        "x.csv: line 7, column 'a': found 'OVLD' (the first of 2 such cells); expected a number."
    )
    assert np.isfinite(table.take([1, 2])).all()


REFUSED: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "x.csv: found an empty file"),
    "blank": ("\n \n", "x.csv: found an empty file"),
    "header only": ("time,a,b\n", "x.csv: found a header and no samples"),
    "one column": ("time/a\n1/2\n", "line 1: found a single column, 'time/a'"),
    "no header": ("0,1,2\n1,2,3\n", "line 1: found numbers in the first line; expected the names of the columns"),
    "too many cells": ("time,a\n0,1\n1,2,3\n", "x.csv: line 3: found 3 cells; expected 2, as many as the header"),
    "decimal comma": ("time,a\n0,5,1,5\n", "found 4 cells; expected 2"),
    "no time": ("x,a\n1,2\n0,3\n", "no column named time among 'x', 'a'"),
    "unit of time": ("time [h],a\n0,1\n1,2\n", "column 'time [h]': found 'h'; expected a unit of time"),
    "text as time": ("time,a\nnoon,1\n1,2\n", "line 2, column 'time': found 'noon'; expected a number"),
    "no time in a line": ("time,a\n0,1\n,2\n2,3\n", "x.csv: line 3, column 'time'"),
    "open quotation": ('time,a\n0,1\n1,"2\n2,3\n', "quotation mark that is not closed"),
    "binary": (b"\0\1\2", "a file of no known format; expected exactly one of the known formats: csv"),
}


@pytest.mark.parametrize(("content", "words"), REFUSED.values(), ids=REFUSED)
def test_a_file_that_is_no_table_is_refused_with_its_reason(tmp_path: Path, content: str | bytes, words: str) -> None:
    with pytest.raises(InputError) as error:
        table_of(tmp_path, content)
    assert words in str(error.value)


def test_what_stands_in_a_file_does_not_steer_the_terminal(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text("time,a\n0,1\n1,\x1b[2J\n2,1\xa0000\n", encoding="utf-8")
    said = str(read_table(path).find_non_number(0))
    assert r"found '\x1b[2J'" in said
    assert said.isprintable()
