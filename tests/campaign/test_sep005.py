from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sprung
from sprung.campaign import to_sep005
from sprung.campaign.recording import Recording
from sprung.errors import InputError
from sprung.formats.sep005 import from_sep005

VALUES = np.random.default_rng(6).normal(size=(2, 30))


def signal(name: Any = "a", **changes: Any) -> dict[str, Any]:
    return {"name": name, "data": VALUES[0], "unit_str": "g", "fs": 2000, **changes}


def test_signals_at_a_rate() -> None:
    table = from_sep005([signal(), signal("b", data=VALUES[1].tolist(), unit_str="m/s^2", quantity="acceleration")])
    assert table.channels == ("a", "b")
    assert table.units == ("g", "m/s^2")
    assert table.clock == 2000.0
    np.testing.assert_array_equal(table.take(), VALUES)


def test_signals_with_times() -> None:
    times = 3 + np.arange(30) / 500
    table = from_sep005([{"name": "a", "data": VALUES[0], "unit_str": "", "time": times}])
    assert table.units == (None,)
    np.testing.assert_array_equal(table.clock, times)
    assert from_sep005([signal(fs=500, time=times - 3)]).clock == pytest.approx(500, rel=1e-15)


def test_one_name_in_two_places() -> None:
    table = from_sep005([signal(location="left"), signal(location="right")])
    assert table.channels == ("left.a", "right.a")


def test_signals_at_two_rates_are_read_at_that_of_the_most() -> None:
    table = from_sep005([signal("a"), signal("b"), signal("c", fs=500), signal("d", fs=20)])
    assert table.clock == 2000.0
    assert table.resampled[2].rate_ratio == pytest.approx(0.25)
    assert [table.find_non_number(column) is not None for column in range(4)] == [False, False, False, True]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ([], r"signals: found no signals"),
        ({"name": "a"}, "signals: found dict; expected a list of dictionaries"),
        (["a"], r"signals\[0\]: found str; expected a dictionary"),
        ([{"name": "a", "unit_str": "g", "fs": 1}], r"signals\[0\]\.data: found nothing"),
        ([{"name": "a", "data": [1, 2], "unit": "g", "fs": 1}], r"\.unit_str: found nothing.*Did you mean 'unit'"),
        ([signal(name=3)], r"signals\[0\]\.name: found 3; expected text"),
        ([signal(data=VALUES)], r"signals\[0\]\.data: found an array of float64 of shape \(2, 30\)"),
        ([signal(data=["x"])], r"\.data: found an array of <U1"),
        ([signal(data=[1j])], r"\.data: found an array of complex128"),
        ([signal(data=[[1], [1, 2]])], r"\.data: found an array"),
        ([signal(fs=-1)], r"\.fs: found -1; expected samples per second, a positive number"),
        ([signal(fs="2000")], r"\.fs: found '2000'"),
        ([signal(fs=None)], r"\.fs: found neither fs nor time"),
        ([signal(time=[0, 1])], r"\.time: found 2 times for 30 samples"),
        ([signal(fs=None, time=np.zeros(30))], r"\.time: found times that do not increase, not so at sample 2"),
        ([signal(fs=2001, time=np.arange(30) / 2000)], r"\.fs: found 2001 Hz beside times at 2000 Hz"),
        ([signal(start_timestamp="1"), signal("b", start_timestamp="2")], "found start_timestamp 1, 2"),
    ],
)
def test_what_is_wrong_with_signals(wrong: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        from_sep005(wrong)


def test_every_problem_at_once() -> None:
    with pytest.raises(InputError) as raised:
        from_sep005([signal(fs=0, unit_str=1), signal("b", data=[])])
    assert [problem.where for problem in raised.value.problems] == [
        "signals[0].unit_str",
        "signals[0].fs",
        "signals[1].data",
    ]


@given(start=st.sampled_from([0.0, 12.5]), rate=st.sampled_from([200.0, 2048.0, 1651.5]))
def test_there_and_back(start: float, rate: float) -> None:
    recording = Recording("x", ("a", "b", "c"), np.vstack([VALUES, np.full(30, np.nan)]), start, rate)
    signals = to_sep005(recording)
    assert all(
        sorted(s) == sorted(["name", "data", "unit_str", "quantity", "time" if start else "fs"]) for s in signals
    )
    table = from_sep005(signals)
    assert table.channels == ("a", "b")  # c is left out of the recording
    assert table.units == ("m/s^2", "m/s^2")
    np.testing.assert_array_equal(table.take(), VALUES)
    np.testing.assert_array_equal(table.time, recording.time)


Sound = Callable[..., Path]
"""The fixture that gives a sound campaign folder with some texts replaced."""


def test_a_campaign_whose_recordings_are_in_memory(folder: Sound) -> None:
    path = folder()
    read = sprung.read(path)
    signals = {recording.name: sprung.to_sep005(recording) for recording in read.recordings}
    for name in signals:
        (path / name).unlink()
    again = sprung.read(path, signals=signals)
    assert again.drops == read.drops
    assert again.faults == read.faults
    for one, other in zip(again.recordings, read.recordings, strict=True):
        assert (one.name, one.channels, one.start) == (other.name, other.channels, other.start)
        assert one.rate == pytest.approx(other.rate, rel=1e-12)
        np.testing.assert_array_equal(one.values, other.values)


def test_some_recordings_in_memory_and_some_in_files(folder: Sound) -> None:
    path = folder(('file = "one.csv"', 'file = "in memory"'))
    data = np.arange(100.0)
    given = [{"name": name, "data": data, "unit_str": "g", "fs": 500} for name in ("body_fl", "body_fr", "body_rl")]
    first, second = sprung.read(path, signals={"in memory": given}).recordings
    np.testing.assert_allclose(first.values[0], 9.80665 * data)  # the unit g, by its definition
    assert (first.name, first.rate) == ("in memory", 500)
    assert second.name == "two.csv"


def test_the_campaign_file_says_of_signals_what_it_says_of_files(folder: Sound) -> None:
    path = folder(('channel = "body_fl"', 'channel = "body_fl"\nunit = "mg"\ndirection = "down"'))
    given = [{"name": name, "data": np.arange(100.0), "unit_str": "g", "fs": 500} for name in ("body_fl", "body_fr")]
    recording = sprung.read(path, signals={"one.csv": given}).recordings[0]
    np.testing.assert_allclose(recording.values[0], -9.80665e-3 * np.arange(100.0))
    assert [fault.code for fault in recording.faults] == ["missing"]  # body_rl


def test_what_is_wrong_with_the_signals_of_a_campaign(folder: Sound) -> None:
    path = folder()
    given = {"one.csv": [signal("body_fl", fs=0)], "tow.csv": [signal()], "three": [signal()]}
    with pytest.raises(InputError) as raised:
        sprung.read(path, signals=given)
    assert [problem.where for problem in raised.value.problems] == ["one.csv[0].fs", "signals", "signals"]
    assert "'tow.csv', which no drop has" in str(raised.value)
    assert "Did you mean 'two.csv'?" in str(raised.value)


def test_masked_samples_are_missing() -> None:
    masked = np.ma.masked_array(VALUES[0], np.arange(30) == 4)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(from_sep005([signal(data=masked)]).take()[0])), [4])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (signal(fs=10**400), r"\.fs: found 1000.*expected samples per second"),  # larger than any float
        (signal(unit_str=np.arange(40.0)), r"\.unit_str: found array\(\[ ?0.*expected text"),
    ],
)
def test_what_no_float_and_no_line_can_hold(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        from_sep005([wrong])


def test_names_and_starts_of_any_kind() -> None:
    assert from_sep005([signal(None, unit_str=None, start_timestamp=np.zeros(3))]).channels == ("signals[0]",)
