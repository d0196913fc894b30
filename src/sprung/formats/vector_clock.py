"""The clock of a recording among its vectors and numbers: a vector of times, a rate or an interval."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problem, did_you_mean
from sprung.formats.metadata import MetadataScope, normalise_name
from sprung.formats.nested import Number
from sprung.formats.stated_rates import TIME_UNITS
from sprung.formats.text_clock import TIME_NAMES
from sprung.units import split_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sprung.formats.nested import Content, Path
    from sprung.formats.sample_store import Samples

RATES = frozenset(("fs", "rate", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "samplefreq"))
RATES |= {"samplingfreq", "sfreq", "fsample", "fsampling", "samplespersecond", "abtastrate", "abtastfrequenz"}
INTERVALS = frozenset(("dt", "ts", "deltat", "timestep", "tstep", "sampletime", "samplingtime", "sampleinterval"))
INTERVALS |= {"samplinginterval", "sampleperiod", "samplingperiod", "wfincrement", "xincrement", "abtastzeit"}
RATE_UNITS = {"hz": 1.0, "khz": 1e3, "1/s": 1.0, "s/s": 1.0, "sps": 1.0}


@dataclass(frozen=True, eq=False)
class Vector:
    """Numbers in time.

    Attributes
    ----------
    path
        The names that lead to it.
    called
        The same, ending with what it is called, without the unit.
    samples
        Its samples, in its own unit.
    unit
        Unit stated in the file; None without one.
    moments
        Whether the file declares it to be times in s.
    """

    path: Path
    called: Path
    samples: Samples
    unit: str | None = None
    moments: bool = False

    @property
    def name(self) -> str:
        """Its names joined by dots."""
        return ".".join(self.called)

    def is_time(self) -> bool:
        """Return whether it is called time, or declared to be times."""
        return self.moments or time_name_unit(self.called[-1]) is not None

    def __len__(self) -> int:
        """Return the number of its samples."""
        return self.samples.store.length

    def increases(self) -> bool:
        """Return whether every sample is larger than the one before; reading stops at the first that is not."""
        before = -np.inf
        for piece in self.samples.pieces():
            if not (piece[:1] > before).all() or not (piece[1:] > piece[:-1]).all():
                return False
            before = float(piece[-1])
        return True


@dataclass(frozen=True, eq=False)
class VectorClock:
    """The clock of a recording.

    Attributes
    ----------
    time
        Seconds of every sample, shape (time,), or samples per second.
    taken
        Vectors that are not channels.
    notes
        Assumptions, in words.
    """

    time: NDArray[np.float64] | float
    taken: tuple[Vector, ...] = ()
    notes: tuple[str, ...] = ()


def time_name_unit(name: str) -> str | None:
    """Return the unit in a name of time: ``ms`` for ``time_ms`` or ``time (ms)``, empty for ``time``; None for other names.

    Parameters
    ----------
    name
        As written in the file.
    """
    if name.strip().lower() in TIME_NAMES:
        return ""
    match = re.fullmatch(r"(?P<name>.*?)\s*\[(?P<unit>.*)\]", name.strip())
    ending = re.fullmatch(r"(?P<name>.*?)[\s_]*[\s_(](?P<unit>[^\s()]+)\)?", name.strip())
    if ending is not None and ending["unit"].lower() in TIME_UNITS:
        match = ending
    return match["unit"].strip() if match is not None and match["name"].lower() in TIME_NAMES else None


def find_vector_clock(vectors: Sequence[Vector], content: Content, scope: MetadataScope, file: str) -> VectorClock:
    """Find the clock of vectors of one length.

    Parameters
    ----------
    vectors
        All vectors, in the file's order.
    content
        What else the file holds.
    scope
        Scopes of its texts and numbers.
    file
        Its name.

    Returns
    -------
    Clock

    Raises
    ------
    InputError
        If there is none, or more than one.
    """
    times = [vector for vector in vectors if vector.is_time()]
    said = _said_rates(content, scope)
    nearest = [scope.nearest(said, vector.path) for vector in vectors]
    rates = {_rate(number, said[number], file): number for number in nearest if number is not None}
    if times:
        return _time(times, rates, file)
    if len(rates) == 1:
        [(rate, number)] = rates.items()
        return VectorClock(rate, notes=(f"{rate:.6g} samples per second, from {_dotted(number.path)}",))
    if rates:
        found = f"several rates: {', '.join(f'{_dotted(n.path)} = {n.value:g}' for n in rates.values())}"
        raise InputError([Problem(file, found, "one rate for all channels", "Keep one recording per file.")])
    guesses = [v for v in vectors if v.increases() and (v.unit is None or v.unit.lower() in TIME_UNITS)]
    if len(guesses) == 1 < len(vectors):
        note = f"{guesses[0].name} is used as the time: no other vector increases from sample to sample"
        return VectorClock(_seconds(guesses[0], file), (guesses[0],), (note,))
    names = ", ".join(repr(vector.name) for vector in vectors[:20])
    found = f"no time among {names}" + (f" and {len(vectors) - 20} more" if len(vectors) > 20 else "")
    expected = "a vector named time, in s, or a number named fs or dt"
    raise InputError([Problem(file, found, expected, "Add one of them to the file.")])


def _time(times: Sequence[Vector], rates: dict[float, Number], file: str) -> VectorClock:
    """Return the times of the clock; where several vectors can be it, they must agree."""
    ranked = sorted(times, key=lambda vector: (not vector.increases(), not vector.moments))
    best = ranked[0]
    seconds = _seconds(best, file)
    for other in ranked[1:]:
        alike = (other.increases(), other.moments) == (best.increases(), best.moments)
        if alike and not np.array_equal(_seconds(other, file), seconds, equal_nan=True):
            found = f"two different times, {best.name} and {other.name}"
            raise InputError([Problem(file, found, "one time for all channels", "Keep one recording per file.")])
    notes = tuple(f"{other.name} was left out, as {best.name} is the time" for other in ranked[1:])
    span = float(seconds[-1]) - float(seconds[0])
    for rate, number in rates.items():
        if span > 0 and abs(span * rate / (len(seconds) - 1) - 1) > 0.01:
            notes += (f"{_dotted(number.path)} states {rate:.6g} samples per second, which differs from {best.name}",)
    return VectorClock(seconds, tuple(times), notes)


def _seconds(vector: Vector, file: str) -> NDArray[np.float64]:
    unit = (vector.unit or "s").lower()
    if unit not in TIME_UNITS:
        do = did_you_mean(unit, TIME_UNITS)
        raise InputError([Problem(f"{file}: {vector.name}", f"'{vector.unit}'", "a unit of time", do)])
    with np.errstate(all="ignore"):
        return TIME_UNITS[unit] * vector.samples.all()


def _said_rates(content: Content, scope: MetadataScope) -> dict[Number, str | None]:
    """Return all numbers that are called rates or intervals, also those written as text, with their units."""
    units = {text.path[:-1]: text.words[0] for text in scope.unit_lists()}
    said: dict[Number, str | None] = {}
    for number in content.numbers:
        called = scope.named_path(number.path)
        said[Number(called, number.value)] = units.get(number.path[:-1]) if called != number.path else None
    for text in content.texts:
        match = re.fullmatch(r"\s*([+-]?\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(\D*)", text.words[0])
        if match and len(text.words) == 1:
            said[Number(text.path, float(match[1]))] = match[2].strip() or None
    return {number: unit for number, unit in said.items() if number.path and _kind(number.path) is not None}


def _kind(path: Path) -> tuple[bool, str | None] | None:
    """Return whether a name is one of a rate (True) or an interval (False), and its unit; None for other names."""
    name, unit = split_unit(path[-1])
    ending = re.fullmatch(r"(.+?)_(\w+)", name)
    for bare, of in ((name, unit), *([(ending[1], ending[2])] if ending else [])):
        if normalise_name(bare) in RATES and (of or "Hz").lower() in RATE_UNITS:
            return True, of
        if normalise_name(bare) in INTERVALS and (of or "s").lower() in TIME_UNITS:
            return False, of
    return None


def _rate(number: Number, unit: str | None, file: str) -> float:
    kind = _kind(number.path)
    assert kind is not None  # noqa: S101 (only such were kept; for the type checker)
    is_rate, of = kind
    unit = unit or of or ("Hz" if is_rate else "s")
    known = RATE_UNITS if is_rate else TIME_UNITS
    value = number.value * known.get(unit.lower(), np.nan)
    if not 1e-6 <= (value if is_rate else 1 / value if value else 0.0) <= 1e9:
        expected = f"a positive number in one of {', '.join(known)}"
        found = f"{number.value:g} {unit}"
        raise InputError([Problem(f"{file}: {_dotted(number.path)}", found, expected, "Correct it.")])
    return float(value if is_rate else 1 / value)


def _dotted(path: Path) -> str:
    return ".".join(path)
