"""From the columns of a file to a recording: one clock, the campaign's channels, SI, positive up."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sprung.campaign.gap_filling import MAX_MISSING, fill_gaps
from sprung.campaign.recording import Recording
from sprung.campaign.time_base import RegularTimeBase, regularise_time_base
from sprung.errors import Fault, InputError, Problem, Problems, did_you_mean
from sprung.formats import MIN_RATE, SampleTable, resolves_wheel_hop
from sprung.units import SI_UNITS, Quantity, quantity_name, si_factor, si_symbol, split_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sprung.vehicle import Sensor

MAX_READING: Mapping[Quantity, float] = {
    "acceleration": 1e6,
    "velocity": 1e4,
    "displacement": 1e3,
    "angular-rate": 1e4,
    "force": 1e8,
}
"""SI: no sensor reads more; loggers write such numbers where they have none."""

_USUAL: Mapping[Quantity, str] = {
    "acceleration": "g",
    "velocity": "mm/s",
    "displacement": "mm",
    "angular-rate": "deg/s",
    "force": "N",
}
"""Units that loggers usually write."""

_LATEST, _SHORTEST = 1e12, 1e-9
"""s: no clock shows more, and no sample follows another sooner."""


def find_column(table: SampleTable, channel: str) -> tuple[int, ...]:
    """Find a sensor's columns: of just that name, or else of that name with a unit behind it.

    Parameters
    ----------
    table
        The file's columns.
    channel
        As the campaign file has it, with or without the unit that the file appends.

    Returns
    -------
    tuple of int
        Indices of the columns: one, or none, or several that the name does not tell apart.
    """
    wanted = split_unit(channel)
    exact = tuple(i for i, column in enumerate(zip(table.channels, table.units, strict=True)) if column == wanted)
    return exact or tuple(i for i, name in enumerate(table.channels) if name == channel.strip())


def make_recording(table: SampleTable, sensors: Sequence[Sensor], name: str) -> Recording:
    """Return the recording of one drop, from the table of one file.

    Parameters
    ----------
    table
        What its file holds.
    sensors
        The campaign's, in the order of the channels.
    name
        The file's, as the campaign names it.

    Returns
    -------
    Recording
        Its faults name what was missing and was filled in, and the channels left out.

    Raises
    ------
    InputError
        If the clock does not run forward or is too slow, a needed cell holds text or a unit is none of what is measured;
        all problems at once.
    """
    problems = Problems()
    faults: list[Fault] = []
    left_out: list[Fault] = []
    done: dict[str, list[str]] = {}
    full_scale: list[float | None] = []
    with problems.collect():
        _refuse_backward(table, name)
    raw: dict[int, NDArray[np.float64]] = {}
    needed = [column[0] for sensor in sensors if len(column := find_column(table, sensor.channel)) == 1]
    table = _common_range(table, needed)
    with problems.collect():
        raw = dict(zip(needed, table.take(needed), strict=True))
    problems.raise_if_any()
    values = np.full((len(sensors), table.samples), np.nan)
    for sensor, row in zip(sensors, values, strict=True):
        with problems.collect():
            found = _channel(table, raw, sensor, sensors, name)
            if isinstance(found, Fault):
                left_out.append(found)
                full_scale.append(None)
            else:
                row[:], step, factor = found
                done.setdefault(step, []).append(sensor.channel)
                full_scale.append(None if sensor.range is None else sensor.range * factor)
    del raw
    problems.raise_if_any()

    count = values.shape[1]
    samples = _regular(table, values, name)
    useless = np.isnan(samples.values).all() and bool(samples.faults)
    if not (resolves_wheel_hop(samples.rate) or useless):
        raise InputError([_too_slow(samples.rate, name)])
    if useless:
        faults, left_out = [*samples.faults], []
    else:
        wheres = [f"{name}: {sensor.channel}" for sensor in sensors]
        filled, first, gaps, lost = fill_gaps(
            samples.values, samples.lost, samples.rate, wheres, lambda sample: table.place(int(samples.origin[sample]))
        )
        samples = samples._replace(values=filled, start=samples.start + first / samples.rate)
        faults = [*samples.faults, *left_out, *gaps]
        left_out += lost
        if np.isnan(samples.values).all():
            do = "Check the logger and its cables, and the channel names in the campaign file."
            left_out.append(Fault("missing", name, "no channel of it is usable; the drop is left out", do))
            faults.append(left_out[-1])
    history = (
        f"read {count} samples at {samples.rate:.6g} Hz, from {samples.start:.6g} s on",
        *table.notes,
        *(f"{', '.join(channels)}: {step}" for step, channels in done.items()),
        *(f"{fault.where}: {f'left out ({fault.code})' if fault in left_out else fault.what}" for fault in faults),
    )
    return Recording(
        name=name,
        channels=tuple(sensor.channel for sensor in sensors),
        values=samples.values,
        start=samples.start,
        rate=samples.rate,
        history=history,
        faults=tuple(faults),
        full_scale=tuple(full_scale),
        rate_ratios=_rate_ratios(table, sensors),
    )


def _rate_ratios(table: SampleTable, sensors: Sequence[Sensor]) -> tuple[float, ...]:
    """Return the rate ratio of each channel; empty where all channels have one clock."""
    columns = [find_column(table, sensor.channel)[:1] for sensor in sensors]
    slower = [
        table.resampled[column[0]].rate_ratio if column and column[0] in table.resampled else 1.0 for column in columns
    ]
    return tuple(slower) if min(slower, default=1.0) < 1 else ()


def _common_range(table: SampleTable, needed: Sequence[int]) -> SampleTable:
    """Leave out the few samples at both ends that columns of another clock do not reach."""
    covering = [table.resampled[column] for column in needed if column in table.resampled]
    covering = [column for column in covering if column.last - column.first >= (1 - MAX_MISSING) * table.samples]
    first = max((column.first for column in covering), default=0)
    last = min((column.last for column in covering), default=table.samples)
    return table.part(first, last) if last - first < table.samples else table


def _channel(
    table: SampleTable, raw: Mapping[int, NDArray[np.float64]], sensor: Sensor, sensors: Sequence[Sensor], file: str
) -> tuple[NDArray[np.float64], str, float] | Fault:
    """Return samples, SI (NaN where missing), what was done to them and their unit; or why the channel is left out."""
    where, columns = f"{file}: {sensor.channel}", find_column(table, sensor.channel)
    if not columns:
        what = f"the recording has no column '{sensor.channel}'; the channel is left out of this drop"
        unclaimed = set(table.channels) - {split_unit(other.channel)[0] for other in sensors}
        meant = f" {did_you_mean(sensor.channel, unclaimed, heading='It also has')}" if unclaimed else ""
        return Fault("missing", where, what, f"Check the sensor's cable and the logger's channel names.{meant}")
    if len(columns) > 1:
        found, do = f"{len(columns)} columns of that name", "Rename the columns in the file."
        raise InputError([Problem(where, found, "one column per channel", do)])
    column = columns[0]
    samples, stated, of = raw[column], sensor.unit or table.units[column], quantity_name(sensor.quantity)
    unit = stated or SI_UNITS[sensor.quantity]
    if not np.isfinite(samples).all() and (problem := table.find_non_number(column)) is not None:
        raise InputError([problem])
    if not np.isfinite(samples).any():
        do = "Check the sensor's cable and the logger, or export the recording again."
        return Fault("missing", where, "every sample is missing; the channel is left out of this drop", do)
    do = f'Give the sensor a unit in the campaign file, such as unit = "{_USUAL[sensor.quantity]}", if that is what it is.'
    if not stated and sensor.quantity != "acceleration":
        raise InputError([Problem(where, "no unit, in the campaign file or in the recording", f"a unit of {of}", do)])
    try:
        factor = si_factor(unit, sensor.quantity)
    except ValueError:
        raise InputError([Problem(where, f"the unit '{unit}'", f"a unit of {of}", do)]) from None
    no_number = ~(np.abs(samples) <= MAX_READING[sensor.quantity] / factor)
    if no_number.all():
        first = f"the first {samples[0]:.4g} {unit}"
        what = f"every sample exceeds the range of any sensor of {of}, {first}; the channel is left out of this drop"
        return Fault("missing", where, what, "Check the sensor's cable and its unit.")
    source = (
        ""
        if sensor.unit
        else ", as the file says"
        if table.units[column]
        else ", as neither the file nor the campaign names a unit"
    )
    step = f"read in {unit}{source}" + (f", times {factor:g} to {si_symbol(sensor.quantity)}" if factor != 1 else "")
    sign = -1.0 if sensor.direction == "down" else 1.0
    step += ", turned from down to up" if sign < 0 else ""
    return sign * factor * np.where(no_number, np.nan, samples), step, factor


def _refuse_backward(table: SampleTable, file: str) -> None:
    time = table.time
    if len(time) < 2:
        found, do = "a single sample" if len(time) else "no samples", "Export it again."
        raise InputError([Problem(file, found, "the samples of a whole drop", do)])
    far = np.flatnonzero(~(np.abs(time) <= _LATEST))
    if far.size:
        where, found = f"{file}: {table.place(int(far[0]))}", f"the time {time[far[0]]:.9g} s"
        raise InputError([Problem(where, found, "the time of a sample, in s", "Export the recording again.")])
    backward = np.flatnonzero(~(np.diff(time) > 0)) + 1
    if backward.size:
        first = int(backward[0])
        again = f" (the first of {backward.size} such places)" if backward.size > 1 else ""
        found = f"the time {time[first]:.9g} s after {time[first - 1]:.9g} s{again}"
        do = "Remove the repeated part, or export the time with more digits."
        raise InputError(
            [Problem(f"{file}: {table.place(first)}", found, "a time that increases from line to line", do)]
        )
    usual = float(np.median(np.diff(time)))
    if usual < _SHORTEST:
        found, do = f"{usual:.3g} s from one sample to the next", "Check that the time is in s, or name its unit."
        raise InputError([Problem(file, found, f"steps of {_SHORTEST:g} s or more", do)])


def _regular(table: SampleTable, values: NDArray[np.float64], file: str) -> RegularTimeBase:
    if isinstance(table.clock, np.ndarray):
        return regularise_time_base(table.clock, values, table.place, file)
    count = values.shape[1]
    return RegularTimeBase(values, 0.0, table.clock, np.zeros(count, dtype=bool), np.arange(count))


def _too_slow(rate: float, file: str) -> Problem:
    do = "Record at 200 Hz or more."
    if 1e3 * rate >= MIN_RATE:
        do += " If the time is written in ms, name its column 'time [ms]'; if it only counts samples, give it in s."
    return Problem(file, f"{rate:.4g} samples per second", f"at least {MIN_RATE:g}, to resolve wheel hop", do)
