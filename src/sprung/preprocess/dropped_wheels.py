"""Which wheels lost their blocks, compared with what the campaign states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from sprung.campaign import DROP_KINDS, Drop, Recording
from sprung.errors import Fault
from sprung.preprocess.fall import IMPACT, detect_dropped_channels, measure_fall
from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS, Sensor, Wheel

_LAST, _LOWEST_BLOCKS = 0.3, 0.01
"""s at the end of a recording over which a wheel's height is averaged, and m by which it is lower at least where it fell."""

Dropped = Mapping[Wheel, bool]
"""For each wheel of which the release shows it: whether it lost its block."""


def detect_dropped_wheels(recording: Recording, release: Release | None, sensors: Sequence[Sensor]) -> Dropped:
    """Detect which wheels lost their blocks, as far as the release shows it.

    Parameters
    ----------
    recording
        Corrected, in SI.
    release
        Its release; without one, nothing is known.
    sensors
        One for each channel.

    Returns
    -------
    mapping
        For each wheel with a clear reading whether it fell.

    Notes
    -----
    Besides moving as wheels do that fall, a wheel that fell was driven down with more than 1 g, by gravity and by its spring,
    and one that stood was not.
    """
    of_wheels = np.array([sensor.wheel is not None or sensor.on is None for sensor in sensors]) & recording.usable
    if release is None or not of_wheels.any():
        return {}
    if not (of_wheels & np.array([sensor.reads_gravity for sensor in sensors])).any():
        return _lowered_wheels(recording, release, sensors)
    shown = _falls_by_wheel(recording, release, sensors)
    return {wheel: shown[wheel] == {True} for wheel in STATIONS if shown.get(wheel) in ({True}, {False})}


def find_disagreeing_wheels(recording: Recording, release: Release | None, sensors: Sequence[Sensor]) -> set[Wheel]:
    """Return the wheels of which one sensor shows that they fell and another one that they stood.

    Parameters
    ----------
    recording, release, sensors
        As for `detect_dropped_wheels`.

    Returns
    -------
    set
        Wheel stations.
    """
    shown = {} if release is None else _falls_by_wheel(recording, release, sensors)
    return {wheel for wheel, falls in shown.items() if {True, False} <= falls}


def _falls_by_wheel(recording: Recording, release: Release, sensors: Sequence[Sensor]) -> dict[Wheel, set[bool | None]]:
    """Return what the accelerometers of each wheel show: a fall, none, or None where one is not clear."""
    wheels = recording.usable & np.array(
        [(one.wheel is not None or one.on is None) and one.reads_gravity for one in sensors]
    )
    level, first = release.level, release.sample
    moved = recording.values[:, first : first + int(IMPACT * recording.rate)] - level[:, None]
    onset, depth, speed, *_ = measure_fall(moved, recording.rate, 0, level)
    channels = detect_dropped_channels(level, onset, depth, speed, wheels)
    shown: dict[Wheel, set[bool | None]] = {}
    for channel in np.flatnonzero(wheels).tolist() if channels else ():
        station, falls = sensors[channel].wheel, channel in channels
        if station is not None:  # a wheel, but not known which
            is_clear = falls == bool(depth[channel] > STANDARD_GRAVITY)
            shown.setdefault(station, set()).add(falls if is_clear else None)
    return shown


def _lowered_wheels(recording: Recording, release: Release, sensors: Sequence[Sensor]) -> dict[Wheel, bool]:
    """Return which wheels stand lower in the end than before the release, as far as displacements of wheels show it."""
    rest = max(recording.values.shape[1] - max(int(_LAST * recording.rate), 1), release.sample)
    lowered = {
        sensor.wheel: float(release.level[channel] - recording.values[channel, rest:].mean())
        for channel, sensor in enumerate(sensors)
        if sensor.wheel is not None and sensor.quantity == "displacement" and recording.usable[channel]
    }
    most = max(lowered.values(), default=0.0)
    return {wheel: height > most / 2 for wheel, height in lowered.items()} if most > _LOWEST_BLOCKS else {}


def find_contradicted_drops(drops: Sequence[Drop], dropped: Sequence[Dropped]) -> tuple[int, ...]:
    """Return the drops in which other wheels fell than the campaign states, where nothing else explains the readings.

    Parameters
    ----------
    drops
        As the campaign states them.
    dropped
        What the release of each shows.

    Returns
    -------
    tuple of int
        Their positions. Not those in which the wheels that fell make no usual drop, for then it is rather the
        channels that are not where they should be; and none where one wheel alone differs, in several drops or
        without being clear in every one, or where an exchange of two wheels' channels would explain all of it.
    """
    wrong = {i: _contradicted_wheels(*pair) for i, pair in enumerate(zip(drops, dropped, strict=True))}
    wrong = {i: wheels for i, wheels in wrong.items() if wheels}
    alone = set().union(*wrong.values())
    if len(alone) == 1 and (len(wrong) > 1 or any(shown and not alone <= shown.keys() for shown in dropped)):
        return ()
    named = {wheel for drop in drops for wheel in drop.wheels}.union(*dropped)
    present = [wheel for wheel in STATIONS if wheel in named]
    for first, second in combinations(present, 2):
        swap = {first: second, second: first}
        exchanged = [{swap.get(wheel, wheel): falls for wheel, falls in shown.items()} for shown in dropped]
        if not any(_contradicted_wheels(*pair) for pair in zip(drops, exchanged, strict=True)):
            return ()
    return tuple(i for i in wrong if frozenset(merge_dropped_wheels(drops[i], dropped[i])) in DROP_KINDS)


def _contradicted_wheels(drop: Drop, dropped: Dropped) -> set[Wheel]:
    """Return the wheels of which the release shows something else than stated; none where nothing was stated."""
    if not drop.wheels:
        return set()
    return {wheel for wheel, falls in dropped.items() if falls != (wheel in drop.wheels)}


def merge_dropped_wheels(drop: Drop, dropped: Dropped) -> tuple[Wheel, ...]:
    """Return the wheels that fell: where the release shows it as it shows, of the others as the campaign states.

    Parameters
    ----------
    drop
        As the campaign states it.
    dropped
        Which wheels fell, as far as the release shows it.

    Returns
    -------
    tuple
        Wheel stations.
    """
    return tuple(wheel for wheel in STATIONS if dropped.get(wheel, wheel in drop.wheels))


def dropped_wheels_fault(drop: Drop, dropped: Dropped, where: str) -> Fault:
    """Return the fault that other wheels fell than the campaign states.

    Parameters
    ----------
    drop
        As the campaign states it.
    dropped
        What its release shows.
    where
        Its recording.
    """
    seen = merge_dropped_wheels(drop, dropped)
    what = (
        f"the release shows {', '.join(seen)} to have fallen, the campaign states {', '.join(drop.wheels)}; the wheels of "
        "the release are used"
    )
    do = f"Write wheels = {list(seen)} for this drop, or give it the right file".replace("'", '"')
    # One wheel more and one less is what two exchanged channels would show too.
    exchange = len(seen) == len(drop.wheels) and len(_contradicted_wheels(drop, dropped)) == 2
    do += ", unless two wheels' channels were exchanged in it." if exchange else "."
    return Fault("wheels", where, what, do)
