"""Readings of sensors as functions of the vehicle's parameters and of what is uncertain of the sensors themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.vehicle.kinematics import body_point
from sprung.vehicle.model import Rows
from sprung.vehicle.nuisances import SENSOR_UNKNOWNS, sensor_unknown
from sprung.vehicle.sensor import Sensor

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_GAIN, _X, _Y, _DELAY = range(len(SENSOR_UNKNOWNS))


@shown
@dataclass(frozen=True, eq=False)
class Readout:
    """Rows of the accelerations that several sensors read, their gains, places and delays being unknown or exact.

    A channel reads (1 + γ) (S + x S_x + y S_y) Ẍ(t - δ), with the row S of its place as stated, a gain γ, what it sits further
    forward and left, x and y, and a delay δ. None of them changes the motion: no derivative of it is needed.

    Attributes
    ----------
    names
        The parameters: the vehicle's, masses of loads, then the unknowns of the sensors.
    rows
        The sensors' rows as stated, over all parameters but those of the sensors.
    positions
        Position of each sensor's gain, x, y and delay among the parameters, -1 for what is exact; shape (channel, 4).
    """

    names: tuple[str, ...]
    rows: Rows
    positions: Index

    @classmethod
    def of(cls, sensors: Sequence[Sensor], names: Sequence[str]) -> Readout:
        """Return the readout over a list of parameters; what is uncertain of a sensor but not in the list is as stated.

        Parameters
        ----------
        sensors
            In the order of the channels.
        names
            The parameters, those of the sensors last.

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
        own = len(names) - int(np.sum(positions >= 0))
        return cls(tuple(names), Rows.of([sensor.row for sensor in sensors], names[:own]), positions)

    @classmethod
    def with_unknowns(cls, sensors: Sequence[Sensor], names: Sequence[str]) -> Readout:
        """Return the readout with everything that is uncertain of the sensors as further parameters behind those of a list."""
        return cls.of(sensors, (*names, *(name for sensor in sensors for name in sensor.uncertainties)))

    @cached_property
    def shared(self) -> int:
        """Number of parameters that are none of the sensors."""
        return int(self.rows.affine.shape[2]) - 1

    @cached_property
    def _has(self) -> NDArray[np.bool_]:
        """Of which of gain, x, y and delay any sensor has an unknown, shape (4,)."""
        return np.asarray((self.positions >= 0).any(axis=0))

    @property
    def has_delays(self) -> bool:
        """Whether a delay is unknown."""
        return bool(self._has[_DELAY])

    @cached_property
    def delay_positions(self) -> tuple[tuple[int, int], ...]:
        """Each channel whose delay is unknown, and the position of that among the parameters."""
        positions = self.positions[:, _DELAY].tolist()
        return tuple((channel, position) for channel, position in enumerate(positions) if position >= 0)

    def _unknown(self, kind: int, values: Array) -> Array:
        """Return gain, x, y or delay of every channel, 0 where it is exact; shape (..., channel)."""
        positions = self.positions[:, kind]
        return np.where(positions >= 0, values[..., positions], 0.0)

    def delays(self, values: Array) -> Array:
        """Return the delay of each channel at parameter values of shape (..., parameter), s, shape (..., channel)."""
        return self._unknown(_DELAY, values)

    @cached_property
    def _angles(self) -> Mapping[int, Array]:
        """Changes of the rows by a metre forward and a metre to the left, for x and y where any sensor has them as unknowns."""
        origin, *moved = (body_point(*place) for place in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)))
        changes = Rows.of([one - origin for one in moved], self.names[: self.shared]).affine[:, :, 0]
        return {kind: change for kind, change in zip((_X, _Y), changes, strict=True) if self._has[kind]}

    def _placed(self, values: Array) -> Array:
        """Return the rows with their places, without gains."""
        rows = self.rows.at(values)
        for kind, row in self._angles.items():
            rows = rows + self._unknown(kind, values)[..., None] * row
        return rows

    def at(self, values: ArrayLike) -> Array:
        """Return the rows, 1 and m, at parameter values of shape (..., parameter); shape (..., channel, coordinate)."""
        values = np.asarray(values, dtype=float)
        placed = self._placed(values)
        return placed * (1 + self._unknown(_GAIN, values)[..., None]) if self._has[_GAIN] else placed

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of the rows by the parameters; those by a delay are of no row, and zero.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).

        Returns
        -------
        ndarray
            Shape (channel, parameter, coordinate).
        """
        if not self._has.any():
            return self.rows.slopes
        channels, size = self.rows.affine.shape[:2]
        gains = 1 + self._unknown(_GAIN, values)
        slopes = np.zeros((channels, len(self.names), size))
        slopes[:, : self.shared] = self.rows.slopes * gains[:, None, None]
        if self._has[_GAIN]:
            which = np.flatnonzero(self.positions[:, _GAIN] >= 0)
            slopes[which, self.positions[which, _GAIN]] = self._placed(values)[which]
        for kind, row in self._angles.items():
            which = np.flatnonzero(self.positions[:, kind] >= 0)
            slopes[which, self.positions[which, kind]] = gains[which, None] * row
        return slopes
