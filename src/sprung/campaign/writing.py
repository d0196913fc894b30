"""Writing a campaign: the campaign file and one text table per drop, as `sprung.campaign.read` reads them back."""

from __future__ import annotations

import csv
import io
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import tomli_w
from pydantic import TypeAdapter

from sprung.campaign.reading import CAMPAIGN_FILE
from sprung.campaign.schema_file import SCHEMA, SCHEMA_FILE, SCHEMA_LINE, schema_text
from sprung.units import SI_UNITS, si_factor, split_unit
from sprung.vehicle import EMPTY, Load, Sensor

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence

    from sprung.campaign.campaign import Campaign
    from sprung.campaign.drop import DropTest
    from sprung.campaign.recording import Recording
    from sprung.uncertainty import KnownValue


def write(campaign: Campaign, folder: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write a campaign into a folder, whole or not at all.

    The recordings are written in each sensor's own unit and direction, nine significant digits; a channel that is left
    out stays without numbers. Recordings of other formats become text tables. The JSON Schema of the campaign file is put
    beside it, by which editors complete its keys, and comments say what each section and key is for.

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
    from sprung.files import atomic_write  # noqa: PLC0415 (only writing needs it)

    atomic_write(folder, campaign_files(campaign), overwrite=overwrite)
    return Path(folder) / CAMPAIGN_FILE


def campaign_files(campaign: Campaign) -> dict[str, bytes]:
    """Return what `write` writes of a campaign: content by file name, the campaign file last.

    Parameters
    ----------
    campaign
        The campaign.
    """
    names = tuple(_file_names(campaign.drops))
    sensors = {sensor.channel: sensor for sensor in campaign.sensors}
    files = {
        name: _table(piece, [sensors[channel] for channel in piece.channels])
        for of_drop, drop in zip(names, campaign.drops, strict=True)
        for name, piece in zip(of_drop, _pieces(drop.recording), strict=True)
    }
    from sprung.campaign.comments import add_comments  # noqa: PLC0415 (only a file that is written has comments)

    files[SCHEMA_FILE] = schema_text().encode()
    files[CAMPAIGN_FILE] = (SCHEMA_LINE + add_comments(_toml(_document(campaign, names)))).encode()
    return files


def _pieces(recording: Recording) -> tuple[Recording, ...]:
    """Return what each logger recorded: one file is written for each."""
    return recording.parts or (recording,)


def _file_names(drops: Sequence[DropTest]) -> Iterator[tuple[str, ...]]:
    """Yield the names of each drop's text tables: its files' own where these stay within the folder, and no two alike."""
    taken: set[str] = set()
    for drop in drops:
        pieces, own = _pieces(drop.recording), []
        for file in [piece.name for piece in pieces] if len(pieces) > 1 else [drop.file]:
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
    if campaign.vehicle_model != "full":
        vehicle["model"] = campaign.vehicle_model
    if campaign.wheelbase is not None:
        vehicle["wheelbase"] = _measured(campaign.wheelbase)
    vehicle |= {name: getattr(campaign, name) for name in heights if getattr(campaign, name) is not None}
    if campaign.motion_ratio:
        vehicle["motion_ratio"] = {name: _measured(ratio) for name, ratio in campaign.motion_ratio.items()}
    sections = {
        "vehicle": vehicle,
        "test": document_of_record(campaign.test),
        "known": {name: _measured(known) for name, known in campaign.known.items()},
        "model": document_of_record(campaign.model),
        "sensor": [document_of_record(sensor) for sensor in campaign.sensors],
        "load": [_load(load) for load in campaign.loads if load.name != EMPTY.name],
        "drop": [
            ({"file": own[0]} if len(own) == 1 else {"files": list(own)})
            | {"load": drop.load, "wheels": drop.wheels}
            | document_of_record(drop, "file", "files", "window", "recording")
            for own, drop in zip(files, campaign.drops, strict=True)
        ],
    }
    return {"schema": SCHEMA} | {name: section for name, section in sections.items() if section}


def document_of_record(record: object, *without: str) -> dict[str, Any]:
    """Return the keys of a record that differ from their defaults, as TOML holds them.

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
    keys = document_of_record(load)
    for part in (*keys.get("items", ()), *([keys["added"]] if "added" in keys else [])):
        if "mass_std" in part:
            part["mass"] = {"value": part["mass"], "std": part.pop("mass_std")}
    return keys


def _measured(known: KnownValue) -> float | dict[str, float]:
    return known.value if known.is_exact else {"value": known.value, "std": known.std}


def _toml(document: Mapping[str, Any]) -> str:
    """Write a campaign file: one line for each key, one section for each sensor, load and drop."""
    sections = [_keys({name: value for name, value in document.items() if not isinstance(value, dict | list)})]
    for name, value in document.items():
        if isinstance(value, dict):
            sections.append(f"[{name}]\n{_keys(value)}")
        elif isinstance(value, list):
            sections += [f"[[{name}]]\n{_keys(entry)}" for entry in value]
    return "\n".join(sections)


def _keys(entry: Mapping[str, Any]) -> str:
    """Write the keys of a section, the equals signs below each other."""
    widest = max(map(len, entry), default=0)
    return "".join(f"{name:<{widest}} = {_value(value, widest + 5)}\n" for name, value in entry.items())


def _value(value: Any, indent: int = 0) -> str:
    """Write a value on one line; a list of tables has one line for each."""
    match value:
        case dict():
            return "{ " + ", ".join(f"{name} = {_value(entry)}" for name, entry in value.items()) + " }"
        case [dict(), *_]:
            return "[ " + f",\n{' ' * indent}".join(map(_value, value)) + " ]"
        case list() | tuple():
            return f"[{', '.join(map(_value, value))}]"
        case _:
            return tomli_w.dumps({"value": value}).removeprefix("value = ").removesuffix("\n")


def _table(recording: Recording, sensors: Sequence[Sensor]) -> bytes:
    per_unit = np.array([_si_per_reading(sensor) for sensor in sensors])
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(["time", *recording.channels])
    # Times to 0.1 ns give the rate back to eleven digits and stay short where the step is a round number.
    columns = np.vstack([recording.time.round(10), recording.values / per_unit[:, None]]).T
    np.savetxt(text, columns, fmt=["%.15g"] + ["%.9g"] * len(sensors), delimiter=",")
    return text.getvalue().encode()


def _si_per_reading(sensor: Sensor) -> float:
    """Return the factor from the sensor's unit and direction to SI, positive up."""
    unit = sensor.unit or split_unit(sensor.channel)[1] or SI_UNITS[sensor.quantity]
    factor = si_factor(unit, sensor.quantity)
    return -factor if sensor.direction == "down" else factor
