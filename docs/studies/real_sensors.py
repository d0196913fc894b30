"""Accelerometers and loggers as they are: gain, tilt, place, delay, a low-pass filter, noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from real_motion import Motion, points
from real_vehicle import GRAVITY, SIDE, STATIONS, Real, RealCar, Station
from scipy.signal import butter, lfilter, lfilter_zi

FILTER_ORDER, CORNER = 4, 100.0
"""Of the loggers' Butterworth filter, Hz."""

_NEAR = 1e-4
"""m between two points of the body that show how it is inclined."""


@dataclass(frozen=True)
class RealSensor:
    """One accelerometer.

    Attributes
    ----------
    channel, on
        Its name, and the body or a wheel station.
    x, y, z
        Where it is said to be, m: forward of the front axle, left of the centreline, above the ground; the body's only.
    gain
        Of its readings, gravity included.
    tilt
        Components of its direction along x and y, rad.
    misplaced
        How far it is from where it is said to be, along x and y, m.
    delay
        Of its readings, s.
    """

    channel: str
    on: Literal["body"] | Station
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    gain: float = 1.0
    tilt: tuple[float, float] = (0.0, 0.0)
    misplaced: tuple[float, float] = (0.0, 0.0)
    delay: float = 0.0

    def reading(self, car: RealCar, motion: Motion, row: int, cg_height: float) -> Real:
        """Return what it reads at every step of a drop, without noise, m/s².

        Parameters
        ----------
        car
            What it is mounted on.
        motion, row
            The drop.
        cg_height
            Of the car's body above the ground, m: what is above it moves sideways as the body turns.
        """
        acceleration = motion.acceleration[row]
        along = np.sqrt(1 - self.tilt[0] ** 2 - self.tilt[1] ** 2)
        if self.on != "body":
            return np.asarray(self.gain * along * (acceleration[4 + STATIONS.index(self.on)] + GRAVITY))
        x, y = self.x + self.misplaced[0], self.y + self.misplaced[1]
        where, ahead, beside = points(car, [x, x + _NEAR, x], [y, y, y + _NEAR])
        (pitch, roll), above = motion.angles[row], self.z - cg_height
        # The body's own axes turn with it: gravity shows forward when the nose is up, and to the left when the left is. What
        # is above the middle moves back where the body rises ahead, as it pitches, and as it bends or twists there.
        forward = -GRAVITY * pitch - above * (ahead - where) @ acceleration / _NEAR
        left = GRAVITY * roll - above * (beside - where) @ acceleration / _NEAR
        up = where @ acceleration + GRAVITY
        return np.asarray(self.gain * (along * up + self.tilt[0] * forward + self.tilt[1] * left))


def sensors_of(car: RealCar, ahead: float = 0.12, inside: float = 0.06, height: float = 0.55) -> tuple[RealSensor, ...]:
    """Return eight sensors: at the body's corners beyond the axles and inside the wheels, and on the wheels."""
    corners = []
    for station, side in zip(STATIONS, SIDE.tolist(), strict=True):
        x, half = (ahead, car.t_f) if station[0] == "f" else (-car.wheelbase - 0.8 * ahead, car.t_r)
        place = (round(x, 3), round(side * (half - inside), 3))
        corners.append(RealSensor(f"body_{station}", "body", *place, height))
    return (*corners, *(RealSensor(f"wheel_{station}", station) for station in STATIONS))


def recorded(
    car: RealCar,
    sensors: Sequence[RealSensor],
    motion: Motion,
    row: int,
    *,
    rate: float,
    noise: float,
    random: np.random.Generator,
    filtered: bool = False,
    cg_height: float = 0.55,
    slaps: str | None = None,
) -> Real:
    """Return a recording of one drop, (channel, time), m/s².

    Parameters
    ----------
    car, sensors, motion, row, cg_height
        As for `RealSensor.reading`.
    rate, noise
        Samples per second, and m/s² root-mean-square of white noise.
    random
        Where the noise comes from.
    filtered
        Whether the logger has its low-pass filter.
    slaps
        Channel of a sensor that is loose.
    """
    if motion.readings is None:
        values = np.array([one.reading(car, motion, row, cg_height) for one in sensors])
    else:
        values = motion.readings[row]
    for channel, one in enumerate(sensors):
        if one.channel == slaps:
            values[channel] = slapping(one, car, motion, row, random)
    if filtered:
        b, a = butter(FILTER_ORDER, CORNER, fs=1 / motion.step)
        start = lfilter_zi(b, a)[None] * values[:, :1]
        values = lfilter(b, a, values, axis=1, zi=start)[0]
    time = motion.step * np.arange(values.shape[1])
    for channel, one in enumerate(sensors):
        if one.delay:
            values[channel] = np.interp(time - one.delay, time, values[channel])
    every = round(1 / (rate * motion.step))
    sampled = values[:, ::every]
    return np.asarray(sampled + noise * random.standard_normal(sampled.shape))


def slapping(sensor: RealSensor, car: RealCar, motion: Motion, row: int, random: np.random.Generator) -> Real:
    """Return what a loose sensor reads at every step: it rests on its base by its weight, and strikes a stop above it.

    Parameters
    ----------
    sensor, car, motion, row
        As for `RealSensor.reading`.
    random
        Where the play of 0.2 to 1 mm and the frequency of contact of 60 to 150 Hz come from.
    """
    base = sensor.reading(car, motion, row, 0.0)
    play, turning = random.uniform(0.2e-3, 1e-3), 2 * np.pi * random.uniform(60, 150)
    stiff, damping, h = turning**2, 0.2 * turning, motion.step
    above, speed = -GRAVITY / stiff, 0.0
    read = np.empty_like(base)
    for k, pushed in enumerate(base.tolist()):
        depth = min(above, 0.0) + max(above - play, 0.0)
        read[k] = -stiff * depth - damping * speed if depth else 0.0
        # Semi-implicit, as a contact of 100 Hz is slow beside the step.
        speed += h * (read[k] - pushed)
        above += h * speed
    return read
