"""One recording written in every format that can be read, as other programs write it."""

from __future__ import annotations

import struct
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import savemat, wavfile

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Signals:
    """What one logger recorded from time 0 on.

    Attributes
    ----------
    names
        Of the channels.
    values
        Shape (channel, time), g.
    rate
        Samples per second.
    """

    names: tuple[str, ...]
    values: Real
    rate: float

    @property
    def time(self) -> Real:
        """Time of every sample, s; shape (time,)."""
        return np.arange(self.values.shape[1]) / self.rate

    @property
    def by_name(self) -> dict[str, Real]:
        """The samples of every channel."""
        return dict(zip(self.names, self.values, strict=True))


@dataclass(frozen=True)
class WritingMethod:
    """A way of writing a recording.

    Attributes
    ----------
    write
        Takes the signals and the path to write, the ending apart; gives the file that a campaign names.
    needs
        The library it needs; empty where it needs none but SciPy.
    off
        By how much it rounds: the share of a channel's largest number that one of its numbers may be off.
    nameless
        Whether it cannot name channels, nor their unit.
    """

    write: Callable[[Signals, Path], Path]
    needs: str = ""
    off: float = 1e-15
    nameless: bool = False


def csv(signals: Signals, path: Path, digits: int = 17) -> Path:
    """Write a text table."""
    path = path.with_name(f"{path.name}.csv")
    header = ",".join(["time", *(f"{name} [g]" for name in signals.names)])
    np.savetxt(path, np.vstack([signals.time, signals.values]).T, f"%.{digits}g", ",", header=header, comments="")
    return path


def struct_of(signals: Signals) -> dict[str, Any]:
    """Return the struct that contains a recording."""
    return {"time": signals.time, **signals.by_name, "units": "s, g"}


def timetable_of(signals: Signals) -> dict[str, Any]:
    """Return the struct to which a timetable with its properties is converted."""
    units = np.array(["g"] * len(signals.names), dtype=object)
    properties = {"DimensionNames": np.array(["Time", "Variables"], dtype=object), "VariableUnits": units}
    columns = {name: row[:, None] for name, row in signals.by_name.items()}
    return {"Time": signals.time[:, None], **columns, "Properties": properties}


def mat5(signals: Signals, path: Path, struct_: Callable[[Signals], Any] = struct_of, packed: bool = False) -> Path:
    """Write a struct as MATLAB's version 5 or, packed, 7."""
    path = path.with_name(f"{path.name}.mat")
    savemat(path, {"run": struct_(signals)}, do_compression=packed)
    return path


def mat73(signals: Signals, path: Path) -> Path:
    """Write a struct as MATLAB's version 7.3: HDF5 behind 512 bytes, every array with its sides exchanged."""
    h5py: Any = import_module("h5py")
    path = path.with_name(f"{path.name}.mat")
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("run")
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, row in {"time": signals.time, **signals.by_name}.items():
            group.create_dataset(name, data=row[None]).attrs["MATLAB_class"] = np.bytes_("double")
        letters = np.array([[ord(letter)] for letter in "s, g"], dtype=np.uint16)
        group.create_dataset("units", data=letters).attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64 HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM")
    return path


def hdf5(signals: Signals, path: Path) -> Path:
    """Write a dataset per channel."""
    h5py: Any = import_module("h5py")
    path = path.with_name(f"{path.name}.h5")
    with h5py.File(path, "w") as file:
        file.attrs["fs"] = signals.rate
        for name, row in signals.by_name.items():
            file.create_dataset(name, data=row).attrs["unit"] = "g"
    return path


def hdf5_packed(signals: Signals, path: Path) -> Path:
    """Write a compressed matrix beside a list of names."""
    h5py: Any = import_module("h5py")
    path = path.with_name(f"{path.name}.h5")
    with h5py.File(path, "w") as file:
        group = file.create_group("run")
        values = np.vstack([signals.time, signals.values]).T
        matrix = group.create_dataset("data", data=values, chunks=(16, 1), compression="gzip", shuffle=True)
        matrix.attrs["units"] = ", ".join(["s", *["g"] * len(signals.names)])
        group["names"] = ["time", *signals.names]
    return path


def parquet(signals: Signals, path: Path) -> Path:
    """Write columns."""
    pa: Any = import_module("pyarrow")
    pq: Any = import_module("pyarrow.parquet")
    path = path.with_name(f"{path.name}.parquet")
    columns = {"time [s]": signals.time, **{f"{name} [g]": row for name, row in signals.by_name.items()}}
    pq.write_table(pa.table(columns), path, row_group_size=512)
    return path


def tdms(signals: Signals, path: Path) -> Path:
    """Write two segments of waveforms."""
    nptdms: Any = import_module("nptdms")
    path = path.with_name(f"{path.name}.tdms")
    even = {"wf_increment": 1 / signals.rate, "wf_start_offset": 0.0, "unit_string": "g"}
    half = signals.values.shape[1] // 2
    with nptdms.TdmsWriter(str(path)) as writer:
        for values in (signals.values[:, :half], signals.values[:, half:]):
            rows = zip(signals.names, values, strict=True)
            writer.write_segment([nptdms.ChannelObject("log", name, row, properties=even) for name, row in rows])
    return path


def mdf4(signals: Signals, path: Path, compression: int = 0) -> Path:
    """Write one group of version 4."""
    asammdf: Any = import_module("asammdf")
    path = path.with_name(f"{path.name}.mf4")
    with asammdf.MDF(version="4.10") as file:
        channels = [asammdf.Signal(row, signals.time, name=name, unit="g") for name, row in signals.by_name.items()]
        file.append(channels, common_timebase=True)
        file.save(path, overwrite=True, compression=compression)
    return path


def uff(signals: Signals, path: Path, binary: int = 1) -> Path:
    """Write data sets 58, binary (58b) or text."""
    pyuff: Any = import_module("pyuff")
    path = path.with_name(f"{path.name}.uff")
    path.unlink(missing_ok=True)
    plain: dict[str, object] = {
        "type": 58,
        "func_type": 1,
        "rsp_dir": 3,
        "ref_node": 0,
        "ref_dir": 0,
        "orddenom_spec_data_type": 0,
    }
    plain |= {"binary": binary, "abscissa_spacing": 1, "x": signals.time, "ordinate_axis_units_lab": "g"}
    functions = [{**plain, "id1": name, "rsp_node": 3, "data": row} for name, row in signals.by_name.items()]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the library leaves a file to be closed by chance
        pyuff.UFF(str(path)).write_sets(functions, "add")
    return path


def wav(signals: Signals, path: Path, kind: type[np.floating[Any]] = np.float64) -> Path:
    """Write floating-point samples, in g."""
    path = path.with_name(f"{path.name}.wav")
    wavfile.write(path, round(signals.rate), signals.values.T.astype(kind))
    return path


def wav24(signals: Signals, path: Path) -> Path:
    """Write integers of 24 bits, full scale 1 g."""
    path = path.with_name(f"{path.name}.wav")
    count, rate = len(signals.names), round(signals.rate)
    samples = np.round(signals.values.T * 2**23).astype("<i4").reshape(-1, 1).view(np.uint8)[:, :3].tobytes()
    form = struct.pack("<HHIIHH", 1, count, rate, 3 * count * rate, 3 * count, 24)
    chunks = b"fmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", len(samples)) + samples
    path.write_bytes(b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks + b"\0" * (len(samples) % 2))
    return path


def rpc(signals: Signals, path: Path, kind: type = int) -> Path:
    """Write integers of 16 bits or floats of 32, in groups."""
    rpc3: Any = import_module("rpc3")
    rpc3.rpc3.progressbar = False
    path = path.with_name(f"{path.name}.rsp")
    channels = [rpc3.Channel(name, "g", 1 / signals.rate, row) for name, row in signals.by_name.items()]
    rpc3.write(str(path), channels, datatype=kind, pts_per_group=64, overwrite=True)
    return path


def iso_mme(signals: Signals, path: Path) -> Path:
    """Write a descriptor, and a folder with one text per channel."""
    path = path.with_name(f"{path.name}.mme")
    folder = path.parent / "Channel"
    folder.mkdir(exist_ok=True)
    path.write_text("Data format :ISO-MME\n", encoding="ascii")
    for number, (name, row) in enumerate(signals.by_name.items(), 1):
        keys = {"Name of the channel": name, "Channel code": f"11{number:05}", "Unit": "g"}
        keys |= {"Time of first sample": "0", "Sampling interval": f"{1 / signals.rate!r}"}
        lines = [*(f"{key:28}:{value}" for key, value in keys.items()), *map(repr, row.tolist())]
        (folder / f"{path.stem}.{number:03}").write_text("\n".join([*lines, ""]), encoding="ascii")
    return path


def lvm(signals: Signals, path: Path) -> Path:
    """Write two segments as LabVIEW does, with six decimals."""
    path = path.with_name(f"{path.name}.lvm")
    count, half = len(signals.names), signals.values.shape[1] // 2
    lines = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t.", "X_Columns\tOne"]
    lines += ["***End_of_Header***\t", "\t"]
    for part in (slice(0, half), slice(half, None)):
        time, values = signals.time[part], signals.values[:, part]
        fields = {"Samples": len(time), "Date": "2026/11/20", "Time": "09:30:00.5", "Y_Unit_Label": "g"}
        fields |= {"X_Dimension": "Time", "X0": f"{time[0]:.16E}", "Delta_X": f"{1 / signals.rate:.6f}"}
        lines += [f"Channels\t{count}", *("\t".join([tag, *[str(cell)] * count, ""]) for tag, cell in fields.items())]
        lines += ["***End_of_Header***\t", "\t".join(["X_Value", *signals.names, "Comment"])]
        lines += ["\t".join(f"{number:.6f}" for number in row) for row in np.vstack([time, values]).T]
        lines += [""]
    path.write_text("\r\n".join([*lines, ""]), encoding="cp1252", newline="")
    return path


WAYS = {
    "CSV, 17 digits": WritingMethod(csv),
    "CSV, 9 digits": WritingMethod(partial(csv, digits=9), off=5e-9),
    "MAT 5, struct": WritingMethod(mat5),
    "MAT 5, timetable": WritingMethod(partial(mat5, struct_=timetable_of)),
    "MAT 7, struct": WritingMethod(partial(mat5, packed=True)),
    "MAT 7.3, struct": WritingMethod(mat73, "h5py"),
    "HDF5": WritingMethod(hdf5, "h5py"),
    "HDF5, packed": WritingMethod(hdf5_packed, "h5py"),
    "Parquet": WritingMethod(parquet, "pyarrow"),
    "TDMS": WritingMethod(tdms, "nptdms"),
    "MDF4": WritingMethod(mdf4, "asammdf"),
    "MDF4, packed": WritingMethod(partial(mdf4, compression=2), "asammdf"),
    "UFF 58b": WritingMethod(uff, "pyuff"),
    "UFF 58, text": WritingMethod(partial(uff, binary=0), "pyuff", off=5e-12),
    "WAV, 64 bit floats": WritingMethod(wav, nameless=True),
    "WAV, 32 bit floats": WritingMethod(partial(wav, kind=np.float32), off=2.0**-24, nameless=True),
    "RPC, 16 bit integers": WritingMethod(rpc, "rpc3", off=1 / 32752),
    "RPC, 32 bit floats": WritingMethod(partial(rpc, kind=float), "rpc3", off=2.0**-24),
    "ISO-MME": WritingMethod(iso_mme),
    "LVM": WritingMethod(lvm, off=1e-6),
}
"""Every way but one: integers of a WAV file are parts of a full scale of 1 g, which a vehicle at rest would fill."""
