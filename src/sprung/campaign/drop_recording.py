"""One drop's recording from the files that hold it: one file, part of one, or one for each of several loggers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sprung.campaign.drop import Drop
from sprung.campaign.logger_files import find_logger_files
from sprung.campaign.logger_merging import merge_loggers
from sprung.campaign.logger_windows import cut_to_window
from sprung.campaign.recording import Recording
from sprung.campaign.signals import find_column, make_recording
from sprung.errors import Fault, InputError, Problem, Problems
from sprung.formats import SampleTable
from sprung.vehicle import Sensor


def qualify_channels(sensors: Sequence[Sensor]) -> tuple[Sensor, ...]:
    """Return the sensors; where several have one channel name, the logger's name is put before it.

    Parameters
    ----------
    sensors
        As the campaign file describes them.
    """
    often = Counter(sensor.channel for sensor in sensors)
    return tuple(
        replace(sensor, channel=f"{sensor.logger} {sensor.channel}")
        if often[sensor.channel] > 1 and sensor.logger
        else sensor
        for sensor in sensors
    )


def assemble_recording(
    tables: Mapping[str, SampleTable], sensors: Sequence[tuple[Sensor, Sensor]], drop: Drop, name: str
) -> Recording:
    """Return the recording of one drop, from the tables of its files.

    Parameters
    ----------
    tables
        What its files hold, by their names.
    sensors
        The campaign's: each as the campaign file describes it, and as it is called from then on.
    drop
        The drop.
    name
        What to call it.

    Returns
    -------
    Recording
        Several loggers are merged as if all had been started at one moment; preprocessing aligns them at the release.

    Raises
    ------
    InputError
        If the logger of a channel is ambiguous, or one of the files cannot be used; all problems at once.
    """
    if len(tables) == 1:
        ((only, table),) = tables.items()
        recording = make_recording(_within(table, drop.window), [written for written, _ in sensors], only)
        return replace(recording, name=name, channels=tuple(named.channel for _, named in sensors))
    problems = Problems()
    loggers = {written.logger for written, _ in sensors if written.logger}
    sensors_of_file: dict[str, list[tuple[Sensor, Sensor]]] = {file: [] for file in tables}
    faults: list[Fault] = []
    for written, named in sensors:
        with problems.collect():
            file = _file_of(written, tables, loggers)
            if file is None:
                faults.append(_nowhere(written, name))
            else:
                sensors_of_file[file].append((written, named))
    parts: list[Recording] = []
    for file_name, of_logger in sensors_of_file.items():
        with problems.collect():
            if of_logger:
                part = make_recording(tables[file_name], [written for written, _ in of_logger], file_name)
                parts.append(replace(part, channels=tuple(named.channel for _, named in of_logger)))
    if drop.window is not None and not sensors_of_file[drop.files[0]]:
        where, found = f"{name}: window", f"no sensor of the campaign in {drop.files[0]}, on whose clock it is"
        problems.add(where, found, "a window on the clock of a file that is used", "Name another file first in files.")
    problems.raise_if_any()
    if drop.window is not None:
        parts = list(cut_to_window(parts, drop.window))
    channels = tuple(named.channel for _, named in sensors)
    faults += [fault for part in parts for fault in part.faults]
    nothing = np.full((len(channels), 0), np.nan)
    whole = Recording(name, channels, nothing, 0.0, 1.0, faults=tuple(faults), parts=tuple(parts))
    return merge_loggers(whole, [part.start for part in parts])


def _within(table: SampleTable, window: tuple[float, float] | None) -> SampleTable:
    """Return the part of a table within a window of its clock, s."""
    if window is None:
        return table
    time = table.time
    return table.part(int(np.searchsorted(time, window[0])), int(np.searchsorted(time, window[1], side="right")))


def _file_of(sensor: Sensor, tables: Mapping[str, SampleTable], loggers: Collection[str]) -> str | None:
    """Return the file that a sensor's logger wrote: one with its name, otherwise the only one with such a channel.

    Where no file has its name, one named after another logger is not its own.
    """
    own = find_logger_files(tables, sensor.logger) if sensor.logger else []
    named = {file for logger in loggers for file in find_logger_files(tables, logger)} if sensor.logger else set()
    free = [file for file in tables if file not in named]
    files = [file for file in own or free if find_column(tables[file], sensor.channel)]
    if len(files) > 1:
        found = f"'{sensor.channel}' in {', '.join(files)}"
        do = 'Give the sensor logger = "...": a part of the file name that only its own files have.'
        raise InputError([Problem(f"sensor '{sensor.channel}'", found, "the channel in one file of each drop", do)])
    return next(iter(files), None)


def _nowhere(sensor: Sensor, name: str) -> Fault:
    logger = f" of the logger '{sensor.logger}'" if sensor.logger else ""
    what = f"no file of this drop has a column '{sensor.channel}'{logger}; the channel is left out of this drop"
    return Fault("missing", f"{name}: {sensor.channel}", what, "Check the logger, and the names in the campaign file.")
