"""Wire-frame model of the vehicle, whose nodes move with its coordinates: it shows a mode shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.picture import Real
from sprung.results import Result
from sprung.vehicle import FULL, STATIONS, Layout, half_distances, layout_of
from sprung.vibration import largest_entry

_DECK, _ROOF, _HUB = 0.3, 0.62, 0.13
"""Heights of the wire frame, as parts of its wheelbase: a result has no outline of the vehicle."""

_OVERHANG, _INSET = 0.2, 0.12
"""Body beyond the axles, as a part of the wheelbase, and inset of the roof, as a part of the track."""

_WHEELBASE = 2.7
"""m, where it is not known."""

_TRACK = 0.27
"""Half the track as a part of the wheelbase, where it is not known."""

_AWAY = (0.42, 0.30)
"""Oblique projection: shift to the right and up per unit of distance from the viewer."""

_SWING = 0.15
"""Largest displacement on the picture, as a part of the wheelbase."""

BODY_EDGES = ((0, 1), (1, 3), (3, 2), (2, 0), (4, 5), (5, 7), (7, 6), (6, 4), (0, 4), (1, 5), (2, 6), (3, 7))
"""Between nodes: deck, roof, pillars."""

STRUTS = ((12, 8), (13, 9), (14, 10), (15, 11))
"""From the hubs to the deck above them."""

HUBS = (12, 13, 14, 15)
"""Nodes that are wheels: A front left, B front right, C rear left, D rear right."""

_ENGINE = 0.4
"""Radius of an engine relative to that of a wheel."""


@dataclass(frozen=True, eq=False)
class WireFrame:
    """The wire frame on the picture.

    Attributes
    ----------
    places
        Positions of its nodes at rest, to the right and down, units, shape (node, 2). The last is an engine on its mounts, if
        there is one.
    rows
        Rise of each node per unit of each coordinate, the engine's the last, units, shape (node, 8).
    wheel
        Radius of a wheel, units.
    width, height
        Of the picture, units.
    """

    places: Real
    rows: Real
    wheel: float
    width: float
    height: float

    def swing(self, motion: Sequence[tuple[float, float]]) -> NDArray[np.complex128]:
        """Return the rise of each node in a mode, scaled to a visible largest displacement.

        Parameters
        ----------
        motion
            Mode shape in the vehicle's coordinates, dimensionless real and imaginary parts.

        Returns
        -------
        ndarray
            Units, shape (node,).
        """
        shape = np.array([complex(*part) for part in motion])
        moved: NDArray[np.complex128] = self.rows[:, : len(shape)] @ shape
        # In the phase in which the node with the largest motion is at its top.
        largest = moved[largest_entry(moved)]
        return moved * (_SWING * self._wheelbase / largest) if largest else moved

    @property
    def circles(self) -> tuple[tuple[int, float], ...]:
        """Nodes that are drawn as circles, with their radii in units: the wheels, and an engine."""
        engine = range(HUBS[-1] + 1, len(self.places))
        return (*((hub, self.wheel) for hub in HUBS), *((node, _ENGINE * self.wheel) for node in engine))

    @property
    def _wheelbase(self) -> float:
        return float(abs(self.places[HUBS[0], 0] - self.places[HUBS[2], 0]))


@dataclass(frozen=True, eq=False)
class SolidFrame:
    """The wire frame in space.

    Attributes
    ----------
    places
        Positions of its nodes at rest: x forward of the centre of gravity, y left of the centreline, z above the ground, m,
        shape (node, 3). The last is an engine on its mounts, if there is one.
    rows
        Rise of each node per unit of each coordinate of the vehicle, the engine's the last, shape (node, coordinate + 1).
    wheel
        Radius of a wheel, m.
    wheelbase
        m.
    """

    places: Real
    rows: Real
    wheel: float
    wheelbase: float


def solid_frame(result: Result) -> SolidFrame:
    """Return a wire frame in space with the proportions of the identified vehicle.

    Parameters
    ----------
    result
        Of an identification.

    Returns
    -------
    SolidFrame
    """
    values = {name: estimate.value for name, estimate in result.parameters.items() if estimate.value is not None}
    wheelbase = result.setup.known["wheelbase"].value if "wheelbase" in result.setup.known else _WHEELBASE
    a, b = values.get("a"), values.get("b")
    a, b = (a, b) if a and b else (wheelbase / 2, wheelbase / 2)
    length = a + b
    half = _half_track(result, values, length)
    front, rear = a + _OVERHANG * length, -b - _OVERHANG * length
    inner = half * (1 - _INSET)
    corners = [(x, y) for x in (front, rear) for y in (half, -half)]
    roof = [(x, y) for x in (0.5 * front, 0.94 * rear) for y in (inner, -inner)]
    stations = [(x, y) for x in (a, -b) for y in (half, -half)]
    engine = [(a + values["x_e"], 0.0)] if "x_e" in values else []
    flat = np.array([*corners, *roof, *stations, *stations, *engine])
    heights = length * np.array([*np.repeat([_DECK, _ROOF, _DECK, _HUB], 4), *([_DECK] * len(engine))])
    rows = np.zeros((len(flat), 8))
    rows[:12, 0], rows[:12, 1], rows[:12, 2] = 1, -flat[:12, 0], flat[:12, 1]
    rows[HUBS, range(3, 7)] = 1
    rows[16:, 7] = 1
    return SolidFrame(np.column_stack([flat, heights]), rows @ _of_whole(layout_of(values)), _HUB * length, length)


def wire_frame(result: Result, width: float = 220.0) -> WireFrame:
    """Return a wire frame with the proportions of the identified vehicle, in oblique projection.

    Parameters
    ----------
    result
        Of an identification.
    width
        Of the picture, units.

    Returns
    -------
    WireCar
    """
    solid = solid_frame(result)
    (x, y, heights), length = solid.places.T, solid.wheelbase
    across, up = x + _AWAY[0] * y, heights + _AWAY[1] * y
    radius = solid.wheel
    scale = (width - 12) / (np.ptp(across) + 1e-9)
    swing = _SWING * length
    top, bottom = up.max() + swing, up[list(HUBS)].min() - radius - swing
    places = np.stack([6 + scale * (across - across.min()), scale * (top - up)], axis=1)
    return WireFrame(places, solid.rows * scale, scale * radius, width, float(scale * (top - bottom)))


def _of_whole(layout: Layout) -> Real:
    """Return the coordinates of a whole vehicle, and of its engine, by those of the part of it that moves so."""
    of_part = (*layout.coordinates, "z_e")
    coordinates = [coordinate if coordinate in layout.body else "" for coordinate in FULL.body]
    for wheel in FULL.wheels:
        _, _, side, end = STATIONS[wheel]
        alike = (one for one in layout.wheels if STATIONS[one].side in (0.0, side) and STATIONS[one].end in (0.0, end))
        coordinates.append(STATIONS[next(alike)].coordinate)
    return np.array([[float(own == one) for one in of_part] for own in (*coordinates, "z_e")])


def _half_track(result: Result, values: Mapping[str, float], wheelbase: float) -> float:
    """Return half the track: the largest half-distance of springs or dampers, or else of the body's sensors."""
    names = {name for tracks in ("shared", "separate") for name in half_distances(tracks).values()}
    places = [value for name, value in values.items() if name in names]
    if not places:
        places = [abs(sensor.position[1]) for sensor in result.setup.sensors if sensor.position is not None]
    return max(places, default=0.0) or _TRACK * wheelbase
