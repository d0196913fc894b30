from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from spoiling import Spoiling, read_or_refused, spoilings
from sprung.errors import InputError
from sprung.formats import libraries
from sprung.formats.tdms import TdmsFormat

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats import SampleTable

nptdms = pytest.importorskip("nptdms")
VALUES = np.random.default_rng(3).normal(size=(3, 60))
EVEN: dict[str, Any] = {"wf_increment": 1 / 2000, "wf_start_offset": 0.0, "unit_string": "g"}


def channel(name: str, values: Any, group: str = "one", **properties: Any) -> Any:
    return nptdms.ChannelObject(group, name, values, properties=properties)


def written(folder: Path, *segments: list[Any]) -> Path:
    path = folder / "x.tdms"
    with nptdms.TdmsWriter(str(path)) as writer:
        for segment in segments:
            writer.write_segment(segment)
    return path


def read(path: Path) -> SampleTable:
    assert TdmsFormat().claims(path, path.read_bytes()[:8192])
    return TdmsFormat().read(path)


def test_doubles_units_and_the_rate_are_exact(tmp_path: Path) -> None:
    table = read(written(tmp_path, [channel(f"a{i}", row, **EVEN) for i, row in enumerate(VALUES)]))
    assert table.channels == ("a0", "a1", "a2")
    assert table.units == ("g",) * 3
    assert table.clock == 2000.0
    np.testing.assert_array_equal(table.take(), VALUES)


def test_segments_follow_one_another_and_an_old_index_is_not_asked(tmp_path: Path) -> None:
    path = written(tmp_path, [channel("a", VALUES[0], **EVEN)], [channel("a", VALUES[1])])
    (tmp_path / "x.tdms_index").write_bytes(b"of another recording")
    np.testing.assert_array_equal(read(path).take()[0], np.concatenate(VALUES[:2]))


@pytest.mark.parametrize(("name", "unit", "factor"), [("Time", "ms", 1e-3), ("zeit [ms]", "", 1e-3), ("t (s)", "", 1)])
def test_a_channel_of_times(tmp_path: Path, name: str, unit: str, factor: float) -> None:
    times = np.cumsum(np.arange(1.0, 61.0))
    channels = [channel(name, times, unit_string=unit), channel("a [g]", VALUES[0])]
    table = read(written(tmp_path, [*channels, channel("b", VALUES[1], "two")]))
    assert table.channels == ("a",)
    assert table.units == ("g",)
    np.testing.assert_array_equal(table.clock, factor * times)
    assert table.notes == ("left out, as they have neither a time step nor a time channel: two/b",)


def test_time_stamps_count_from_the_first(tmp_path: Path) -> None:
    stamps = np.datetime64("2026-01-02T03:04:05", "us") + np.arange(60) * np.timedelta64(500, "us")
    table = read(written(tmp_path, [channel("Timestamp", stamps), channel("a", VALUES[0], NI_UnitDescription="g")]))
    assert table.units == ("g",)
    assert table.clock == 2000.0


def test_one_name_in_two_groups(tmp_path: Path) -> None:
    table = read(written(tmp_path, [channel("a", VALUES[0], **EVEN), channel("a", VALUES[1], "two", **EVEN)]))
    assert table.channels == ("one/a", "two/a")
    np.testing.assert_array_equal(table.take(), VALUES[:2])


def test_groups_that_start_apart_are_on_two_clocks(tmp_path: Path) -> None:
    begin = np.datetime64("2026-01-02T03:04:05", "us")
    rows = [channel(f"a{i}", row, wf_start_time=begin, **EVEN) for i, row in enumerate(VALUES[:2])]
    rows.append(channel("b", VALUES[2], "two", wf_start_time=begin + np.timedelta64(500, "ms"), **EVEN))
    table = read(written(tmp_path, rows))
    assert table.channels == ("a0", "a1", "b")
    assert table.clock == 2000.0
    assert "found 60 samples from 0.5 to 0.5295 s at 2000 Hz" in str(table.find_non_number(2))


def test_other_starts_text_and_channels_without_time(tmp_path: Path) -> None:
    moved: dict[str, Any] = {**EVEN, "wf_start_offset": -0.25}
    table = read(written(tmp_path, [channel("a", VALUES[0], **moved), channel("state", ["on"] * 60, **moved)]))
    assert table.channels == ("a",)
    np.testing.assert_allclose(table.clock, -0.25 + np.arange(60) / 2000, rtol=0, atol=1e-16)
    with pytest.raises(InputError, match="no time for any channel: one/a"):
        read(written(tmp_path, [channel("a", VALUES[0])]))


def test_a_file_cut_short(tmp_path: Path) -> None:
    path = written(tmp_path, [channel("a", VALUES[0], **EVEN)], [channel("a", VALUES[1])])
    whole = path.read_bytes()
    for end in (20, 100, len(whole) - 480 - 20, len(whole) - 8):
        path.write_bytes(whole[:end])
        with pytest.raises(InputError, match=r"x\.tdms: found .*It is cut short"):
            read(path)


def test_without_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, [channel("a", VALUES[0], **EVEN)])

    def missing(name: str) -> None:
        raise ImportError(f"No module named '{name}'")

    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(InputError, match=r'pip install "sprung\[tdms\]"'):
        TdmsFormat().read(path)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=100, deadline=None
)
@given(spoiling=spoilings())
def test_whatever_happens_to_a_file(tmp_path: Path, spoiling: Spoiling) -> None:
    segment = [channel("a", VALUES[0], **EVEN), channel("Time", VALUES[1], "two"), channel("b", VALUES[1], "two")]
    path = written(tmp_path, segment)
    path.write_bytes(spoiling.of(path.read_bytes()))
    read_or_refused(TdmsFormat(), path)
