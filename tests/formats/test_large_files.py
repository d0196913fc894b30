"""Of a file with many channels, only what is asked for is read: some columns, a range, or piece by piece."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.io import savemat, wavfile

from sprung.formats import SampleTable, read_table, text_samples
from sprung.formats import csv as csv_format
from sprung.formats.sample_store import BUDGET, Samples, join_samples, regroup, store_by_ranges, store_in_memory
from sprung.formats.text_blocks import detect_encoding, read_blocks

Write = Callable[[Path, NDArray[np.float64]], Path]
CHANNELS, SAMPLES = 200, 8192
WANTED = [3, 50, 51, 52, 120, 170, 199, 7]
VALUES = np.random.default_rng(8).integers(-999, 999, size=(CHANNELS, SAMPLES)) / 8.0  # exact in any format
NAMES = [f"a{index}" for index in range(CHANNELS)]


def written(values: NDArray[np.float64]) -> list[list[str]]:
    eighths = np.array([f"{eighth / 8:.3f}" for eighth in range(-999, 999)])
    texts: list[list[str]] = eighths[(8 * values).astype(int) + 999].tolist()
    return texts


def csv(folder: Path, values: NDArray[np.float64]) -> Path:
    rows = [",".join(row) for row in written(values.T)]
    lines = [f"{index / 1000:.3f},{row}" for index, row in enumerate(rows)]
    (folder / "x.csv").write_text("\n".join([",".join(["time", *NAMES]), *lines, ""]))
    return folder / "x.csv"


def wav(folder: Path, values: NDArray[np.float64]) -> Path:
    wavfile.write(folder / "x.wav", 1000, values.T.astype(np.float32))
    return folder / "x.wav"


def rpc(folder: Path, values: NDArray[np.float64]) -> Path:
    keys = {"FORMAT": "BINARY_IEEE_LITTLE_END", "NUM_HEADER_BLOCKS": "64", "NUM_PARAMS": f"{10 + CHANNELS}"}
    keys |= {"FILE_TYPE": "TIME_HISTORY", "DATA_TYPE": "FLOATING_POINT", "CHANNELS": f"{CHANNELS}", "DELTA_T": "1E-3"}
    keys |= {"PTS_PER_FRAME": "512", "PTS_PER_GROUP": "512", "FRAMES": f"{values.shape[1] // 512}"}
    keys |= {f"DESC.CHAN_{index}": name for index, name in enumerate(NAMES, 1)}
    header = b"".join(f"{key:\0<32}{value:\0<96}".encode() for key, value in keys.items()).ljust(64 * 512, b"\0")
    groups = values.reshape(CHANNELS, -1, 512).swapaxes(0, 1)
    (folder / "x.rsp").write_bytes(header + groups.astype("<f4").tobytes())
    return folder / "x.rsp"


def hdf5(folder: Path, values: NDArray[np.float64]) -> Path:
    with pytest.importorskip("h5py").File(folder / "x.h5", "w") as file:
        file["time"] = np.arange(values.shape[1]) / 1000
        for name, row in zip(NAMES, values, strict=True):
            file.create_dataset(name, data=row, chunks=(1000,), compression="gzip", compression_opts=1)
    return folder / "x.h5"


def hdf5_of_rows(folder: Path, values: NDArray[np.float64]) -> Path:
    with pytest.importorskip("h5py").File(folder / "x.h5", "w") as file:
        file["names"], file["fs"] = NAMES, 1000.0
        file.create_dataset("data", data=values.T)
    return folder / "x.h5"


def hdf5_of_columns(folder: Path, values: NDArray[np.float64]) -> Path:
    with pytest.importorskip("h5py").File(folder / "x.h5", "w") as file:
        file["names"], file["fs"] = NAMES, 1000.0
        file.create_dataset("data", data=values)
    return folder / "x.h5"


def mat(folder: Path, values: NDArray[np.float64]) -> Path:
    savemat(folder / "x.mat", {"fs": 1000.0, **dict(zip(NAMES, values, strict=True))})
    return folder / "x.mat"


def mat_of_rows(folder: Path, values: NDArray[np.float64]) -> Path:
    savemat(folder / "x.mat", {"fs": 1000.0, "names": np.array(NAMES, dtype=object), "data": values})
    return folder / "x.mat"


def mat_compressed(folder: Path, values: NDArray[np.float64]) -> Path:
    savemat(folder / "x.mat", {"s": {"fs": 1000.0, **dict(zip(NAMES, values, strict=True))}}, do_compression=True)
    return folder / "x.mat"


def tdms(folder: Path, values: NDArray[np.float64]) -> Path:
    nptdms = pytest.importorskip("nptdms")
    even = {"wf_increment": 0.001}
    with nptdms.TdmsWriter(str(folder / "x.tdms")) as writer:
        for part in np.array_split(values, 4, axis=1):
            writer.write_segment(
                [nptdms.ChannelObject("one", n, row, properties=even) for n, row in zip(NAMES, part, strict=True)]
            )
    return folder / "x.tdms"


def mdf(folder: Path, values: NDArray[np.float64]) -> Path:
    asammdf = pytest.importorskip("asammdf")
    time = np.arange(values.shape[1]) / 1000
    with asammdf.MDF(version="4.10") as measurement:
        signals = [asammdf.Signal(row, time, name=name, unit="g") for name, row in zip(NAMES, values, strict=True)]
        measurement.append(signals, common_timebase=True)
        measurement.save(folder / "x.mf4", overwrite=True)
    return folder / "x.mf4"


def parquet(folder: Path, values: NDArray[np.float64]) -> Path:
    arrow, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    table = arrow.table({"time": np.arange(values.shape[1]) / 1000, **dict(zip(NAMES, values, strict=True))})
    pq.write_table(table, folder / "x.parquet", row_group_size=3000)
    return folder / "x.parquet"


def iso_mme(folder: Path, values: NDArray[np.float64]) -> Path:
    for number, row in enumerate(values, 1):
        [cells] = ["\n".join(cells) for cells in written(row[None])]
        head = f"Name of the channel :a{number - 1}\nSampling interval :0.001\n"
        (folder / f"x.{number:03}").write_text(f"{head}{cells}\n")
    (folder / "x.mme").write_text("Data format edition number :1.6\n")
    return folder / "x.mme"


def uff(folder: Path, values: NDArray[np.float64]) -> Path:
    """Write data sets 58 in binary by their description: the library takes a second for each."""
    sets = []
    for number, row in enumerate(values):
        text = [f"a{number}", "NONE", "NONE", "NONE", "NONE"]
        text += [f"{1:5}{0:10}{0:5}{0:10} {'NONE':10}{1:10}{3:4} {'NONE':10}{0:10}{0:4}"]
        text += [f"{4:10}{len(row):10}{1:10}{0:13.5e}{1e-3:13.5e}{0:13.5e}"]
        text += [f"{kind:10}{0:5}{0:5}{0:5} {'NONE':20} {'NONE':20}" for kind in (17, 12, 0, 0)]
        lines = "".join(f"{line:80}\n" for line in text)
        head = f"    -1\n    58b{1:6}{2:6}{11:12}{8 * len(row):12}{0:6}{0:6}{0:12}{0:12}\n"
        sets.append(head.encode() + lines.encode() + row.astype("<f8").tobytes() + b"\n    -1\n")
    (folder / "x.uff").write_bytes(b"".join(sets))
    pytest.importorskip("pyuff")
    return folder / "x.uff"


def lvm(folder: Path, values: NDArray[np.float64]) -> Path:
    head = ["LabVIEW Measurement", "Writer_Version\t2", "Separator\tTab", "***End_of_Header***"]
    steps = "\t".join(["Delta_X", *["0.001"] * CHANNELS])
    head += [f"Channels\t{CHANNELS}", steps, "***End_of_Header***", "\t".join(["X_Value", *NAMES, "Comment"])]
    rows = [f"{index / 1000:.3f}\t" + "\t".join(row) for index, row in enumerate(written(values.T))]
    (folder / "x.lvm").write_text("\n".join([*head, *rows, ""]))
    return folder / "x.lvm"


WRITERS: list[Write] = [csv, wav, rpc, hdf5, hdf5_of_rows, hdf5_of_columns, mat, mat_of_rows, mat_compressed]
WRITERS += [tdms, mdf, parquet, iso_mme, uff, lvm]


@pytest.fixture(scope="module", params=WRITERS, ids=lambda write: write.__name__)
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    write: Write = request.param
    found = write(tmp_path_factory.mktemp(write.__name__), VALUES)
    read_table(found)  # so that what its library loads is not counted below
    return found


def in_order(table: SampleTable, names: list[str]) -> list[int]:
    called = [f"ch{int(name[1:]) + 1}" for name in names] if table.channels[0] == "ch1" else names
    return [table.channels.index(name) for name in called]


@pytest.mark.slow
def test_eight_channels_of_many_take_little_memory(path: Path) -> None:
    wanted = [NAMES[column] for column in WANTED]
    tracemalloc.start()
    table = read_table(path)
    values = table.take(in_order(table, wanted))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    np.testing.assert_array_equal(values, VALUES[WANTED])
    assert values.nbytes < 1e6 < VALUES.nbytes / 10
    # Two libraries read more than they are asked for: one the whole file, one fragments of a fixed size.
    more = {".uff": path.stat().st_size, ".mf4": 24e6}.get(path.suffix, 0)
    assert peak < 4 * values.nbytes + 8e6 + more


@pytest.mark.slow
def test_pieces_and_ranges_are_parts_of_the_whole(path: Path) -> None:
    table = read_table(path)
    columns = in_order(table, [NAMES[column] for column in WANTED])
    assert table.samples == SAMPLES
    np.testing.assert_array_equal(table.take(columns, 4999, 5001), VALUES[WANTED, 4999:5001])
    np.testing.assert_array_equal(table.take(columns[::-1], 8190), VALUES[WANTED[::-1], 8190:])
    assert table.take(columns, 77, 77).shape == (8, 0)
    assert table.take([]).shape == (0, SAMPLES)
    firsts, pieces = zip(*table.pieces(columns, 1000), strict=True)
    assert list(firsts) == list(range(0, SAMPLES, 1000))
    np.testing.assert_array_equal(np.hstack(pieces), VALUES[WANTED])
    later = table.part(3000, 6000).part(10, 2000)
    np.testing.assert_array_equal(later.take(columns), VALUES[WANTED, 3010:5000])
    np.testing.assert_allclose(later.time, table.time[3010:5000], rtol=1e-15)
    assert later.place(0) == table.place(3010)


@pytest.mark.parametrize("step", [1, 2, 3, 7, 100])
def test_steps_cut_and_join(step: int) -> None:
    values = np.arange(46.0).reshape(2, 23)
    pieces = np.split(values, [0, 1, 1, 5, 6, 20], axis=1)
    found = list(regroup(pieces, step))
    np.testing.assert_array_equal(np.hstack(found), values)
    assert all(piece.shape[1] == step for piece in found[:-1])
    assert 1 <= found[-1].shape[1] <= step


def test_columns_of_several_stores_are_one() -> None:
    first, second = store_in_memory(np.arange(12.0).reshape(3, 4)), store_in_memory(np.arange(20, 24)[None])
    whole = join_samples([Samples(first, 2), Samples(second, 0), Samples(first, 0)])
    [values] = whole.read([2, 1, 0, 1], 1, 3, 5)
    np.testing.assert_array_equal(values, [[1, 2], [21, 22], [9, 10], [21, 22]])


def test_pieces_read_no_more_at_once_than_is_worth_it() -> None:
    asked: list[int] = []

    def get(columns: list[int], first: int, last: int) -> NDArray[np.float64]:
        asked.append(8 * len(columns) * (last - first))
        return np.zeros((len(columns), last - first))

    table = SampleTable(("a",) * 100, (None,) * 100, store_by_ranges(100, 10**6, get), 1000.0)  # type: ignore[arg-type]
    assert sum(piece.shape[1] for _, piece in table.pieces(samples=4096)) == 10**6
    assert max(asked) <= BUDGET < 0.1 * sum(asked)


@pytest.mark.slow
def test_text_far_down_is_found_where_somebody_needs_the_column(tmp_path: Path) -> None:
    rows = [f"{index / 1000:.3f},{index},{index}.5" for index in range(250_000)]
    rows[200_000] = "200.000,OVLD,1.5"
    rows[200_001] = "200.001,,oops"
    rows.insert(150_000, "")
    path = tmp_path / "x.csv"
    path.write_text("\n".join(["Logger 7", "", "time,a,b", *rows, ""]))
    assert path.stat().st_size > 1 << 22  # it is not read at once
    table = read_table(path)
    a, b = table.take()
    assert np.flatnonzero(np.isnan(a)).tolist() == [200_000, 200_001]
    assert np.flatnonzero(np.isnan(b)).tolist() == [200_001]
    assert table.place(200_000) == "line 200005"
    assert str(table.find_non_number(0)).startswith("x.csv: line 200005, column 'a': found 'OVLD'; expected a number.")
    assert table.find_non_number(0, 200_001) is None
    assert table.part(200_000, 200_002).find_non_number(1) == table.find_non_number(1)
    np.testing.assert_array_equal(table.take([1], 123_456, 123_459), [[123456.5, 123457.5, 123458.5]])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be", "cp1252", "latin-1"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("last", [[""], ["end"], ["", ""]])
def test_blocks_are_whole_lines(tmp_path: Path, encoding: str, line_end: str, last: list[str]) -> None:
    # In UTF-16, two of these hold the byte of a line feed; 0x81 is a letter in the Latin alphabet only.
    letters = {"cp1252": "Stoß", "latin-1": "\x81Stoß"}.get(encoding, "Stoß Ċ ऊ €")
    lines = [letters, "", "a" * 40, *[f"{index};1,5" for index in range(50)], *last]
    path = tmp_path / "x.csv"
    mark = b"\xfe\xff" if encoding == "utf-16-be" else b""
    path.write_bytes(mark + line_end.join(lines).encode(encoding))
    expected = lines if lines[-1] else lines[:-1]
    recognised = detect_encoding(path)
    for size in (1, 2, 3, 5, 8, 64, 1000):
        found = list(read_blocks(path, recognised, size=size))
        assert [line for block in found for line in block.lines] == expected
        for index, block in enumerate(found[:4]):
            rest = [line for block in found[index:] for line in block.lines]
            assert [line for block in read_blocks(path, recognised, block.start) for line in block.lines] == rest
    assert len(list(read_blocks(path, recognised, size=64))) > 4


@pytest.mark.parametrize("blank", ["", "\n", "\n;;\n \n\n", 60 * "\n"])
def test_a_text_table_in_many_blocks_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, blank: str) -> None:
    lines = [
        f"10:00:{index / 50:06.3f};{index},5;{'on' if index in (3, 90) else index}{blank * (index % 7 == 0)}"
        for index in range(200)
    ]
    path = tmp_path / "x.csv"
    path.write_text("\n".join(["Logger 7", "Zeit;a;b", *lines, f"10:00:04.000;2{blank}"]))
    whole = read_table(path)
    monkeypatch.setattr(text_samples, "_SMALL", 0)
    for module in (csv_format, text_samples):
        monkeypatch.setattr(module, "read_blocks", partial(read_blocks, size=300))
    table = read_table(path)
    assert table.notes == whole.notes
    assert any(note.endswith("is cut short and was left out") for note in table.notes)
    assert [table.place(sample) for sample in range(200)] == [whole.place(sample) for sample in range(200)]
    assert [table.find_non_number(column) for column in range(2)] == [
        whole.find_non_number(column) for column in range(2)
    ]
    assert "(the first of 2 such cells)" in str(table.find_non_number(1))
    np.testing.assert_array_equal(table.time, whole.time)
    np.testing.assert_array_equal(table.take(), whole.take())
    np.testing.assert_array_equal(table.take([1, 0], 40, 161), whole.take([1, 0])[:, 40:161])
    np.testing.assert_array_equal(np.hstack([piece for _, piece in table.pieces(samples=33)]), whole.take())
