"""From the columns of a file to a recording: one clock, the campaign's channels, m/s², positive up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sprung.errors import Fault, InputError, Problem, Problems, did_you_mean
from sprung.recording.formats import Table, split_unit
from sprung.recording.recording import Recording
from sprung.units import acceleration_factor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sprung.vehicle import Sensor

SLOWEST = 64.0
"""Samples per second below which wheel hop, up to some 20 Hz, is lost."""

LARGEST = 1e6
"""m/s²: no accelerometer reads more; loggers write such numbers where they have none."""

UNEVEN = 0.2
"""By how much, relative to the usual step, a step of an even clock may differ."""


def column_of(table: Table, channel: str) -> tuple[int, ...]:
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


def own_unit(sensor: Sensor, written: str | None) -> str:
    """Give the unit of a channel: the sensor's, otherwise what the file says, otherwise m/s².

    Parameters
    ----------
    sensor
        The sensor.
    written
        What the file says; None where it says nothing.
    """
    return sensor.unit or written or "m/s^2"


def recording_of(table: Table, sensors: Sequence[Sensor], name: str) -> Recording:
    """Make the recording of one drop.

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
        Its faults name the channels left out.

    Raises
    ------
    InputError
        If the clock does not run forward or is too slow, a needed cell holds text or a unit is none of acceleration;
        all problems at once.
    """
    problems = Problems()
    faults: list[Fault] = []
    done: dict[str, list[str]] = {}
    with problems.collecting():
        _refuse_backward(table, name)
    values = np.full((len(sensors), table.values.shape[1]), np.nan)
    for sensor, row in zip(sensors, values, strict=True):
        with problems.collecting():
            found = _channel(table, sensor, sensors, name)
            if isinstance(found, Fault):
                faults.append(found)
            else:
                row[:], step = found
                done.setdefault(step, []).append(sensor.channel)
    problems.raise_if_any()

    time = table.time
    rate = float((len(time) - 1) / (time[-1] - time[0])) if isinstance(table.clock, np.ndarray) else table.clock
    uneven = _uneven(table, name)
    if uneven is not None:
        values[:] = np.nan
        faults = [uneven]
    elif rate < SLOWEST:
        raise InputError([_too_slow(rate, name)])
    elif np.isnan(values).all():
        do = "Check the logger and its cables, and the channel names in the campaign file."
        faults.append(Fault("missing", name, "no channel of it is usable; the drop is left out", do))
    history = (
        f"read {len(time)} samples at {rate:.6g} Hz, from {time[0]:.6g} s on",
        *table.notes,
        *(f"{', '.join(channels)}: {step}" for step, channels in done.items()),
        *(f"{fault.where}: left out ({fault.code})" for fault in faults),
    )
    channels = tuple(sensor.channel for sensor in sensors)
    return Recording(name, channels, values, float(time[0]), rate, history, tuple(faults))


def _channel(
    table: Table, sensor: Sensor, sensors: Sequence[Sensor], file: str
) -> tuple[NDArray[np.float64], str] | Fault:
    """Give one sensor's samples and what was done to them, or why it is left out."""
    where, columns = f"{file}: {sensor.channel}", column_of(table, sensor.channel)
    if not columns:
        what = f"the recording has no column '{sensor.channel}'; the channel is left out of this drop"
        unclaimed = set(table.channels) - {split_unit(other.channel)[0] for other in sensors}
        meant = f" {did_you_mean(sensor.channel, unclaimed)}".replace("Allowed:", "It also has:") if unclaimed else ""
        return Fault("missing", where, what, f"Check the sensor's cable and the logger's channel names.{meant}")
    if len(columns) > 1:
        found, do = f"{len(columns)} columns of that name", "Rename the columns in the file."
        raise InputError([Problem(where, found, "one column per channel", do)])
    column = columns[0]
    if table.channels[column] in table.spoilt:
        raise InputError([table.spoilt[table.channels[column]]])
    raw, unit = table.values[column], own_unit(sensor, table.units[column])
    again = "Check the sensor's cable and the logger, or export the recording again."
    gaps = ~np.isfinite(raw)
    if gaps.any():
        some = "every sample is" if gaps.all() else f"{gaps.sum()} of {gaps.size} samples are"
        first = "" if gaps.all() else f", the first in {table.place(int(gaps.argmax()))}"
        return Fault("missing", where, f"{some} missing{first}; the channel is left out of this drop", again)
    try:
        factor = acceleration_factor(unit)
    except ValueError:
        do = 'Give the sensor a unit in the campaign file, such as unit = "g", if that is what the numbers are.'
        raise InputError([Problem(where, f"the unit '{unit}'", "a unit of acceleration", do)]) from None
    beyond = np.abs(raw) > LARGEST / factor
    if beyond.any():
        first = f"{raw[beyond.argmax()]:.4g} {unit} in {table.place(int(beyond.argmax()))}"
        what = f"{beyond.sum()} of {beyond.size} samples read more than any accelerometer can, the first {first}"
        return Fault("missing", where, f"{what}; the channel is left out of this drop", again)
    source = (
        ""
        if sensor.unit
        else ", as the file says"
        if table.units[column]
        else ", as neither the file nor the campaign names a unit"
    )
    step = f"read in {unit}{source}" + (f", times {factor:g} to m/s²" if factor != 1 else "")
    sign = -1.0 if sensor.direction == "down" else 1.0
    return sign * factor * raw, step + (", turned from down to up" if sign < 0 else "")


def _refuse_backward(table: Table, file: str) -> None:
    time = table.time
    if len(time) < 2:
        found, do = "a single sample" if len(time) else "no samples", "Export it again."
        raise InputError([Problem(file, found, "the samples of a whole drop", do)])
    backward = np.flatnonzero(~(np.diff(time) > 0)) + 1
    if backward.size:
        first = int(backward[0])
        again = f" (the first of {backward.size} such places)" if backward.size > 1 else ""
        found = f"the time {time[first]:.9g} s after {time[first - 1]:.9g} s{again}"
        do = "Remove the repeated part, or export the time with more digits."
        raise InputError(
            [Problem(f"{file}: {table.place(first)}", found, "a time that increases from line to line", do)]
        )


def _uneven(table: Table, file: str) -> Fault | None:
    """Find steps of the clock that are none of an even one."""
    time = table.time
    steps = np.diff(time)
    usual = float(np.median(steps))
    digits = next((digits for digits in range(10) if np.allclose(time, time.round(digits), rtol=0, atol=1e-12)), 10)
    if np.abs(time - np.linspace(time[0], time[-1], len(time))).max() <= 10.0**-digits:
        return None  # an even clock, written with too few digits to look even
    off = np.flatnonzero(np.abs(steps - usual) > UNEVEN * usual)
    if not off.size:
        return None
    first = int(off[0])
    what = (
        f"the clock is uneven: {off.size} of {steps.size} steps differ from the usual {usual:.6g} s by more than "
        f"{UNEVEN:.0%}, the first, {steps[first]:.6g} s, up to {table.place(first + 1)}; the drop is left out"
    )
    return Fault("clock", file, what, "Export the recording at a fixed rate, or repeat the drop.")


def _too_slow(rate: float, file: str) -> Problem:
    do = "Record at 200 Hz or more."
    if 1e3 * rate >= SLOWEST:
        do += " If the time is written in ms, name its column 'time [ms]'; if it only counts samples, give it in s."
    return Problem(file, f"{rate:.4g} samples per second", f"at least {SLOWEST:g}, to see wheels hop", do)
