from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spoiling import Spoiling, read_or_refused, spoilings
from sprung.errors import InputError
from sprung.formats import libraries
from sprung.formats.uff import UffFormat

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats import SampleTable

pyuff = pytest.importorskip("pyuff")
VALUES = np.random.default_rng(1).normal(size=(2, 40))


def function(row: int, **changes: Any) -> dict[str, Any]:
    time = np.arange(40) / 2048
    plain = {"type": 58, "binary": 1, "func_type": 1, "rsp_node": row + 3, "rsp_dir": 3, "ref_node": 0, "ref_dir": 0}
    data = {"x": time, "data": VALUES[row], "abscissa_spacing": 1, "ordinate_axis_units_lab": "g"}
    return {**plain, **data, "orddenom_spec_data_type": 0, **changes}


def written(folder: Path, *functions: dict[str, Any]) -> Path:
    path = folder / "x.uff"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the library leaves a file unclosed while it writes
        pyuff.UFF(str(path)).write_sets(list(functions), "add")
    return path


def read(path: Path) -> SampleTable:
    assert UffFormat().claims(path, path.read_bytes()[:8192])
    return UffFormat().read(path)


# The library's writer leaves a file to be closed by chance; only the tests write.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


# 58b holds doubles; the text has twelve digits.
@pytest.mark.parametrize(("binary", "exact"), [(1, 0.0), (0, 1e-11)])
def test_values_names_and_units(tmp_path: Path, binary: int, exact: float) -> None:
    table = read(written(tmp_path, function(0, binary=binary), function(1, binary=binary, rsp_dir=-1)))
    assert table.channels == ("3Z+", "4X-")
    assert table.units == ("g", "g")
    np.testing.assert_allclose(table.take(), VALUES, rtol=0, atol=exact)


def test_the_rate_that_six_digits_of_the_step_mean(tmp_path: Path) -> None:
    path = written(tmp_path, function(0))
    assert b"4.88281e-04" in path.read_bytes()
    assert read(path).clock == 2048.0


def test_uneven_times_and_other_starts(tmp_path: Path) -> None:
    uneven = np.cumsum(np.arange(1.0, 41.0)) / 64
    table = read(written(tmp_path, function(0, x=uneven, abscissa_spacing=0)))
    np.testing.assert_array_equal(table.clock, uneven)
    table = read(written(tmp_path / "..", function(0, x=0.5 + np.arange(40) / 1000)))
    np.testing.assert_allclose(table.time, 0.5 + np.arange(40) / 1000, rtol=1e-15)


def test_names_of_the_first_line_only_where_they_tell_apart(tmp_path: Path) -> None:
    table = read(written(tmp_path, function(0, id1="left"), function(1, id1="right")))
    assert table.channels == ("left", "right")
    (tmp_path / "x.uff").unlink()
    table = read(written(tmp_path, function(0, id1="run 1"), function(1, id1="run 1")))
    assert table.channels == ("3Z+", "4Z+")
    assert table.notes == ("renamed, as several channels have one name or none: 3Z+, 4Z+",)


def test_functions_over_frequency_are_left_out(tmp_path: Path) -> None:
    table = read(written(tmp_path, function(0), function(1, func_type=4)))
    assert table.channels == ("3Z+",)
    assert table.notes[0] == "left out 1 functions that are no real time responses"
    (tmp_path / "x.uff").unlink()
    with pytest.raises(InputError, match=r"x\.uff: found no channel with samples over time"):
        read(written(tmp_path, function(1, func_type=4)))


def test_numbers_of_another_format_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, function(0))
    path.write_bytes(path.read_bytes().replace(b"b     1     2", b"b     1     5", 1))
    with pytest.raises(InputError, match="data set 1: found binary numbers of format 5"):
        read(path)


@pytest.mark.parametrize("end", [-1, -7, -60, 300, 1200])
@pytest.mark.parametrize("binary", [0, 1])
def test_a_file_cut_short(tmp_path: Path, binary: int, end: int) -> None:
    path = written(tmp_path, function(0, binary=binary), function(1, binary=binary))
    whole = path.read_bytes()
    path.write_bytes(whole[:end])
    if end == -1:  # but for the last line end it is whole
        np.testing.assert_allclose(read(path).take(), VALUES, atol=1e-11)
        return
    with pytest.raises(InputError):
        read(path)


def test_without_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, function(0))

    def missing(name: str) -> None:
        raise ImportError(f"No module named '{name}'")

    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(InputError, match=r'pip install "sprung\[uff\]"'):
        UffFormat().read(path)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=60, deadline=None
)
@given(binary=st.integers(0, 1), spoiling=spoilings())
def test_whatever_happens_to_a_file(tmp_path: Path, binary: int, spoiling: Spoiling) -> None:
    (tmp_path / "x.uff").unlink(missing_ok=True)
    path = written(tmp_path, function(0, binary=binary), function(1, binary=binary))
    path.write_bytes(spoiling.of(path.read_bytes()))
    read_or_refused(UffFormat(), path)
