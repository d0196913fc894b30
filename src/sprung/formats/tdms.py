"""TDMS files, of LabVIEW and DIAdem."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.formats.channels import ChannelClock, Column, assemble_table, clock_from_times, regular_clock
from sprung.formats.libraries import load_library
from sprung.formats.reading_errors import check_declared_size, input_error, memory_limit, reading, truncation_error
from sprung.formats.sample_store import Samples, Store, split_range
from sprung.formats.stated_rates import TIME_UNITS
from sprung.formats.text_clock import TIME_NAMES
from sprung.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sprung.formats.table import SampleTable

_MAGIC = b"TDSm"
_LEAD_IN, _BIG_ENDIAN = 28, 1 << 6
_UNITS = ("unit_string", "NI_UnitDescription", "Unit", "unit")


class TdmsFormat:
    """TDMS files: channels in groups, at a fixed rate or beside a channel of times."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending and the mark that begins every segment."""
        return path.suffix.lower() == ".tdms" and head.startswith(_MAGIC)

    def read(self, path: Path) -> SampleTable:
        """Read one file.

        Raises
        ------
        InputError
            If npTDMS is not installed, if the file is cut short or damaged, or if no channel has a time.
        """
        nptdms, file, size = load_library("nptdms", "tdms", path), path.name, path.stat().st_size
        _refuse_cut_short(path)
        # Given a stream, the library leaves the index beside the file alone, which may be of another recording.
        with path.open("rb") as stream:
            with reading(file, "a TDMS file"):
                content = nptdms.TdmsFile.open(stream)
                groups = {group.name: group.channels() for group in content.groups()}
                numbers = sum(len(channel) for channels in groups.values() for channel in channels)
            if numbers > 8 * size:  # no sample takes less than a bit
                check_declared_size(numbers, file, 0.0)
            columns: list[Column] = []
            timeless: list[str] = []
            with reading(file, "a TDMS file"):
                zero = _zero([channel for channels in groups.values() for channel in channels])
                samples = _samples([channel for channels in groups.values() for channel in channels], path)
                for name, channels in groups.items():
                    found, without = _columns(channels, name, zero, file, samples)
                    columns += found
                    timeless += without
            notes = [f"left out, as they have neither a time step nor a time channel: {', '.join(timeless)}"]
            if timeless and not columns:
                expected = "a property wf_increment, or a channel named time in the same group"
                do = "Export the recording with its time."
                raise input_error(file, f"no time for any channel: {', '.join(timeless)}", expected, do)
            return assemble_table(columns, file, memory_limit(size), notes if timeless else ())


def _refuse_cut_short(path: Path) -> None:
    """Check that the last segment ends where the file does."""
    size, position = path.stat().st_size, 0
    with path.open("rb") as stream:
        while position < size:
            stream.seek(position)
            lead_in = stream.read(_LEAD_IN)
            if len(lead_in) < _LEAD_IN:
                raise truncation_error(path.name, f"{len(lead_in)} bytes of a segment's first {_LEAD_IN}")
            if not lead_in.startswith(_MAGIC):
                do = "The file is damaged: copy or export the recording again."
                raise input_error(f"{path.name}: byte {position}", "no segment", "the beginning of a segment", do)
            order = ">" if int.from_bytes(lead_in[4:8], "little") & _BIG_ENDIAN else "<"
            (length,) = struct.unpack(f"{order}Q", lead_in[12:20])
            position += _LEAD_IN + length
            if position > size:
                raise truncation_error(path.name, "a segment that extends beyond the end of the file")


def _columns(
    channels: Sequence[Any], group: str, zero: Any, file: str, samples: Mapping[str, Samples]
) -> tuple[list[Column], list[str]]:
    """Return the channels of a group, and the names of those without time."""
    times = next((channel for channel in channels if _is_time(channel)), None)
    shared = None if times is None else _times(times, file)
    columns: list[Column] = []
    timeless: list[str] = []
    for channel in channels:
        if channel is times or not len(channel):
            continue
        clock = _clock(channel, shared, zero, f"{file}: channel '{group}/{channel.name}'")
        if clock is None:
            timeless.append(f"{group}/{channel.name}")
            continue
        name, unit = _name_and_unit(channel)
        columns.append(Column(name, f"{group}/{name}", unit, clock, samples.get(channel.path)))
    return columns, timeless


def _is_time(channel: Any) -> bool:
    name = str(channel.name).partition("[")[0].partition("(")[0].strip().lower()
    return name in TIME_NAMES and bool(len(channel)) and channel.dtype.kind in "fiuM"


def _times(channel: Any, file: str) -> ChannelClock:
    with reading(f"{file}: channel '{channel.name}'", "a TDMS file"):
        samples = np.asarray(channel[:])
    if samples.dtype.kind == "M":
        return clock_from_times((samples - samples[0]) / np.timedelta64(1, "ns") * 1e-9)
    name, unit = _name_and_unit(channel)
    bracket = str(channel.name).rpartition("(")[2].rstrip(") ") if "(" in name else ""
    text = (unit or bracket or "s").strip().lower()
    if text not in TIME_UNITS:
        do = "Export the time in s."
        raise input_error(f"{file}: channel '{channel.name}'", f"the unit '{text}'", "a unit of time", do)
    return clock_from_times(TIME_UNITS[text] * samples.astype(np.float64))


def _clock(channel: Any, shared: ChannelClock | None, zero: Any, where: str) -> ChannelClock | None:
    step = channel.properties.get("wf_increment")
    if isinstance(step, (int, float)) and step > 0:
        factor = TIME_UNITS.get(str(channel.properties.get("wf_xunit_string") or "s").strip().lower())
        if factor is None:
            return None  # over frequency, say
        start = float(channel.properties.get("wf_start_offset", 0.0)) * factor
        absolute = channel.properties.get("wf_start_time")
        if isinstance(absolute, np.datetime64) and zero is not None:
            start += float((absolute - zero) / np.timedelta64(1, "ns")) * 1e-9
        step = factor * float(step)
        return regular_clock(start, step, len(channel), 4 * float(np.spacing(step)), where)
    return shared if shared is not None and shared.count == len(channel) else None


def _zero(channels: Sequence[Any]) -> Any:
    """Return the earliest start of all channels, from which the others are counted; None where one has none."""
    starts = [channel.properties.get("wf_start_time") for channel in channels if len(channel)]
    absolute = [start for start in starts if isinstance(start, np.datetime64) and not np.isnat(start)]
    return min(absolute) if absolute and len(absolute) == len(starts) else None


def _name_and_unit(channel: Any) -> tuple[str, str | None]:
    stated = (str(channel.properties.get(key, "")).strip() for key in _UNITS)
    unit = next((text for text in stated if text), None)
    return (str(channel.name).strip(), unit) if unit else split_unit(str(channel.name))


def _samples(channels: Sequence[Any], path: Path) -> dict[str, Samples]:
    """Return the samples of all numeric channels by their paths in the file; those of one length share a store."""
    lengths: dict[int, list[str]] = {}
    for channel in channels:
        if channel.dtype.kind in "fiub":
            lengths.setdefault(len(channel), []).append(channel.path)
    stores = {length: _store(path, paths, length) for length, paths in lengths.items()}
    return {
        own: Samples(stores[length], column) for length, paths in lengths.items() for column, own in enumerate(paths)
    }


def _store(path: Path, channels: Sequence[str], length: int) -> Store:
    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        nptdms = load_library("nptdms", "tdms", path)
        with path.open("rb") as stream:
            with reading(path.name, "a TDMS file"):
                content = nptdms.TdmsFile.open(stream)
                own = {channel.path: channel for group in content.groups() for channel in group.channels()}
            for begin, end in split_range(first, last, step):
                values = np.empty((len(columns), end - begin))
                for row, column in zip(values, columns, strict=True):
                    channel = own[channels[column]]
                    with reading(f"{path.name}: channel '{channel.name}'", "a TDMS file"):
                        samples = channel.read_data(begin, end - begin)
                        if len(samples) < end - begin:
                            raise truncation_error(path.name, f"{begin + len(samples)} of {length} samples")
                        row[:] = samples
                yield values

    return Store(len(channels), length, read)
