"""The clock of a text table: a column of times, or of clock times, or the rate written above the samples."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem, did_you_mean
from sprung.formats.stated_rates import TIME_UNITS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from sprung.formats.stated_rates import Rate

TIME_NAMES = frozenset(
    (
        *("t", "time", "zeit", "temps", "tiempo", "tempo", "tijd", "tid", "timestamp", "seconds"),
        *("uhrzeit", "zeitstempel", "messzeit", "datetime", "heure", "hora", "ora", "sekunden"),
    )
)
CLOCK = re.compile(
    r"(?:\d{1,4}[-./]\d{1,2}[-./]\d{1,4}[T_ ,]{1,2})?(?:(?P<h>\d{1,2}):(?P<m>\d{2}):(?P<s>\d{2}(?:[.,:_]\d{1,12})?)"
    r"|(?P<minute>\d{1,3}):(?P<second>\d{2}[.,]\d{1,12}))(?: ?(?P<noon>[AaPp])\.?[Mm]\.?)?"
    r"(?: ?(?:Z|UTC|[+-]\d{2}:?\d{2}))?"
)
"""A time of day, with or without its date and time zone: 14:03:22.125, 2025-04-11T14:03:22,125Z, 03:22.125."""

WRAP = 2.0**32
"""Period of counters of 32 bits."""

_DAY = 86400.0
_OWN_UNIT = {"sampletimefine": 1e-6}  # names that say their unit without naming it: Movella's sensors count µs
_WITH_UNIT = re.compile(r"(.{0,200}?)\s{0,20}[\[(](.{0,200})[\])]", re.DOTALL)
_LOOSE_UNIT = re.compile(r"(?i)(.{1,200}?)(?:[_/,]|\s{1,20}|\s?in\s)\s?(s|sec|ms|msec|us|µs|μs|usec|ns)")


@dataclass(frozen=True, eq=False)
class Columns:
    """The columns of a table among which its time is found.

    Attributes
    ----------
    names, units
        Of all columns, from the header and a row of units.
    values
        By column that may be the time: its numbers, NaN where the file holds none, shape (time,).
    clocks
        By such a column that holds clock times: seconds since midnight, NaN where there is none, shape (time,).
    wrong
        By such a column, a problem for text that is neither a number nor a clock time.
    line
        Returns the line of the file in which a sample stands.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Mapping[int, NDArray[np.float64]]
    clocks: Mapping[int, NDArray[np.float64]]
    wrong: Mapping[int, Problem]
    line: Callable[[int], int]


@dataclass(frozen=True, eq=False)
class TextClock:
    """Which column is the time, and the time of every sample in s, or the samples per second where no column is."""

    column: int | None
    time: NDArray[np.float64] | float
    notes: tuple[str, ...] = ()


def is_time_name(name: str) -> bool:
    """Return whether a column's name, without its unit, is one of time."""
    return _base(name)[0].lower() in TIME_NAMES


def find_time_candidates(names: Sequence[str], rows: Sequence[Sequence[str]]) -> list[int]:
    """Return the columns that may hold the time.

    Parameters
    ----------
    names
        Of all columns.
    rows
        The cells of the first lines.

    Returns
    -------
    list of int
        The first that is called a time; otherwise those whose names hold such a word, those that begin with clock
        times, and the first column that has a name or holds anything.
    """
    for column, name in enumerate(names):
        if is_time_name(name):
            return [column]
    beginning = [{row[column] for row in rows if column < len(row) and row[column]} for column in range(len(names))]
    first = next((column for column, name in enumerate(names) if name or beginning[column]), 0)
    return [
        column
        for column, name in enumerate(names)
        if column == first
        or _holds_time_word(name)
        or any(parse_clock_time(cell) is not None for cell in beginning[column])
    ]


def parse_clock_time(cell: str) -> float | None:
    """Return a clock time in seconds since midnight, its date left out; None for other text."""
    match = CLOCK.fullmatch(cell)
    if match is None:
        return None
    hour, minute, second = match["h"] or "0", match["m"] or match["minute"], match["s"] or match["second"]
    hours = int(hour) % 12 + 12 * (match["noon"] in ("p", "P")) if match["noon"] else int(hour)
    return 3600.0 * hours + 60.0 * int(minute) + float(re.sub("[,:_]", ".", second))


def find_text_clock(columns: Columns, rate: Rate | None, file: str) -> TextClock:
    """Find the time of every sample.

    Parameters
    ----------
    columns
        The table.
    rate
        Rate stated above it.
    file
        Name of the file, for messages.

    Returns
    -------
    Clock
        From the column named as a time, in whatever unit it or the rate says; or one whose name holds such a word; or
        one of clock times; or the first one, if it increases; or the rate.

    Raises
    ------
    InputError
        If none of these is there, or the time has gaps or text in it.
    """
    names = columns.names
    column = next((index for index in columns.values if is_time_name(names[index])), None)
    if column is None:
        column = next((index for index in columns.values if _is_time_in_other_words(columns, index)), None)
    if column is None:
        column = next(iter(columns.clocks), None)
    if column is None and _first_is_time(columns, rate):
        column = min(columns.values)
    if column is not None:
        return _from_column(columns, column, rate, file)
    if rate is not None:
        return TextClock(None, rate.hertz, (f"time from a rate of {rate.hertz:.9g} Hz in line {rate.line}",))
    listed = ", ".join(repr(name[:40]) for name in names[:20]) + (", ..." if len(names) > 20 else "")
    found = f"no column named time among {listed}"
    expected = "a column named time, in s, or a first column that increases from line to line"
    do = "Name the time column 'time', or add a line such as 'Sample rate: 500 Hz' above the names."
    raise InputError([Problem(file, found, expected, do)])


def _base(name: str) -> tuple[str, str | None]:
    """Split a time's name and unit: ``time [ms]``, ``Zeit/s``, ``t_us``."""
    match = _WITH_UNIT.fullmatch(name) or _LOOSE_UNIT.fullmatch(name)
    return (match[1].strip(), match[2].strip().lower()) if match else (name.strip(), None)


def _holds_time_word(name: str) -> bool:
    base, unit = _base(name[:200])
    words = re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-zà-ÿ])(?=[A-Z])", " ", base).lower())
    return bool(TIME_NAMES - {"t"} & set(words)) and (unit is None or unit in TIME_UNITS)


def _is_time_in_other_words(columns: Columns, index: int) -> bool:
    """Return whether a column's name contains a word for time, as SampleTimeFine, and its numbers mostly increase."""
    if not _holds_time_word(columns.names[index]) or index in columns.wrong:
        return False
    with np.errstate(all="ignore"):
        time, _ = _unwrapped(columns.clocks.get(index, columns.values[index]), columns.line)
    return bool(np.mean(np.diff(time) > 0) > 0.9) if len(time) > 1 else True


def _first_is_time(columns: Columns, rate: Rate | None) -> bool:
    first = min(columns.values)
    time, unit = columns.values[first], _base(columns.names[first])[1] or columns.units[first].lower() or "s"
    with np.errstate(all="ignore"):
        increases = first not in columns.wrong and bool((np.diff(time) > 0).all()) and unit in TIME_UNITS
    return increases and (rate is None or _unit_from(rate, time) is not None)


def _unit_from(rate: Rate, time: NDArray[np.float64]) -> float | None:
    """Return the unit, s, in which the median time step matches the stated rate; None where there is none."""
    with np.errstate(all="ignore"):
        step = float(np.median(np.diff(time))) * rate.hertz if len(time) > 1 else np.nan
    return next((unit for unit in (1.0, 1e-3, 1e-6, 1e-9) if abs(step * unit - 1) < 0.05), None)


def _from_column(columns: Columns, column: int, rate: Rate | None, file: str) -> TextClock:
    name = columns.names[column]
    if column in columns.wrong:
        raise InputError([columns.wrong[column]])
    time = columns.clocks.get(column, columns.values[column])
    gaps = np.isnan(time)
    if gaps.any():
        line = columns.line(int(gaps.argmax()))
        where, found = f"{file}: line {line}, column '{name}'", f"no time beside the samples of line {line}"
        raise InputError([Problem(where, found, "the time in every line", "Fill it in.")])
    with np.errstate(all="ignore"):
        if column in columns.clocks:
            days = np.cumsum(np.diff(time, prepend=time[:1]) < -_DAY / 2)
            return TextClock(column, time - time[:1] + _DAY * days, (f"time from the clock times in column '{name}'",))
        unit = _base(name)[1]
        unit = columns.units[column].lower() or None if unit is None else unit
        if unit is not None and unit not in TIME_UNITS:
            raise InputError([Problem(f"{file}: column '{name}'", f"'{unit}'", "a unit of time", _unit_meant(unit))])
        time, notes = _unwrapped(time, columns.line)
        if unit is not None:
            return TextClock(column, TIME_UNITS[unit] * time, notes)
        if name.lower() in _OWN_UNIT:
            return TextClock(column, _OWN_UNIT[name.lower()] * time, (*notes, f"time from column '{name}', in µs"))
        factor = _unit_from(rate, time) if rate is not None else None
        if rate is not None and factor not in (None, 1.0):
            notes = (*notes, f"unit of time, {factor:g} s, from the rate of {rate.hertz:.9g} Hz in line {rate.line}")
        return TextClock(column, (factor or 1.0) * time, notes)


def _unit_meant(unit: str) -> str:
    return did_you_mean(unit[:40], TIME_UNITS)


def _unwrapped(time: NDArray[np.float64], line: Callable[[int], int]) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Unwrap a counter of 32 bits."""
    if len(time) < 3 or not (np.abs(time) < WRAP).all():
        return time, ()
    steps = np.diff(time)
    again = (steps < 0) & (steps + WRAP > 0) & (steps + WRAP < 1000 * np.median(steps))
    if not again.any():
        return time, ()
    note = f"the time counter wraps at 2^32 in line {line(int(again.argmax()) + 1)}; it was unwrapped"
    return time + WRAP * np.concatenate(([0], np.cumsum(again))), (note,)
