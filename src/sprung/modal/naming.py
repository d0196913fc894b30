"""Naming modes as the paper does, by what moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.optimize import linear_sum_assignment

from sprung.modal.modes import Mode, similarity, together, vibrations
from sprung.vehicle import Matrices, Rows, Sensor

Real = NDArray[np.float64]

MODE_NAMES = (
    "body bounce",
    "body pitch",
    "body roll",
    "wheel bounce",
    "wheel pitch",
    "wheel roll",
    "wheel articulation",
    "engine bounce",
)
"""The paper's seven modes, Table 3, and the one that an engine on its mounts adds."""

LEAST_SIMILARITY = 0.2
"""A shape less like every template than this gets no name."""

_HALF_WHEELBASE, _HALF_TRACK = 1.35, 0.7
"""Levers, m, where no sensor tells better ones: those of a car. They only weigh angles against displacements."""

_ALL_WHEELS = np.array([[1, 1, 1, 1], [-1, -1, 1, 1], [1, -1, 1, -1], [1, -1, -1, 1]]) / 2
"""Wheel bounce, pitch, roll and articulation as the words say, on the wheels A to D: where all four hop together."""

_AXLE_BY_AXLE = np.array([[0, 0, 1, 1], [0, 0, 1, -1], [1, 1, 0, 0], [1, -1, 0, 0]]) / np.sqrt(2)
"""What Table 3 calls by these names: the school bus's axles hop one by one, the rear one in phase (12.42 Hz) and in
opposition (12.44 Hz), the front one in phase (14.10 Hz) and in opposition (14.18 Hz)."""


def name_modes(
    modes: Sequence[Mode], half_wheelbase: float = _HALF_WHEELBASE, half_track: float = _HALF_TRACK
) -> tuple[Mode, ...]:
    """Give each mode the name of the template it is most like, no name twice but for pairs of real poles.

    The best assignment as a whole is taken, so every name is used where there are modes enough.

    Bounce against pitch of the body: the mode with the larger share of bounce once the pitch angle is multiplied by
    half the wheelbase. That is, both ends of the body move the same way in body bounce, opposite ways in body pitch:
    the point at rest lies outside the wheelbase in the first, between the axles in the second.

    Wheel modes: on a vehicle with unlike axles each axle hops on its own, in phase or in opposition left and right, and
    none of the four words describes that. The names are then those the paper uses in Table 3, which do not mean what
    they say: its wheel pitch is the rear axle in opposition, its wheel roll the front axle in phase. Where all four
    wheels hop together the words are taken literally.

    Parameters
    ----------
    modes
        Shapes in the coordinates of a vehicle: the paper's seven, or these and its engine's.
    half_wheelbase, half_track
        Levers that make pitch and roll angles comparable with displacements, m.

    Returns
    -------
    tuple of Mode
        The same modes, in the order of undamped natural frequency.
    """
    groups = together(modes)
    if not groups:
        return ()
    # The body counts at its four corners, and an engine as much, of which it is a large part.
    scale = np.array([2, 2 * half_wheelbase, 2 * half_track, 1, 1, 1, 1, 2])
    scale = scale[: len(groups[0][0].shape)]
    shapes = [scale[:, None] * np.stack([mode.shape for mode in group], axis=1) for group in groups]
    readings = []
    for wheels in (_AXLE_BY_AXLE, _ALL_WHEELS):
        templates = block_diag(np.eye(3), wheels.T, np.eye(len(scale) - 7))
        alike = np.stack([similarity(shape, templates).mean(axis=0) for shape in shapes])
        rows, columns = linear_sum_assignment(alike, maximize=True)
        readings.append((float(alike[rows, columns].sum()), alike, rows, columns))
    _, alike, rows, columns = max(readings, key=lambda reading: reading[0])
    name_of = {
        int(row): MODE_NAMES[column]
        for row, column in zip(rows, columns, strict=True)
        if alike[row, column] >= LEAST_SIMILARITY
    }
    return tuple(replace(mode, name=name_of.get(i)) for i, group in enumerate(groups) for mode in group)


def modes_of(matrices: Matrices) -> tuple[Mode, ...]:
    """Give the modes of M Ẍ + C Ẋ + K X = 0, eq. (3), with their names.

    Parameters
    ----------
    matrices
        M, C and K.

    Returns
    -------
    tuple of Mode
        Shapes in its coordinates, in the order of undamped natural frequency; the two real poles of an overdamped
        mode follow each other under one name.

    Examples
    --------
    >>> from sprung.vehicle import SCHOOL_BUS
    >>> [f"{mode.name} {mode.frequency:.3f}" for mode in modes_of(SCHOOL_BUS.matrices())][:3]
    ['body roll 1.071', 'body bounce 2.015', 'body pitch 2.812']
    """
    sprung, pitch, roll = np.diag(matrices.M)[:3]
    return name_modes(vibrations(matrices), float(np.sqrt(pitch / sprung)), float(np.sqrt(roll / sprung)))


def in_coordinates(modes: Sequence[Mode], sensors: Sequence[Sensor], a: float | None = None) -> tuple[Mode, ...]:
    """Turn shapes at the sensors into shapes in the seven coordinates, by least squares.

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
        Without names and spreads; a coordinate no sensor tells of stays at rest.
    """
    places = _body_places(sensors)
    if a is None:
        a = -float(places[:, 0].min() + places[:, 0].max()) / 2 if len(places) else 0.0
    rows = Rows.of([sensor.row for sensor in sensors], ("a",)).at([a])
    inverse = np.linalg.pinv(rows)
    return tuple(replace(mode, shape=inverse @ mode.shape, name=None, spread=None) for mode in modes)


def name_by_sensors(modes: Sequence[Mode], sensors: Sequence[Sensor], a: float | None = None) -> tuple[Mode, ...]:
    """Name modes identified from records: `in_coordinates`, then `name_modes`, with the sensors' spread as levers.

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
        Shapes in the seven coordinates, named, in the order of undamped natural frequency.
    """
    spread = np.ptp(_body_places(sensors), axis=0) / 2 if len(_body_places(sensors)) else np.zeros(2)
    return name_modes(
        in_coordinates(modes, sensors, a),
        float(spread[0]) or _HALF_WHEELBASE,
        float(spread[1]) or _HALF_TRACK,
    )


def _body_places(sensors: Sequence[Sensor]) -> Real:
    places = [sensor.position[:2] for sensor in sensors if sensor.on == "body" and sensor.position is not None]
    return np.array(places, dtype=float).reshape(-1, 2)
