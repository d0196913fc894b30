from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sprung.errors import InputError
from sprung.formats import SampleTable, libraries
from sprung.formats.hdf5 import Hdf5Format

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

h5py = pytest.importorskip("h5py")

RANDOM = np.random.default_rng(2)
TIME = -0.5 + np.arange(60) / 700
A, B = RANDOM.normal(size=(2, 60))


def written(folder: Path, write: Callable[[Any], object], **options: Any) -> Path:
    path = folder / "x.h5"
    with h5py.File(path, "w", **options) as file:
        write(file)
    return path


def read(path: Path) -> SampleTable:
    assert Hdf5Format().claims(path, path.read_bytes()[:8192])
    return Hdf5Format().read(path)


def plain(file: Any) -> None:
    file["time"], file["front"], file["rear"] = TIME, A, B
    file["front"].attrs["unit"], file["rear"].attrs["Units"] = "g", np.bytes_("mg")


def grouped(file: Any) -> None:
    file["run/clock/t"], file["run/acc/front"], file["run/acc/rear"] = 1e3 * TIME, A, B
    file["run/clock/t"].attrs["unit"] = "ms"
    file["run/acc"].attrs["units"] = ["g", "mg"]


def named(file: Any) -> None:
    file["time"], file["ch0"], file["ch1"] = TIME, A, B
    for dataset, name, unit in (("ch0", "front", "g"), ("ch1", "rear", "mg")):
        file[dataset].attrs.update(name=name, unit=unit, gain=1.5)


def matrix(file: Any) -> None:
    file.create_dataset("data", data=np.array([TIME, A, B]), compression="gzip", chunks=(1, 60))
    file["names"] = ["time", "front", "rear"]
    file["data"].attrs["units"] = "s, g, mg"


def table(file: Any) -> None:
    file["table"] = np.array(
        list(zip(TIME, A, B, strict=True)), dtype=[("time", float), ("front [g]", float), ("rear [mg]", float)]
    )


@pytest.mark.parametrize("write", [plain, grouped, named, matrix, table])
@pytest.mark.parametrize("block", [0, 512])
def test_every_layout_gives_the_same_numbers(tmp_path: Path, write: Callable[[Any], None], block: int) -> None:
    result = read(written(tmp_path, write, userblock_size=block))
    assert result.channels == ("front", "rear")
    assert result.units == ("g", "mg")
    np.testing.assert_array_equal(result.take(), [A, B])
    np.testing.assert_allclose(result.time, TIME, rtol=1e-15, atol=1e-16)


@pytest.mark.parametrize("name", ["fs", "sampling_rate", "SampleRate", "dt"])
@pytest.mark.parametrize("where", ["/", "acc", "acc/front"])
def test_a_rate_among_the_attributes_is_a_clock(tmp_path: Path, name: str, where: str) -> None:
    def write(file: Any) -> None:
        file["acc/front"] = A
        file[where].attrs[name] = 1 / 800 if name == "dt" else 800

    result = read(written(tmp_path, write))
    assert result.clock == pytest.approx(800, rel=1e-15)
    assert result.channels == ("front",)


def test_nothing_outside_of_the_file_is_read(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["secret"] = B
        other.create_group("inner")["secret"] = B
    (tmp_path / "secret.txt").write_text("what nobody else may read")

    def write(file: Any) -> None:
        file["time"], file["a"] = TIME, A
        file["link"] = h5py.ExternalLink("other.h5", "secret")
        layout = h5py.VirtualLayout(shape=(60,), dtype=float)
        layout[:] = h5py.VirtualSource("other.h5", "secret", shape=(60,))
        file.create_virtual_dataset("virtual", layout)
        file["ext"] = h5py.ExternalLink("other.h5", "inner")
        file["through"] = h5py.SoftLink("/ext/secret")
        file.create_dataset("unit", shape=(1,), dtype="S25", external=[(str(tmp_path / "secret.txt"), 0, 25)])
        file["circle"] = file["/"]
        file["gone"] = h5py.SoftLink("/nowhere")

    result = read(written(tmp_path, write))
    assert "link: a link to another file" in result.notes[-1]
    assert "virtual: data in another file" in result.notes[-1]
    assert "through: a link to another file" in result.notes[-1]
    assert "unit: data in another file" in result.notes[-1]
    assert "nobody" not in str(result)
    assert result.channels == ("a",)


def test_more_than_the_file_can_hold_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, lambda file: file.create_dataset("a", (10_000_000,), float, chunks=True))
    assert path.stat().st_size < 1e5  # it declares 80 MB, of which none were written
    with pytest.raises(InputError, match="more than 10 times their size"):
        read(path)


def test_text_only_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"x\.h5: found no vectors of numbers; expected a time"):
        read(written(tmp_path, lambda file: file.create_dataset("note", data="hello")))


def test_without_its_library_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(module: str) -> None:
        raise ImportError(f"No module named '{module}'")

    path = written(tmp_path, plain)
    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(InputError, match=r'h5py.*not installed.*pip install "sprung\[hdf5\]"'):
        read(path)


@pytest.mark.parametrize(
    ("name", "head", "claimed"),
    [
        ("x.h5", b"\x89HDF\r\n\x1a\n", True),
        ("x.HDF5", b"\0" * 512 + b"\x89HDF\r\n\x1a\n", True),
        ("x.mat", b"\x89HDF\r\n\x1a\n", True),
        ("x.mat", b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n", False),
        ("x.csv", b"\x89HDF\r\n\x1a\n", False),
        ("x.h5", b"", False),
    ],
)
def test_claims(tmp_path: Path, name: str, head: bytes, claimed: bool) -> None:
    assert Hdf5Format().claims(tmp_path / name, head) is claimed


def test_attributes_of_any_kind_are_borne(tmp_path: Path) -> None:
    def write(file: Any) -> None:
        plain(file)
        file.attrs["empty"] = h5py.Empty("f8")
        file["front"].attrs.update(matrix=np.eye(3), none=h5py.Empty("S4"), reference=file["time"].ref, flag=True)

    assert read(written(tmp_path, write)).units == ("g", "mg")


# Bytes changed within are not tried: some of them end the process inside the HDF5 library, where Python cannot help.
@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=60, deadline=None
)
@given(kept=st.floats(0, 1, exclude_max=True), write=st.sampled_from([plain, grouped, matrix]))
def test_a_cut_file_is_refused(tmp_path: Path, kept: float, write: Callable[[Any], None]) -> None:
    path = written(tmp_path, write)
    raw = path.read_bytes()
    path.write_bytes(raw[: int(kept * len(raw))])
    with pytest.raises(InputError, match=r"x\.h5: found a damaged file .*; expected an HDF5 file"):
        Hdf5Format().read(path)


@pytest.mark.parametrize("rate", [1e300, 1e-300, 0.0, -500.0, np.nan])
def test_a_rate_that_no_logger_has(tmp_path: Path, rate: float) -> None:
    def write(file: Any) -> None:
        file["a"], file.attrs["fs"] = A, rate

    with pytest.raises(InputError, match=r"x\.h5: fs: found .* Hz; expected a positive number"):
        read(written(tmp_path, write))
