"""Readings of sensors as functions of the vehicle's parameters and of what is uncertain of the sensors themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.kinematics import Row, body_slopes
from sprung.vehicle.model import Rows
from sprung.vehicle.nuisances import LOW_PASS_CORNER, SENSOR_UNKNOWNS, sensor_unknown
from sprung.vehicle.response import Motion
from sprung.vehicle.sensor import Sensor

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Part = TypeVar("Part", bound=NDArray[Any])

_GAIN, _X, _Y, _TILT_X, _TILT_Y, _DELAY = range(len(SENSOR_UNKNOWNS))

_PLACED = (_X, _Y, _TILT_X, _TILT_Y)
"""Unknowns by which the rows change."""

_NOTHING = Row({})


@shown
@dataclass(frozen=True, eq=False)
class Readout:
    """Rows of what several sensors read of a motion, their gains, places, tilts and delays being unknown or exact.

    A channel reads (1 + γ) (S + x S_x + y S_y + τ_x G_x + τ_y G_y) Z(t - δ), with the row S of its place as stated, a gain γ,
    what it sits further forward and left, x and y, what its direction leans forward and left, τ_x and τ_y, and a delay δ. G_x
    and G_y are gravity along the body, g times by how much the body rises per metre forward or left. Z holds, one below the
    other, those of X, Ẋ and Ẍ that any of the sensors reads. None of them changes the motion: no derivative of it is needed.

    Attributes
    ----------
    names
        The parameters: the vehicle's, masses of loads, then the unknowns of the sensors, and the corner frequency of a low-pass
        that all passed where it is one; what this does to readings is left to the caller.
    rows
        The sensors' rows as stated, over all parameters but those of the sensors; columns are those of Z.
    orders
        Derivatives of X by time of which Z consists: 0, 1 or 2, ascending.
    positions
        Position of each unknown of each sensor among the parameters, in the order of `SENSOR_UNKNOWNS`, -1 for what is exact;
        shape (channel, 6).
    placed
        Changes of the rows by a metre forward and to the left, and by a radian forward and to the left, of each sensor;
        4 channel rows.
    """

    names: tuple[str, ...]
    rows: Rows
    orders: tuple[int, ...]
    positions: Index
    placed: Rows

    @classmethod
    def of(cls, sensors: Sequence[Sensor], names: Sequence[str], wheelbase: float = 0.0) -> Readout:
        """Return the readout over a list of parameters; what is uncertain of a sensor but not in the list is as stated.

        Parameters
        ----------
        sensors
            In the order of the channels.
        names
            The parameters, those of the sensors last.
        wheelbase
            Of a body that twists or bends, m.

        Raises
        ------
        KeyError
            If a row depends on a parameter that is not listed.
        """
        index = {name: i for i, name in enumerate(names)}
        positions = np.array(
            [[index.get(sensor_unknown(quantity, one.channel), -1) for quantity in SENSOR_UNKNOWNS] for one in sensors],
            dtype=np.int64,
        ).reshape(-1, len(SENSOR_UNKNOWNS))
        own = names[: len(names) - int(np.sum(positions >= 0)) - int(LOW_PASS_CORNER in index)]
        read = [sensor.rows(own, wheelbase) for sensor in sensors]
        leaning = bool(np.any(positions[:, [_TILT_X, _TILT_Y]] >= 0))
        orders = tuple(sorted({order for one in read for order in one} | ({0} if leaning else set()))) or (2,)
        moves = [body_slopes(*(one.position or (0.0, 0.0))[:2], wheelbase) for one in sensors]
        by_way = list(zip(*moves, strict=True))
        places = _stacked(
            [dict.fromkeys(one, move) for way in by_way for one, move in zip(read, way, strict=True)], orders, own
        )
        tilts = _stacked([{0: move} for way in by_way for move in way], orders, own)
        placed = Rows(np.concatenate([places.affine, STANDARD_GRAVITY * tilts.affine]))
        return cls(tuple(names), _stacked(read, orders, own), orders, positions, placed)

    @classmethod
    def with_unknowns(
        cls, sensors: Sequence[Sensor], names: Sequence[str], wheelbase: float = 0.0, has_corner: bool = False
    ) -> Readout:
        """Return the readout with everything that is uncertain of the sensors as further parameters behind those of a list.

        Parameters
        ----------
        sensors
            In the order of the channels.
        names
            The parameters of the vehicle.
        wheelbase
            Of a body that twists or bends, m.
        has_corner
            Whether the corner frequency of a low-pass that all passed is one of them.

        Returns
        -------
        Readout
        """
        unknowns = (name for sensor in sensors for name in sensor.uncertainties)
        return cls.of(sensors, (*names, *unknowns, *([LOW_PASS_CORNER] if has_corner else [])), wheelbase)

    @cached_property
    def shared(self) -> int:
        """Number of parameters that are none of the sensors."""
        return int(self.rows.affine.shape[2]) - 1

    @cached_property
    def _has(self) -> NDArray[np.bool_]:
        """Which unknowns any sensor has, shape (6,)."""
        return np.asarray((self.positions >= 0).any(axis=0))

    @cached_property
    def corner_position(self) -> int | None:
        """Position of the corner frequency of a low-pass among the parameters; None where it is none of them."""
        return self.names.index(LOW_PASS_CORNER) if LOW_PASS_CORNER in self.names else None

    @property
    def has_delays(self) -> bool:
        """Whether a delay is unknown."""
        return bool(self._has[_DELAY])

    @cached_property
    def gain_positions(self) -> tuple[tuple[int, int], ...]:
        """Each channel whose gain is unknown, and the position of that among the parameters."""
        positions = self.positions[:, _GAIN].tolist()
        return tuple((channel, position) for channel, position in enumerate(positions) if position >= 0)

    def gains(self, values: Array) -> Array:
        """Return by what each channel multiplies what it should read, 1 + γ, dimensionless, shape (..., channel).

        Parameters
        ----------
        values
            Parameters, SI, shape (..., parameter).
        """
        return 1 + self._unknown(_GAIN, values)

    @cached_property
    def delay_positions(self) -> tuple[tuple[int, int], ...]:
        """Each channel whose delay is unknown, and the position of that among the parameters."""
        positions = self.positions[:, _DELAY].tolist()
        return tuple((channel, position) for channel, position in enumerate(positions) if position >= 0)

    def _unknown(self, kind: int, values: Array) -> Array:
        """Return one kind of unknown of every channel, 0 where it is exact; shape (..., channel)."""
        positions = self.positions[:, kind]
        return np.where(positions >= 0, values[..., positions], 0.0)

    def delays(self, values: Array) -> Array:
        """Return the delay of each channel at parameter values of shape (..., parameter), s, shape (..., channel)."""
        return self._unknown(_DELAY, values)

    @cached_property
    def _changes(self) -> Mapping[int, Array]:
        """Changes of the rows by places and tilts that any sensor has as unknowns, each of shape (channel, column)."""
        changes = np.split(self.placed.affine[:, :, 0], len(_PLACED))
        return {kind: change for kind, change in zip(_PLACED, changes, strict=True) if self._has[kind]}

    def _placed(self, values: Array) -> Array:
        """Return the rows with their places and tilts, without gains."""
        rows = self.rows.at(values)
        for kind, row in self._changes.items():
            rows = rows + self._unknown(kind, values)[..., None] * row
        return rows

    def at(self, values: ArrayLike) -> Array:
        """Return the rows, 1 and m, at parameter values of shape (..., parameter); shape (..., channel, column of Z)."""
        values = np.asarray(values, dtype=float)
        placed = self._placed(values)
        return placed * (1 + self._unknown(_GAIN, values)[..., None]) if self._has[_GAIN] else placed

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of the rows by the parameters; those by a delay or a corner are of no row, and zero.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).

        Returns
        -------
        ndarray
            Shape (channel, parameter, column of Z).
        """
        if len(self.names) == self.shared:
            return self.rows.slopes
        channels, size = self.rows.affine.shape[:2]
        gains = 1 + self._unknown(_GAIN, values)
        slopes = np.zeros((channels, len(self.names), size))
        slopes[:, : self.shared] = self.rows.slopes * gains[:, None, None]
        if self._has[_GAIN]:
            which = np.flatnonzero(self.positions[:, _GAIN] >= 0)
            slopes[which, self.positions[which, _GAIN]] = self._placed(values)[which]
        for kind, row in self._changes.items():
            which = np.flatnonzero(self.positions[:, kind] >= 0)
            slopes[which, self.positions[which, kind]] = gains[which, None] * row[which]
        return slopes

    def observed(self, displacements: Part, velocities: Part, accelerations: Part, axis: int = -2) -> Part:
        """Return Z from X, Ẋ and Ẍ.

        Parameters
        ----------
        displacements, velocities, accelerations
            SI, shape (..., coordinate, time) or (..., coordinate, mode).
        axis
            That of the coordinates, if another one.
        """
        motions = (displacements, velocities, accelerations)
        if len(self.orders) == 1:
            return motions[self.orders[0]]
        return cast("Part", np.concatenate([motions[order] for order in self.orders], axis=axis))

    def read(self, values: ArrayLike, motion: Motion) -> Array:
        """Return what the sensors read of a motion at parameter values, SI, shape (channel, time); delays are not in it."""
        return np.asarray(self.at(values) @ self.observed(*motion), dtype=np.float64)

    def observed_of_states(self, highest: Array, massive: int) -> Array:
        """Return Z as a linear function of the state {X, Ẋ} and of what follows it.

        Parameters
        ----------
        highest
            The highest derivatives likewise, SI, shape (coordinate, state + further); see `LinearModel.accelerations`.
        massive
            Number of coordinates that move a mass.

        Returns
        -------
        ndarray
            Shape (column of Z, state + further).
        """
        n = len(highest)
        unit = np.eye(n + massive, highest.shape[1])
        rates = np.concatenate([unit[n:], highest[massive:]])
        return self.observed(unit[:n], rates, highest)

    @cached_property
    def place_slopes(self) -> Array:
        """Change of each row by a metre forward, and by a metre to the left; shape (2, channel, column of Z)."""
        return np.array(np.split(self.placed.affine[:, :, 0], len(_PLACED))[:2])

    def of_accelerations(self, rows: Array) -> Array:
        """Return the part of rows that multiplies Ẍ, of shape (..., channel, column of Z); (..., channel, coordinate)."""
        size = rows.shape[-1] // len(self.orders)
        return rows[..., -size:] if self.orders[-1:] == (2,) else np.zeros_like(rows[..., :size])

    @cached_property
    def reads_accelerations(self) -> NDArray[np.bool_]:
        """Which channels are those of accelerometers, shape (channel,)."""
        return np.asarray(self.of_accelerations(self.rows.affine[:, :, 0]).any(axis=1))


def _stacked(rows: Sequence[Mapping[int, Row]], orders: Sequence[int], names: Sequence[str]) -> Rows:
    """Return rows, each by the order of the derivative, over all orders beside each other."""
    blocks = [Rows.of([one.get(order, _NOTHING) for one in rows], names).affine for order in orders]
    return Rows(np.concatenate(blocks, axis=1)) if blocks else Rows.of([], names)


def sensor_rows(sensors: Sequence[Sensor], names: Sequence[str], wheelbase: float = 0.0) -> Rows:
    """Return the rows of the displacements that sensors observe, themselves or by a derivative of theirs.

    Parameters
    ----------
    sensors
        In the order of the channels.
    names
        Parameters of the vehicle.
    wheelbase
        Of a body that twists unevenly, m.

    Returns
    -------
    Rows
        One for each sensor; of a force that by the displacement.
    """
    return Rows.of([next(iter(sensor.rows(names, wheelbase).values())) for sensor in sensors], names)
