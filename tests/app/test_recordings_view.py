"""Decimation of long recordings, and what is visible as CSV."""

from __future__ import annotations

import csv
import io
import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sprung.app import recordings_view
from sprung.app.decimation import Extremes, interval_edges
from sprung.errors import InputError


@given(samples=st.integers(1, 300), intervals=st.integers(1, 80), cuts=st.lists(st.integers(1, 299), max_size=5))
def test_extremes_are_those_of_every_interval_however_it_is_read(samples: int, intervals: int, cuts: list[int]) -> None:
    values = np.random.default_rng(samples).normal(size=(2, samples))
    values[0, ::7] = np.nan
    found = Extremes(2, samples, intervals)
    edges = [0, *sorted({cut for cut in cuts if cut < samples}), samples]
    for first, last in itertools.pairwise(edges):
        found.add(first, values[:, first:last])
    ends = interval_edges(samples, intervals)
    for number, (first, last) in enumerate(itertools.pairwise(ends.tolist())):
        own = values[:, first:last]
        assert last > first
        for channel in (0, 1):
            numbers = own[channel][np.isfinite(own[channel])]
            if numbers.size:
                assert found.low[channel, number] == numbers.min()
                assert found.high[channel, number] == numbers.max()
            else:
                assert np.isnan(found.low[channel, number])


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of 250 000 samples with one spike, longer than what is kept whole."""
    path = tmp_path_factory.mktemp("long") / "long.csv"
    time = np.arange(250_000) / 1000
    signal = np.sin(2 * np.pi * time)
    signal[123_456] = 40.0
    np.savetxt(path, np.column_stack([time, signal, 2 * signal]), "%.5f", ",", header="time_s,a,b", comments="")
    return path


def drawn(path: Path, low: float, high: float, pixels: int = 500) -> tuple[np.ndarray, np.ndarray]:
    while "done" in (found := recordings_view.visible(str(path), ["a"], low, high, pixels)):
        assert 0 <= found["done"] < 1
    return tuple(np.array(found["channels"]["a"][name], dtype=float) for name in ("time", "values"))  # type: ignore[return-value]


def test_a_spike_is_seen_at_every_zoom(long: Path) -> None:
    for low, high in ((0, 250), (100, 150), (123, 124), (123.45, 123.46)):
        times, values = drawn(long, low, high)
        assert len(times) <= 4 * 500
        assert values.max() == 40
        # In the middle of one of 500 intervals of the range.
        assert times[values.argmax()] == pytest.approx(123.456, abs=(high - low) / 500)
    times, values = drawn(long, 123.45, 123.46)
    assert values[np.argmin(np.abs(times - 123.456))] == 40  # where there are few samples, each is drawn


def test_a_long_recording_is_read_in_turns(long: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recordings_view, "_TURN", 0.0)
    recordings_view._kept.clear()
    first = recordings_view.visible(str(long), ["a"], 0, 250, 500)
    assert 0 < first["done"] < 1
    assert drawn(long, 0, 250)[1].max() == 40


def test_a_changed_file_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for value in (1.0, 2.0):
        np.savetxt(
            path,
            np.column_stack([np.arange(100) / 100, np.full(100, value)]),
            "%.7f",
            ",",
            header="time_s,a",
            comments="",
        )
        path.touch()
        (found,) = recordings_view.channels({"a": str(path)})
        assert found["samples"] == 100
        path.write_text(path.read_text() + "1.0,3.0\n" * int(value))
        assert recordings_view.visible(str(path), ["a"], 0, 1, 500)["channels"]["a"]["values"][0] == value


def test_what_is_visible_is_every_sample_of_every_file(tmp_path: Path, long: Path) -> None:
    other = tmp_path / "=other.csv"
    np.savetxt(
        other, np.column_stack([np.arange(100) / 10, np.arange(100)]), "%.5f", ",", header="time_s,b", comments=""
    )
    parts = [
        {"file": "long.csv", "path": str(long), "offset": 0.0, "channels": ["a", "b"]},
        {"file": "=other.csv", "path": str(other), "offset": 0.5, "channels": ["b"]},
    ]
    rows = list(csv.reader(io.StringIO(recordings_view.visible_csv(parts, 1.0, 1.1))))
    assert rows[0] == ["file", "time in the picture, s", "time of the file, s", "a", "b"]
    own = [row for row in rows[1:] if row[0] == "long.csv"]
    assert [float(row[1]) for row in own] == pytest.approx(np.arange(1.0, 1.1005, 0.001))
    assert float(own[50][3]) == pytest.approx(np.sin(2 * np.pi * 1.05), abs=1e-5)  # five decimals are in the file
    others = [row for row in rows[1:] if row[0] == "'=other.csv"]  # no formula of a spreadsheet
    assert [(row[1], row[2], row[3], row[4]) for row in others] == [("1", "0.5", "", "5"), ("1.1", "0.6", "", "6")]
    with pytest.raises(InputError, match="Zoom in"):
        recordings_view.visible_csv([{**parts[0], "path": str(long)}] * 2, 0, 250)


def test_files_that_are_no_recordings_say_so(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("nothing of interest")
    (found,) = recordings_view.channels({"notes.txt": str(tmp_path / "notes.txt")})
    assert "channels" not in found
    assert re.search(r"^Found .*; expected .*\. ", found["problem"])
    (tmp_path / "a.csv").write_text("time_s,a\n0,1\n0.1,2\n0.2,3\n")
    with pytest.raises(InputError, match="no channel 'c'"):
        recordings_view.visible(str(tmp_path / "a.csv"), ["c"], 0, 1, 500)
