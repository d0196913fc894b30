"""Proportions of the drawn vehicle: known lengths to scale, typical ones for the others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sprung.report.sketch.geometry import Geometry
from sprung.vehicle import STATIONS, Wheel

_WHEELBASE = 2.7
"""Wheelbase of a typical car, m, drawn dashed where it is unknown."""

_HALF_TRACK, _WHEEL_RADIUS, _CG_HEIGHT = 0.27, 0.115, 0.2
"""Typical half track, wheel radius and height of the centre of gravity, as parts of the wheelbase."""

_OVERHANG, _BODY_BOTTOM, _BODY_TOP, _WHEEL_WIDTH = 0.2, 0.09, 0.48, 0.07
"""Of the outline, as parts of the wheelbase; a campaign has no outline of the body."""

_ALONE = 0.4
"""Length of the outline before and behind an axle that is the only one, as a part of a typical wheelbase."""

_OUTSIDE = 1.15
"""Half track relative to the largest half-distance of springs and dampers, which are inside the wheels."""


@dataclass(frozen=True)
class Proportions:
    """Lengths that are drawn, m, in the campaign's coordinates: x forward from the front axle, y left, z up from the ground.

    Attributes
    ----------
    geometry
        Known dimensions.
    wheelbase, half_track, wheel_radius
        As drawn.
    """

    geometry: Geometry
    wheelbase: float
    half_track: float
    wheel_radius: float

    @property
    def to_scale(self) -> bool:
        """Whether any length along the vehicle is known."""
        if self.geometry.blank:
            return False
        return self.geometry.wheelbase.value is not None or any(True for _ in self.places)

    @property
    def wheel_width(self) -> float:
        """Width of a wheel in the plan view, m."""
        return _WHEEL_WIDTH * self.wheelbase

    @property
    def places(self) -> Iterator[tuple[float, float, float]]:
        """Known positions on the body, of sensors and load items, m."""
        yield from (sensor.position for sensor in self.geometry.sensors if sensor.position is not None)
        for load in self.geometry.loads:
            yield from (item.position for item in load.items if item.position is not None)

    @property
    def centre_of_gravity(self) -> tuple[float, float]:
        """Position (x, z) of the sprung mass's centre of gravity; half-way between the axles where a is not known."""
        a, height = self.geometry.a.value, self.geometry.cg_height.value
        x = min(self.axles) / 2 if a is None else -a
        return x, _CG_HEIGHT * self.wheelbase if height is None else height

    def half_distance(self, springs: bool, axle: int) -> float:
        """Return the half-distance of springs or dampers, as drawn.

        Parameters
        ----------
        springs
            Whether of the springs.
        axle
            0 for the front, 1 for the rear one.
        """
        known = (self.geometry.springs if springs else self.geometry.dampers)[axle].value
        return self.half_track / _OUTSIDE if known is None else known

    def wheel(self, wheel: Wheel) -> tuple[float, float]:
        """Return x and y of the centre of a wheel, m.

        Parameters
        ----------
        wheel
            Its station.
        """
        station = STATIONS[wheel]
        return -self.wheelbase if station.end < 0 else 0.0, station.side * self.half_track

    @property
    def axles(self) -> tuple[float, ...]:
        """Position of each axle, m."""
        return (0.0, -self.wheelbase) if self.geometry.layout.pitches else (0.0,)

    @property
    def has_length(self) -> bool:
        """Whether the position of the rear axle is known, or there is none."""
        return self.geometry.wheelbase.value is not None or not self.geometry.layout.pitches

    @property
    def outline(self) -> tuple[float, float, float]:
        """Front end, rear end and half-width of the outline of the body, which encloses everything on it."""
        x = [place[0] for place in self.places]
        y = [abs(place[1]) for place in self.places]
        margin = (_OVERHANG if self.geometry.layout.pitches else _ALONE) * self.wheelbase
        width = self.half_track + self.wheel_width
        return (
            max([margin, *(value + 0.25 * margin for value in x)]),
            min([min(self.axles) - margin, *(value - 0.25 * margin for value in x)]),
            max([width, *(value + 0.1 * margin for value in y)]),
        )

    @property
    def heights(self) -> tuple[float, float]:
        """Lower and upper edge of the outline of the body, from the side."""
        z = [place[2] for place in self.places]
        margin = 0.04 * self.wheelbase
        top = max([_BODY_TOP * self.wheelbase, self.centre_of_gravity[1] + margin, *(value + margin for value in z)])
        return min([_BODY_BOTTOM * self.wheelbase, *(value - margin for value in z if value > margin)]), top


def proportions_of(geometry: Geometry) -> Proportions:
    """Return the proportions of a vehicle, unknown ones from typical vehicles.

    Parameters
    ----------
    geometry
        Known dimensions.

    Returns
    -------
    Proportions
    """
    incomplete = Proportions(geometry, _WHEELBASE, 0.0, 0.0)
    x = [place[0] for place in incomplete.places]
    span = max(x) - min(x) if x else 0.0
    wheelbase = geometry.wheelbase.value or (span if span > 0.5 * _WHEELBASE else _WHEELBASE)
    known = [length.value for length in (*geometry.springs, *geometry.dampers) if length.value is not None]
    y = [abs(place[1]) for place in incomplete.places]
    if known:
        half_track = _OUTSIDE * max(known)
    else:
        half_track = max(y) if y and 0.15 < max(y) / wheelbase < 0.4 else _HALF_TRACK * wheelbase
    radius = geometry.wheel_height.value or _WHEEL_RADIUS * wheelbase
    return Proportions(geometry, wheelbase, half_track, radius)
