from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from sprung.errors import InputError
from sprung.formats import SampleTable, libraries
from sprung.formats.hdf5 import Hdf5Format
from sprung.formats.mat import MatFormat

if TYPE_CHECKING:
    from pathlib import Path

RANDOM = np.random.default_rng(1)
TIME = 0.1 + np.arange(50) / 3000
A, B = RANDOM.normal(size=(2, 50))
NAMES = np.array(["front", "rear"], dtype=object)


def saved(folder: Path, content: dict[str, Any], **options: Any) -> Path:
    path = folder / "x.mat"
    savemat(path, content, **options)
    return path


def read(path: Path) -> SampleTable:
    assert MatFormat().claims(path, path.read_bytes()[:8192])
    assert not Hdf5Format().claims(path, path.read_bytes()[:8192])
    return MatFormat().read(path)


# The same recording in the ways in which people save it: the second item says the names and units that must come out.
LAYOUTS: dict[str, tuple[dict[str, Any], tuple[str, ...], tuple[str | None, ...]]] = {
    "vectors": ({"t": TIME, "front": A, "rear": B}, ("front", "rear"), (None, None)),
    "struct": ({"s": {"Time": TIME, "front": A, "rear": B, "unit": "g"}}, ("front", "rear"), ("g", "g")),
    "units in one text": ({"s": {"a": A, "time": TIME, "b": B, "units": "s, m/s^2"}}, ("a", "b"), ("m/s^2", "m/s^2")),
    "unit by name": ({"time": TIME, "a": A, "a_unit": "g", "b": B, "units": {"b": "mg"}}, ("a", "b"), ("g", "mg")),
    "matrix": ({"time": TIME, "data": np.array([A, B]).T, "names": NAMES}, ("front", "rear"), (None, None)),
    "flat matrix": ({"time": TIME, "x": np.array([A, B])}, ("x_1", "x_2"), (None, None)),
    "time in the matrix": (
        {"m": np.array([TIME, A, B]).T, "labels": np.array(["time", "a", "b"], dtype=object)},
        ("a", "b"),
        (None, None),
    ),
    "char matrix": (
        {"time": TIME, "d": np.array([A, B]), "names": np.array(["front", "rear "])},
        ("front", "rear"),
        (None, None),
    ),
    "cell of vectors": (
        {"s": {"time": TIME, "data": np.array([A, B, None], dtype=object)[:2], "labels": NAMES}},
        ("front", "rear"),
        (None, None),
    ),
    "timetable as a struct": (
        {"T": {"Time": TIME, "Variables": np.array([A, B]).T,
               "Properties": {"VariableNames": NAMES, "VariableUnits": np.array(["g", "mg"], dtype=object),
                              "DimensionNames": np.array(["Time", "Variables"], dtype=object)}}},
        ("front", "rear"),
        ("g", "mg"),
    ),
    "a struct per channel": (
        {"ch1": {"data": A, "name": "front", "unit": "g", "time": TIME}, "ch2": {"data": B, "name": "rear", "time": TIME}},
        ("front", "rear"),
        ("g", None),
    ),
    "deep": ({"run": {"car": {"axle": {"front": A, "rear": B}, "time_ms": 1000 * TIME}}}, ("front", "rear"), (None, None)),
    "the same name twice": (
        {"time": TIME, "l": {"acc": A}, "r": {"acc": B, "unit": "g"}},
        ("l.acc", "r.acc"),
        (None, "g"),
    ),
    "beside a spectrum": (
        {"time": TIME, "a": A, "b": B, "psd": {"f": np.arange(9.0), "p": np.ones(9), "unit": "g^2/Hz", "dt": 1.0}},
        ("a", "b"),
        (None, None),
    ),
}  # fmt: skip


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("shape", ["row", "column"])
def test_every_layout_gives_the_same_numbers(tmp_path: Path, layout: str, compressed: bool, shape: Any) -> None:
    content, channels, units = LAYOUTS[layout]
    table = read(saved(tmp_path, content, do_compression=compressed, oned_as=shape, long_field_names=True))
    assert table.channels == channels
    assert table.units == units
    np.testing.assert_array_equal(table.take(), [A, B])
    np.testing.assert_allclose(table.time, TIME, rtol=1e-15)


@pytest.mark.parametrize(
    ("rate", "expected"),
    [
        ({"fs": 3000}, 3000),
        ({"Fs": "3 kHz"}, 3000),
        ({"SampleRate": {"value": 3.0, "unit": "kHz"}}, 3000),
        ({"dt": 1 / 512}, 512),
        ({"dt_ms": 2.0}, 500),
        ({"fs": 3000, "spectrum": {"dt": 1.0, "p": np.ones(7)}}, 3000),
    ],
)
def test_a_rate_or_an_interval_is_a_clock(tmp_path: Path, rate: dict[str, Any], expected: float) -> None:
    table = read(saved(tmp_path, {"s": {"a": A, "b": B, **rate}}))
    assert table.clock == expected
    assert table.units == (None, None)
    assert any("samples per second" in note for note in table.notes)


def test_guesses_are_said(tmp_path: Path) -> None:
    table = read(saved(tmp_path, {"x": TIME, "a": A, "z": A + 1j, "short": B[:9]}))
    np.testing.assert_array_equal(table.time, TIME)
    assert table.notes[0].startswith("x is used as the time")
    assert table.notes[1] == "left out: short (9 samples), z: complex numbers"


def test_a_rate_that_contradicts_the_time_is_said(tmp_path: Path) -> None:
    table = read(saved(tmp_path, {"time": TIME, "a": A, "fs": 1000}))
    np.testing.assert_array_equal(table.time, TIME)
    assert table.notes == ("fs states 1000 samples per second, which differs from time",)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"fs": 1000.0, "text": "a"}, "no vectors of numbers"),
        ({"z": A + 1j}, "no vectors of numbers but z: complex numbers"),
        ({"c": np.eye(3)[None] * np.ones((3, 1, 1))}, "an array of 3 dimensions"),
        ({"a": A, "b": B}, "no time among 'a', 'b'"),
        ({"x": TIME, "y": TIME + 1, "a": A}, "no time among"),
        ({"time": TIME}, "only the time"),
        ({"a": A, "fs": 0}, "found 0 Hz; expected a positive number"),
        ({"a": A, "fs": np.nan}, "found nan Hz"),
        ({"p": {"a": A, "fs": 100}, "q": {"b": B, "fs": 200}}, "several rates: p.fs = 100, q.fs = 200"),
        ({"p": {"a": A, "time": TIME}, "q": {"b": B, "time": TIME + 1}}, "two different times, p.time and q.time"),
        ({"time": {"data": TIME, "unit": "min"}, "a": A}, "time: found 'min'; expected a unit of time"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, content: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(saved(tmp_path, content))


def test_version_4_is_read(tmp_path: Path) -> None:
    table = read(saved(tmp_path, {"time": TIME, "a": A}, format="4"))
    np.testing.assert_array_equal(table.take(), [A])


def as_hdf5(value: Any) -> np.ndarray:
    if np.iscomplexobj(value):
        return np.atleast_2d(value).view([("real", float), ("imag", float)])
    return np.atleast_2d(np.asarray(value, dtype=float))


def new_version(path: Path, content: dict[str, Any]) -> Path:
    """Imitate MATLAB 7.3: HDF5 after 512 bytes of header; transposed arrays, text as numbers, cells by reference."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        count = iter(range(1000))

        def write(group: Any, name: str, value: Any) -> Any:
            if isinstance(value, list) and isinstance(value[0], dict):  # an array of structs
                item = group.create_group(name)
                for key in value[0]:
                    refs = [write(file.require_group("#refs#"), f"r{next(count)}", one[key]).ref for one in value]
                    item.create_dataset(key, data=np.array([refs], dtype=h5py.ref_dtype))
                kind = "struct"
            elif isinstance(value, dict):
                item, kind = group.create_group(name), "struct"
                for key, child in value.items():
                    write(item, key, child)
            elif isinstance(value, list):
                refs = [write(file.require_group("#refs#"), f"r{next(count)}", child).ref for child in value]
                item, kind = group.create_dataset(name, data=np.array([refs], dtype=h5py.ref_dtype)), "cell"
            elif isinstance(value, str):
                codes = np.array([[ord(letter)] for letter in value], dtype=np.uint16)
                item, kind = group.create_dataset(name, data=codes), "char"
            else:
                item, kind = group.create_dataset(name, data=as_hdf5(value)), "double"
            item.attrs["MATLAB_class"] = np.bytes_(kind)
            return item

        for name, value in content.items():
            write(file, name, value)
        if "#refs#" in file:
            empty = file["#refs#"].create_dataset("empty", data=np.zeros(2, dtype=np.uint64))
            empty.attrs["MATLAB_class"], empty.attrs["MATLAB_empty"] = np.bytes_("double"), np.uint8(1)
        table = file.create_dataset("tt", data=np.zeros((1, 6), dtype=np.uint32))
        table.attrs["MATLAB_class"], table.attrs["MATLAB_object_decode"] = np.bytes_("timetable"), np.int32(3)
    with path.open("r+b") as raw:
        raw.write(
            b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan  1 00:00:00 2024 HDF5 schema 1.00 .".ljust(
                124
            )
        )
        raw.write(b"\x00\x02IM")
    return path


NEW: dict[str, tuple[dict[str, Any], tuple[str, ...], tuple[str | None, ...]]] = {
    "struct": ({"s": {"time": TIME, "front": A, "rear": B, "units": "s, g"}}, ("front", "rear"), ("g", "g")),
    "matrix": ({"m": np.array([A, B]), "names": ["p", "q"], "unit": ["g", "mg"], "time": TIME}, ("p", "q"), ("g", "mg")),
    "cell": ({"time": TIME[:, None], "data": [A, B[:, None]], "names": ["p", "q"]}, ("p", "q"), (None, None)),
    "array of structs": (
        {"time": TIME, "signals": [{"values": A, "label": "p", "unit": "g"}, {"values": B, "label": "q", "unit": "mg"}]},
        ("p", "q"),
        ("g", "mg"),
    ),
    "complex beside": ({"time": TIME, "a": A, "b": B, "z": A + 1j}, ("a", "b"), (None, None)),
}  # fmt: skip


@pytest.mark.parametrize("layout", NEW)
def test_version_7_3_is_read(tmp_path: Path, layout: str) -> None:
    content, channels, units = NEW[layout]
    table = read(new_version(tmp_path / "x.mat", content))
    assert table.channels == channels
    assert table.units == units
    np.testing.assert_array_equal(table.take(), [A, B])
    np.testing.assert_allclose(table.time, TIME, rtol=1e-15)
    assert any("an object of class timetable, which only MATLAB can read" in note for note in table.notes)


def test_only_objects_are_refused_with_a_way_out(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"tt: an object of class timetable.*seconds\(tt\.Time\)"):
        read(new_version(tmp_path / "x.mat", {}))


def test_version_7_3_without_its_library_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(module: str) -> None:
        raise ImportError(f"No module named '{module}'")

    path = new_version(tmp_path / "x.mat", {"time": TIME, "a": A})
    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(InputError, match=r'x\.mat: .*h5py.*pip install "sprung\[hdf5\]"'):
        read(path)


def test_more_than_the_file_can_hold_is_refused(tmp_path: Path) -> None:
    zeros = {"time": np.arange(8e6), "a": np.zeros(8_000_000)}
    path = saved(tmp_path, {"s": {"a": zeros["a"]}}, do_compression=True)
    assert path.stat().st_size < 1e5 < zeros["a"].nbytes
    with pytest.raises(InputError, match="more than 10 times their size"):
        read(path)


@pytest.mark.shared
def test_a_real_recording(shared: Path) -> None:
    table = read(shared / "data" / "real" / "HammerImpact.mat")
    assert table.channels == ("acc1", "acc2", "acc3")
    assert table.units == ("m/s^2",) * 3
    assert table.take().shape == (3, 65536)
    # From the file's own description: it starts 10 ms before the blow, at 12 800 samples per second.
    assert table.time[0] == pytest.approx(-0.01, abs=1e-12)
    assert np.diff(table.time).mean() == pytest.approx(1 / 12800, rel=1e-9)


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=150, deadline=None
)
@given(data=st.data(), version=st.sampled_from(["4", "5", "7", "7.3"]))
@pytest.mark.slow
def test_damage_is_refused_or_harmless(tmp_path: Path, data: st.DataObject, version: str) -> None:
    path = tmp_path / "x.mat"
    content: dict[str, Any] = {"time": TIME, "a": A}
    if version != "4":
        content = {"s": {**content, "unit": "g", "c": ["p", "q"]}}
    if version == "7.3":
        new_version(path, content)
    else:
        savemat(path, content, format="4" if version == "4" else "5", do_compression=version == "7")
    raw = bytearray(path.read_bytes())
    if version != "7.3":  # over some bytes changed within, the HDF5 library ends the process, where Python cannot help
        for place in data.draw(st.lists(st.integers(0, len(raw) - 1), max_size=6)):
            raw[place] = data.draw(st.integers(0, 255))
    path.write_bytes(raw[: data.draw(st.integers(0, len(raw)) | st.just(len(raw)))])
    try:
        table = MatFormat().read(path)
        values = table.take()
    except InputError as error:
        assert all(problem.where.startswith("x.mat") for problem in error.problems)  # noqa: PT017
    else:
        assert values.shape == (len(table.channels), len(table.time))


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_a_cut_file_is_refused(tmp_path: Path, version: str) -> None:
    content = {"time": TIME, "a": A}
    path = saved(tmp_path, content) if version == "5" else new_version(tmp_path / "x.mat", content)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InputError, match=r"x\.mat: found a damaged file .*; expected a MATLAB file of vectors"):
        read(path)


@pytest.mark.parametrize(
    ("name", "head", "claimed"),
    [
        ("x.mat", b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM", True),
        ("x.MAT", b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM", True),
        ("x.mat", b"\x89HDF\r\n\x1a\n" + bytes(200), False),
        ("x.mat", b"# Created by Octave 8.4, in text", False),
        ("x.csv", b"MATLAB 5.0 MAT-file", False),
        ("x.mat", b"", False),
    ],
)
def test_claims(tmp_path: Path, name: str, head: bytes, claimed: bool) -> None:
    assert MatFormat().claims(tmp_path / name, head) is claimed


def test_big_endian_files_are_read(tmp_path: Path) -> None:
    def element(kind: int, values: bytes) -> bytes:
        return struct.pack(">II", kind, len(values)) + values + bytes(-len(values) % 8)

    def variable(name: bytes, numbers: np.ndarray) -> bytes:
        flags, sides = struct.pack(">II", 6, 0), struct.pack(">ii", 1, len(numbers))
        parts = element(6, flags) + element(5, sides) + element(1, name) + element(9, numbers.astype(">f8").tobytes())
        return element(14, parts)

    path = tmp_path / "x.mat"
    header = b"MATLAB 5.0 MAT-file, Platform: SOL2".ljust(124) + b"\1\0MI"
    path.write_bytes(header + variable(b"time", TIME) + variable(b"a", A))
    table = read(path)
    np.testing.assert_array_equal(table.take(), [A])
    np.testing.assert_array_equal(table.time, TIME)


def header_of_4(sort: int, rows: int, columns: int, name: bytes = b"a\0") -> bytes:
    return struct.pack("<5i", sort, rows, columns, 0, len(name)) + name


@pytest.mark.parametrize(
    "content",
    [
        header_of_4(0, 2**31 - 1, 1) + bytes(16),  # SciPy's reader makes room for all of them first
        header_of_4(0, -2, 3) + bytes(48),
        header_of_4(70, 2, 1) + bytes(16),
        header_of_4(0, 2, 1)[:13],
    ],
)
def test_version_4_that_declares_what_it_does_not_hold(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.mat"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"x\.mat: found a damaged file"):
        MatFormat().read(path)


def test_version_4_of_any_numbers_words_and_byte_order(tmp_path: Path) -> None:
    path = tmp_path / "x.mat"
    whole = header_of_4(30, len(TIME), 1) + np.arange(len(TIME), dtype="<i2").tobytes()
    words = header_of_4(51, 1, 1, b"unit\0") + b"g"
    time = header_of_4(0, 1, len(TIME), b"time\0") + TIME.tobytes()
    path.write_bytes(words + whole + time)
    table = read(path)
    assert (table.channels, table.units) == (("a",), ("g",))
    np.testing.assert_array_equal(table.take(), [np.arange(len(TIME))])
    big = (
        struct.pack(">5i", 1000, len(TIME), 1, 0, 2) + b"a\0",
        struct.pack(">5i", 1000, len(TIME), 1, 0, 5) + b"time\0",
    )
    path.write_bytes(big[0] + A.astype(">f8").tobytes() + big[1] + TIME.astype(">f8").tobytes())
    np.testing.assert_array_equal(read(path).take(), [A])
