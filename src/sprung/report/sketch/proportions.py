"""Proportions of the drawn vehicle: those that are known, to scale, and usual ones in place of those that are not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sprung.report.sketch.geometry import Geometry
from sprung.vehicle import Wheel

_WHEELBASE = 2.7
"""m, of a usual car: drawn dashed where nobody has measured it."""

_HALF_TRACK, _WHEEL_RADIUS, _CG_HEIGHT = 0.27, 0.115, 0.2
"""Usual half track, wheel radius and height of the centre of gravity beside the wheelbase."""

_OVERHANG, _BODY_BOTTOM, _BODY_TOP, _WHEEL_WIDTH = 0.2, 0.09, 0.48, 0.07
"""Of the outline, beside the wheelbase: nothing in a campaign tells the outline of the body."""

_OUTSIDE = 1.15
"""Half track beside the largest half-distance of springs and dampers, which lie inside of the wheels."""


@dataclass(frozen=True)
class Proportions:
    """Lengths that are drawn, m, in the campaign's coordinates: x forward from the front axle, y left, z up from the ground.

    Attributes
    ----------
    geometry
        What is known.
    wheelbase, half_track, wheel_radius
        As they are drawn.
    """

    geometry: Geometry
    wheelbase: float
    half_track: float
    wheel_radius: float

    @property
    def to_scale(self) -> bool:
        """Whether anything along the vehicle is known."""
        if self.geometry.blank:
            return False
        return self.geometry.wheelbase.value is not None or any(True for _ in self.places)

    @property
    def wheel_width(self) -> float:
        """Of the outline of a wheel, seen from above."""
        return _WHEEL_WIDTH * self.wheelbase

    @property
    def places(self) -> Iterator[tuple[float, float, float]]:
        """Known positions on the body: of sensors and of pieces of a load."""
        yield from (sensor.position for sensor in self.geometry.sensors if sensor.position is not None)
        for load in self.geometry.loads:
            yield from (item.position for item in load.items if item.position is not None)

    @property
    def centre_of_gravity(self) -> tuple[float, float]:
        """Place (x, z) of the sprung mass's centre of gravity; half-way between the axles where a is not known."""
        a, height = self.geometry.a.value, self.geometry.cg_height.value
        x = -self.wheelbase / 2 if a is None else -a
        return x, _CG_HEIGHT * self.wheelbase if height is None else height

    def half_distance(self, springs: bool, axle: int) -> float:
        """Return the half-distance of springs or dampers as it is drawn.

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
        """Return x and y of a wheel's centre.

        Parameters
        ----------
        wheel
            Its station.
        """
        x = 0.0 if wheel[0] == "f" else -self.wheelbase
        return x, self.half_track if wheel[1] == "l" else -self.half_track

    @property
    def outline(self) -> tuple[float, float, float]:
        """Front end, rear end and half-width of the outline of the body, which encloses everything on it."""
        x = [place[0] for place in self.places]
        y = [abs(place[1]) for place in self.places]
        margin = _OVERHANG * self.wheelbase
        width = self.half_track + self.wheel_width
        return (
            max([margin, *(one + 0.25 * margin for one in x)]),
            min([-self.wheelbase - margin, *(one - 0.25 * margin for one in x)]),
            max([width, *(one + 0.1 * margin for one in y)]),
        )

    @property
    def heights(self) -> tuple[float, float]:
        """Lower and upper edge of the outline of the body, from the side."""
        z = [place[2] for place in self.places]
        margin = 0.04 * self.wheelbase
        top = max([_BODY_TOP * self.wheelbase, self.centre_of_gravity[1] + margin, *(one + margin for one in z)])
        return min([_BODY_BOTTOM * self.wheelbase, *(one - margin for one in z if one > margin)]), top


def proportions_of(geometry: Geometry) -> Proportions:
    """Complete what is known of a vehicle by usual proportions.

    Parameters
    ----------
    geometry
        What is known.

    Returns
    -------
    Proportions
    """
    bare = Proportions(geometry, _WHEELBASE, 0.0, 0.0)
    x = [place[0] for place in bare.places]
    span = max(x) - min(x) if x else 0.0
    wheelbase = geometry.wheelbase.value or (span if span > 0.5 * _WHEELBASE else _WHEELBASE)
    known = [one.value for one in (*geometry.springs, *geometry.dampers) if one.value is not None]
    y = [abs(place[1]) for place in bare.places]
    if known:
        half_track = _OUTSIDE * max(known)
    else:
        half_track = max(y) if y and 0.15 < max(y) / wheelbase < 0.4 else _HALF_TRACK * wheelbase
    radius = geometry.wheel_height.value or _WHEEL_RADIUS * wheelbase
    return Proportions(geometry, wheelbase, half_track, radius)
