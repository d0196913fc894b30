"""What sensors and loggers make of what they should read."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from sprung.errors import Problems, did_you_mean
from sprung.units import SI_UNITS, Quantity, quantity_name
from sprung.vehicle import Sensor

Array = NDArray[np.float64]

USUAL_NOISE: Mapping[Quantity, float] = {
    "acceleration": 0.02,
    "velocity": 1e-3,
    "displacement": 1e-4,
    "angular-rate": 1e-3,
    "force": 10.0,
}
"""Noise of usual sensors, SI units rms."""

MIN_RATE = 64.0
"""Samples per second: the wheel hop of a bus is at 15 Hz, and four samples per period are the least that show it."""


@dataclass(frozen=True, eq=False)
class Sensing:
    """The imperfections of the measurement.

    Attributes
    ----------
    sensors
        The sensors.
    rate
        Samples per second.
    noise
        White noise of each channel, SI units rms, shape (channel,).
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
            SI units rms: one number for all accelerometers, or one for each channel by its name or what it measures.
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
                sensor.si_factor  # noqa: B018 (asked whether there is one)
            except ValueError as error:
                where = f"simulate: sensor '{sensor.channel}'.unit"
                problems.add(where, f"'{sensor.unit}'", f"a unit of {quantity_name(sensor.quantity)}", str(error))
            if sensor.high_pass is not None and sensor.high_pass >= rate / 2:
                found, expected = f"{sensor.high_pass:g} Hz", f"less than half the rate of {rate:g} samples per second"
                problems.add(f"simulate: sensor '{sensor.channel}'.high_pass", found, expected, "Sample faster.")
        return cls(sensors, rate, _levels(sensors, noise, problems), offset, gravity)

    def readings(self, exact: Array, random: np.random.Generator) -> Array:
        """Read the sensors.

        Parameters
        ----------
        exact
            What each should read beside gravity, SI, positive up, shape (channel, time).
        random
            Where offsets and noise come from.

        Returns
        -------
        ndarray
            SI, positive up, shape (channel, time). At rest an accelerometer reads gravity, an AC-coupled one nothing.
        """
        offsets = self.offset * random.standard_normal(len(self.sensors))
        noise = self.noise[:, None] * random.standard_normal(exact.shape)
        seen = [self._coupled(*each) for each in zip(self.sensors, exact, offsets, strict=True)]
        return np.array([_recorded(*each) for each in zip(self.sensors, np.array(seen) + noise, strict=True)])

    def _coupled(self, sensor: Sensor, exact: Array, offset: float) -> Array:
        if sensor.high_pass is None:
            return exact + self.gravity + offset if sensor.reads_gravity else exact
        numerator, denominator = butter(1, sensor.high_pass, "highpass", fs=self.rate)
        return np.asarray(lfilter(numerator, denominator, exact), dtype=np.float64)


def _levels(sensors: Sequence[Sensor], noise: float | Mapping[str, float], problems: Problems) -> Array:
    """Return the standard deviation of each channel's noise, SI, shape (channel,)."""
    if not isinstance(noise, Mapping):
        if not (math.isfinite(noise) and noise >= 0):
            problems.add("simulate: noise", repr(noise), "a number that is not negative, m/s^2 rms", "Correct it.")
        usual = {quantity: level if noise else 0.0 for quantity, level in USUAL_NOISE.items()} | {"acceleration": noise}
        return np.array([usual[sensor.quantity] for sensor in sensors], dtype=float)
    named = {name for sensor in sensors for name in (sensor.channel, sensor.quantity)}
    for name in noise.keys() - named:
        expected, do = "the channel of a sensor, or what sensors measure", did_you_mean(name, named)
        problems.add("simulate: noise", f"'{name}'", expected, do)
    levels = [noise.get(sensor.channel, noise.get(sensor.quantity, math.nan)) for sensor in sensors]
    for sensor, level in {one.channel: (one, level) for one, level in zip(sensors, levels, strict=True)}.values():
        if not (math.isfinite(level) and level >= 0):
            found = "nothing" if math.isnan(level) else repr(level)
            expected = f"a number that is not negative, {SI_UNITS[sensor.quantity]} rms"
            do = "Give every channel its noise, 0 if it has none."
            problems.add(f"simulate: noise['{sensor.channel}']", found, expected, do)
    return np.array(levels, dtype=float)


def _recorded(sensor: Sensor, reading: Array) -> Array:
    """Round and clip one channel, in the sensor's unit; both are the same whichever way the sensor points."""
    unit = sensor.si_factor
    if sensor.resolution is not None:
        step = sensor.resolution * unit
        reading = step * np.round(reading / step)
    if sensor.range is not None:
        reading = np.clip(reading, -sensor.range * unit, sensor.range * unit)
    return reading
