"""Writing a campaign: the campaign file and one text table per drop, as `sprung.recording.read` reads them back."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import tomli_w
from pydantic import TypeAdapter

from sprung.recording.formats import split_unit
from sprung.recording.published import SCHEMA_FILE, SCHEMA_LINE, schema_text
from sprung.recording.reading import FILE
from sprung.recording.schema import SCHEMA
from sprung.recording.signals import own_unit
from sprung.recording.whole import write_whole
from sprung.units import acceleration_factor
from sprung.vehicle import EMPTY, Load, Sensor

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence

    from sprung.estimate import Known
    from sprung.recording.campaign import Campaign, Drop
    from sprung.recording.recording import Recording


def write(campaign: Campaign, folder: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write a campaign into a folder, whole or not at all.

    The recordings are written in each sensor's own unit and direction, nine significant digits; a channel that is left
    out stays without numbers. Recordings of other formats become text tables. The JSON Schema of the campaign file is put
    beside it, by which editors complete its keys.

    Parameters
    ----------
    campaign
        The campaign.
    folder
        Where to; made if it does not exist. Files that an earlier call wrote there are replaced.
    overwrite
        Whether other files of the same names, and files that were changed since sprung wrote them, are replaced too.

    Returns
    -------
    Path
        The campaign file.

    Raises
    ------
    InputError
        If such files would be overwritten, with their list, or the folder cannot be made or written to.
    """
    pieces = [recording.parts or (recording,) for recording in campaign.recordings]
    names = tuple(_file_names(campaign.drops, pieces))
    sensors = {sensor.channel: sensor for sensor in campaign.sensors}
    files = {
        name: _table(piece, [sensors[channel] for channel in piece.channels])
        for own, of_drop in zip(names, pieces, strict=True)
        for name, piece in zip(own, of_drop, strict=True)
    }
    files[SCHEMA_FILE] = schema_text().encode()
    files[FILE] = SCHEMA_LINE.encode() + _toml(_document(campaign, names))
    write_whole(folder, files, overwrite=overwrite)
    return Path(folder) / FILE


def _file_names(drops: Sequence[Drop], pieces: Sequence[Sequence[Recording]]) -> Iterator[tuple[str, ...]]:
    """Name each drop's text tables: their files' own names where these stay within the folder, and no two alike."""
    taken: set[str] = set()
    for drop, of_drop in zip(drops, pieces, strict=True):
        own = []
        for file in [piece.name for piece in of_drop] if len(of_drop) > 1 else [drop.file]:
            path = PurePosixPath(file or drop.label)
            if path.is_absolute() or ".." in path.parts:
                path = PurePosixPath(path.name)
            plain = path.with_name(path.stem if file else path.name)
            name, count = f"{plain}.csv", 1
            while name.lower() in taken:  # some file systems take A.csv for a.csv
                count += 1
                name = f"{plain}_{count}.csv"
            taken.add(name.lower())
            own.append(name)
        yield tuple(own)


def _document(campaign: Campaign, files: Sequence[Sequence[str]]) -> dict[str, Any]:
    heights = ("cg_height", "wheel_height", "roll_axis_height")
    vehicle: dict[str, Any] = {"name": campaign.name}
    if campaign.identification is not None:
        vehicle["identification"] = campaign.identification
    if campaign.wheelbase is not None:
        vehicle["wheelbase"] = _measured(campaign.wheelbase)
    vehicle |= {name: getattr(campaign, name) for name in heights if getattr(campaign, name) is not None}
    sections = {
        "vehicle": vehicle,
        "test": written(campaign.test),
        "known": {name: _measured(known) for name, known in campaign.known.items()},
        "model": written(campaign.model),
        "sensor": [written(sensor) for sensor in campaign.sensors],
        "load": [_load(load) for load in campaign.loads if load.name != EMPTY.name],
        "drop": [
            ({"file": own[0]} if len(own) == 1 else {"files": list(own)}) | written(drop, "file", "files", "window")
            for own, drop in zip(files, campaign.drops, strict=True)
        ],
    }
    return {"schema": SCHEMA} | {name: section for name, section in sections.items() if section}


def written(record: object, *without: str) -> dict[str, Any]:
    """Give the keys of a record that say more than their defaults, as TOML holds them.

    Parameters
    ----------
    record
        A sensor, load, drop or the choice of the model.
    *without
        Keys to leave out.
    """
    adapter: TypeAdapter[Any] = TypeAdapter(type(record))
    plain = adapter.dump_python(record, exclude_defaults=True, exclude_none=True, exclude=set(without))
    return cast("dict[str, Any]", plain)


def _load(load: Load) -> dict[str, Any]:
    keys = written(load)
    for part in (*keys.get("items", ()), *([keys["added"]] if "added" in keys else [])):
        if "mass_std" in part:
            part["mass"] = {"value": part["mass"], "std": part.pop("mass_std")}
    return keys


def _measured(known: Known) -> float | dict[str, float]:
    return known.value if known.exact else {"value": known.value, "std": known.std}


def _toml(document: Mapping[str, Any]) -> bytes:
    lists = {name: entries for name, entries in document.items() if isinstance(entries, list)}
    parts = [tomli_w.dumps({name: value for name, value in document.items() if name not in lists})]
    for name, entries in lists.items():
        # Entry by entry, for tomli-w would put short ones on one line, where nobody expects a drop.
        tables = (re.sub(r"^(\[+)", rf"\1{name}.", tomli_w.dumps(entry), flags=re.MULTILINE) for entry in entries)
        parts += [f"[[{name}]]\n{table}" for table in tables]

    def one_line(match: re.Match[str]) -> str:
        return "= [" + ", ".join(line.strip().removesuffix(",") for line in match[1].rstrip().split("\n")) + "]"

    # Vectors read better on one line; no text can look like this, for TOML writes line breaks in text as \n.
    return re.sub(r"= \[\n((?:    [^\n]*,\n)+)\]", one_line, "\n".join(parts)).encode()


def _table(recording: Recording, sensors: Sequence[Sensor]) -> bytes:
    per_unit = np.array([_si_per_reading(sensor) for sensor in sensors])
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(["time", *recording.channels])
    # Times to 0.1 ns give the rate back to eleven digits and stay short where the step is a round number.
    columns = np.vstack([recording.time.round(10), recording.values / per_unit[:, None]]).T
    np.savetxt(text, columns, fmt=["%.15g"] + ["%.9g"] * len(sensors), delimiter=",")
    return text.getvalue().encode()


def _si_per_reading(sensor: Sensor) -> float:
    """Give m/s², positive up, in one unit of a sensor's reading: the inverse of what reading does."""
    factor = acceleration_factor(own_unit(sensor, split_unit(sensor.channel)[1]))
    return -factor if sensor.direction == "down" else factor
