"""What ride numbers are asked for: roads, speeds, places and conventions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from sprung.campaign import explain_implausible
from sprung.display import shown
from sprung.errors import Problems, did_you_mean
from sprung.ride.bench import AMPLITUDE
from sprung.ride.road import ROAD_CLASSES, Road, Tracks
from sprung.ride.road_response import Drive
from sprung.vehicle import Heights

Place = tuple[float, float] | tuple[float, float, float]
"""A place on the body, m: forward of the front axle, left of the centreline and, for horizontal motion, above the ground."""

USUAL_ROADS = ("A", "B", "C", "D", "E")
"""Classes of ISO 8608 that are asked for unless others are."""

_KMH = 3.6
"""km/h in 1 m/s."""

USUAL_SPEED = 80 / _KMH
"""Speed that is asked for unless another is, m/s: 80 km/h."""

HOUR = 3600.0
"""s: the duration of a drive, for the vibration dose."""

_WHERE = "ride numbers"
_TRACKS: tuple[Tracks, ...] = ("isotropic", "same", "independent")
_FASTEST, _SLOWEST = 150.0, 0.5


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class RideOptions:
    """What ride numbers are asked for.

    Attributes
    ----------
    roads
        The roads.
    speeds
        m/s.
    places
        On the body, by name, where accelerations are asked for.
    tracks
        What the left and the right track have in common: ``isotropic``, ``same`` or ``independent``.
    duration
        Of a drive, s, for the vibration dose value.
    band
        Frequencies that count, Hz.
    plate_amplitude
        Of the suspension tester, m.
    """

    roads: tuple[Road, ...]
    speeds: tuple[float, ...]
    places: Mapping[str, Place] = field(default_factory=dict)
    tracks: Tracks = "isotropic"
    duration: float = HOUR
    band: tuple[float, float] = (0.1, 100.0)
    plate_amplitude: float = AMPLITUDE

    @property
    def drives(self) -> tuple[Drive, ...]:
        """Every road at every speed, the roads of a speed together."""
        return tuple(Drive(road, speed, self.tracks, self.band) for speed in self.speeds for road in self.roads)

    @property
    def reference(self) -> int:
        """Number of the drive at whose amplitudes a nonlinear vehicle is linearised, where no road is asked about."""
        names = [road.name for road in self.roads]
        return names.index("C") if "C" in names else 0


def checked_options(
    roads: Iterable[str | Road],
    speeds: Sequence[float],
    places: Mapping[str, Sequence[float]],
    tracks: str,
    duration: float,
    heights: Heights,
    problems: Problems,
) -> RideOptions:
    """Return options; what is impossible of them is only named.

    Parameters
    ----------
    roads
        Classes of ISO 8608, or roads.
    speeds
        m/s.
    places
        By name, m.
    tracks
        What left and right have in common.
    duration
        s.
    heights
        Of the vehicle, for horizontal motion.
    problems
        Takes up what is impossible.

    Returns
    -------
    RideOptions
    """
    options = RideOptions(
        roads=tuple(_checked_roads(roads, problems)),
        speeds=tuple(_checked_speeds(speeds, problems)),
        places=dict(_checked_places(places, heights, problems)),
        tracks=_checked_tracks(tracks, problems),
        duration=duration,
    )
    if not 0 < duration < math.inf:
        found = f"{duration / HOUR:g} h ({duration:g} s)"
        problems.add(f"{_WHERE}: duration", found, "a positive duration", "Correct it; durations in Python are in s.")
    return options


def _checked_roads(roads: Iterable[str | Road], problems: Problems) -> Iterator[Road]:
    classes, number = ", ".join(ROAD_CLASSES), 0
    for number, road in enumerate(roads, start=1):  # noqa: B007 (counted)
        if isinstance(road, Road):
            yield road
        elif road.upper() in ROAD_CLASSES:
            yield Road.of_class(road.upper())
        else:
            problems.add(f"{_WHERE}: road", f"'{road}'", f"a class of ISO 8608: {classes}", "Correct it.")
    if not number:
        problems.add(f"{_WHERE}: road", "none", f"at least one of {classes}", "Name a road.")


def _checked_speeds(speeds: Sequence[float], problems: Problems) -> Iterator[float]:
    if not speeds:
        problems.add(f"{_WHERE}: speed", "none", "at least one speed", "Give a speed in m/s.")
    for speed in speeds:
        if _SLOWEST <= speed <= _FASTEST:
            yield float(speed)
        else:
            found = f"{_KMH * speed:g} km/h ({speed:g} m/s)"
            limits = f"{_KMH * _SLOWEST:g} to {_KMH * _FASTEST:g} km/h ({_SLOWEST:g} to {_FASTEST:g} m/s)"
            problems.add(f"{_WHERE}: speed", found, limits, "Correct it; speeds in Python are in m/s.")


def _checked_places(
    places: Mapping[str, Sequence[float]], heights: Heights, problems: Problems
) -> Iterator[tuple[str, Place]]:
    for name, place in places.items():
        where = f"{_WHERE}: place '{name}'"
        if len(place) not in (2, 3) or not all(map(math.isfinite, place)):
            expected = "x, y or x, y, z in m: forward of the front axle, left of the centreline, above the ground"
            problems.add(where, str(tuple(place)), expected, "Correct it.")
        elif far := [
            limits for name, at in zip("xyz", place, strict=False) if (limits := explain_implausible(name, at))
        ]:
            problems.add(where, str(tuple(place)), f"coordinates of {far[0][0]}", far[0][1])
        elif len(place) == 2:
            yield name, (place[0], place[1])
        elif heights.cg_height is None:
            found = "a height, but the height of the centre of gravity is not known"
            expected = "cg_height in the campaign, or a place without height"
            problems.add(where, found, expected, "Leave z out: vertical numbers need no height.")
        else:
            yield name, (place[0], place[1], place[2])


def _checked_tracks(tracks: str, problems: Problems) -> Tracks:
    for one in _TRACKS:
        if one == tracks:
            return one
    expected = f"one of {', '.join(_TRACKS)}"
    problems.add(f"{_WHERE}: tracks", f"'{tracks}'", expected, did_you_mean(tracks, _TRACKS, listed=True))
    return _TRACKS[0]
