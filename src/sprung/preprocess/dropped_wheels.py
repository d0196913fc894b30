"""Which wheels fell, held against what the campaign says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from sprung.campaign import DROP_KINDS, Drop, Recording
from sprung.errors import Fault
from sprung.preprocess.drop_features import detect_dropped_channels, read_fall
from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS, Sensor, Wheel

Fell = Mapping[Wheel, bool]
"""For each wheel of which the release tells it: whether it lost its block."""


def detect_dropped_wheels(recording: Recording, release: Release | None, sensors: Sequence[Sensor]) -> Fell:
    """Say of every wheel, as far as one drop's release tells it, whether it lost its block.

    Parameters
    ----------
    recording
        Put right, in SI.
    release
        Its release; without any, nothing is told.
    sensors
        One for each channel.

    Notes
    -----
    Beyond being told from the others by how it moves, a wheel that fell was driven down with more than 1 g, by gravity and
    by its spring, and one that stood was not.
    """
    on_wheels = np.array([sensor.on != "body" for sensor in sensors]) & recording.usable
    if release is None or not on_wheels.any():
        return {}
    seen = read_fall(recording.values, recording.rate, release, on_wheels)
    channels = detect_dropped_channels(seen, on_wheels)
    if not channels:
        return {}
    fell: dict[Wheel, bool] = {}
    unclear: set[Wheel] = set()
    for channel in np.flatnonzero(on_wheels).tolist():
        station = sensors[channel].on
        if station is None or station == "body":  # a wheel, but not known which
            continue
        falls = channel in channels
        if falls != (seen.depth[channel] > STANDARD_GRAVITY) or fell.setdefault(station, falls) != falls:
            unclear.add(station)
    return {station: fell[station] for station in WHEELS if station in fell and station not in unclear}


def find_contradicted_drops(drops: Sequence[Drop], fell: Sequence[Fell]) -> tuple[int, ...]:
    """Say in which drops other wheels fell than the campaign says, where nothing else explains what is seen.

    Parameters
    ----------
    drops
        As the campaign has them.
    fell
        What the release of each tells.

    Returns
    -------
    tuple of int
        Their positions. Not those in which the wheels that are seen to fall make no usual drop, for then it is rather the
        channels that are not where they should be; and none where one wheel alone is seen otherwise, in several drops or
        without being clear in every one, or two wheels' channels that are exchanged would explain all of it.
    """
    wrong = {i: _otherwise(drop, told) for i, (drop, told) in enumerate(zip(drops, fell, strict=True))}
    wrong = {i: wheels for i, wheels in wrong.items() if wheels}
    alone = set().union(*wrong.values())
    if len(alone) == 1 and (len(wrong) > 1 or any(told and not alone <= told.keys() for told in fell)):
        return ()
    for one, other in combinations(WHEELS, 2):
        swap = {one: other, other: one}
        exchanged = [{swap.get(wheel, wheel): falls for wheel, falls in told.items()} for told in fell]
        if not any(_otherwise(drop, told) for drop, told in zip(drops, exchanged, strict=True)):
            return ()
    return tuple(i for i in wrong if frozenset(merge_dropped_wheels(drops[i], fell[i])) in DROP_KINDS)


def _otherwise(drop: Drop, fell: Fell) -> set[Wheel]:
    """Give the wheels that are seen otherwise than stated; none where nothing was stated."""
    if not drop.wheels:
        return set()
    return {wheel for wheel, falls in fell.items() if falls != (wheel in drop.wheels)}


def merge_dropped_wheels(drop: Drop, fell: Fell) -> tuple[Wheel, ...]:
    """Return the wheels that fell: as the release tells it, of the others as the campaign says.

    Parameters
    ----------
    drop
        As the campaign has it.
    fell
        Which wheels fell, as far as the release tells it.

    Returns
    -------
    tuple
        Wheel stations.
    """
    return tuple(wheel for wheel in WHEELS if fell.get(wheel, wheel in drop.wheels))


def dropped_wheels_fault(drop: Drop, fell: Fell, where: str) -> Fault:
    """Say that other wheels fell than the campaign says.

    Parameters
    ----------
    drop
        As the campaign has it.
    fell
        What its release tells.
    where
        Its recording.
    """
    seen = merge_dropped_wheels(drop, fell)
    what = (
        f"the release shows {', '.join(seen)} to have fallen, where the campaign says {', '.join(drop.wheels)}; what fell is "
        "taken from the release"
    )
    do = f"Write wheels = {list(seen)} for this drop, or give it the right file".replace("'", '"')
    # One wheel more and one less is what two exchanged channels would show too.
    exchange = len(seen) == len(drop.wheels) and len(_otherwise(drop, fell)) == 2
    do += ", unless two wheels' channels were exchanged in it." if exchange else "."
    return Fault("wheels", where, what, do)
