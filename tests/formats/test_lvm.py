from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spoiling import Spoiling, read_or_refused, spoilings
from sprung.campaign.signals import make_recording
from sprung.errors import InputError
from sprung.formats import lvm_segments, read_table, text_samples
from sprung.formats.csv import CsvFormat
from sprung.formats.lvm import LvmFormat
from sprung.formats.text_blocks import read_blocks
from sprung.vehicle import Sensor

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats import SampleTable

VALUES = np.round(np.random.default_rng(3).normal(size=(3, 40)), 4)
NAMES = ("left", "right", "rear")


def header(separator: str = "\t", decimal: str = ".", columns: str = "One", several: str = "Yes") -> list[str]:
    """Return the header of a file."""
    word = {"\t": "Tab", ",": "Comma"}.get(separator, separator)
    lines = ["LabVIEW Measurement,", "Writer_Version,2", f"Separator,{word}", "Multi_Headings," + several]
    lines += ["X_Columns," + columns, "Time_Pref,Relative", "Operator,somebody"]
    lines = [line.replace(",", separator, 1) for line in lines]
    return [*lines, f"Decimal_Separator{separator}{decimal}", f"***End_of_Header***{separator}", separator]


def segment(
    values: Sequence[NDArray[np.float64]] | NDArray[np.float64],
    separator: str = "\t",
    decimal: str = ".",
    columns: str = "One",
    names: Sequence[str] = NAMES,
    step: float = 0.002,
    text_step: str = "",
    x0: float = 0.0,
    x: float | None = None,
    times: Sequence[str] = (),
    comment: str = "",
    **fields: str | Sequence[str] | None,
) -> list[str]:
    """Return a segment with its header; `x` is the first number under X_Value where it is not X0."""

    def mark(number: float | str) -> str:
        return (number if isinstance(number, str) else f"{number:.6f}").replace(".", decimal)

    count, gap = len(values), [""] if columns == "Multi" else []
    stated: dict[str, Any] = {"Samples": [str(len(own)) for own in values], "Date": "2026/11/20"}
    stated |= {"Time": [mark(time) for time in times] or mark("09:30:00.25"), "Y_Unit_Label": "m/s²"}
    stated |= {"X_Dimension": "Time", "X0": mark(f"{x0:.16E}"), "Delta_X": mark(text_step or step), **fields}
    lines = [separator.join(["Channels", str(count)])]
    for tag, own in stated.items():
        cells = [own] * count if isinstance(own, str) else own
        if cells:
            lines.append(separator.join([tag, *(part for cell in cells for part in [cell, *gap])]))
    lines.append("***End_of_Header***")
    titles = [title for name in names for title in ["X_Value", name]] if gap else ["X_Value", *names]
    lines.append(separator.join([*titles, "Comment"]))
    for row in range(max(map(len, values))):
        instant = mark((x0 if x is None else x) + row * step)
        cells = [mark(own[row]) if row < len(own) else "" for own in values]
        axis = [instant if own else "" for own in cells] if gap else [instant if columns == "One" else ""]
        data = [cell for pair in zip(axis, cells, strict=True) for cell in pair] if gap else [*axis, *cells]
        lines.append(separator.join([*data, comment] if comment and not row else data))
    return [*lines, ""]


def written(folder: Path, *parts: Sequence[str], encoding: str = "cp1252", name: str = "x.lvm") -> Path:
    path = folder / name
    path.write_text("\r\n".join(line for part in parts for line in part), encoding=encoding, newline="")
    return path


def read(path: Path) -> SampleTable:
    assert LvmFormat().claims(path, path.read_bytes()[:8192])
    return read_table(path)


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
@pytest.mark.parametrize(("separator", "decimal"), [("\t", "."), ("\t", ","), (",", "."), (";", ",")])
@pytest.mark.parametrize("name", ["x.lvm", "x.txt"])
def test_every_way_to_write_a_segment(tmp_path: Path, columns: str, separator: str, decimal: str, name: str) -> None:
    one = segment(VALUES, separator, decimal, columns, comment="first: a 'drop', 2 mm")
    table = read(written(tmp_path, header(separator, decimal, columns), one, name=name))
    assert table.channels == NAMES
    assert table.units == ("m/s²",) * 3
    assert table.clock == 500.0
    assert table.notes == ()
    np.testing.assert_array_equal(table.take(), VALUES)


@pytest.mark.parametrize("encoding", ["cp1252", "latin-1", "utf-8", "utf-8-sig", "utf-16"])
def test_units_and_names_in_any_letters(tmp_path: Path, encoding: str) -> None:
    one = segment(VALUES, names=("Stoß", "b [g]", "c"), Y_Unit_Label=("µm", "", "°"))
    table = read(written(tmp_path, header(), one, encoding=encoding))
    assert table.channels == ("Stoß", "b", "c")
    assert table.units == ("µm", "g", "°")


def test_codes_within_names_and_units(tmp_path: Path) -> None:
    names = ("a\\2C left", "b\\\\c", "d\\09e")
    table = read(written(tmp_path, header(","), segment(VALUES, ",", names=names, Y_Unit_Label="g")))
    assert table.channels == ("a, left", "b\\c", "d e")


def test_a_name_that_the_separator_divides_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, header(","), segment(VALUES, ",", names=("a, left", "b", "c")))
    with pytest.raises(InputError, match=r"line 20: found 4 names for '3' channels.*separator within a name"):
        read(path)


def test_a_decimal_mark_other_than_the_header_states(tmp_path: Path) -> None:
    table = read(written(tmp_path, header(decimal=","), segment(VALUES, decimal=".")))
    np.testing.assert_array_equal(table.take(), VALUES)


def test_the_rate_that_six_decimals_of_the_step_mean(tmp_path: Path) -> None:
    values = np.zeros((1, 4096))
    for columns in ("One", "Multi"):
        one = segment(values, columns=columns, step=1 / 2048, text_step="0.000488", names=["a"])
        assert read(written(tmp_path, header(), one)).clock == 2048.0
    table = read(written(tmp_path, header(), segment(values, columns="No", text_step="0.000488", names=["a"])))
    assert table.clock == pytest.approx(2048, rel=1.1e-3)
    assert table.notes == ("without numbers under X_Value the rate is known to 0.1 %, as Delta_X is rounded",)


def test_the_time_begins_with_x0(tmp_path: Path) -> None:
    for columns in ("No", "One", "Multi"):
        table = read(written(tmp_path, header(), segment(VALUES, columns=columns, x0=0.5)))
        np.testing.assert_allclose(table.time, 0.5 + np.arange(40) / 500, rtol=1e-12)


def test_times_in_other_units_and_since_1904(tmp_path: Path) -> None:
    one = segment(VALUES, step=2.0, X_Unit_Label="ms")
    assert read(written(tmp_path, header(), one)).clock == 500.0
    one = segment(VALUES, x0=3871000000.0, times=("09:30:00.25",) * 3)
    table = read(written(tmp_path, header(), one))
    np.testing.assert_allclose(table.time, np.arange(40) / 500, atol=1e-6)


def test_uneven_times(tmp_path: Path) -> None:
    one = segment(VALUES)
    rows = one.index("***End_of_Header***") + 2
    uneven = np.cumsum(np.arange(1.0, 41.0)) / 64
    for row, time in enumerate(uneven, rows):
        one[row] = "\t".join([f"{time:.6f}", *one[row].split("\t")[1:]])
    table = read(written(tmp_path, header(), one))
    np.testing.assert_allclose(table.clock, uneven, atol=1e-6)


def test_channels_that_a_converter_reads_one_after_another(tmp_path: Path) -> None:
    # A sine of 20 Hz; every channel is sampled a quarter of a step after the one before.
    late = np.array([[0.0], [0.0005], [0.001]])
    time = np.arange(200) / 500
    times = [f"23:59:59.{9990 + 5 * number:04}" for number in range(2)] + ["00:00:00.0000000"]
    one = segment(np.sin(40 * np.pi * (time + late)), times=times, Date=["2026/11/20", "2026/11/20", "2026/11/21"])
    for columns in ("No", "One", "Multi"):
        table = read(written(tmp_path, header(columns=columns), one))
        assert table.clock == 500.0
        assert table.notes == ("on another clock, interpolated to the times of the others: right, rear",)
        found = table.take()
        assert np.isnan(found).sum(axis=1).tolist() == [0, 1, 1]
        np.testing.assert_allclose(found[:, 3:-3], np.sin(40 * np.pi * np.tile(time, (3, 1)))[:, 3:-3], atol=2e-5)
        recording = make_recording(
            table, [Sensor(channel=name, on="body", position=(0, 0, 0)) for name in NAMES], "x.lvm"
        )
        assert np.isfinite(recording.values).all()


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
def test_columns_of_unequal_length(tmp_path: Path, columns: str) -> None:
    table = read(written(tmp_path, header(), segment([VALUES[0], VALUES[1][:30], VALUES[2]], columns=columns)))
    assert table.notes == ("on another clock, interpolated to the times of the others: right",)
    assert table.channels == ("left", "rear", "right")
    assert np.isnan(table.take([2])[0, 30:]).all()
    np.testing.assert_array_equal(table.take([0, 1]), VALUES[[0, 2]])
    np.testing.assert_allclose(table.take([2])[0, :30], VALUES[1][:30], atol=1e-12)


def halves(columns: str, second: dict[str, Any], again: Sequence[str] = ()) -> list[list[str]]:
    one, two = (segment(part, columns=columns, **own) for part, own in ((VALUES[:, :24], {}), (VALUES[:, 24:], second)))
    return [header(), one, list(again), two]


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
@pytest.mark.parametrize(
    "second",
    [
        {"x0": 0.048},
        {"times": ["09:30:00.298"] * 3},
        {"times": ["09:30:00.28"] * 3, "x0": 0.018},
        {"Time": None, "x0": 0.048},
    ],
)
def test_segments_that_follow_on_one_another_are_one_recording(
    tmp_path: Path, columns: str, second: dict[str, Any]
) -> None:
    for again in ((), header(), ["***Start_Special***", "Binary_Data", "\x01\x02", "1\t2\t3", "***End_Special***", ""]):
        table = read(written(tmp_path, *halves(columns, second, again)))
        assert table.clock == 500.0
        np.testing.assert_array_equal(table.take(), VALUES)


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
def test_many_short_segments_of_a_rounded_step(tmp_path: Path, columns: str) -> None:
    make = partial(segment, columns=columns, step=1 / 2048, text_step="0.000488")
    starts = [f"09:30:{0.25 + first / 2048:.9f}" for first in range(0, 40, 4)]
    parts = [make(VALUES[:, 4 * i : 4 * i + 4], times=[start] * 3) for i, start in enumerate(starts)]
    table = read(written(tmp_path, header(), *parts))
    assert table.clock == pytest.approx(2048, rel=1e-4)
    np.testing.assert_array_equal(table.take(), VALUES)


def test_segments_of_columns_of_unequal_length(tmp_path: Path) -> None:
    # The second channel has half the rate.
    slow = VALUES[1][:20]
    fields = {"Delta_X": ["0.002000", "0.004000", "0.002000"], "columns": "No"}
    one = segment([VALUES[0][:24], slow[:12], VALUES[2][:24]], **fields)  # type: ignore[arg-type]
    two = segment([VALUES[0][24:], slow[12:], VALUES[2][24:]], x0=0.048, **fields)  # type: ignore[arg-type]
    table = read(written(tmp_path, header(), one, two))
    assert table.channels == ("left", "rear", "right")
    np.testing.assert_allclose(table.take([2])[0, :39:2], slow, atol=1e-12)
    np.testing.assert_array_equal(table.take([0, 1]), VALUES[[0, 2]])


@pytest.mark.parametrize(
    "second", [{}, {"x0": 1.0}, {"times": ["09:31:00.0"] * 3}, {"times": ["09:30:00.25"] * 3}, {"Time": None}]
)
def test_segments_that_do_not_follow_are_refused(tmp_path: Path, second: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"line 46: found a segment that begins .* 24 samples; expected segments that"):
        read(written(tmp_path, *halves("One", second)))


def test_segments_of_several_devices_are_read_side_by_side(tmp_path: Path) -> None:
    two = segment(VALUES[:1], names=["other"], times=["09:30:00.25"])
    table = read(written(tmp_path, header(), segment(VALUES), two))
    assert table.channels == (*NAMES, "other")
    np.testing.assert_array_equal(table.take(), VALUES[[0, 1, 2, 0]])


def test_rows_added_below_one_header(tmp_path: Path) -> None:
    first, later = segment(VALUES[:, :24]), segment(VALUES[:, 24:], x=0.048, comment="later")
    rows = later[later.index("***End_of_Header***") + 2 :]
    table = read(written(tmp_path, header(several="No"), first[:-1], rows))
    assert table.clock == 500.0
    np.testing.assert_array_equal(table.take(), VALUES)
    blank = ["\t".join(["", *row.split("\t")[1:]]) for row in first[-25:-1] + rows[:-1]]
    table = read(written(tmp_path, header(several="No"), first[:-25], blank))
    assert table.notes == ("samples written later below the header in line 11 were taken to follow at once",)
    np.testing.assert_array_equal(table.take(), VALUES)
    again = segment(VALUES[:, 24:])
    with pytest.raises(InputError, match=r"line 45: found an X_Value that goes back"):
        read(written(tmp_path, header(several="No"), first[:-1], again[again.index("***End_of_Header***") + 2 :]))


def test_what_is_not_over_time_is_left_out(tmp_path: Path) -> None:
    table = read(written(tmp_path, header(), segment(VALUES, X_Dimension=["Time", "Frequency", "Time"])))
    assert table.channels == ("left", "rear")
    assert table.notes == ("left out, as they are not over time: right",)
    with pytest.raises(InputError, match="no channel with samples over time"):
        read(written(tmp_path, header(), segment(VALUES, X_Unit_Label="Hz")))


def test_a_channel_without_samples_is_left_out(tmp_path: Path) -> None:
    table = read(written(tmp_path, header(), segment([VALUES[0], VALUES[1][:0], VALUES[2]])))
    assert table.channels == ("left", "rear")


def test_equal_names(tmp_path: Path) -> None:
    assert read(written(tmp_path, header(), segment(VALUES, names=("a", "", "a")))).channels == (
        "a 1",
        "channel 2",
        "a 3",
    )


def test_text_among_the_samples(tmp_path: Path) -> None:
    one = segment(VALUES)
    one[-5] = one[-5].rpartition("\t")[0] + "\tbroken"
    table = read(written(tmp_path, header(), one))
    assert table.find_non_number(0) is None
    assert "x.lvm: line 57, column 'rear': found 'broken'" in str(table.find_non_number(2))


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda text: text[: text.index("***End")], "a header that begins in line 1, without"),
        (lambda text: text[: text.rindex("***End")], "a header that begins in line 11, without"),
        (lambda text: text[: text.index("X_Value")], "without samples below it"),
        (lambda text: text[: len(text) * 2 // 3], "line 11: found a segment with .. of 40 samples.*cut short"),
        (lambda text: text.replace("X_Value", "Zeit"), "line 20: found 'Zeit'; expected the names of the columns"),
        (lambda text: text.replace("Separator\tTab", "Separator|Pipe"), "expected the names of the columns"),
        (lambda text: text.replace("Decimal_Separator\t.", "Decimal_Separator\t;"), "the decimal separator ';'"),
        (lambda text: text.replace("\t", "!"), "the separator '!'"),
        (lambda text: text.replace("Channels\t3", "Channels\t4"), "3 names for '4' channels"),
        (lambda text: text.replace("Channels\t3", "***Start_Special***"), "a special block without"),
        (lambda text: text.replace("\n0.0", "\n\t").replace("Delta_X", "Delta"), "a positive Delta_X"),
    ],
)
def test_what_is_no_whole_file_is_refused(tmp_path: Path, spoil: Any, message: str) -> None:
    path = written(tmp_path, header(), segment(VALUES))
    path.write_bytes(spoil(path.read_bytes().decode("cp1252")).encode("cp1252"))
    with pytest.raises(InputError, match=message) as caught:
        read(path)
    assert all(problem.where.startswith("x.lvm") and problem.do.endswith(".") for problem in caught.value.problems)


def test_without_headers_it_is_a_text_table(tmp_path: Path) -> None:
    path = tmp_path / "x.lvm"
    path.write_text("time\ta\n0.000\t1\n0.002\t2\n")
    assert CsvFormat().claims(path, path.read_bytes())
    assert read_table(path).channels == ("a",)
    path.write_text("0.000\t1\n0.002\t2\n")
    with pytest.raises(InputError, match="Add a line with the names of the columns"):
        read_table(path)


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
def test_a_file_in_many_blocks_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, columns: str) -> None:
    special = ["***Start_Special***", "Packet_Notes\tany", "***End_Special***"]
    one = segment(VALUES[:, :24], columns=columns, comment="9, 9")
    path = written(tmp_path, header(), one, special, segment(VALUES[:, 24:], columns=columns, x0=0.048, x=0.048))
    whole = read(path)
    monkeypatch.setattr(text_samples, "_SMALL", 0)
    for module in (lvm_segments, text_samples):
        monkeypatch.setattr(module, "read_blocks", partial(read_blocks, size=100))
    table = read(path)
    np.testing.assert_array_equal(table.take(), whole.take())
    np.testing.assert_array_equal(table.take([2, 0], 20, 31), whole.take()[[2, 0], 20:31])
    np.testing.assert_array_equal(table.time, whole.time)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=60, deadline=None
)
@given(columns=st.sampled_from(["No", "One", "Multi"]), spoiling=spoilings())
def test_whatever_happens_to_a_file(tmp_path: Path, columns: str, spoiling: Spoiling) -> None:
    path = written(tmp_path, *halves(columns, {"x0": 0.048}))
    path.write_bytes(spoiling.of(path.read_bytes()))
    read_or_refused(LvmFormat(), path)
