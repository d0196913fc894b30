"""The recording of one drop of a campaign that is being written, drawn with what was detected; answered by a query process."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from sprung.app.campaign_form import campaign_form
from sprung.app.campaign_text import apply_changes
from sprung.app.form_changes import understand
from sprung.campaign import Campaign, parse_toml, read_document
from sprung.checking import Check, check_prepared
from sprung.errors import InputError, Problem
from sprung.preprocess import prepare
from sprung.report import limits_text, picture_frame, picture_svg, recording_picture

LARGE = 100_000_000
"""Size of a file, bytes, beyond which it is read once: the part of it that is stated for the drop is drawn, not all of it."""

_OF_READING = ("channel", "on", "quantity", "axis", "relative_to", "unit", "direction", "range", "high_pass", "logger")
"""Keys of a sensor on which its recording depends; what else is still wrong or missing does not matter here."""

_OF_DROP = ("file", "files", "wheels", "excitation", "window", "start", "end")


def drop_view(path: str, root: str, text: str, entered: Mapping[str, Sequence[str]], index: int) -> dict[str, Any]:
    """Return the picture of a drop's recording.

    Parameters
    ----------
    path
        Of the campaign file; absolute.
    root
        Folder outside which nothing is read.
    text
        Of the file as the form was made from it.
    entered
        Values by the names of the inputs.
    index
        Of the drop, from 0.

    Returns
    -------
    dict
        ``svg``; ``frame``, where its time axis lies; ``times`` of what was detected and ``limits`` of the recording, s on its
        clock; ``facts`` in words.

    Raises
    ------
    InputError
        If the recording cannot be read.
    """
    place = Path(path)
    changed = apply_changes(text, understand(campaign_form(text, place)[0], entered).changes)
    document = parse_toml(changed.removeprefix("\ufeff"), place)
    drops = document.get("drop")
    if not isinstance(drops, list) or not 0 <= index < len(drops) or not isinstance(drops[index], dict):
        raise InputError([Problem("drop", "no such drop", "a drop of the file", "Load the page again.")])
    drop = {key: value for key, value in drops[index].items() if key in _OF_DROP}
    _require_inside(drop, place, Path(root))
    whole = {key: value for key, value in drop.items() if key not in {"window", "start", "end"}}
    detected = _check(document, drop, place)
    shown = detected if drop == whole or _is_large(drop, place) else _check(document, whole, place)
    report = replace(detected.drops[0], channels=shown.drops[0].channels)
    picture = recording_picture(report, shown.recorded[0])
    times = {"release": report.release, "landing": report.landing, "start": report.start, "end": report.end}
    recorded = shown.recorded[0].time
    return {
        "svg": picture_svg(picture),
        "frame": picture_frame(picture),
        "times": times,
        "limits": [float(recorded[0]), float(recorded[-1])],
        "facts": _facts(detected),
    }


def _is_large(drop: Mapping[str, Any], path: Path) -> bool:
    """Whether the recording takes so long to read that only the stated part of it is shown."""
    file = drop.get("file")
    return isinstance(file, str) and (path.parent / file).stat().st_size > LARGE


def _check(document: Mapping[str, Any], drop: Mapping[str, Any], path: Path) -> Check:
    """Check one recording; with the positions of the sensors, from which the landing follows, if they are possible ones."""
    try:
        return _checked(document, drop, path, (*_OF_READING, "position"))
    except InputError:
        return _checked(document, drop, path, _OF_READING)


def _checked(document: Mapping[str, Any], drop: Mapping[str, Any], path: Path, keys: Sequence[str]) -> Check:
    """Check one recording, whatever else of the campaign is missing or wrong."""
    sensors = [
        {key: value for key, value in sensor.items() if key in keys}
        for sensor in document.get("sensor", [])
        if isinstance(sensor, dict)
    ]
    vehicle = document.get("vehicle")
    model = {"model": vehicle["model"]} if isinstance(vehicle, dict) and "model" in vehicle else {}
    campaign: Campaign = read_document({"vehicle": model, "sensor": sensors, "drop": [drop]}, path, complete=False)
    return check_prepared(campaign, prepare(campaign))


def _require_inside(drop: Mapping[str, Any], path: Path, root: Path) -> None:
    """Require that the recordings of a drop lie in the folder of the page."""
    several = drop.get("files")
    for file in (drop.get("file"), *(several if isinstance(several, list) else ())):
        if isinstance(file, str) and not (path.parent / file).resolve().is_relative_to(root):
            do = f"Copy it into {root.name}."
            raise InputError([Problem(path.name, f"'{file}', which lies elsewhere", f"a recording in {root.name}", do)])


def _facts(check: Check) -> list[str]:
    """Return what was found in a recording, one sentence each."""
    report = check.drops[0]
    found = []
    if report.release is not None:
        landing = "" if report.landing is None else f", first landing at {report.landing:.3f} s"
        found.append(f"Release at {report.release:.3f} s{landing}.")
    if report.wheels_seen:
        found.append(f"Wheels that fell, as detected: {', '.join(report.wheels_seen)}.")
    if limits := limits_text(report):
        found.append(limits)
    return [*found, *(f"{fault.where}: {fault.what}. {fault.do}" for fault in check.faults)]
