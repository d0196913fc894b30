"""Everything that reads, what sound files it is given, and what it owes to any file at all."""

from __future__ import annotations

import signal
import tracemalloc
import unicodedata
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType
from typing import Any

import numpy as np
from car import CAR
from every_format import (
    Signals,
    csv,
    hdf5,
    hdf5_packed,
    iso_mme,
    lvm,
    mat5,
    mat73,
    mdf4,
    parquet,
    rpc,
    tdms,
    timetable_of,
    uff,
    wav,
    wav24,
)
from scipy.io import savemat

from sprung.campaign import read, read_vehicle
from sprung.campaign.signals import find_column, make_recording
from sprung.errors import InputError
from sprung.formats import SampleTable, from_sep005, read_table
from sprung.formats.reading_errors import memory_limit
from sprung.vehicle import Sensor

LONGEST = 5.0
"""s that reading a small file may take."""


class Broken(Exception):  # noqa: N818 (it is the finding, not an error of this program)
    """A reader did what it must not do with any file."""


class TooLong(BaseException):
    """A reader did not come back."""


@dataclass(frozen=True)
class Reader:
    """Something that reads files.

    Attributes
    ----------
    files
        Writes sound ones into an empty folder.
    needs
        Libraries that read its files; whose Python code is followed too.
    name
        What to call a spoilt file.
    lay
        Puts what else belongs to the file into its folder, and gives the path to read.
    use
        Reads it, and does with it what is done with any.
    apart
        Whether it may end the process, so that it is only to be tried in one of its own.
    """

    files: Callable[[Path], Sequence[bytes]]
    name: str
    needs: tuple[str, ...] = ()
    lay: Callable[[Path], Path] = lambda path: path
    use: Callable[[Path], object] = lambda path: used(read_table(path), path.name)
    apart: bool = False

    @property
    def missing(self) -> tuple[str, ...]:
        """Those of its libraries that are not installed."""
        return tuple(one for one in self.needs if find_spec(one) is None)


def used(table: SampleTable, name: str) -> None:
    """Do with a table what is done with any; however it is read, it holds the same numbers."""
    values = table.take()
    if values.shape != (len(table.channels), table.samples) or table.time.shape != (table.samples,):
        raise Broken(f"{values.shape} numbers of {len(table.channels)} channels, {table.samples} samples")
    if len(table.units) != len(table.channels):
        raise Broken(f"{len(table.units)} units of {len(table.channels)} channels")
    pieces = [piece for _, piece in table.pieces(samples=7)] if table.samples < 10_000 else [values]
    if not np.array_equal(np.concatenate([*pieces, values[:, :0]], axis=1), values, equal_nan=True):
        raise Broken("other numbers in pieces than at once")
    first, last = table.samples // 3, table.samples // 2
    for column in range(min(len(table.channels), 3)):
        if not np.array_equal(table.take([column], first, last)[0], values[column, first:last], equal_nan=True):
            raise Broken("other numbers in a part than in the whole")
        table.find_non_number(column)
    wanted = [name for name in table.channels[:6] if name and len(find_column(table, name)) == 1] or ["a"]
    make_recording(table, [Sensor(channel=name, on="body", position=(0, 0, 0)) for name in wanted], name)


def tried(reader: Reader, folder: Path, data: bytes) -> bool:
    """Pass a file to a reader; return whether it was read.

    Raises
    ------
    Broken
        If it neither read it nor refused it in words, did not come back, or took too much memory.
    """
    path = folder / reader.name
    path.write_bytes(data)
    given = reader.lay(path)
    size = sum(one.stat().st_size for one in folder.rglob("*") if one.is_file())
    if not tracemalloc.is_tracing():
        tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    try:
        with _in_time(), warnings.catch_warnings():
            warnings.simplefilter("error")
            reader.use(given)
    except InputError as error:
        _check_words(error, [one.name for one in folder.rglob("*")])
        return False
    except Broken:
        raise
    except TooLong as error:
        raise Broken(f"not read within {LONGEST:g} s") from error
    except BaseException as error:
        raise Broken(f"{type(error).__name__}: {error}"[:300]) from error
    finally:
        took = tracemalloc.get_traced_memory()[1] - before
    if took > memory_limit(size):
        raise Broken(f"{took / 1e6:.0f} MB for a file of {size} bytes")
    return True


@contextmanager
def _in_time() -> Iterator[None]:
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(_: int, __: FrameType | None) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _check_words(error: InputError, names: Sequence[str]) -> None:
    """See that a refusal names the file, says all it has to, and leaves the terminal alone."""
    if not error.problems:
        raise Broken("a refusal without a reason")
    for problem in error.problems:
        said = str(problem)
        if not any(name in problem.where for name in (*names, "signals")):
            raise Broken(f"a refusal that does not name the file: {said!r}"[:300])
        if not (problem.found and problem.expected and problem.do.rstrip().endswith((".", "?", "!", '"'))):
            raise Broken(f"a refusal that does not say what to do: {said!r}"[:300])
        if any(unicodedata.category(letter) in ("Cc", "Cs") for letter in said):
            raise Broken(f"a refusal with unreadable characters: {said!r}"[:300])
        if len(said) > 2500:
            raise Broken(f"a refusal of {len(said)} letters: {said!r}"[:300])


SMALL = Signals(("front left", "b"), np.round(np.random.default_rng(5).normal(size=(2, 40)), 4), 500.0)
"""A recording that is long enough to have a clock."""

_DIALECTS = (
    "Logger;7;Köln\nAbtastrate;500 Hz\n\nZeit;Stoß;b\nms;g;m/s²\n" + "".join(f"{2 * i};0,{i}1;{i},5\n" for i in range(30)),
    "# made by hand\nTimestamp\ta [g]\tb (mg)\n" + "".join(f"2026-11-20 23:59:59.{i:02}0\t{i % 7}e-1\t-{i}.5\n" for i in range(90)),  # noqa: E501
    "Sample rate: 500 Hz\na b c\n" + "".join(f"  {i % 5}.5   -{i}   nan\n" for i in range(30)),
    'sep=,\nDevice,x\n\n"Packet","SampleTimeFine","Acc, X"\n' + "".join(f'{i},{(4294950629 + 2000 * i) % 2**32},"{i % 9}.25"\n' for i in range(40)),  # noqa: E501
    "time,a,b\n" + "".join(f"{(i + (i > 20) * 3) * 0.002 + 0.0003 * (i % 3):.5f},{i % 5},{'' if i == 7 else i % 3}\n" for i in range(60)),  # noqa: E501
)  # fmt: skip


def _written(*writers: Callable[[Signals, Path], Path]) -> Callable[[Path], Sequence[bytes]]:
    return lambda folder: [writer(SMALL, folder / "x").read_bytes() for writer in writers]


def _texts(folder: Path) -> Sequence[bytes]:
    utf_16 = (_DIALECTS[0].encode(code) for code in ("utf-16", "cp1252"))
    return [csv(SMALL, folder / "x").read_bytes(), *(text.encode() for text in _DIALECTS), *utf_16]


def _old_mat(folder: Path) -> Sequence[bytes]:
    savemat(folder / "x.mat", {"time": SMALL.time, "a": SMALL.values[0], "word": "g"}, format="4")
    return [(folder / "x.mat").read_bytes()]


def _mat(folder: Path) -> Sequence[bytes]:
    """Return structs, cells, words, matrices and integers."""
    content: dict[str, Any] = {"m": SMALL.values.astype(np.int16), "names": ["p", "q"], "fs": 500, "note": "Stoß €"}
    content |= {"c": np.array([SMALL.time, SMALL.values[0]], dtype=object), "z": SMALL.values[0] + 1j}
    content |= {"signals": np.array([(row, "g") for row in SMALL.values], dtype=[("values", object), ("unit", object)])}
    more = []
    for packed in (False, True):
        savemat(folder / "x.mat", content, do_compression=packed)
        more.append((folder / "x.mat").read_bytes())
    return [*_written(mat5, partial(mat5, struct_=timetable_of), partial(mat5, packed=True))(folder), *more]


def _wavs(folder: Path) -> Sequence[bytes]:
    part = Signals(SMALL.names, SMALL.values / 10, SMALL.rate)
    return [wav24(part, folder / "x").read_bytes(), *_written(wav, partial(wav, kind=np.float32))(folder)]


_LVM = """LabVIEW Measurement,
Writer_Version,2
Separator,Comma
Multi_Headings,Yes
X_Columns,Multi
***End_of_Header***,
***Start_Special***
Packet_Notes
***End_Special***
Notes,made by hand
Channels,2,,,,
Samples,40,,30,,
Date,2026/11/20,,2026/11/20,,
Time,09:30:00.25,,09:30:00.2505,,
Y_Unit_Label,g,,m/s²,,
X_Dimension,Time,,Time,,
X0,0,,0,,
Delta_X,2E-3,,2E-3,,
***End_of_Header***,,,,,
X_Value,front\\2C left,X_Value,b,Comment
""" + "".join(
    f"{i / 500:.6f},{i % 7}.5,{f'{i / 500:.6f},-{i}E-1' if i < 30 else ','}{',first' * (i == 0)}\n" for i in range(40)
)


def _lvms(folder: Path) -> Sequence[bytes]:
    return [lvm(SMALL, folder / "x").read_bytes(), _LVM.encode("cp1252")]


def _channels(folder: Path) -> Sequence[bytes]:
    """Return the channel files of a test, and a time channel to which another refers."""
    iso_mme(SMALL, folder / "x")
    times = "Channel code :TIME\nUnit :ms\n" + "".join(f"{2 * i}\n" for i in range(40))
    return [*(path.read_bytes() for path in sorted((folder / "Channel").iterdir())), times.encode()]


def _beside_channels(path: Path) -> Path:
    """Put the channel with others, under the descriptor."""
    descriptor = iso_mme(SMALL, path.with_name("x"))
    path.replace(path.parent / "Channel" / path.name)
    sound = (path.parent / "Channel" / "x.001").read_bytes()
    (path.parent / "Channel" / "x.003").write_bytes(b"Reference channel name :TIME\n" + sound)
    return descriptor


def _beside_recordings(path: Path) -> Path:
    for name in ("one", "two"):
        csv(Signals(("front left", "b", "c", "d"), np.vstack([SMALL.values] * 2), SMALL.rate), path.with_name(name))
    return path


_CAMPAIGN = """schema = 1
[vehicle]
name = "car"
wheelbase = { value = 2.76, std = 0.01 }
cg_height = 0.55
[known]
total_mass = 1540
a = { value = 1.25, std = 0.01 }
[model]
extras = ["anti-roll"]
[[sensor]]
channel = "front left"
on = "body"
position = [0.1, 0.7, 0.5]
direction = "down"
range = 5
[[sensor]]
channel = "b"
on = "fl"
unit = "g"
high_pass = 0.2
[[sensor]]
channel = "c"
on = "body"
position = [0.1, -0.7, 0.5]
resolution = 0.1
[[sensor]]
channel = "d [g]"
on = "body"
position = [-2.9, 0.7, 0.5]
[[load]]
name = "ballast"
items = [{ mass = 140, position = [-1, 0, 0.5] }]
[[drop]]
file = "one.csv"
wheels = ["fl", "fr"]
start = 0.01
[[drop]]
file = "two.csv"
load = "ballast"
window = [0.0, 0.07]
height = 0.05
"""


def _simulated() -> str:
    """Return a vehicle file with its own sensors, loads and drops."""
    wanted = _CAMPAIGN[_CAMPAIGN.index("[known]") :].splitlines()
    return "\n".join([CAR, *(line for line in wanted if not line.startswith(("file", "start", "window")))])


_THINGS: tuple[object, ...] = (
    *(SMALL.values[0], SMALL.values[1].tolist(), SMALL.values, SMALL.time, SMALL.time[::-1], 500, 500.0, "g", "m/s^2", "a", "b"),  # noqa: E501
    *(None, True, 0, -1, 1e300, 1e-300, float("nan"), float("inf"), 10**400, "", "\x1b", "x" * 300, [], {}, b"g", 1j, [1, [2]]),
    *(np.float64(500), np.array(500.0), np.array([]), np.arange(40), np.full(40, np.nan), np.full(40, 1e308), [None] * 40, ["x"] * 40),  # noqa: E501
    *(np.ma.masked_array(SMALL.values[0], SMALL.values[0] > 1), np.arange(40, dtype="m8[s]"), np.zeros(40, bool), np.zeros(40, object)),  # noqa: E501
)  # fmt: skip
_KEYS: tuple[Any, ...] = (
    "name",
    "data",
    "unit_str",
    "fs",
    "time",
    "start_timestamp",
    "quantity",
    "location",
    "other",
    3,
)


def _signals(path: Path) -> object:
    """Take bytes for decisions: each chooses a key, the next what stands under it."""
    usual: dict[Any, object] = {"name": "a", "data": SMALL.values[0], "unit_str": "g", "fs": 500}
    bytes_ = path.read_bytes()
    signals: list[Any] = []
    for number in range(1 + len(bytes_) // 8 % 4):
        own = {**usual, "name": "ab"[number % 2]}
        for key, thing in zip(bytes_[number::8], bytes_[number + 4 :: 8], strict=False):
            if key < 200:
                own[_KEYS[key % len(_KEYS)]] = _THINGS[thing % len(_THINGS)]
            else:
                own.pop(_KEYS[key % len(_KEYS)], None)
        signals.append(own)
    return signals if len(bytes_) % 17 else _THINGS[sum(bytes_) % len(_THINGS)]


def _decisions(_: Path) -> Sequence[bytes]:
    return [b"", b"\4\3\1\5", bytes(range(64))]


READERS = {
    "csv": Reader(_texts, "x.csv"),
    "mat4": Reader(_old_mat, "x.mat"),
    "mat5": Reader(_mat, "x.mat"),
    "wav": Reader(_wavs, "x.wav"),
    "rpc": Reader(_written(rpc, partial(rpc, kind=float)), "x.rsp"),
    "iso_mme": Reader(_channels, "x.002", lay=_beside_channels),
    "lvm": Reader(_lvms, "x.lvm"),
    "sep005": Reader(_decisions, "x", use=lambda path: used(from_sep005(_signals(path)), "signals")),  # type: ignore[arg-type]
    "campaign": Reader(lambda _: [_CAMPAIGN.encode()], "campaign.toml", lay=_beside_recordings, use=read),
    "vehicle": Reader(lambda _: [CAR.encode(), _simulated().encode()], "v.toml", use=read_vehicle),
    "uff": Reader(_written(uff, partial(uff, binary=0)), "x.uff", ("pyuff",)),
    "tdms": Reader(_written(tdms), "x.tdms", ("nptdms",)),
    "mdf": Reader(_written(mdf4, partial(mdf4, compression=2)), "x.mf4", ("asammdf",)),
    "parquet": Reader(_written(parquet), "x.parquet", ("pyarrow",)),
    "hdf5": Reader(_written(hdf5, hdf5_packed), "x.h5", ("h5py",), apart=True),
    "mat73": Reader(_written(mat73), "x.mat", ("h5py",), apart=True),
}
"""All of them."""


def sound_files(reader: Reader) -> list[bytes]:
    """Write the sound files of a reader."""
    with TemporaryDirectory() as folder:
        return list(reader.files(Path(folder)))
