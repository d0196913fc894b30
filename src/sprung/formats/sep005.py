"""Lists of dictionaries as SEP005 of the SDyPy project proposes them, from which other Python tools take signals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import InputError, Problems, did_you_mean
from sprung.formats.channels import ChannelClock, Column, assemble_table, clock_from_times, regular_clock
from sprung.formats.reading_errors import input_error
from sprung.formats.sample_store import Samples, store_in_memory

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sprung.formats.table import SampleTable

REQUIRED = ("name", "data", "unit_str")
OPTIONAL = ("fs", "time", "start_timestamp", "quantity", "location")

Signals = Mapping[str, Sequence[Mapping[str, object]]]
"""Recordings by name, each a list of dictionaries, one per signal."""


def from_sep005(signals: Sequence[Mapping[str, object]], name: str = "signals") -> SampleTable:
    """Return a table of signals.

    Parameters
    ----------
    signals
        One dictionary per signal: ``name``, ``data`` of shape (time,), ``unit_str``, and ``fs`` in Hz or ``time`` in s,
        shape (time,). Of ``start_timestamp``, ``quantity`` and ``location`` only the last is used, where several
        signals have one name. Other keys are left alone.
    name
        What to call them where something is wrong.

    Returns
    -------
    SampleTable

    Raises
    ------
    InputError
        If there is no signal, or something wrong with one; every problem at once.
    """
    problems = Problems()
    given: object = signals
    if not isinstance(given, Sequence) or isinstance(given, str) or not given:
        found = "no signals" if isinstance(given, Sequence) and not given else type(given).__name__
        problems.add(name, found, "a list of dictionaries, one per signal", "Put each signal in a dictionary.")
        problems.raise_if_any()
    columns: list[Column] = []
    for index, signal in enumerate(signals):
        with problems.collect():
            columns.append(_column(signal, f"{name}[{index}]"))
    starts = {start for signal in signals if (start := _start(signal))}
    if len(starts) > 1:
        do = "State all times on one clock, without a start_timestamp for each."
        problems.add(name, f"start_timestamp {', '.join(sorted(starts))}", "one and the same", do)
    problems.raise_if_any()
    return assemble_table(columns, name, np.inf)


def _start(signal: object) -> str:
    start = signal.get("start_timestamp") if isinstance(signal, Mapping) else None
    return "" if start is None else str(start)


def _column(signal: object, where: str) -> Column:
    """Check one signal."""
    problems = Problems()
    if not isinstance(signal, Mapping):
        do = "Put each signal in a dictionary."
        problems.add(where, f"{type(signal).__name__}", f"a dictionary with {', '.join(REQUIRED)}", do)
        raise InputError(problems)
    for key in REQUIRED:
        if key not in signal:
            near = did_you_mean(key, [str(other) for other in signal if other not in (*REQUIRED, *OPTIONAL)])
            problems.add(f"{where}.{key}", "nothing", "one of the keys that every signal has", f"Add it. {near}")
    for key in ("name", "unit_str", "quantity", "location"):
        if signal.get(key) is not None and not isinstance(signal[key], str):
            problems.add(f"{where}.{key}", _written(signal[key]), "text", "Write it in quotation marks.")
    data = np.empty(0)
    with problems.collect():
        if "data" in signal:
            data = _numbers(signal["data"], f"{where}.data")
    clock = ChannelClock(0.0, 0.0, len(data), None, np.zeros(len(data)))
    with problems.collect():
        clock = _clock(signal, len(data), where)
    problems.raise_if_any()
    name, location = str(signal["name"] or "").strip(), str(signal.get("location") or "").strip()
    otherwise = f"{location}.{name}" if location else name or where
    unit = str(signal["unit_str"] or "").strip() or None
    return Column(name, otherwise, unit, clock, Samples(store_in_memory(data[None]), 0))


def _clock(signal: Mapping[str, object], count: int, where: str) -> ChannelClock:
    """Return the clock from the times, otherwise from the rate; where both are given, they must agree."""
    rate, problems = _rate(signal.get("fs"), f"{where}.fs"), Problems()
    if signal.get("time") is None:
        if rate is None:
            do = "Add fs, in Hz, or time, in s."
            problems.add(f"{where}.fs", "neither fs nor time", "when the samples were taken", do)
            raise InputError(problems)
        clock = regular_clock(0.0, 1 / rate, count, 0.0, f"{where}.fs")
        return ChannelClock(0.0, clock.end, count, rate)
    times = _numbers(signal["time"], f"{where}.time")
    backward = np.flatnonzero(~(np.diff(times) > 0))
    if len(times) != count:
        do = "State one time per sample."
        problems.add(f"{where}.time", f"{len(times)} times for {count} samples", "as many times as samples", do)
    elif not np.isfinite(times).all() or backward.size:
        first = f", not so at sample {backward[0] + 2}" if backward.size else ""
        problems.add(f"{where}.time", f"times that do not increase{first}", "times that increase, in s", "Correct it.")
    problems.raise_if_any()
    clock = clock_from_times(times)
    if rate is not None and clock.rate is not None and abs(clock.rate / rate - 1) > 1e-6:
        found, do = f"{rate:.9g} Hz beside times at {clock.rate:.9g} Hz", "Leave one of them out."
        problems.add(f"{where}.fs", found, "a rate that agrees with time", do)
        raise InputError(problems)
    return clock


def _rate(given: object, where: str) -> float | None:
    if given is None:
        return None
    try:
        rate = float(given) if isinstance(given, Real) else np.nan
    except OverflowError:  # an integer larger than any float
        rate = np.nan
    if not (np.isfinite(rate) and rate > 0):
        raise input_error(where, _written(given), "samples per second, a positive number", "Correct it.")
    return rate


def _written(given: object) -> str:
    return " ".join(repr(given).split())[:80]


def _numbers(given: object, where: str) -> NDArray[np.float64]:
    """Return real numbers as an array of shape (time,)."""
    problems = Problems()
    try:
        array = np.asarray(given)
        if isinstance(given, np.ma.MaskedArray) and given.dtype.kind in "fiub":
            array = np.ma.filled(given.astype(np.float64), np.nan)
    except ValueError:
        array = np.empty((0, 0))  # lists of different lengths
    if array.dtype.kind not in "fiub" or array.ndim != 1 or not array.size:
        shape = f"an array of {array.dtype} of shape {array.shape}"
        problems.add(where, shape, "real numbers, shape (time,)", "Give each signal a dictionary of its own.")
        raise InputError(problems)
    return array.astype(np.float64)
