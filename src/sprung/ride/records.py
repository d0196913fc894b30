"""Records of ride numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.errors import InputError, Problem
from sprung.ride.options import RideOptions
from sprung.uncertainty import Estimate, NamedValues

Real = NDArray[np.float64]

Estimates = Mapping[str, Estimate]
"""Numbers by name."""


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class RoadNumbers:
    """What a vehicle does on a road.

    Attributes
    ----------
    road
        Class of ISO 8608.
    speed
        m/s.
    places
        By name of a place on the body: ``acceleration`` and ``weighted``, vertical, m/s² rms, and ``vibration_dose``,
        m/s^1.75; of a place with a height ``forward_weighted``, ``left_weighted`` and ``total`` as well.
    body
        ``pitch`` and ``roll``: ``acceleration`` and ``weighted``, rad/s² rms.
    wheels
        By wheel station: ``acceleration``, m/s², ``travel``, m, ``load``, N, all rms, and ``load_coefficient``, 1.
    """

    road: str
    speed: float
    places: Mapping[str, Estimates]
    body: Mapping[str, Estimates]
    wheels: Mapping[str, Estimates]


@shown
@dataclass(frozen=True, slots=True, eq=False)
class Transmissibility:
    """A gain over frequency, from the height of the road, all wheels moving alike.

    Attributes
    ----------
    frequency
        Hz, shape (line,).
    gain, phase
        Dimensionless (1/m for wheel loads over their static value) and rad, shape (line,).
    std
        Standard uncertainty of the gain, shape (line,).
    """

    frequency: Real
    gain: Real
    phase: Real
    std: Real


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class RideNumbers:
    """Ride and inspection numbers of a vehicle, each an `Estimate`.

    Attributes
    ----------
    vehicle, load
        Their names.
    options
        Roads, speeds, places and conventions.
    axles
        ``front``, ``rear`` (``axle`` where there is one): the quarter car and its modes: m_s, m_u, k_s, k_t, c_s, c_t,
        body_frequency, body_damping, hop_frequency, hop_damping.
    half_cars
        ``pitch`` and ``roll``: the half cars.
    peaks
        By transmissibility, ``body_front``, ``wheel_front`` and so on: ``frequency``, Hz, and ``gain``.
    plates
        By wheel station: what suspension testers would find: ``static_load``, ``least_load`` (EUSAMA), ``least_phase`` (EGEA)
        and ``resonance``.
    roads
        Every road at every speed.
    curves
        Transmissibilities by name: ``body_front``, ``wheel_front``, ``travel_front``, ``load_front`` and so on, and of each
        place, such as ``place_seat``.
    notes
        How the numbers are to be read, and what could not be computed; sentences.
    """

    vehicle: str
    load: str
    options: RideOptions
    axles: Mapping[str, Estimates]
    half_cars: Mapping[str, Estimates]
    peaks: Mapping[str, Estimates]
    plates: Mapping[str, Estimates]
    roads: tuple[RoadNumbers, ...]
    curves: Mapping[str, Transmissibility] = field(default_factory=dict, repr=False)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("axles", "half_cars", "peaks", "plates", "curves"):
            object.__setattr__(self, name, NamedValues(getattr(self, name)))

    def on(self, road: str, speed: float | None = None) -> RoadNumbers:
        """Return the numbers of one road.

        Parameters
        ----------
        road
            Its class.
        speed
            m/s; the first one unless given.

        Raises
        ------
        InputError
            If they were not asked for, or could not be computed.
        """
        speed = self.options.speeds[0] if speed is None else speed
        for one in self.roads:
            if one.road == road and np.isclose(one.speed, speed):
                return one
        known = ", ".join(f"{one.road} at {one.speed:g} m/s" for one in self.roads)
        raise InputError(
            [Problem("ride numbers", f"road {road} at {speed:g} m/s", known, "Ask for it in ride_numbers.")]
        )

    def items(self) -> Iterator[tuple[str, Estimate]]:
        """Yield every number with its full name.

        Yields
        ------
        (str, Estimate)
            ``axles.front.body_damping``, ``roads.C@22.2.places.front.weighted`` and so on.
        """
        for group in ("axles", "half_cars", "peaks", "plates"):
            for place, own in getattr(self, group).items():
                yield from ((f"{group}.{place}.{name}", estimate) for name, estimate in own.items())
        for one in self.roads:
            for group in ("places", "body", "wheels"):
                for place, own in getattr(one, group).items():
                    for name, estimate in own.items():
                        yield f"roads.{one.road}@{one.speed:.3g}.{group}.{place}.{name}", estimate

    def document(self) -> dict[str, Any]:
        """Return everything as plain values for JSON.

        Returns
        -------
        dict
        """
        options = self.options
        return {
            "vehicle": self.vehicle,
            "load": self.load,
            "options": {
                "roads": [road.name for road in options.roads],
                "speeds": list(options.speeds),
                "places": {name: list(place) for name, place in options.places.items()},
                "tracks": options.tracks,
                "duration": options.duration,
                "band": list(options.band),
                "plate_amplitude": options.plate_amplitude,
            },
            **{group: _plain(getattr(self, group)) for group in ("axles", "half_cars", "peaks", "plates")},
            "roads": [
                {"road": one.road, "speed": one.speed}
                | {group: _plain(getattr(one, group)) for group in ("places", "body", "wheels")}
                for one in self.roads
            ],
            "transmissibility": {
                name: {
                    key: [float(f"{value:.6g}") for value in getattr(curve, key)]
                    for key in ("frequency", "gain", "phase", "std")
                }
                for name, curve in self.curves.items()
            },
            "notes": list(self.notes),
        }


def _plain(groups: Mapping[str, Estimates]) -> dict[str, dict[str, Any]]:
    return {
        place: {
            name: {
                "value": one.value,
                "std": one.std,
                "interval95": None if one.interval95 is None else list(one.interval95),
                "unit": one.unit,
                "status": one.status,
            }
            for name, one in own.items()
        }
        for place, own in groups.items()
    }
