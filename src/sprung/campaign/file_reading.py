"""Campaign files and the recordings that they name: every fault of all of them at once."""

from __future__ import annotations

from dataclasses import astuple, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sprung.campaign.campaign import Campaign
from sprung.campaign.checks import check, find_wrong_unit
from sprung.campaign.completeness import find_missing_entries
from sprung.campaign.drop import Drop, DropTest, unique_recording_names
from sprung.campaign.drop_recording import assemble_recording, qualify_channels
from sprung.campaign.parsing import ParsedFile, parse_document
from sprung.campaign.repeated_problems import merge_repeated
from sprung.campaign.schema import CampaignFile
from sprung.campaign.signals import find_column
from sprung.campaign.source_file import SourceFile
from sprung.errors import Fault, InputError, Problem, Problems, did_you_mean
from sprung.formats import SampleTable, Signals, from_sep005, read_table
from sprung.progress import Progress, counted
from sprung.units import split_unit
from sprung.vehicle import EMPTY, Load, Sensor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sprung.campaign.recording import Recording


def read_campaign(
    document: Mapping[str, Any], path: Path, signals: Signals, complete: bool, progress: Progress
) -> Campaign:
    """Read the recordings of a campaign file; see `sprung.campaign.read_document`."""
    problems, unread = Problems(), Problems()
    of_recordings = problems if complete else unread
    parsed = parse_document(CampaignFile, document, path.name, problems)
    missing = tuple(find_missing_entries(parsed))
    if complete:
        for entry in missing:
            if entry.needed:
                problems.add(*astuple(entry.problem))
    check(parsed, problems)
    files = _files(parsed, problems)
    tables = _tables(files, path.parent, signals, of_recordings, progress)
    _check_signals(parsed, files, signals, problems)
    _check_channels(parsed, tables, problems)
    _check_starts_and_ends(parsed, tables, problems)
    sensors = qualify_channels(parsed.file.sensor)
    drops = _recorded(parsed, sensors, tables, of_recordings, progress)
    if found := tuple(problems) or (() if drops else tuple(unread)):
        raise InputError(merge_repeated(found, {name for of_drop in tables.values() for name in of_drop}))
    _refuse_unusable([drop.recording for drop in drops.values()])
    return replace(
        stated_campaign(parsed, path, sensors),
        drops=tuple(drops.values()),
        faults=tuple(_unread_fault(problem) for problem in unread),
        files=_sources(files, path, signals),
        missing=missing,
        unread=tuple(
            drop for index, drop in zip(parsed.numbered("drop"), parsed.file.drop, strict=True) if index not in drops
        ),
    )


def stated_campaign(parsed: ParsedFile[CampaignFile], path: Path, sensors: Sequence[Sensor]) -> Campaign:
    """Return what a campaign file states of the vehicle, its sensors and loads, without drops."""
    vehicle = parsed.file.vehicle
    return Campaign(
        name=vehicle.name or _printable(path.absolute().parent.name),
        sensors=tuple(sensors),
        drops=(),
        loads=stated_loads(parsed.file),
        wheelbase=vehicle.wheelbase.known if vehicle.wheelbase else None,
        cg_height=vehicle.cg_height,
        wheel_height=vehicle.wheel_height,
        roll_axis_height=vehicle.roll_axis_height,
        known={name: measured.known for name, measured in parsed.file.known.items()},
        model=parsed.file.model,
        path=path,
        vehicle_model=vehicle.model,
        identification=vehicle.identification,
        test=parsed.file.test,
        motion_ratio=vehicle.motion_ratio.known,
    )


def stated_loads(file: CampaignFile) -> tuple[Load, ...]:
    """Return the loads of a campaign file, ``empty`` first."""
    return (EMPTY, *(load for load in file.load if load.name != EMPTY.name))


def _files(parsed: ParsedFile[CampaignFile], problems: Problems) -> dict[int, tuple[str, ...]]:
    """Return the names of the recordings by the drop's index in the file, also of drops with other faults."""
    written = [] if ("drop",) in parsed.lost else parsed.document.get("drop", [])
    entries = {index: entry for index, entry in enumerate(written) if isinstance(entry, dict)}
    either = {index: entry.get("files") or [entry.get("file")] for index, entry in entries.items()}
    files = {index: names for index, names in either.items() if names != [None]}
    for index in parsed.numbered("drop"):
        if index not in files:
            where = parsed.where("drop", index, "file")
            problems.add(where, "nothing", "the name of its recording", 'Add file = "..." to it.')
    return {
        index: tuple(names)
        for index, names in files.items()
        if isinstance(names, list) and all(isinstance(name, str) for name in names)
    }


def _tables(
    files: Mapping[int, Sequence[str]], folder: Path, signals: Signals, problems: Problems, progress: Progress
) -> dict[int, dict[str, SampleTable]]:
    """Read every recording that can be read, each once; by the drop's index and the recording's name."""
    others = {Path(file).name for names in files.values() for file in names}
    read_already: dict[str, SampleTable] = {}
    names_once = tuple(dict.fromkeys(file for names in files.values() for file in names))
    for file in counted(progress, "reading the recordings", names_once):
        try:
            read_already[file] = (
                from_sep005(signals[file], Path(file).name) if file in signals else read_table(folder / file, others)
            )
        except InputError as error:
            for problem in error.problems:
                where = problem.where.replace(Path(file).name, file, 1)
                problems.add(where, problem.found, problem.expected, problem.do)
    # A drop of which one file is lost has a problem already: its others are not asked for what that one has.
    return {
        index: {file: read_already[file] for file in names}
        for index, names in files.items()
        if all(file in read_already for file in names)
    }


def _sources(files: Mapping[int, Sequence[str]], path: Path, signals: Signals) -> tuple[SourceFile, ...]:
    """Return the checksums of all files that were read, each once."""
    recordings = dict.fromkeys(file for names in files.values() for file in names if file not in signals)
    names = (path.name, *recordings)
    return tuple(SourceFile.of(path.parent, name) for name in names if (path.parent / name).is_file())


def _unread_fault(problem: Problem) -> Fault:
    """Return the fault of a recording that cannot be read."""
    what = f"found {problem.found}, expected {problem.expected}; the recording is left out"
    return Fault("unreadable", problem.where, what, problem.do)


def _check_signals(
    parsed: ParsedFile[CampaignFile], files: Mapping[int, Sequence[str]], signals: Signals, problems: Problems
) -> None:
    """Add a problem for every given signal that no drop uses."""
    wanted = {file for names in files.values() for file in names}
    for name in signals:
        if name not in wanted and parsed.complete("drop"):
            do = did_you_mean(name, wanted - set(signals), heading="Without signals")
            problems.add("signals", f"'{name}', which no drop has", "the name of a drop's recording", do)


def _check_channels(
    parsed: ParsedFile[CampaignFile], tables: Mapping[int, Mapping[str, SampleTable]], problems: Problems
) -> None:
    """Add a problem for every sensor that is in no recording."""
    whole = [table for of_drop in tables.values() for table in of_drop.values()]
    columns = sorted({name for table in whole for name in table.channels})
    sensors = tuple(zip(parsed.numbered("sensor"), parsed.file.sensor, strict=True))
    unclaimed = set(columns) - {split_unit(sensor.channel)[0] for _, sensor in sensors}
    for index, sensor in sensors:
        if whole and not any(find_column(table, sensor.channel) for table in whole):
            where = parsed.where("sensor", index, "channel")
            expected = "the name of a column of the recordings"
            problems.add(
                where,
                f"'{sensor.channel}', which no recording has",
                expected,
                did_you_mean(sensor.channel, unclaimed or columns, heading="They have"),
            )


def _recorded(
    parsed: ParsedFile[CampaignFile],
    sensors: Sequence[Sensor],
    tables: Mapping[int, Mapping[str, SampleTable]],
    problems: Problems,
    progress: Progress,
) -> dict[int, DropTest]:
    """Return every drop whose files could be read, with its recording; by the drop's index."""
    pairs = [
        (written, named)
        for written, named in zip(parsed.file.sensor, sensors, strict=True)
        if find_wrong_unit(written) is None
    ]
    understood = dict(zip(parsed.numbered("drop"), parsed.file.drop, strict=True))
    drops = [understood.get(index) or Drop(file=next(iter(of_drop))) for index, of_drop in tables.items()]
    recorded: dict[int, DropTest] = {}
    names = counted(progress, "checking the clocks and units of the recordings", tuple(unique_recording_names(drops)))
    for (index, of_drop), drop, name in zip(tables.items(), drops, names, strict=True):
        with problems.collect():
            recorded[index] = drop.with_recording(assemble_recording(of_drop, pairs, drop, name))
    return recorded


def _check_starts_and_ends(
    parsed: ParsedFile[CampaignFile], tables: Mapping[int, Mapping[str, SampleTable]], problems: Problems
) -> None:
    for index, drop in zip(parsed.numbered("drop"), parsed.file.drop, strict=True):
        time = next(iter(tables[index].values())).time if index in tables else np.empty(0)
        window = drop.window or (None, None)
        for key, value in (("start", drop.start), ("end", drop.end), ("window", window[0]), ("window", window[1])):
            if value is not None and len(time) > 1 and not time.min() <= value <= time.max():
                expected = f"a time within the recording, {time.min():.6g} to {time.max():.6g} s on its own clock"
                do = f"Correct {key}, or leave it out."
                problems.add(parsed.where("drop", index, key), f"{value:g} s", expected, do)


def _printable(name: str) -> str:
    """Replace what a file system allows in names and UTF-8 does not."""
    return name.encode("utf-8", errors="replace").decode()


def _refuse_unusable(recordings: Sequence[Recording]) -> None:
    if any(recording.usable.any() for recording in recordings):
        return
    raise InputError(
        fault.as_problem("something usable in at least one drop")
        for recording in recordings
        for fault in recording.faults
    )
