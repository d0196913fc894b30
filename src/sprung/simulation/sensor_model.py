"""What accelerometers and loggers make of an acceleration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from sprung.errors import Problems, did_you_mean
from sprung.units import acceleration_factor
from sprung.vehicle import Sensor

Array = NDArray[np.float64]

MIN_RATE = 64.0
"""Samples per second: the wheel hop of a bus is at 15 Hz, and four samples per period are the least that show it."""


@dataclass(frozen=True, eq=False)
class Sensing:
    """The imperfections of the measurement.

    Attributes
    ----------
    sensors
        The accelerometers.
    rate
        Samples per second.
    noise
        White noise of each channel, m/s² rms, shape (channel,).
    offset
        Standard deviation of the zero-g offset that each channel draws anew in every drop, m/s².
    gravity
        m/s².
    """

    sensors: tuple[Sensor, ...]
    rate: float
    noise: Array
    offset: float
    gravity: float

    @classmethod
    def of(
        cls,
        sensors: tuple[Sensor, ...],
        rate: float,
        noise: float | Mapping[str, float],
        *,
        offset: float,
        gravity: float,
        problems: Problems,
    ) -> Sensing:
        """Check how it is measured; what cannot be is added to the problems.

        Parameters
        ----------
        sensors, rate, offset, gravity
            As the attributes.
        noise
            m/s² rms: one number for all channels, or one for each by its name.
        problems
            Collects what is wrong.
        """
        if not (math.isfinite(rate) and rate >= MIN_RATE):
            found, do = f"{rate} samples per second", "Sample faster."
            problems.add("simulate: rate", found, f"{MIN_RATE:g} or more, four per period of a wheel hop", do)
        for name, value in (("offset", offset), ("gravity", gravity)):
            if not (math.isfinite(value) and value >= 0):
                problems.add(f"simulate: {name}", repr(value), "a number that is not negative, m/s^2", "Correct it.")
        for sensor in sensors:
            try:
                acceleration_factor(sensor.unit or "m/s^2")
            except ValueError as error:
                where = f"simulate: sensor '{sensor.channel}'.unit"
                problems.add(where, f"'{sensor.unit}'", "a unit of acceleration", str(error))
            if sensor.high_pass is not None and sensor.high_pass >= rate / 2:
                found, expected = f"{sensor.high_pass:g} Hz", f"less than half the rate of {rate:g} samples per second"
                problems.add(f"simulate: sensor '{sensor.channel}'.high_pass", found, expected, "Sample faster.")
        return cls(sensors, rate, _levels([sensor.channel for sensor in sensors], noise, problems), offset, gravity)

    def readings(self, acceleration: Array, random: np.random.Generator) -> Array:
        """Read the sensors.

        Parameters
        ----------
        acceleration
            Of each sensor, upward, m/s², shape (channel, time); none before the first sample.
        random
            Where offsets and noise come from.

        Returns
        -------
        ndarray
            m/s², positive up, shape (channel, time). At rest a sensor reads gravity, an AC-coupled one nothing.
        """
        offsets = self.offset * random.standard_normal(len(self.sensors))
        noise = self.noise[:, None] * random.standard_normal(acceleration.shape)
        seen = [self._coupled(*each) for each in zip(self.sensors, acceleration, offsets, strict=True)]
        return np.array([_recorded(*each) for each in zip(self.sensors, np.array(seen) + noise, strict=True)])

    def _coupled(self, sensor: Sensor, acceleration: Array, offset: float) -> Array:
        if sensor.high_pass is None:
            return acceleration + self.gravity + offset
        numerator, denominator = butter(1, sensor.high_pass, "highpass", fs=self.rate)
        return np.asarray(lfilter(numerator, denominator, acceleration), dtype=np.float64)


def _levels(channels: list[str], noise: float | Mapping[str, float], problems: Problems) -> Array:
    """Return the standard deviation of each channel's noise, m/s², shape (channel,)."""
    if not isinstance(noise, Mapping):
        if not (math.isfinite(noise) and noise >= 0):
            problems.add("simulate: noise", repr(noise), "a number that is not negative, m/s^2 rms", "Correct it.")
        return np.full(len(channels), noise, dtype=float)
    for channel in noise.keys() - set(channels):
        problems.add("simulate: noise", f"'{channel}'", "the channel of a sensor", did_you_mean(channel, set(channels)))
    for channel in dict.fromkeys(channels):
        level = noise.get(channel, math.nan)
        if not (math.isfinite(level) and level >= 0):
            found = repr(level) if channel in noise else "nothing"
            do = "Give every channel its noise, 0 if it has none."
            problems.add(f"simulate: noise['{channel}']", found, "a number that is not negative, m/s^2 rms", do)
    return np.array([noise.get(channel, math.nan) for channel in channels], dtype=float)


def _recorded(sensor: Sensor, reading: Array) -> Array:
    """Round and clip one channel, in the sensor's unit; both are the same whichever way the sensor points."""
    unit = acceleration_factor(sensor.unit or "m/s^2")
    if sensor.resolution is not None:
        step = sensor.resolution * unit
        reading = step * np.round(reading / step)
    if sensor.range is not None:
        reading = np.clip(reading, -sensor.range * unit, sensor.range * unit)
    return reading
