from __future__ import annotations

import gc
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spoiling import Spoiling, read_or_refused, spoilings
from sprung.errors import InputError
from sprung.formats import libraries
from sprung.formats.mdf import MdfFormat

if TYPE_CHECKING:
    from pathlib import Path

    from sprung.formats import SampleTable

asammdf = pytest.importorskip("asammdf")
VALUES = np.random.default_rng(2).normal(size=(3, 200))
TIME = np.arange(200) / 2000


def signal(values: Any, time: Any, name: str, unit: str = "g", **more: Any) -> Any:
    return asammdf.Signal(values, time, name=name, unit=unit, **more)


def written(folder: Path, *groups: list[Any], version: str = "4.10", compression: int = 0) -> Path:
    path = folder / ("x.mf4" if version >= "4" else "x.mdf")
    with asammdf.MDF(version=version) as measurement:
        for number, group in enumerate(groups):
            measurement.append(group, acq_name=f"device {number}", common_timebase=True)
        measurement.save(path, overwrite=True, compression=compression)
    return path


def read(path: Path) -> SampleTable:
    assert MdfFormat().claims(path, path.read_bytes()[:8192])
    return MdfFormat().read(path)


@pytest.mark.parametrize(("version", "compression"), [("3.30", 0), ("4.10", 0), ("4.10", 1), ("4.10", 2), ("4.20", 2)])
def test_doubles_and_the_rate_are_exact(tmp_path: Path, version: str, compression: int) -> None:
    group = [
        signal(row, TIME, f"a{i}", unit) for i, (row, unit) in enumerate(zip(VALUES, ["g", "m/s^2", ""], strict=True))
    ]
    table = read(written(tmp_path, group, version=version, compression=compression))
    assert table.channels == ("a0", "a1", "a2")
    assert table.units == ("g", "m/s^2", None)
    assert table.clock == 2000.0  # from the times it is 1999.9999999999998
    np.testing.assert_array_equal(table.take(), VALUES)


def test_groups_on_one_clock_are_one_table(tmp_path: Path) -> None:
    table = read(written(tmp_path, [signal(VALUES[0], TIME, "a")], [signal(VALUES[1], TIME + 1e-8, "a", "m/s^2")]))
    assert table.channels == ("device 0.a", "device 1.a")
    assert table.units == ("g", "m/s^2")
    np.testing.assert_array_equal(table.take(), VALUES[:2])
    assert table.notes == ("renamed, as several channels have one name or none: device 0.a, device 1.a",)


def test_channels_on_another_clock_are_read_at_the_times_of_the_others(tmp_path: Path) -> None:
    slow_time = TIME[:50] * 10
    slow = np.sin(2 * np.pi * 3 * slow_time)
    groups = [[signal(slow, slow_time, "slow"), signal(-slow, slow_time, "slower")], [signal(VALUES[0], TIME, "a")]]
    table = read(written(tmp_path, *groups))
    assert table.channels == ("a", "slow", "slower")
    np.testing.assert_array_equal(table.take()[0], VALUES[0])
    np.testing.assert_allclose(table.take()[1], np.sin(2 * np.pi * 3 * TIME), atol=1e-4)
    np.testing.assert_allclose(table.take()[2], -table.take()[1], atol=1e-12)
    assert table.resampled[1].rate_ratio == pytest.approx(0.1)
    assert table.notes == ("on another clock, interpolated to the times of the others: slow, slower",)


def test_channels_too_slow_for_wheels_are_spoilt(tmp_path: Path) -> None:
    groups = [[signal(VALUES[2, :50], TIME[:50] * 100, "slow")], [signal(VALUES[0], TIME, "a")]]
    table = read(written(tmp_path, *groups))
    assert table.channels == ("a", "slow")
    assert np.isnan(table.take()[1:]).all()
    assert str(table.find_non_number(1)) == (
        "x.mf4: channel 'slow': found 50 samples from 0 to 2.45 s at 20 Hz; expected the clock of most samples of "
        "the file, 200 samples from 0 to 0.0995 s at 2000 Hz. "
        "Export all channels that are needed at one rate and over one time."
    )


def test_integers_are_scaled_and_text_is_left_out(tmp_path: Path) -> None:
    halves = {"a": 0.5, "b": 1.0}
    raw = np.arange(200, dtype=np.int16)
    text = signal(np.array([b"on"] * 200), TIME, "state", "", encoding="utf-8")
    table = read(written(tmp_path, [signal(raw, TIME, "a", conversion=halves), text]))
    assert table.channels == ("a",)
    np.testing.assert_array_equal(table.take()[0], 0.5 * raw + 1)
    assert table.notes == ("left out, as their samples are no numbers: state",)


def test_invalid_samples_are_no_numbers(tmp_path: Path) -> None:
    invalid = np.zeros(200, dtype=bool)
    invalid[7] = True
    table = read(written(tmp_path, [signal(VALUES[0], TIME, "a", invalidation_bits=invalid)]))
    np.testing.assert_array_equal(np.isnan(table.take()[0]), invalid)


def test_uneven_times_and_other_starts_are_kept(tmp_path: Path) -> None:
    for time in (np.cumsum(np.arange(1.0, 201.0)) / 64, 12.3 + TIME):
        np.testing.assert_array_equal(read(written(tmp_path, [signal(VALUES[0], time, "a")])).clock, time)


@pytest.mark.parametrize("version", ["3.30", "4.10"])
def test_a_file_cut_short(tmp_path: Path, version: str) -> None:
    path = written(tmp_path, [signal(row, TIME, f"a{i}") for i, row in enumerate(VALUES)], version=version)
    whole = path.read_bytes()
    for end in (100, len(whole) // 2, len(whole) - 600):
        path.write_bytes(whole[:end])
        with pytest.raises(InputError, match=rf"{path.name}.*expected"):
            read(path)


@pytest.mark.parametrize("version", ["3.30", "4.10"])
def test_blocks_that_lead_back_to_themselves(tmp_path: Path, version: str) -> None:
    path = written(tmp_path, [signal(VALUES[0], TIME, "a")], version=version)
    content = bytearray(path.read_bytes())
    wide, group, links = (8, b"##DG", 24) if version > "4" else (4, b"DG", 4)
    width = slice(88, 96) if version > "4" else slice(68, 72)
    address = int.from_bytes(content[width], "little")
    assert content[address:].startswith(group)
    content[address + links : address + links + wide] = address.to_bytes(wide, "little")
    path.write_bytes(content)
    with pytest.raises(InputError, match=f"byte {address}: found a block that is met twice"):
        read(path)


def test_more_samples_than_the_file_can_hold(tmp_path: Path) -> None:
    path = written(tmp_path, [signal(VALUES[0], TIME, "a")])
    content = bytearray(path.read_bytes())
    group = content.index(b"##CG")
    count = group + 24 + 8 * 6 + 8  # behind six links and the record's number: how many records
    assert int.from_bytes(content[count : count + 8], "little") == 200
    content[count : count + 8] = (2**60).to_bytes(8, "little")
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"group 1: found \d+ declared samples; expected no more"):
        read(path)


def test_without_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, [signal(VALUES[0], TIME, "a")])

    def missing(name: str) -> None:
        raise ImportError(f"No module named '{name}'")

    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(InputError, match=r'pip install "sprung\[mdf\]"'):
        MdfFormat().read(path)


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("sound")
    groups = [[signal(VALUES[0], TIME, "a")], [signal(VALUES[1], 2 * TIME, "b")]]
    return {
        version: written(folder, *groups, version=version, compression=compression).read_bytes()
        for version, compression in (("3.30", 0), ("4.10", 0), ("4.20", 1))
    }


# The library's destructor fails where its constructor did; that is told to nobody.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=100, deadline=None
)
@given(version=st.sampled_from(["3.30", "4.10", "4.20"]), spoiling=spoilings())
def test_whatever_happens_to_a_file(tmp_path: Path, sound: dict[str, bytes], version: str, spoiling: Spoiling) -> None:
    path = tmp_path / "x.mf4"
    path.write_bytes(spoiling.of(sound[version]))
    read_or_refused(MdfFormat(), path)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_nothing_is_left_of_damaged_files() -> None:
    gc.collect()
    assert not [o for o in gc.get_objects() if type(o).__name__ == "MDF4" and not hasattr(o, "header")]


def test_what_cannot_be_opened_is_closed_and_forgotten_in_silence(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(tmp_path, [signal(VALUES[0], TIME, "a")])
    content = bytearray(path.read_bytes())
    content[12] = 0xFF  # within the version, which is text: the library gives up before it has read anything
    path.write_bytes(content)
    complaints: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", complaints.append)
    with pytest.raises(InputError):
        MdfFormat().read(path)
    gc.collect()
    assert not complaints
    assert capfd.readouterr().err == ""
