"""Whatever dialect a table is written in, the same numbers come out, or an error that names the place."""

from __future__ import annotations

import itertools
import tracemalloc
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from sprung.errors import InputError
from sprung.formats.csv import CsvFormat

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats import SampleTable

DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "pipe": "|", "spaces": "   "}
PREAMBLES = {
    "none": (),
    "key and value": ("Device{d}Stoßlogger", "Channels{d}2", ""),
    "as wide as the table": ("Logger{d}7{d}Köln", "Serial{d}a{d}b"),
    "comments": ("# made by hand", "# 1, 2, 3", "// {d}", "% 2"),
}
TIMES = ("seconds", "ms", "rate", "clock", "date")
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "cp1252")
VALUES = np.array([[9.81, -0.5, 1e-5, 12345.0, 3.0], [0.1, 2.0, -3.25, 0.0, 7.0]])


def read(folder: Path, content: str | bytes, name: str = "x.csv") -> SampleTable:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return CsvFormat().read(path)


def written(values: np.ndarray, delimiter: str, mark: str, preamble: tuple[str, ...], units: bool, time: str) -> str:
    """Write two channels at 500 Hz, from 23:59:59.996 on where it is a time of day."""
    d = DELIMITERS[delimiter]
    quote = '"' if d == mark else ""
    milliseconds = [86399996 + 2 * i for i in range(values.shape[1])]
    day = [f"{m // 3600000 % 24:02}:{m // 60000 % 60:02}:{m // 1000 % 60:02}.{m % 1000:03}" for m in milliseconds]
    first = {
        "seconds": [f"{0.002 * i:.3f}" for i in range(values.shape[1])],
        "ms": [f"{2 * i}" for i in range(values.shape[1])],
        "clock": day,
        "date": [f"2026-11-{20 + m // 86400000}T{hour}Z" for m, hour in zip(milliseconds, day, strict=True)],
    }
    names = ["Zeit", "Stoß", "b"]
    row = ["ms" if time == "ms" else "s" if time == "seconds" else "", "g", "m/s^2"]
    if not units:
        names = ["Zeit [ms]" if time == "ms" else "Zeit", "Stoß [g]", "b [m/s^2]"]
    columns = [first[time]] if time != "rate" else []
    columns += [[repr(float(value)) for value in channel] for channel in values]
    skipped = 1 if time == "rate" else 0
    lines = [line.format(d=d) for line in preamble]
    lines += [f"Sample rate: {500} Hz"] if time == "rate" else []
    lines += [d.join(names[skipped:])]
    lines += [d.join(cell or "-" for cell in row[skipped:])] if units else []
    lines += [
        d.join(f"{quote}{cell.replace('.', mark)}{quote}" for cell in cells) for cells in zip(*columns, strict=True)
    ]
    return "\n".join([*lines, ""])


@pytest.mark.parametrize(("delimiter", "mark"), list(itertools.product(DELIMITERS, ".,")))
@pytest.mark.parametrize("preamble", PREAMBLES)
def test_a_table_is_read_back_exactly(tmp_path: Path, delimiter: str, mark: str, preamble: str) -> None:
    for units, time, encoding in itertools.product((False, True), TIMES, ENCODINGS):
        text = written(VALUES, delimiter, mark, PREAMBLES[preamble], units, time)
        table = read(tmp_path, text.encode(encoding))
        assert (table.channels, table.units) == (("Stoß", "b"), ("g", "m/s^2")), text
        np.testing.assert_array_equal(table.take(), VALUES, err_msg=text)
        np.testing.assert_allclose(table.time, 0.002 * np.arange(5), rtol=0, atol=2e-11, err_msg=text)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=80, deadline=None
)
@given(
    values=st.lists(st.tuples(*[st.floats(-1e9, 1e9)] * 2), min_size=2, max_size=8),
    delimiter=st.sampled_from(list(DELIMITERS)),
    mark=st.sampled_from(".,"),
    preamble=st.sampled_from(list(PREAMBLES)),
    time=st.sampled_from(TIMES),
    units=st.booleans(),
)
def test_any_numbers_are_read_back_exactly(
    tmp_path: Path,
    values: list[tuple[float, float]],
    delimiter: str,
    mark: str,
    preamble: str,
    time: str,
    units: bool,
) -> None:
    expected = np.array(values).T
    table = read(tmp_path, written(expected, delimiter, mark, PREAMBLES[preamble], units, time))
    np.testing.assert_array_equal(table.take(), expected)


MOVELLA = """sep=,
DeviceTag:,front left
FirmwareVersion:,3.0.0
AppVersion:,2023.6.0
StartTime: ,2026-04-11_11:49:50_000 CET
© somebody

PacketCounter,SampleTimeFine,Acc_X,Acc_Z
0,4294950629,0.0,9.8
1,4294958962,0.1,9.7
2,4294967295,0.2,9.6
3,8332,0.3,9.5
4,16665,0.4,9.4
"""


def test_a_sensor_with_a_counter_of_microseconds_that_begins_again(tmp_path: Path) -> None:
    table = read(tmp_path, MOVELLA)
    assert table.channels == ("PacketCounter", "Acc_X", "Acc_Z")
    np.testing.assert_allclose(np.diff(table.time), 0.008333, rtol=1e-9)  # as written, the last but one over 2^32
    assert table.place(0) == "line 9"
    assert any("wraps at 2^32 in line 12" in note for note in table.notes)
    assert any("in µs" in note for note in table.notes)


@pytest.mark.shared
@pytest.mark.parametrize("floor", ["ground", "1st", "2nd", "3rd"])
def test_four_real_sensors(shared: Path, floor: str) -> None:
    path = shared / "data" / "real" / f"storey_{floor}_floor.csv"
    table = CsvFormat().read(path)
    assert table.channels[0] == "PacketCounter"
    assert table.channels[4:7] == ("Acc_X", "Acc_Y", "Acc_Z")
    assert table.take().shape == (10, len(path.read_bytes().strip().split(b"\n")) - 8)  # seven lines and the names
    assert 1 / np.median(np.diff(table.time)) == pytest.approx(120, rel=1e-3)  # nominal, from their README
    assert np.median(table.take()[6]) == pytest.approx(9.81, abs=0.5)  # gravity in z, and offsets


@pytest.mark.parametrize(
    ("line", "hertz"),
    [
        ("Sample rate: 500 Hz", 500),
        ("Fs=500", 500),
        ("dt;0,002", 500),
        ("Abtastrate [kHz];0,5", 500),
        ("Sampling interval (ms)\t2", 500),
        ('"Fréquence d\'échantillonnage";"500"', 500),
        ("# fs 1e3", 1000),
        ("Sample period: 250 us", 4000),
    ],
)
def test_a_rate_above_the_names(tmp_path: Path, line: str, hertz: float) -> None:
    table = read(tmp_path, f"Test 7\n{line}\na [g];b\n1,5;2\n3;4,25\n1;1\n")
    assert table.clock == pytest.approx(hertz, rel=1e-12)
    assert table.notes == (f"time from a rate of {hertz} Hz in line 2",)
    assert table.take().tolist() == [[1.5, 3, 1], [2, 4.25, 1]]


def test_a_rate_alone_reads_a_single_column(tmp_path: Path) -> None:
    table = read(tmp_path, "Fs=500\nbody_fl [g]\n1,25\n2,5\n3\n")
    assert (table.channels, table.units, table.clock) == (("body_fl",), ("g",), 500)
    assert table.take().tolist() == [[1.25, 2.5, 3]]


def test_the_rate_tells_the_unit_of_time(tmp_path: Path) -> None:
    table = read(tmp_path, "Fs=500\ntime,a\n0,1\n2,1\n4,2\n")
    np.testing.assert_allclose(table.time, [0, 0.002, 0.004])
    assert "unit of time, 0.001 s, from the rate of 500 Hz in line 1" in table.notes


def test_columns_of_words_and_dates_do_no_harm(tmp_path: Path) -> None:
    table = read(tmp_path, "Date;Time;state;a\n" + "".join(f"11.04.26;10:00:0{i},5;ok;{i}\n" for i in range(9)))
    assert table.channels == ("Date", "state", "a")
    assert [table.find_non_number(column) is not None for column in range(3)] == [True, True, False]
    assert table.time.tolist() == list(range(9))


def test_half_past_eleven_in_the_evening(tmp_path: Path) -> None:
    table = read(tmp_path, "time,a\n11:59:59.5 AM,1\n12:00:00.5 PM,2\n")
    assert table.time.tolist() == [0, 1]


REFUSED = {
    "thousands in the rate": ("Sample rate: 1,000 Hz\na,b\n1.5,2\n3,4\n", "line 1: found the rate '1,000 Hz'"),
    "thousands": ("time;a\n0,002;1.234,5\n0,004;3\n", "without thousands separators, with ','"),
    "two marks": ("time;a\n0.002;1,234\n0.004;3.5\n", "without thousands separators, with '.'"),
    "no names": ("Fs=500\n1;2\n3;4\n", "found numbers without names above them"),
    "false mark": (b"\xff\xfea", "marked as UTF-16 with invalid text"),
    "too few names": ("Logger 7\nx;y;z\nt;a\n0;1;2\n", "line 4: found 3 cells; expected 2"),
}


@pytest.mark.parametrize(("content", "words"), REFUSED.values(), ids=REFUSED)
def test_what_may_be_read_in_two_ways_is_not_read(tmp_path: Path, content: str | bytes, words: str) -> None:
    try:
        table = read(tmp_path, content)
        problems = [table.find_non_number(column) for column in range(len(table.channels))]
    except InputError as error:
        problems = list(error.problems)
    assert words in " ".join(map(str, problems))


VALID = written(VALUES, "semicolon", ",", PREAMBLES["key and value"], units=True, time="clock").encode()


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=400, deadline=10_000
)
@given(
    content=st.one_of(
        st.binary(max_size=300),
        st.text(alphabet='0123456789.,;:|"\t\n -+eEtainfg#%[]', max_size=200).map(str.encode),
        st.tuples(st.integers(0, len(VALID)), st.integers(0, 40), st.binary(max_size=20)).map(
            lambda cut: VALID[: cut[0]] + cut[2] + VALID[cut[0] + cut[1] :]
        ),
    )
)
@example(content=b"t,t\n" + b"9" * 400 + b",1\n")
@example(content=b"t,a\n1e999,-1e999\n2,3\n")
@example(content=b"#\n%\n//\n1\n")
@example(content=b'"' + b"a," * 20000)
def test_any_bytes_are_read_or_refused(tmp_path: Path, content: bytes) -> None:
    try:
        table = read(tmp_path, content)
        values = table.take()
    except InputError:
        return
    assert values.shape == (len(table.channels), len(table.time))


@pytest.mark.parametrize(
    "row", ["{i},1,2\n", "{i},1.2345,-2.25,12.5\n", "{i},1.2345,overload\n", "a\n", "1\n", ",", "\n,,"]
)
@pytest.mark.slow
def test_memory_is_bounded_by_the_size_of_the_file(tmp_path: Path, row: str) -> None:
    size = 100_000
    text = "time,a,b,c\n" if row.count(",") > 2 else "time,a,b\n"
    text += "".join(row.format(i=i) for i in range(size // len(row.format(i=10000))))
    path = tmp_path / "x.csv"
    path.write_text(text)
    tracemalloc.start()
    try:
        CsvFormat().read(path)
    except InputError:
        pass
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 10 * len(text) + 5e6  # ten times the file, and what any file costs
