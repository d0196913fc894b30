"""Combination of all recordings to the sensors and drops of a campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import permutations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.drafting.channel import Channel
from sprung.drafting.detected_drop import DetectedDrop, assign_dropped_wheels, wheel_score
from sprung.drafting.examination import ExaminedRecording
from sprung.drafting.excitation_names import with_named_excitation
from sprung.drafting.logger_groups import common_name, group_by_drop
from sprung.drafting.names import load_named, part_named, station_named, wheels_named
from sprung.drafting.records import DraftDrop, DraftSensor
from sprung.preprocess import find_slower_drops
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, SensorPlace, Wheel

Real = NDArray[np.float64]

_STILL = 8.0
"""Largest reading over the noise at rest, in any drop, below which a channel is no sensor on the vehicle."""

_CLEARLY = 2.0
"""By how much more a corner of the body falls with its own wheels than with the others."""

TAKEN_EMPTY = "the name of the file states no load: assumed empty"

_PROPOSED = "loaded"
"""Name of a load that only the motion shows."""

SHORT = 20.0
"""s: a recording with one drop, no longer than this, needs no window."""


def combine_recordings(
    recordings: Sequence[ExaminedRecording],
) -> tuple[tuple[DraftSensor, ...], tuple[DraftDrop, ...], Mapping[str, str]]:
    """Combine the recordings to sensors and drops.

    Parameters
    ----------
    recordings
        As examined; at least one of them holds a drop.

    Returns
    -------
    sensors
        In the order in which the recordings have them.
    drops
        In the order of the recordings and of time.
    still
        Channels that no drop moves, each with the reason.
    """
    channels = {channel.name: channel for recording in recordings if recording.drops for channel in recording.channels}
    names = tuple(channels)
    recorded = list(group_by_drop(recordings))
    drops = [_of(drop, held, names) for _, drop, held in recorded]
    loudness = np.max(
        [np.nan_to_num(drop.features.peak / np.maximum(drop.features.noise, 1e-9)) for drop in drops], axis=0
    )
    still = {name: "no drop moves it" for name, size in zip(names, loudness, strict=True) if size < _STILL}
    moving = tuple(name for name in names if name not in still)
    drops, names = [_of(drop, names, moving) for drop in drops], moving

    hints = [wheels_named(common_name(files)) for files, _, _ in recorded]
    score = wheel_score(drops)
    parts = [_body_or_wheel(name, float(score[i]), drops, i) for i, name in enumerate(names)]
    places, by_files = _assign_stations(
        names, [part for part, _ in parts], assign_dropped_wheels(drops, [part for part, _ in parts]), hints
    )
    assigned = assign_dropped_wheels(drops, places)
    scales = _largest_full_scales(recordings)
    sensors = tuple(
        _sensor(
            _most_frequent_channel(name, recordings),
            place,
            (*notes, *(by_files if place != before and place in WHEELS else ())),
            scales,
            assigned,
            i,
        )
        for i, (name, place, (before, notes)) in enumerate(zip(names, places, parts, strict=True))
    )
    several = Counter(files for files, _, _ in recorded)
    drafted = [
        with_named_excitation(
            _drop(
                files,
                drop,
                hint,
                names,
                next(recording for recording in recordings if recording.file.name == files[0]),
                several[files],
                sensors,
            ),
            alone=several[files] == 1,
        )
        for (files, _, _), drop, hint in zip(recorded, assigned, hints, strict=True)
    ]
    return sensors, _with_loads(drafted, sensors, [_names_load(files) for files, _, _ in recorded]), still


def _names_load(files: Sequence[str]) -> bool:
    """Return whether the names of a drop's files state its load."""
    return any(load_named(name) is not None for name in (common_name(files), *files))


def _with_loads(
    drops: Sequence[DraftDrop], sensors: Sequence[DraftSensor], named: Sequence[bool]
) -> tuple[DraftDrop, ...]:
    """Group the drops whose load no name states by the periods of the body, and propose a load for the slower ones."""
    body = [i for i, sensor in enumerate(sensors) if sensor.on == "body"]
    open_ = [
        i
        for i, (drop, is_named) in enumerate(zip(drops, named, strict=True))
        if not is_named and drop.excitation == "drop" and drop.found.slow_motion is not None
    ]
    motions = [slow[body] for i in open_ if (slow := drops[i].found.slow_motion) is not None]
    slower = find_slower_drops([drops[i].found.dropped_channels for i in open_], motions) if body else ()
    given = list(drops)
    for i, is_slower in zip(open_, slower, strict=False):
        drop = given[i]
        notes = tuple(note for note in drop.notes if note != TAKEN_EMPTY)
        if is_slower is None:
            note = "unknown whether a load was on the vehicle, as in others of these drops"
            given[i] = replace(drop, load=None, notes=(*notes, note))
            continue
        load, pace = (_PROPOSED, "more slowly") if is_slower else ("empty", "more quickly")
        note = f"swings {pace} than others of the same wheels: assumed {load}"
        given[i] = replace(drop, load=load, notes=(*notes, note), proposed=True)
    return tuple(given)


def _of(drop: DetectedDrop, held: Sequence[str], names: Sequence[str]) -> DetectedDrop:
    """Return a drop with other channels than those it holds, or in another order."""
    channels = [held.index(name) if name in held else None for name in names]
    return drop.at(channels)


def _body_or_wheel(
    name: str, score: float, drops: Sequence[DetectedDrop], channel: int
) -> tuple[Literal["body", "wheel"], tuple[str, ...]]:
    """Distinguish body and wheel by the motion; by the name only where it never fell."""
    peak = float(np.nanmax([drop.features.peak[channel] for drop in drops])) / STANDARD_GRAVITY
    depth = float(np.nanmax([drop.features.depth[channel] for drop in drops])) / STANDARD_GRAVITY
    seen: Literal["body", "wheel"] = "wheel" if score > 1 else "body"
    note = f"falls {depth:.2g} g below rest and lands with {peak:.2g} g: {'a wheel' if seen == 'wheel' else 'the body'}"
    if 1 / 3 < score < 3:
        note += ", but not clearly"
    named = part_named(name)
    if named == "wheel" and seen == "body" and depth < 0.2 * _deepest(drops):
        return "wheel", ("a wheel by its name; it fell in none of the drops",)
    if named is not None and named != seen:
        note += f", though its name states {named}"
    return seen, (note,)


def _deepest(drops: Sequence[DetectedDrop]) -> float:
    return max(float(np.nanmax(drop.features.depth)) for drop in drops) / STANDARD_GRAVITY


def _assign_stations(
    names: Sequence[str],
    parts: Sequence[SensorPlace],
    drops: Sequence[DetectedDrop],
    hints: Sequence[tuple[Wheel, ...]],
) -> tuple[list[SensorPlace], tuple[str, ...]]:
    """Assign stations to the wheels: by the channels' names, or else by which of them fall in files named after wheels."""
    places: list[SensorPlace] = [
        station_named(name) or part if part == "wheel" else part for name, part in zip(names, parts, strict=True)
    ]
    unknown = [i for i, place in enumerate(places) if place == "wheel"]
    free = [wheel for wheel in WHEELS if wheel not in places]
    clues = [(set(drop.dropped_channels), set(hint)) for drop, hint in zip(drops, hints, strict=True) if hint]
    if not unknown or len(unknown) > len(free) or not clues:
        return places, ()
    scored = sorted(
        (
            sum(
                (i in dropped) == (wheel in hint)
                for dropped, hint in clues
                for i, wheel in zip(unknown, chosen, strict=True)
            ),
            chosen,
        )
        for chosen in permutations(free, len(unknown))
    )
    most, chosen = scored[-1]
    ambiguous = len(scored) > 1 and scored[-2][0] == most
    if ambiguous or most < 0.9 * len(clues) * len(unknown):
        return places, ()
    for i, wheel in zip(unknown, chosen, strict=True):
        places[i] = wheel
    return places, ("station: from the drops in which it falls, by the names of their files",)


def _most_frequent_channel(name: str, recordings: Sequence[ExaminedRecording]) -> Channel:
    """Return a channel as most recordings have it."""
    seen = [
        channel for recording in recordings if recording.drops for channel in recording.channels if channel.name == name
    ]
    usual = Counter((channel.unit, channel.direction, channel.coupling) for channel in seen).most_common(1)[0][0]
    agreeing = [channel for channel in seen if (channel.unit, channel.direction, channel.coupling) == usual]
    if len(agreeing) == len(seen):
        return agreeing[0]
    note = f"in {len(seen) - len(agreeing)} of {len(seen)} recordings it has another reading at rest"
    return replace(agreeing[0], notes=(*agreeing[0].notes, note))


def _largest_full_scales(recordings: Sequence[ExaminedRecording]) -> dict[str, float]:
    found: dict[str, float] = {}
    for recording in recordings:
        for name, size in recording.full_scale.items():
            found[name] = max(size, found.get(name, 0.0))
    return found


def _sensor(
    channel: Channel,
    place: SensorPlace,
    notes: tuple[str, ...],
    scales: Mapping[str, float],
    drops: Sequence[DetectedDrop],
    index: int,
) -> DraftSensor:
    direction, own = channel.direction, list(channel.notes)
    if channel.coupling == "AC":
        onsets = [float(drop.features.onset[index]) for drop in drops if np.isfinite(drop.features.onset[index])]
        first = max(onsets, key=abs, default=0.0)
        direction = "down" if first > 0 else "up"
        own.append(f"its reading goes {'up' if first > 0 else 'down'} when it falls, so it points {direction}")
    corner = None
    if place == "body":
        corner, named = _corner(drops, index, direction != channel.direction), station_named(channel.name)
        if corner is not None:
            own.append(
                f"moves most when the {_in_words(corner)} falls"
                + (f", though its name states {_in_words(named)}" if named not in (None, corner) and named else "")
            )
    return DraftSensor(
        channel=channel.name,
        on=place,
        corner=corner,
        unit=channel.unit,
        stated_unit=channel.stated_unit,
        direction=direction,
        coupling=channel.coupling,
        full_scale=scales.get(channel.name),
        notes=(*own, *notes),
        logger=channel.logger,
    )


def _corner(drops: Sequence[DetectedDrop], index: int, turned: bool) -> Wheel | None:
    """Find the corner of the body at which a sensor sits, from drops of one end and of one side."""
    depths: dict[str, list[float]] = {key: [] for key in ("f", "r", "l", "R")}
    for drop in drops:
        ends, sides = {wheel[0] for wheel in drop.wheels}, {wheel[1] for wheel in drop.wheels}
        onset = float(np.nan_to_num(drop.features.onset[index]))
        depth = max(onset if turned else -onset, 0.0)
        if len(ends) == 1 and len(sides) == 2:
            depths["f" if ends == {"f"} else "r"].append(depth)
        if len(sides) == 1 and len(ends) == 2:
            depths["l" if sides == {"l"} else "R"].append(depth)
    if not all(depths.values()):
        return None
    front, rear, left, right = (float(np.mean(depths[key])) for key in ("f", "r", "l", "R"))
    if max(front, rear) < _CLEARLY * min(front, rear) or max(left, right) < _CLEARLY * min(left, right):
        return None
    return next(w for w in WHEELS if w[0] == ("f" if front > rear else "r") and w[1] == ("l" if left > right else "r"))


def _in_words(corner: Wheel) -> str:
    return f"{'front' if corner[0] == 'f' else 'rear'} {'left' if corner[1] == 'l' else 'right'}"


def _drop(
    files: tuple[str, ...],
    drop: DetectedDrop,
    hint: tuple[Wheel, ...],
    names: Sequence[str],
    recording: ExaminedRecording,
    several: int,
    sensors: Sequence[DraftSensor],
) -> DraftDrop:
    notes = list(drop.why(names))
    wheels = drop.wheels
    if wheels and hint and set(wheels) != set(hint):
        notes.append(f"these wheels fell, though the name of the file states {', '.join(hint)}")
    if not wheels and hint:
        wheels = hint
        notes.append("dropped wheels by the name of the file")
        if any(sensor.on != "body" for sensor in sensors) and len(drop.dropped_channels) != len(hint):
            notes.append(f"though {len(drop.dropped_channels)} channels show the fall of a wheel")
    alone = several == 1 and recording.file.end - recording.file.start <= SHORT
    window = None if alone or len(files) > 1 else drop.window
    load = load_named(common_name(files)) or next((load for load in map(load_named, files) if load is not None), None)
    if load is None and several == 1:
        load = "empty"
        notes.append(TAKEN_EMPTY)
    return DraftDrop(files, window, load, wheels, drop, tuple(notes))
