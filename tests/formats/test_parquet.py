from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sprung.errors import InputError
from sprung.formats import SampleTable, libraries
from sprung.formats.parquet import ParquetFormat

if TYPE_CHECKING:
    from pathlib import Path

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

RANDOM = np.random.default_rng(3)
TIME = 2 + np.arange(70) / 700
A, B = RANDOM.normal(size=(2, 70))


def written(folder: Path, columns: dict[str, Any], metadata: dict[str, str] | None = None, **options: Any) -> Path:
    path = folder / "x.parquet"
    pq.write_table(pa.table(columns).replace_schema_metadata(metadata), path, **options)
    return path


def read(path: Path) -> SampleTable:
    assert ParquetFormat().claims(path, path.read_bytes()[:8192])
    return ParquetFormat().read(path)


@pytest.mark.parametrize("options", [{}, {"compression": "zstd", "row_group_size": 16}, {"compression": "none"}])
def test_columns_come_back_as_they_were(tmp_path: Path, options: dict[str, Any]) -> None:
    result = read(written(tmp_path, {"time [ms]": 1e3 * TIME, "front [g]": A, "rear": B}, **options))
    assert result.channels == ("front", "rear")
    assert result.units == ("g", None)
    np.testing.assert_array_equal(result.take(), [A, B])
    np.testing.assert_allclose(result.time, TIME, rtol=1e-15)


def test_units_stand_in_the_metadata_of_the_fields(tmp_path: Path) -> None:
    fields = [pa.field("time", pa.float64()), pa.field("a", pa.float64(), metadata={"unit": "g"})]
    path = tmp_path / "x.parquet"
    pq.write_table(pa.table([TIME, A], schema=pa.schema(fields)), path)
    assert read(path).units == ("g",)


@pytest.mark.parametrize(
    "metadata", [{"fs": "2000"}, {"dt_ms": "0.5"}, {"sample_rate": "2 kHz"}, {"acq": '{"fs": 2e3}'}]
)
def test_a_rate_stands_in_the_metadata_of_the_file(tmp_path: Path, metadata: dict[str, str]) -> None:
    result = read(written(tmp_path, {"a": A, "b": B}, {**metadata, "note": "{no JSON"}))
    assert result.clock == pytest.approx(2000, rel=1e-15)


def test_the_attributes_of_a_pandas_frame_count(tmp_path: Path) -> None:
    frame = pd.DataFrame({"a": A})
    frame.attrs = {"fs": 2000, "unit": "g"}
    frame.to_parquet(tmp_path / "x.parquet", engine="pyarrow")
    result = read(tmp_path / "x.parquet")
    assert (result.clock, result.units) == (2000, ("g",))


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
@pytest.mark.parametrize("kind", ["timestamp", "duration", "time"])
def test_dates_durations_and_times_of_day_are_time(tmp_path: Path, unit: str, kind: str) -> None:
    ticks = {"ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    counts = np.arange(70) * (ticks // 500)
    start = 0 if kind == "duration" else 36_000 * ticks if kind == "time" else 1_700_000_000 * ticks
    arrow: Any = {"timestamp": pa.timestamp, "duration": pa.duration, "time": pa.time32 if unit == "ms" else pa.time64}
    column = pa.array(start + counts, pa.int64() if unit != "ms" or kind != "time" else pa.int32()).cast(
        arrow[kind](unit)
    )
    result = read(written(tmp_path, {"when": column, "a": A}))
    np.testing.assert_allclose(result.time, np.arange(70) / 500, rtol=1e-15)  # 2 ms apart, whatever counts them
    assert result.channels == ("a",)


def test_empty_cells_are_no_numbers_and_types_do_not_matter(tmp_path: Path) -> None:
    columns = {
        "time": pa.array(TIME),
        "i": pa.array([None, *range(1, 70)], pa.int16()),
        "f": pa.array([None, *A[1:]], pa.float32()),
        "text": pa.array(["a"] * 70),
        "lists": pa.array([[1.0, 2.0]] * 70),
    }
    result = read(written(tmp_path, columns))
    assert result.channels == ("i", "f")
    np.testing.assert_array_equal(result.take()[:, 0], [np.nan, np.nan])
    np.testing.assert_array_equal(result.take()[:, 1:], [np.arange(1, 70), A[1:].astype(np.float32)])
    assert "text: values of type string, lists: values of type list" in result.notes[-1]


def test_more_than_the_file_can_hold_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, {"a": np.zeros(8_000_000)})
    assert path.stat().st_size < 1e5  # runs of one value take no room
    with pytest.raises(InputError, match="more than 10 times their size"):
        read(path)


@pytest.mark.parametrize(
    ("columns", "message"),
    [({"text": ["a"]}, "no vectors of numbers but text"), ({"a": A, "b": B}, "no time among 'a', 'b'")],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, columns: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(written(tmp_path, columns))


def test_without_its_library_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(module: str) -> None:
        raise ImportError(f"No module named '{module}'")

    path = written(tmp_path, {"time": TIME, "a": A})
    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(InputError, match=r'pyarrow.*not installed.*pip install "sprung\[parquet\]"'):
        read(path)


def test_claims_by_ending_and_first_bytes(tmp_path: Path) -> None:
    assert ParquetFormat().claims(tmp_path / "x.PQ", b"PAR1")
    assert not ParquetFormat().claims(tmp_path / "x.csv", b"PAR1")
    assert not ParquetFormat().claims(tmp_path / "x.parquet", b"")


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=80, deadline=None
)
@given(data=st.data(), compression=st.sampled_from(["none", "snappy", "zstd"]))
def test_damage_is_refused_or_harmless(tmp_path: Path, data: st.DataObject, compression: str) -> None:
    path = written(tmp_path, {"time": TIME, "a": A}, {"unit": "g"}, compression=compression)
    raw = bytearray(path.read_bytes())
    for place in data.draw(st.lists(st.integers(0, len(raw) - 1), max_size=6)):
        raw[place] = data.draw(st.integers(0, 255))
    path.write_bytes(raw[: data.draw(st.integers(0, len(raw)) | st.just(len(raw)))])
    try:
        result = ParquetFormat().read(path)
        values = result.take()
    except InputError as error:
        assert all(problem.where.startswith(path.name) for problem in error.problems)  # noqa: PT017
    else:
        assert values.shape == (len(result.channels), len(result.time))
