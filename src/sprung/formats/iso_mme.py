"""ISO-MME, the exchange format of crash laboratories (ISO/TS 13499): a descriptor, a folder, one text file per channel."""

from __future__ import annotations

from collections import Counter
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem, Problems
from sprung.formats.sample_store import Samples, Store, join_samples, missing_samples, regroup
from sprung.formats.stated_rates import TIME_UNITS
from sprung.formats.table import SampleTable
from sprung.formats.text_blocks import Encoding, detect_encoding, read_blocks
from sprung.formats.text_layout import EMPTY

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_NONE = "novalue"
_MISSING = EMPTY | {_NONE}
_NAMES = ("customer channel name", "name of the channel", "channel code")


@dataclass(frozen=True, eq=False)
class _Channel:
    """One channel file: its header with the keys in small letters, how many samples it has, and where they begin."""

    path: Path
    encoding: Encoding
    header: Mapping[str, str]
    count: int
    start: int

    @property
    def file(self) -> str:
        return self.path.name

    @property
    def name(self) -> str:
        return next((self.header[key] for key in _NAMES if key in self.header), self.file)

    @property
    def code(self) -> str:
        return self.header.get("channel code", self.name)

    def number(self, key: str, problems: Problems) -> float | None:
        """Return a number of the header; None where it is missing."""
        written = self.header.get(key)
        if written is None:
            return None
        try:
            number = float(written.replace(",", "."))
        except ValueError:
            number = np.nan
        if not np.isfinite(number):
            problems.add(f"{self.file}: {key}", f"'{written[:40]}'", "a number, in s", "Export the channel again.")
            return None
        return number


class IsoMmeFormat:
    """ISO-MME; named by its descriptor, .mme, or by its list of channels, .chn."""

    def claims(self, path: Path, head: bytes) -> bool:
        """Claim by the ending: both files are plain text that may say anything."""
        return path.suffix.lower() in {".mme", ".chn"} and b"\0" not in head

    def read(self, path: Path) -> SampleTable:
        """Read all channels of a test.

        Channels of another length or clock than most are left out, as spoilt.

        Raises
        ------
        InputError
            If there are no channel files, or nothing says how they were sampled; every problem at once.
        """
        problems = Problems()
        channels = [_channel(file) for file in _files(path)]
        codes = {channel.code: channel for channel in channels}
        references = {channel.header.get("reference channel name") for channel in channels}
        measured = [channel for channel in channels if channel.code not in references] or channels
        clocks = {id(channel): _clock(channel, codes, problems) for channel in measured}
        problems.raise_if_any()
        usual = Counter(clock for clock in clocks.values() if clock is not None).most_common(1)
        if not usual:
            do = "Add 'Sampling interval :' with the interval in s to the channel files."
            raise InputError([Problem(path.name, "no channel with a sampling interval", "one for each", do)])
        first, interval, count, reference = clock = usual[0][0]
        time = first + interval * np.arange(count, dtype=np.float64) if reference is None else _times(codes[reference])
        samples = [
            Samples(_store(channel), 0)
            if clocks[id(channel)] == clock
            else missing_samples(count, _other(channel, clocks[id(channel)], clock))
            for channel in measured
        ]
        return SampleTable(
            channels=tuple(channel.name for channel in measured),
            units=tuple(channel.header.get("unit") for channel in measured),
            store=join_samples(samples),
            clock=time,
        )


_Clock = tuple[float, float, int, str | None]  # first sample and interval in s, number of samples, channel of times


def _files(path: Path) -> list[Path]:
    """Find the channel files: of the test's name or of any, with a number for an ending, in the folder Channel."""
    try:
        folders = [path.parent, *(it for it in path.parent.iterdir() if it.is_dir() and it.name.lower() == "channel")]
        files = [file for folder in folders for file in folder.iterdir() if file.suffix[1:].isdecimal()]
        files = sorted((file for file in files if file.is_file()), key=lambda file: (int(file.suffix[1:]), file.name))
    except OSError as error:
        do = "Check its permissions."
        raise InputError([Problem(path.name, f"a folder that cannot be read ({error.strerror})", "one", do)]) from error
    files = [file for file in files if file.stem.lower() == path.stem.lower()] or files
    if not files:
        do = "Put the folder Channel with the files .001, .002, ... beside it."
        raise InputError([Problem(path.name, "no channel files", "files .001, .002, ... in the folder Channel", do)])
    return files


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        found = f"a file that cannot be read ({error.strerror})"
        raise InputError([Problem(path.name, found, "a channel", "Check its permissions.")]) from error
    except UnicodeDecodeError as error:
        found = f"a file marked as UTF-16 with invalid text ({error.reason})"
        raise InputError([Problem(path.name, found, "text", "Export the channel again.")]) from error


def _channel(path: Path) -> _Channel:
    header: dict[str, str] = {}
    count = start = above = 0
    with _reading(path):
        encoding = detect_encoding(path)
        for block in read_blocks(path, encoding):
            lines = block.lines
            if not start:
                found = next((index for index, line in enumerate(lines) if not _is_header(line)), len(lines))
                for line in lines[:found]:
                    key, _, value = (part.strip() for part in line.partition(":"))
                    if value and value.lower() != _NONE:
                        header.setdefault(key.lower(), value)
                above += found
                start, lines = above + 1 if found < len(lines) else 0, lines[found:]
            count += sum(not line.isspace() for line in lines if line)
    return _Channel(path, encoding, header, count, start)


def _is_header(line: str) -> bool:
    return ":" in line or not line.strip()


def _cells(channel: _Channel) -> Iterator[list[tuple[int, str]]]:
    """Yield the lines with samples and their line numbers, block by block."""
    number = 1
    with _reading(channel.path):
        for block in read_blocks(channel.path, channel.encoding):
            lines = enumerate(map(str.strip, block.lines), number)
            yield [(line, cell) for line, cell in lines if cell and line >= channel.start]
            number += len(block.lines)


def _number(cell: str) -> float:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return np.nan


def _store(channel: _Channel) -> Store:
    def pieces(first: int, last: int) -> Iterator[NDArray[np.float64]]:
        place = 0
        for cells in _cells(channel):
            own = cells[max(first - place, 0) : max(last - place, 0)]
            yield np.array([[_number(cell) for _, cell in own]])
            place += len(cells)

    def read(columns: Sequence[int], first: int, last: int, step: int) -> Iterator[NDArray[np.float64]]:
        return (np.repeat(piece, len(columns), axis=0) for piece in regroup(pieces(first, last), step))

    def find_non_number(_column: int, first: int, last: int) -> Problem | None:
        within = islice(chain.from_iterable(_cells(channel)), first, last)
        words = ((line, cell) for line, cell in within if np.isnan(_number(cell)) and cell.lower() not in _MISSING)
        found = next(words, None)
        return _spoilt(channel.file, *found, 1 + sum(1 for _ in words)) if found else None

    return Store(1, channel.count, read, find_non_number)


def _spoilt(file: str, line: int, cell: str, count: int) -> Problem:
    more = f" (the first of {count} such lines)" if count > 1 else ""
    return Problem(f"{file}: line {line}", f"'{cell[:80]}'{more}", "a number", "Export the channel again.")


def _clock(channel: _Channel, codes: Mapping[str, _Channel], problems: Problems) -> _Clock | None:
    """Return the clock of a channel; None where its header and its file state none."""
    count = channel.count
    reference = channel.header.get("reference channel name")
    if (
        reference is not None
        and reference in codes
        and codes[reference] is not channel
        and codes[reference].count == count
    ):
        return 0.0, 0.0, count, reference
    first = channel.number("time of first sample", problems) or 0.0
    interval = channel.number("sampling interval", problems)
    if interval is None or not count:
        return None
    if interval <= 0:
        found = f"{interval:g} s"
        problems.add(f"{channel.file}: sampling interval", found, "a positive number", "Export the channel again.")
    return first, interval, count, None


def _times(channel: _Channel) -> NDArray[np.float64]:
    """Return the times in a channel of times, s, shape (time,)."""
    problems = Problems()
    unit = channel.header.get("unit", "s").strip("[]() ").lower()
    if unit not in TIME_UNITS:
        problems.add(f"{channel.file}: unit", f"'{unit[:40]}'", "a unit of time", "Correct it.")
    times = Samples(_store(channel), 0).all()
    if np.isnan(times).any():
        found = f"no number for sample {int(np.isnan(times).argmax()) + 1} of the times"
        problems.add(channel.file, found, "the time of every sample", "Export the channel again.")
    problems.raise_if_any()
    return TIME_UNITS[unit] * times


def _other(channel: _Channel, clock: _Clock | None, usual: _Clock) -> Problem:
    return Problem(
        f"{channel.file}: {channel.name}",
        _words(clock),
        f"{_words(usual)}, as most channels have",
        "Export all channels at one rate and of one length.",
    )


def _words(clock: _Clock | None) -> str:
    if clock is None:
        return "no samples, or no sampling interval"
    first, interval, count, reference = clock
    how = f"every {interval:g} s from {first:g} s on" if reference is None else f"at the times of channel {reference}"
    return f"{count} samples {how}"
