"""Tables of any shape at any width: every cell whole, every line within the width unless one word alone is longer."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from sprung.report.terminal.columns import Line, arrange, wrap
from sprung.tables import Table

CELLS = st.lists(st.text("abc12.±²試", min_size=0, max_size=12), max_size=5).map(" ".join)


@st.composite
def tables(draw: st.DrawFn) -> Table:
    headers = tuple(f"{draw(CELLS)} h{i}" for i in range(draw(st.integers(1, 7))))
    rows = draw(st.lists(st.tuples(*(CELLS for _ in headers)), max_size=5))
    chosen = st.sets(st.sampled_from(headers))
    heads = draw(st.integers(1, min(2, len(headers))))
    return Table("title", headers, tuple(rows), frozenset(draw(chosen)), tuple(draw(chosen)), heads)


@given(tables(), st.integers(1, 120))
def test_nothing_is_lost_at_any_width(table: Table, width: int) -> None:
    lines = arrange(table, width)
    shown = Counter(word for line in lines for word in line.text.split())
    assert not Counter(word for row in table.rows for cell in row for word in cell.split()) - shown
    if table.rows:
        shared = [
            header for header in table.headers if any(row[table.headers.index(header)].strip() for row in table.rows)
        ]
        text = " ".join(line.text for line in lines)
        assert all(word in text for header in shared[1:] for word in header.split())
    # What is longer than the width is one word, or a number, that has no room.
    widest = max(
        cell_len(part) for row in (table.headers, *table.rows) for cell in row for part in (cell, *cell.split())
    )
    assert all(cell_len(line.text) <= max(width, widest + 4 + sum(map(cell_len, table.headers))) for line in lines)


@given(tables())
@pytest.mark.slow
def test_a_table_that_fits_has_one_line_for_each_row(table: Table) -> None:
    lines = arrange(table, 10_000)
    assert len(lines) == 1 + len(table.rows)
    assert [line.style for line in lines] == ["dim", *[""] * len(table.rows)]


def texts(lines: list[Line]) -> list[str]:
    return [line.text for line in lines]


WORDS = "found in the recordings of all drops but one"
SMALL = Table("t", ("name", "x", "said"), (("a", "1.5", WORDS), ("b", "22.5", "")), frozenset("x"))


def test_text_wraps_and_numbers_do_not() -> None:
    assert texts(arrange(SMALL, 40)) == [
        "name     x  said",
        "a      1.5  found in the recordings of",
        "            all drops but one",
        "b     22.5",
    ]


def test_columns_that_do_not_fit_make_a_block_of_their_own() -> None:
    rows = tuple((f"drop_{i}", f"{i}.123", f"{i}.456", f"{i}.789") for i in range(2))
    table = Table("t", ("drop", "from", "to", "length"), rows, frozenset(("from", "to", "length")), ("length",))
    assert texts(arrange(table, 21)) == [
        "drop     from     to",
        "drop_0  0.123  0.456",
        "drop_1  1.123  1.456",
        "",
        "drop    length",
        "drop_0   0.789",
        "drop_1   1.789",
    ]


def test_rows_become_lists_where_no_column_fits_beside_the_name() -> None:
    table = Table("t", ("file", "reading"), (("a_long_name.csv", "1.2345678"),), frozenset(("reading",)))
    assert texts(arrange(table, 20)) == ["file", "a_long_name.csv", "  reading: 1.2345678"]


@pytest.mark.parametrize("width", [1, 5, 11, 40])
def test_no_word_is_broken(width: int) -> None:
    path = "/a/path/that/is/longer/than/any/terminal/is/wide.csv"
    lines = wrap(f"see {path} for more", width, indent=2)
    assert " ".join(" ".join(lines).split()) == f"see {path} for more"
    assert any(line.strip().endswith(path) for line in lines)


WIDE = Table(
    "t",
    ("name", "of", "aaaaaaaa", "bbbbbbbb", "cccccccc", "dddddddd", "eeeeeeee"),
    (("one", "x", "1", "2", "", "4", "5"), ("one", "y", "1", "2", "", "", "")),
    frozenset(("aaaaaaaa", "bbbbbbbb", "cccccccc", "dddddddd", "eeeeeeee")),
    heads=2,
)


def test_further_blocks_have_the_rows_that_say_anything_there() -> None:
    """Each named by all its heads; the last column does not stand alone where another can stand beside it."""
    assert texts(arrange(WIDE, 30)) == [
        "name  of  aaaaaaaa  bbbbbbbb",
        "one   x          1         2",
        "one   y          1         2",
        "",
        "name  of  cccccccc  dddddddd",
        "one   x                    4",
        "",
        "name  of  eeeeeeee",
        "one   x          5",
    ]
    assert texts(arrange(WIDE, 40))[4:] == [
        "name  of  dddddddd  eeeeeeee",
        "one   x          4         5",
    ]


def test_negative_numbers_of_a_page_have_minus_signs() -> None:
    cells = (("run-2", "-0.14"), ("2026-11-22", "-3 to -1"))
    table = Table("t", ("name", "x"), cells, frozenset("x"))
    assert [cell in table.html() for cell in ("run-2", "−0.14", "2026-11-22", "−3 to −1")] == [True] * 4
