"""ISO-MME, the exchange format of crash laboratories (ISO/TS 13499): a descriptor, a folder, one text file per channel."""

from __future__ import annotations

from array import array
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem, Problems
from sprung.recording.formats.clock import TIME_UNITS
from sprung.recording.formats.dialect import EMPTY, lines_of, text_of
from sprung.recording.formats.table import Table

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

_NONE = "novalue"
_NAMES = ("customer channel name", "name of the channel", "channel code")


@dataclass(frozen=True, eq=False)
class _Channel:
    """One channel file: its header with the keys in small letters, and its samples, NaN where there is none."""

    file: str
    header: Mapping[str, str]
    values: NDArray[np.float64]
    spoilt: Problem | None

    @property
    def name(self) -> str:
        return next((self.header[key] for key in _NAMES if key in self.header), self.file)

    @property
    def code(self) -> str:
        return self.header.get("channel code", self.name)

    def number(self, key: str, problems: Problems) -> float | None:
        """Give a number of the header; None where it says nothing."""
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

    def read(self, path: Path) -> Table:
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
            raise InputError([Problem(path.name, "no channel that says its sampling interval", "one for each", do)])
        first, interval, count, reference = clock = usual[0][0]
        time = first + interval * np.arange(count, dtype=np.float64) if reference is None else _times(codes[reference])
        spoilt: dict[str, Problem] = {}
        for channel in measured:
            if clocks[id(channel)] != clock:
                spoilt[channel.name] = _other(channel, clocks[id(channel)], clock)
            elif channel.spoilt is not None:
                spoilt[channel.name] = channel.spoilt
        return Table(
            channels=tuple(channel.name for channel in measured),
            units=tuple(channel.header.get("unit") for channel in measured),
            values=np.array(
                [channel.values if clocks[id(channel)] == clock else np.full(count, np.nan) for channel in measured]
            ),
            clock=time,
            spoilt=spoilt,
        )


_Clock = tuple[float, float, int, str | None]  # first sample and interval in s, number of samples, channel of times


def _files(path: Path) -> list[Path]:
    """Find the channel files: of the test's name or of any, with a number for an ending, in the folder Channel."""
    try:
        folders = [path.parent, *(it for it in path.parent.iterdir() if it.is_dir() and it.name.lower() == "channel")]
        files = [file for folder in folders for file in folder.iterdir() if file.suffix[1:].isdecimal()]
        files = sorted((file for file in files if file.is_file()), key=lambda file: (int(file.suffix[1:]), file.name))
    except OSError as error:
        do = "See to its permissions."
        raise InputError([Problem(path.name, f"a folder that cannot be read ({error.strerror})", "one", do)]) from error
    files = [file for file in files if file.stem.lower() == path.stem.lower()] or files
    if not files:
        do = "Put the folder Channel with the files .001, .002, ... beside it."
        raise InputError([Problem(path.name, "no channel files", "files .001, .002, ... in the folder Channel", do)])
    return files


def _channel(path: Path) -> _Channel:
    try:
        text = text_of(path.read_bytes())
    except OSError as error:
        found = f"a file that cannot be read ({error.strerror})"
        raise InputError([Problem(path.name, found, "a channel", "See to its permissions.")]) from error
    except UnicodeDecodeError as error:
        found = f"a file marked as UTF-16 that is none ({error.reason})"
        raise InputError([Problem(path.name, found, "text", "Export the channel again.")]) from error
    header: dict[str, str] = {}
    numbers = array("d")
    wrong: tuple[int, str, int] | None = None
    for line, written in enumerate(lines_of(text, 0, len(text)), 1):
        cell = written.strip()
        key, colon, value = cell.partition(":")
        if not cell:
            continue
        if colon and not numbers:
            if value.strip() and value.strip().lower() != _NONE:
                header.setdefault(key.strip().lower(), value.strip())
            continue
        try:
            numbers.append(float(cell.replace(",", ".")))
        except ValueError:
            numbers.append(np.nan)
            if cell.lower() != _NONE and cell.lower() not in EMPTY:
                first, text_there, count = wrong or (line, cell, 0)
                wrong = (first, text_there, count + 1)
    return _Channel(path.name, header, np.frombuffer(numbers, dtype=float), _spoilt(path.name, wrong))


def _spoilt(file: str, wrong: tuple[int, str, int] | None) -> Problem | None:
    if wrong is None:
        return None
    line, cell, count = wrong
    more = f" (the first of {count} such lines)" if count > 1 else ""
    return Problem(f"{file}: line {line}", f"'{cell[:80]}'{more}", "a number", "Export the channel again.")


def _clock(channel: _Channel, codes: Mapping[str, _Channel], problems: Problems) -> _Clock | None:
    """Say when a channel was sampled; None if nothing says so."""
    count = len(channel.values)
    reference = channel.header.get("reference channel name")
    if (
        reference is not None
        and reference in codes
        and codes[reference] is not channel
        and len(codes[reference].values) == count
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
    """Give the times that a channel of times holds, s."""
    problems = Problems()
    unit = channel.header.get("unit", "s").strip("[]() ").lower()
    if unit not in TIME_UNITS:
        problems.add(f"{channel.file}: unit", f"'{unit[:40]}'", "a unit of time", "Correct it.")
    if np.isnan(channel.values).any():
        found = f"no number for sample {int(np.isnan(channel.values).argmax()) + 1} of the times"
        problems.add(channel.file, found, "the time of every sample", "Export the channel again.")
    problems.raise_if_any()
    return TIME_UNITS[unit] * channel.values


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
