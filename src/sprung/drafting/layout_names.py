"""Names of stations of a whole vehicle and of its parts: which end and which side the names of a recording's channels state."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from sprung.drafting.names import ends_named, parts_of, sides_named, station_named, tokens, wheels_named
from sprung.vehicle import LAYOUTS, STATIONS, WHEELS, VehicleModel, Wheel

_CENTRE = ("centre", "center", "middle", "mitte", "mittig", "both", "beide", "centro", "milieu")
"""Words of what is in the middle, or at both sides."""

Station = tuple[str, str]
"""End, ``f`` or ``r``, and side, ``l`` or ``r``; empty text where the name states none."""

_ALONE: Mapping[str, Station] = {"f": ("f", ""), "r": ("r", ""), "l": ("", "l")}


def stations_named(channels: Collection[str]) -> dict[str, Station]:
    """Return the end and the side that each channel's name states.

    A letter alone counts where all names together leave no doubt: l and r for the sides, f and r for the ends.

    Parameters
    ----------
    channels
        Names of all channels of a vehicle.

    Examples
    --------
    >>> stations_named(["Sprung LH (Filtered)", "wheel rear", "body FR"])
    {'Sprung LH (Filtered)': ('', 'l'), 'wheel rear': ('r', ''), 'body FR': ('f', 'r')}
    >>> stations_named(["pot L", "pot R"]), stations_named(["pot F", "pot R"])
    ({'pot L': ('', 'l'), 'pot R': ('', 'r')}, {'pot F': ('f', ''), 'pot R': ('r', '')})
    """
    alone = {channel: {word for word in tokens(channel) if word in _ALONE} for channel in channels}
    letters = set().union(*alone.values())
    of_r = "side" if letters == {"l", "r"} else "end" if letters == {"f", "r"} else None
    found = {}
    for channel in channels:
        whole = station_named(channel)
        if whole is not None:
            found[channel] = (whole[0], whole[1])
            continue
        ends, sides = ends_named(channel), sides_named(channel)
        if of_r is not None and not ends and not sides and len(alone[channel]) == 1:
            (letter,) = alone[channel]
            ends, sides = (set(), {letter}) if of_r == "side" else ({letter}, set())
        found[channel] = (ends.pop() if len(ends) == 1 else "", sides.pop() if len(sides) == 1 else "")
    return found


def part_of_vehicle(sensors: Sequence[tuple[str, str, Station]]) -> VehicleModel:
    """Return which part of a vehicle has sensors.

    Parameters
    ----------
    sensors
        What each sensor of a vertical motion or force measures; ``body``, ``wheel`` or ``travel``; and end and side, as its
        name states them.

    Returns
    -------
    VehicleModel
        The whole vehicle where nothing shows less.

    Examples
    --------
    >>> left, right, front, rear = ("", "l"), ("", "r"), ("f", ""), ("r", "")
    >>> part_of_vehicle([("force", "wheel", left), ("force", "wheel", right)])
    'roll-plane'
    >>> part_of_vehicle([("displacement", "body", front), ("displacement", "body", rear)])
    'pitch-plane'
    >>> part_of_vehicle([("acceleration", "body", ("", "")), ("acceleration", "wheel", ("", ""))])
    'quarter'
    """
    ends, sides = {end for _, _, (end, _) in sensors}, {side for _, _, (_, side) in sensors}
    if len(set(sensors)) < len(sensors):
        return "full"  # two sensors of a kind at one place are apart in a direction that no name states
    if ends == {""} and sides == {"l", "r"}:
        return "roll-plane"
    if sides == {""} and ends == {"f", "r"}:
        return "pitch-plane"
    kinds = {kind for _, kind, _ in sensors}
    return "quarter" if len(ends) == len(sides) == 1 and len(kinds) > 1 else "full"


def wheel_at(station: Station, model: VehicleModel) -> Wheel | None:
    """Return the wheel station of a vehicle, or of a part of it, at an end and a side.

    Parameters
    ----------
    station
        End and side, as far as a name states them.
    model
        Which part of a vehicle it is.

    Returns
    -------
    Wheel or None
        None where it is not known.

    Examples
    --------
    >>> wheel_at(("f", "l"), "full"), wheel_at(("", "l"), "roll-plane"), wheel_at(("f", ""), "full")
    ('fl', 'left', None)
    """
    end = {"f": 1.0, "r": -1.0, "": None}[station[0]]
    side = {"l": 1.0, "r": -1.0, "": None}[station[1]]
    fitting = [
        wheel
        for wheel in LAYOUTS[model].wheels
        if STATIONS[wheel].end in (0.0, end) and STATIONS[wheel].side in (0.0, side)
    ]
    return fitting[0] if len(fitting) == 1 else None


def wheels_in_part(wheels: Sequence[Wheel], model: VehicleModel) -> tuple[Wheel, ...]:
    """Return the wheel stations of a part of a vehicle that wheels of the whole vehicle are at; none where they do not fit.

    Parameters
    ----------
    wheels
        Of a whole vehicle.
    model
        Which part of it is meant.

    Examples
    --------
    >>> wheels_in_part(("fl", "rl"), "roll-plane"), wheels_in_part(("fl", "fr"), "roll-plane"), wheels_in_part((), "quarter")
    (('left',), ('left', 'right'), ())
    """
    found = {wheel_at((wheel[0], wheel[1]), model) for wheel in wheels}
    return tuple(wheel for wheel in LAYOUTS[model].wheels if wheel in found)


def wheels_named_anywhere(path: str) -> tuple[Wheel, ...]:
    """Return the wheels that a recording's name states, or else the folder that it is in, or the folder of that.

    Parameters
    ----------
    path
        Relative to the campaign's folder.

    Examples
    --------
    >>> wheels_named_anywhere("LHS/damped/test 3.lvm"), wheels_named_anywhere("Centre/test 3.lvm")
    (('fl', 'rl'), ('fl', 'fr', 'rl', 'rr'))
    """
    for part in parts_of(path):
        found = WHEELS if any(word in _CENTRE for word in tokens(part)) else wheels_named(f"{part}.csv")
        if found:
            return found
    return ()
