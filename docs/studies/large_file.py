"""How much memory and time does it take to read eight channels of a file with 200? Writes such files, reads, deletes.

Run with `python docs/studies/large_file.py --megabytes 2000 --formats hdf5 tdms`. Every file is read in a process of its
own, whose peak of resident memory counts; a process that reads nothing is the first line. Needs as much space on the
disk as one file takes.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
import wave
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.formats import read_table

Real = NDArray[np.float64]

CHANNELS, WANTED, RATE = 200, 8, 2000
PIECE = 4096
NAMES = [f"a{index:03}" for index in range(CHANNELS)]


def pieces(samples: int) -> Iterator[Real]:
    """Make accelerations in g piece by piece; shape (channel, time)."""
    random = np.random.default_rng(1)
    for first in range(0, samples, PIECE):
        yield 1 + 0.1 * random.normal(size=(CHANNELS, min(PIECE, samples - first)))


def csv(path: Path, samples: int) -> None:
    """Write text, some 7 bytes per sample."""
    texts = np.array([f"{level / 10000:.4f}" for level in range(20001)])
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(["time", *(f"{name} [g]" for name in NAMES)]) + "\n")
        line = 0
        for piece in pieces(samples):
            for row in texts[np.clip(1e4 * piece, 0, 20000).astype(int)].T.tolist():
                file.write(f"{line / RATE:.4f},{','.join(row)}\n")
                line += 1


def hdf5(path: Path, samples: int) -> None:
    """Write doubles, a dataset for every channel."""
    h5py: Any = import_module("h5py")
    with h5py.File(path, "w") as file:
        file["fs"] = float(RATE)
        sets = [file.create_dataset(name, (samples,), "f8", chunks=(min(PIECE, samples),)) for name in NAMES]
        for number, piece in enumerate(pieces(samples)):
            for dataset, row in zip(sets, piece, strict=True):
                dataset[number * PIECE : number * PIECE + len(row)] = row


def tdms(path: Path, samples: int) -> None:
    """Write doubles, a segment for every piece."""
    nptdms: Any = import_module("nptdms")
    even = {"wf_increment": 1 / RATE, "unit_string": "g"}
    with nptdms.TdmsWriter(str(path)) as writer:
        for number, piece in enumerate(pieces(samples)):
            first = even if not number else None
            writer.write_segment(
                [nptdms.ChannelObject("log", name, row, first) for name, row in zip(NAMES, piece, strict=True)]
            )


def mf4(path: Path, samples: int) -> None:
    """Write doubles in records; the writing itself takes as much memory as the file."""
    asammdf: Any = import_module("asammdf")
    values = np.concatenate(list(pieces(samples)), axis=1)
    time_ = np.arange(samples) / RATE
    with asammdf.MDF(version="4.10") as file:
        signals = [asammdf.Signal(row, time_, name=name, unit="g") for name, row in zip(NAMES, values, strict=True)]
        file.append(signals, common_timebase=True)
        file.save(path, overwrite=True)


def parquet(path: Path, samples: int) -> None:
    """Write doubles, a group of rows for every piece."""
    pa: Any = import_module("pyarrow")
    pq: Any = import_module("pyarrow.parquet")
    schema = pa.schema([(name, pa.float64()) for name in NAMES], {"fs": str(RATE)})
    with pq.ParquetWriter(path, schema) as writer:
        for piece in pieces(samples):
            writer.write_table(pa.table(list(piece), schema=schema))


def rpc(path: Path, samples: int) -> None:
    """Write integers of 16 bits in groups."""
    groups = -(-samples // PIECE)
    keys = {"FORMAT": "BINARY_IEEE_LITTLE_END", "NUM_HEADER_BLOCKS": "256", "NUM_PARAMS": f"{10 + 3 * CHANNELS}"}
    keys |= {"FILE_TYPE": "TIME_HISTORY", "DATA_TYPE": "SHORT_INTEGER", "CHANNELS": f"{CHANNELS}"}
    keys |= {
        "DELTA_T": f"{1 / RATE:E}",
        "PTS_PER_FRAME": f"{PIECE}",
        "PTS_PER_GROUP": f"{PIECE}",
        "FRAMES": f"{groups}",
    }
    for number, name in enumerate(NAMES, 1):
        keys |= {f"DESC.CHAN_{number}": name, f"UNITS.CHAN_{number}": "g", f"SCALE.CHAN_{number}": "1E-4"}
    with path.open("wb") as file:
        file.write(
            b"".join(f"{key:\0<32}{value:\0<96}".encode() for key, value in keys.items()).ljust(256 * 512, b"\0")
        )
        for piece in pieces(groups * PIECE):
            file.write((1e4 * piece).astype("<i2").tobytes())


def wav(path: Path, samples: int) -> None:
    """Write integers of 16 bits, the samples of all channels side by side."""
    with wave.open(str(path), "wb") as file:
        file.setnchannels(CHANNELS)
        file.setsampwidth(2)
        file.setframerate(RATE)
        for piece in pieces(samples):
            file.writeframes((1e4 * piece).astype("<i2").T.tobytes())


FORMATS: dict[str, tuple[Callable[[Path, int], None], int]] = {
    "csv": (csv, 7),
    "hdf5": (hdf5, 8),
    "mf4": (mf4, 8),
    "parquet": (parquet, 8),
    "rpc": (rpc, 2),
    "tdms": (tdms, 8),
    "wav": (wav, 2),
}
"""What writes a format, and how many bytes it takes per sample."""


def read(path: Path | None, how: str) -> None:
    """Read a file in this process, and say how long it took and how much memory the process ever had."""
    begin = time.perf_counter()
    if path is not None:
        table = read_table(path)
        columns = np.linspace(0, len(table.channels) - 1, WANTED).astype(int).tolist()
        if how == "take":
            assert np.isfinite(table.take(columns)).all()  # noqa: S101
        else:
            wanted = None if how == "all pieces" else columns
            total = sum(piece.shape[1] for _, piece in table.pieces(wanted))
            assert total == table.samples  # noqa: S101
    seconds = time.perf_counter() - begin
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    sys.stdout.write(f"{peak / 1e6:8.0f} MB {seconds:8.1f} s\n")


def main() -> None:
    """Take the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--megabytes", type=float, default=200)
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=["hdf5", "tdms", "csv"])
    parser.add_argument("--folder", type=Path, help="where the files are written; a temporary folder if not given")
    parser.add_argument("--read", nargs="*", help=argparse.SUPPRESS)
    parser.add_argument("--write", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.read is not None:
        read(Path(given.read[1]) if len(given.read) > 1 else None, given.read[0] if given.read else "")
    elif given.write is not None:
        write, size = FORMATS[given.formats[0]]
        write(given.write, int(given.megabytes * 1e6 / (CHANNELS * size)))
    else:
        run(given.megabytes, given.formats, given.folder)


def run(megabytes: float, formats: list[str], folder: Path | None) -> None:
    """Write and read each format; in processes of their own, as one is born with its parent's peak of memory."""

    def own(*given: str) -> str:
        return subprocess.run([sys.executable, __file__, *given], check=True, capture_output=True, text=True).stdout  # noqa: S603

    sys.stdout.write(f"{'nothing read':36}{own('--read')}")
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        for name in formats:
            path = Path(temporary) / f"x.{'h5' if name == 'hdf5' else name}"
            own("--write", str(path), "--formats", name, "--megabytes", f"{megabytes}")
            for how in ("take", "pieces", "all pieces"):
                what = f"{name}, {path.stat().st_size / 1e6:.0f} MB, {how}"
                sys.stdout.write(f"{what:36}{own('--read', how, str(path))}")
                sys.stdout.flush()
            path.unlink()


if __name__ == "__main__":
    main()
