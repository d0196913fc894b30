"""Names of modes, from their shapes: what moves, and how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, product

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.optimize import linear_sum_assignment

from sprung.vehicle import COORDINATES, LAYOUTS, Layout, Matrices, Sensor, VehicleModel, sensor_rows
from sprung.vibration.modes import Mode, eigenmodes, group_real_pairs, modal_assurance_criterion

Real = NDArray[np.float64]

_BODY = {"z_s": "body bounce", "theta": "body pitch", "phi": "body roll"}

# Patterns of the wheels A front left, B front right, C rear left, D rear right. Left and right move alike in the first two
# sets, oppositely in the other two; in each of these pairs either the axles move on their own, or all four wheels together.
_Patterns = Mapping[tuple[str, ...], Real]

_HOP: _Patterns = {
    ("front axle hop", "rear axle hop"): np.array([[1, 1, 0, 0], [0, 0, 1, 1]]) / np.sqrt(2),
    ("wheel bounce", "wheel pitch"): np.array([[1, 1, 1, 1], [-1, -1, 1, 1]]) / 2,
}
_TRAMP: _Patterns = {
    ("front axle tramp", "rear axle tramp"): np.array([[1, -1, 0, 0], [0, 0, 1, -1]]) / np.sqrt(2),
    ("wheel roll", "wheel warp"): np.array([[1, -1, 1, -1], [1, -1, -1, 1]]) / 2,
}
_WHEEL_PATTERNS: Mapping[VehicleModel, Sequence[_Patterns]] = {
    "full": (_HOP, _TRAMP),
    "pitch-plane": (
        {
            ("front axle hop", "rear axle hop"): np.eye(2),
            ("wheel bounce", "wheel pitch"): np.array([[1, 1], [-1, 1]]) / np.sqrt(2),
        },
    ),
    "roll-plane": ({("axle hop", "axle tramp"): np.array([[1, 1], [1, -1]]) / np.sqrt(2)},),
    "quarter": ({("wheel hop",): np.eye(1)},),
}
"""Patterns of the wheels of a part of a vehicle: sets of which one each is taken."""

_ALONE = {
    "z_e": "engine bounce",
    "z_o": "seat bounce",
    "dz_o": "seat roll",
    "q_w": "body twist",
    "q_v": "body bending",
    **{f"z_l{seat}": f"load on seat {seat}" for seat in (1, 2, 3, 4)},
}
"""By coordinate: the name of the mode in which it moves by itself."""

_TELLING: Mapping[VehicleModel, tuple[str, ...]] = {
    "full": ("a",),
    "pitch-plane": ("a", "m_uf"),
    "roll-plane": ("m_u", "I_xx"),
    "quarter": ("m_u",),
}
"""Parameters that tell a part of a vehicle, the place of the centre of gravity among them."""

MODE_NAMES = (
    *_BODY.values(),
    *dict.fromkeys(
        name for sets in _WHEEL_PATTERNS.values() for patterns in sets for names in patterns for name in names
    ),
    *_ALONE.values(),
)
"""Every name that a mode may get. Of the first eight names of wheel modes a whole vehicle has four: for hop and for tramp
either those of the axles or those of all four wheels."""

_PAPER_NAMES = {
    **{name: name for name in (*_BODY.values(), "wheel bounce", "wheel pitch", "wheel roll")},
    "rear axle hop": "wheel bounce",
    "rear axle tramp": "wheel pitch",
    "front axle hop": "wheel roll",
    "front axle tramp": "wheel articulation",
    "wheel warp": "wheel articulation",
}
"""Table 3 of the paper: the shapes of the modes of the bus of Tables 4 and 5, and the names it gives to their frequencies."""

LEAST_SIMILARITY = 0.6
"""Modal assurance criterion with a template below which a shape gets no name. A wheel that hops alone is half hop and half
tramp of its axle, 0.5, and so are the wheels of an axle a quarter of a period apart: neither name would be true."""

_TIE = 1e-9
"""Part of the similarity by which a set of names has to be better than one before it: more than rounding."""

_HALF_WHEELBASE, _HALF_TRACK = 1.35, 0.7
"""Levers, m, of a car, where the sensors do not determine them. They only weigh angles against displacements."""


def paper_name(name: str | None) -> str | None:
    """Return what the paper's Table 3 calls a mode.

    Parameters
    ----------
    name
        One of `MODE_NAMES`, or None.

    Returns
    -------
    str or None
        None where the paper has no such mode.
    """
    return None if name is None else _PAPER_NAMES.get(name)


def name_modes(
    modes: Sequence[Mode],
    half_wheelbase: float = _HALF_WHEELBASE,
    half_track: float = _HALF_TRACK,
    coordinates: Sequence[str] = COORDINATES,
) -> tuple[Mode, ...]:
    """Return modes with the names of the templates most like their shapes, each name once but for pairs of real poles.

    Names are assigned to all modes of a vehicle at once, so that the sum of their similarities is largest.

    Bounce against pitch of the body: the mode with the larger share of bounce once the pitch angle is multiplied by
    half the wheelbase. That is, both ends of the body move the same way in body bounce, opposite ways in body pitch:
    the point at rest lies outside the wheelbase in the first, between the axles in the second. Whether a mode is one of
    the two at all is decided by their shares together.

    Wheel modes: on a vehicle with unlike axles each axle vibrates on its own, its wheels in phase (hop) or in opposition
    (tramp). Where the axles are alike all four wheels move by the same amount: bounce, pitch, roll or warp. Whichever is
    closer to the shapes is taken, for hop and tramp separately; the limit is where one axle moves 0.41 (tan 22.5°) times
    as far as the other.

    Parameters
    ----------
    modes
        Shapes in the coordinates of a vehicle.
    half_wheelbase, half_track
        Levers that make pitch and roll angles comparable with displacements, m.
    coordinates
        Names of the coordinates, those of body and wheels first.

    Returns
    -------
    tuple of Mode
        The same modes, in the order of undamped natural frequency; ``name`` None where a shape is like no template.
    """
    groups = group_real_pairs(modes)
    if not groups:
        return ()
    layout = next(one for one in LAYOUTS.values() if one.coordinates == tuple(coordinates[: len(one.coordinates)]))
    n, body, patterns = len(layout.coordinates), [_BODY[one] for one in layout.body], _WHEEL_PATTERNS[layout.model]
    # The body counts at its corners, and as much what is a large part of it, as an engine; what has no mass does not.
    further = [name for name in coordinates if name in _ALONE]
    chosen = [*range(n), *(list(coordinates).index(name) for name in further)]
    # Twist and bending count by how far the corners, or the middle, of the body move.
    corners = float(np.sqrt(len(layout.wheels)))
    sizes_of = {
        "theta": half_wheelbase,
        "phi": half_track,
        "q_w": half_wheelbase * half_track,
        "q_v": half_wheelbase**2 / 2,
    }
    of_body = [corners * sizes_of.get(one, 1.0) for one in (*layout.body, *further)]
    scale = np.array([*of_body[: len(body)], *[1.0] * len(layout.wheels), *of_body[len(body) :]])
    together = scale[:, None] * np.stack([mode.shape[chosen] for group in groups for mode in group], axis=1)
    templates = block_diag(np.eye(len(body)), np.vstack([shapes for one in patterns for shapes in one.values()]).T)
    # An engine goes along with the body in the body's modes: it counts in a mode of its own alone.
    of_shapes = np.hstack(
        [
            modal_assurance_criterion(together[:n], templates),
            modal_assurance_criterion(together, np.eye(len(scale))[:, n:]),
        ]
    )
    of_wheels = [name for one in patterns for names in one for name in names]
    known = (*body, *of_wheels, *(_ALONE[name] for name in further))
    sizes = np.array([len(group) for group in groups])
    of_groups = np.add.reduceat(of_shapes, np.cumsum(sizes) - sizes, axis=0) / sizes[:, None]
    best, name_of = -np.inf, dict[int, str]()
    for together_named in product(*patterns):
        names = (*body, *chain(*together_named), *(_ALONE[name] for name in further))
        alike = of_groups[:, [known.index(name) for name in names]]
        rows, columns = linear_sum_assignment(alike, maximize=True)
        total = float(alike[rows, columns].sum())
        if total > best + _TIE:
            best = total
            like = alike.copy()
            if layout.pitches:
                like[:, :2] = alike[:, :2].sum(axis=1, keepdims=True)
            found = zip(rows.tolist(), columns.tolist(), strict=True)
            name_of = {row: names[column] for row, column in found if like[row, column] >= LEAST_SIMILARITY}
    return tuple(replace(mode, name=name_of.get(i)) for i, group in enumerate(groups) for mode in group)


def compute_modes(matrices: Matrices, coordinates: Sequence[str] = COORDINATES) -> tuple[Mode, ...]:
    """Return the modes of M Ẍ + C Ẋ + K X = 0, eq. (3), with their names.

    Parameters
    ----------
    matrices
        M, C and K.
    coordinates
        Names of their coordinates, those of body and wheels first.

    Returns
    -------
    tuple of Mode
        Shapes in its coordinates, in the order of undamped natural frequency; the two real poles of an overdamped
        mode follow each other under one name.

    Examples
    --------
    >>> from sprung.vehicle import SCHOOL_BUS
    >>> [f"{mode.name} {mode.frequency:.3f}" for mode in compute_modes(SCHOOL_BUS.matrices())][:3]
    ['body roll 1.071', 'body bounce 2.015', 'body pitch 2.812']
    """
    masses = dict(zip(coordinates, np.diag(matrices.M).tolist(), strict=True))
    pitch, roll = (float(np.sqrt(masses.get(angle, 0.0) / masses["z_s"])) for angle in ("theta", "phi"))
    return name_modes(eigenmodes(matrices), pitch, roll, coordinates)


def expand_to_coordinates(modes: Sequence[Mode], sensors: Sequence[Sensor], a: float | None = None) -> tuple[Mode, ...]:
    """Return modes with shapes in the coordinates of body and wheels from shapes at the sensors, by least squares.

    Parameters
    ----------
    modes
        Shapes at the sensors, in their order.
    sensors
        Where they sit.
    a
        Front axle to the body's centre of gravity, m; unknown, the body turns about the middle of its sensors, which
        stand around the middle of the wheelbase.

    Returns
    -------
    tuple of Mode
        Without names and uncertainties; a coordinate that no sensor determines is zero.
    """
    places = _body_places(sensors)
    if a is None:
        a = -float(places[:, 0].min() + places[:, 0].max()) / 2 if len(places) else 0.0
    names = _TELLING[_layout_at(sensors).model]
    rows = sensor_rows(sensors, names).at([a if name == "a" else 0.0 for name in names])
    inverse, orders = np.linalg.pinv(rows), np.array([max(sensor.rows(names)) for sensor in sensors])
    # Accelerations of the coordinates, whatever the sensors read.
    accelerations = [mode.shape * mode.pole ** (2 - orders) for mode in modes]
    return tuple(
        replace(mode, shape=inverse @ shape, name=None, uncertainty=None)
        for mode, shape in zip(modes, accelerations, strict=True)
    )


def name_modes_at_sensors(modes: Sequence[Mode], sensors: Sequence[Sensor], a: float | None = None) -> tuple[Mode, ...]:
    """Return identified modes with names: `expand_to_coordinates`, then `name_modes`, with the sensors' distances as levers.

    Parameters
    ----------
    modes
        Shapes at the sensors, in their order.
    sensors
        Where they sit.
    a
        Front axle to the body's centre of gravity, m, if known.

    Returns
    -------
    tuple of Mode
        Shapes in the coordinates of body and wheels, named, in the order of undamped natural frequency.
    """
    spread = np.ptp(_body_places(sensors), axis=0) / 2 if len(_body_places(sensors)) else np.zeros(2)
    return name_modes(
        expand_to_coordinates(modes, sensors, a),
        float(spread[0]) or _HALF_WHEELBASE,
        float(spread[1]) or _HALF_TRACK,
        _layout_at(sensors).coordinates,
    )


def _layout_at(sensors: Sequence[Sensor]) -> Layout:
    """Return the layout whose wheel stations sensors are on; that of a whole vehicle where none is on a wheel."""
    stations = {wheel for sensor in sensors for wheel in (sensor.wheel, sensor.relative_to) if wheel is not None}
    return next(layout for layout in LAYOUTS.values() if stations <= {*layout.wheels})


def _body_places(sensors: Sequence[Sensor]) -> Real:
    places = [sensor.position[:2] for sensor in sensors if sensor.on == "body" and sensor.position is not None]
    return np.array(places, dtype=float).reshape(-1, 2)
