"""Wire-frame model of the vehicle, whose nodes move with its coordinates: it shows a mode shape."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import ne

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.picture import Real
from sprung.results import Result
from sprung.vehicle import STATIONS, Layout, half_distances, layout_of
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

_BLOCK = 0.25
"""Half the length of a quarter car's body, as a part of the wheelbase."""

_LEAST_WIDTH = 1.3
"""Least width of a picture in wheelbases: a part of a vehicle is drawn no larger than a whole one."""

_LINE = 2.0
"""Room for the width of lines above and below the largest displacement, units."""

Edges = tuple[tuple[int, int], ...]
"""Pairs of nodes."""

_ENGINE = 0.4
"""Radius of an engine relative to that of a wheel."""


@dataclass(frozen=True)
class Nodes:
    """What the nodes of a wire frame are.

    Attributes
    ----------
    edges
        Pairs of nodes of the body that are joined: deck, roof, pillars.
    struts
        From the hubs to the deck above them.
    hubs
        Nodes that are wheels, in the order of the vehicle's wheel stations.
    engine
        The node that is an engine on its mounts, if there is one.
    """

    edges: Edges
    struts: Edges
    hubs: tuple[int, ...]
    engine: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class WireFrame:
    """The wire frame on the picture.

    Attributes
    ----------
    nodes
        What its nodes are.
    places
        Positions of its nodes at rest, to the right and down, units, shape (node, 2).
    rows
        Rise of each node per unit of each coordinate, the engine's the last, units, shape (node, coordinate + 1).
    wheel
        Radius of a wheel, units.
    wheelbase
        Units.
    width, height
        Of the picture, units.
    view
        From where the vehicle is seen.
    """

    nodes: Nodes
    places: Real
    rows: Real
    wheel: float
    wheelbase: float
    width: float
    height: float
    view: str

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
        return moved * (_SWING * self.wheelbase / largest) if largest else moved

    @property
    def circles(self) -> tuple[tuple[int, float], ...]:
        """Nodes that are drawn as circles, with their radii in units: the wheels, and an engine."""
        nodes = self.nodes
        return (*((hub, self.wheel) for hub in nodes.hubs), *((node, _ENGINE * self.wheel) for node in nodes.engine))


@dataclass(frozen=True, eq=False)
class SolidFrame:
    """The wire frame in space.

    Attributes
    ----------
    nodes
        What its nodes are.
    places
        Positions of its nodes at rest: x forward of the centre of gravity, y left of the centreline, z above the ground, m,
        shape (node, 3).
    rows
        Rise of each node per unit of each coordinate of the vehicle, the engine's the last, shape (node, coordinate + 1).
    wheel
        Radius of a wheel, m.
    wheelbase
        m.
    """

    nodes: Nodes
    places: Real
    rows: Real
    wheel: float
    wheelbase: float


def solid_frame(result: Result) -> SolidFrame:
    """Return a wire frame in space with the wheels, and the proportions, of the identified vehicle or part of one.

    Parameters
    ----------
    result
        Of an identification.

    Returns
    -------
    SolidFrame
    """
    values = {name: estimate.value for name, estimate in result.parameters.items() if estimate.value is not None}
    layout = layout_of(result.parameters)
    wheelbase = result.setup.known["wheelbase"].value if "wheelbase" in result.setup.known else _WHEELBASE
    a, b = values.get("a"), values.get("b")
    a, b = (a, b) if a and b else (wheelbase / 2, wheelbase / 2)
    length = a + b
    half = _half_track(result, values, length) if layout.rolls else 0.0
    corners, roof = (list(itertools.product(*ends)) for ends in _body_ends(layout, a, b, half))
    along = {1.0: a, 0.0: 0.0, -1.0: -b}
    stations = [(along[station.end], half * station.side) for station in map(STATIONS.__getitem__, layout.wheels)]
    engine = [(a + values["x_e"], 0.0)] if "x_e" in values else []
    flat = np.array([*corners, *roof, *stations, *stations, *engine])
    groups = (corners, roof, stations, stations, engine)
    heights = np.repeat([_DECK, _ROOF, _DECK, _HUB, _DECK], [len(group) for group in groups])
    nodes = _nodes(corners, len(stations), len(engine))
    rows = np.zeros((len(flat), len(layout.coordinates) + 1))
    rise = {"z_s": np.ones(len(flat)), "theta": -flat[:, 0], "phi": flat[:, 1]}
    first_hub = nodes.hubs[0]
    for column, coordinate in enumerate(layout.body):
        rows[:first_hub, column] = rise[coordinate][:first_hub]
    rows[nodes.hubs, range(layout.wheels_at.start, layout.wheels_at.stop)] = 1
    rows[nodes.engine, -1] = 1
    return SolidFrame(nodes, np.column_stack([flat, length * heights]), rows, _HUB * length, length)


def _body_ends(
    layout: Layout, a: float, b: float, half: float
) -> Iterator[tuple[tuple[float, ...], tuple[float, ...]]]:
    """Yield the ends of the deck along and across the vehicle, m, and those of the roof: one where the body has no extent."""
    length, inner = a + b, half * (1 - _INSET)
    deck: tuple[float, ...] = (_BLOCK * length, -_BLOCK * length)
    roof = deck
    if layout.pitches:
        deck = front, rear = a + _OVERHANG * length, -b - _OVERHANG * length
        roof = 0.5 * front, 0.94 * rear
    elif layout.rolls:
        deck = roof = (0.0,)
    yield deck, (half, -half) if layout.rolls else (0.0,)
    yield roof, (inner, -inner) if layout.rolls else (0.0,)


def _nodes(corners: Sequence[tuple[float, ...]], stations: int, engines: int) -> Nodes:
    """Return what the nodes are: corners of the deck and as many of the roof, stations on the deck, hubs, an engine."""
    number = len(corners)
    # Along an edge of the deck one of the two coordinates is the same.
    sides = [(i, j) for i, j in itertools.combinations(range(number), 2) if not all(map(ne, corners[i], corners[j]))]
    roof = [(number + i, number + j) for i, j in sides]
    pillars = [(i, number + i) for i in range(number)]
    first = 2 * number
    hubs = tuple(range(first + stations, first + 2 * stations))
    struts = tuple((hub, hub - stations) for hub in hubs)
    return Nodes((*sides, *roof, *pillars), struts, hubs, tuple(range(hubs[-1] + 1, hubs[-1] + 1 + engines)))


def wire_frame(result: Result, width: float = 220.0) -> WireFrame:
    """Return a wire frame with the proportions of the identified vehicle, in oblique projection; a roll plane from behind.

    Parameters
    ----------
    result
        Of an identification.
    width
        Of the picture, units.

    Returns
    -------
    WireFrame
    """
    solid, layout = solid_frame(result), layout_of(result.parameters)
    (x, y, heights), length = solid.places.T, solid.wheelbase
    to_right, to_top = _AWAY if layout.pitches else (-1.0, 0.0)
    across, up = x + to_right * y, heights + to_top * y
    hubs, radius = list(solid.nodes.hubs), solid.wheel
    left, right = min(across.min(), across[hubs].min() - radius), max(across.max(), across[hubs].max() + radius)
    scale = (width - 12) / max(right - left, _LEAST_WIDTH * length)
    swing = _SWING * length + _LINE / scale
    top, bottom = up.max() + swing, up[hubs].min() - radius - swing
    places = np.stack([width / 2 + scale * (across - (left + right) / 2), scale * (top - up)], axis=1)
    view = "front →" if layout.pitches else "rear view" if layout.rolls else ""
    return WireFrame(
        nodes=solid.nodes,
        places=places,
        rows=solid.rows * scale,
        wheel=scale * radius,
        wheelbase=scale * length,
        width=width,
        height=float(scale * (top - bottom)),
        view=view,
    )


def _half_track(result: Result, values: Mapping[str, float], wheelbase: float) -> float:
    """Return half the track: the largest half-distance of springs or dampers, or else of the body's sensors."""
    names = {name for tracks in ("shared", "separate") for name in half_distances(tracks).values()}
    places = [value for name, value in values.items() if name in names]
    if not places:
        places = [abs(sensor.position[1]) for sensor in result.setup.sensors if sensor.position is not None]
    return max(places, default=0.0) or _TRACK * wheelbase
