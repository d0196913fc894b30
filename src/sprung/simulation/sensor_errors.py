"""Deviations of sensors from what is stated of them: gain, tilt, place and delay, drawn from their standard uncertainties."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Motion, Readout, Row, Rows, Sensor, Vehicle

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SensorErrors:
    """What each sensor differs by from what is stated; the same in all drops.

    Attributes
    ----------
    gain
        Relative, shape (channel,).
    tilt
        Of its axis forward and left, rad, shape (channel, 2).
    place
        How much further forward and left it sits, m, shape (channel, 2).
    delay
        s, shape (channel,).
    """

    gain: Array
    tilt: Array
    place: Array
    delay: Array

    @classmethod
    def drawn(cls, sensors: Sequence[Sensor], random: np.random.Generator) -> SensorErrors:
        """Draw the deviations of sensors from normal distributions."""
        gain, tilt, place, delay = np.array(
            [
                (one.gain_std, 0.0 if one.pad else np.radians(one.tilt_std), one.position_std, one.delay_std)
                for one in sensors
            ]
        ).T
        number = len(sensors)
        return cls(
            gain * random.standard_normal(number),
            tilt[:, None] * random.standard_normal((number, 2)),
            place[:, None] * random.standard_normal((number, 2)),
            delay * random.standard_normal(number),
        )

    def readings(
        self, vehicle: Vehicle, sensors: Sequence[Sensor], motion: Motion, rate: float, of_pads: Array | float = 0.0
    ) -> Array:
        """Return what the sensors read of a motion, without gravity at rest.

        Parameters
        ----------
        vehicle
            Whose motion it is.
        sensors
            As stated.
        motion
            Of the coordinates, SI, shape (coordinate, time) each.
        rate
            Samples per second.
        of_pads
            What the pads' displacements add for sensors without errors, SI, shape (channel, time).

        Returns
        -------
        ndarray
            SI, positive up, shape (channel, time).
        """
        moved = [_moved(sensor, *place.tolist()) for sensor, place in zip(sensors, self.place, strict=True)]
        names, values = tuple(vehicle.parameters), list(vehicle.parameters.values())
        readings = Readout.of(moved, names, vehicle.wheelbase).read(values, motion)
        readings *= np.cos(np.linalg.norm(self.tilt, axis=1))[:, None]
        angles = Rows.of([Row({"theta": 1.0}), Row({"phi": 1.0})], names).at(values)
        pitch, roll = STANDARD_GRAVITY * (angles @ motion.displacement)
        by_pitch, by_roll = angles @ motion.acceleration
        for channel, (sensor, (forward, left)) in enumerate(zip(sensors, np.sin(self.tilt), strict=True)):
            if sensor.position is not None and sensor.reads_gravity:
                # Nose down and left side up are positive: what is above the axis then moves forward and to the right.
                height = 0.0 if vehicle.cg_height is None else sensor.position[2] - vehicle.cg_height
                readings[channel] += forward * (height * by_pitch - pitch)
                readings[channel] -= left * (height * by_roll - roll)
        readings = (readings + of_pads) * (1 + self.gain[:, None])
        return np.array([_delayed(*pair, rate) for pair in zip(readings, self.delay.tolist(), strict=True)])


def _moved(sensor: Sensor, forward: float, left: float) -> Sensor:
    if sensor.position is None:
        return sensor
    x, y, z = sensor.position
    return replace(sensor, position=(x + forward, y + left, z))


def _delayed(reading: Array, delay: float, rate: float) -> Array:
    if delay == 0:
        return reading
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 (hardly ever needed)

    time = np.arange(reading.size) / rate
    return np.asarray(CubicSpline(time, reading)(np.maximum(time - delay, 0.0)), dtype=np.float64)
