"""Accelerometers: their places and directions, the rows of their displacements, and how well they are known."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from sprung.errors import InputError, Problem
from sprung.uncertainty import KnownValue
from sprung.vehicle import kinematics
from sprung.vehicle.checked_record import checked_record
from sprung.vehicle.kinematics import Row
from sprung.vehicle.load import Finite, Positive
from sprung.vehicle.nuisances import SensorQuantity, sensor_unknown

SensorPlace = Literal["body", "fl", "fr", "rl", "rr", "front", "rear", "left", "right", "wheel"]
"""The body, or a wheel station."""

LARGEST_PLACE = 1.0
"""Largest standard uncertainty of a position, m."""

_TAIL = 2.4
"""Standard deviation, in means, of a normal distribution of which four are as rare as they are of τ²/2 (exponential): as rare
as what lies 9.4 means beyond the mean."""

_PENDULUM = 0.16
"""m: g/ω² at 1.25 Hz, the natural frequency of usual bodies; see `Sensor.uncertainties`."""


@checked_record
class Sensor:
    """One accelerometer, as a campaign file describes it."""

    # In a draft whose places are not known yet, `on` is None for a wheel station, and a body sensor has no position.

    channel: Annotated[str, Field(min_length=1)]
    """Column or channel name in the recordings."""
    on: SensorPlace | None
    """The body, or a wheel station."""
    position: tuple[Finite, Finite, Finite] | None = None
    """x forward of the front axle, y left of the centreline, z above the ground, m. Body sensors only."""
    unit: str | None = None
    """Unit; overrides that of the file; m/s² if neither states one."""
    direction: Literal["up", "down"] = "up"
    """Direction of a positive reading."""
    range: Positive | None = None
    """Full scale, in the sensor's unit."""
    resolution: Positive | None = None
    """Smallest step, in the sensor's unit."""
    high_pass: Positive | None = None
    """Corner frequency of an AC-coupled sensor, Hz."""
    logger: str | None = None
    """Name of its logger, if there were several."""
    gain_std: Annotated[float, Field(ge=0, le=0.5)] = 0.01
    """Standard uncertainty of its gain, relative: 0.01 is 1 %; 0 means exact."""
    tilt_std: Annotated[float, Field(ge=0, le=30)] = 2.0
    """Standard uncertainty of its tilt about each horizontal axis, degrees; 0 means exact."""
    position_std: Annotated[float, Field(ge=0, le=LARGEST_PLACE)] = 0.01
    """Standard uncertainty of its position, in each direction, m; 0 means exact. Body sensors only."""
    delay_std: Annotated[float, Field(ge=0, le=0.1)] = 0.0
    """Standard uncertainty of its delay against the other channels, s; 0 means exact."""

    @property
    def row(self) -> Row:
        """Row of the displacement whose second derivative it measures, positive up.

        Raises
        ------
        InputError
            If its place is not known.
        """
        if self.on is not None and self.on != "body":
            return kinematics.wheel(self.on)
        if self.on is None or self.position is None:
            found, expected = ("no position", "[x, y, z], m") if self.on else ("no wheel station", "fl, fr, rl or rr")
            raise InputError([Problem(f"sensor '{self.channel}'", found, expected, "State the place of the sensor.")])
        return kinematics.body_point(self.position[0], self.position[1])

    @property
    def exact(self) -> Sensor:
        """The sensor with gain, tilt, place and delay stated to be exact."""
        return replace(self, gain_std=0.0, tilt_std=0.0, position_std=0.0, delay_std=0.0)

    def at_height_above(self, height: float) -> Sensor:
        """Return the sensor with what its tilt adds to the uncertainty of its place, at a height above the axis of rotation.

        There a tilted sensor shows a part of the horizontal acceleration, which is the height times the angular acceleration:
        as if it sat elsewhere by the tilt times the height.

        Parameters
        ----------
        height
            Height of the axis above the ground, m.

        Returns
        -------
        Sensor
        """
        if self.position is None:
            return self
        beside = math.radians(self.tilt_std) * (self.position[2] - height)
        return replace(self, position_std=min(math.hypot(self.position_std, beside), LARGEST_PLACE))

    @property
    def uncertainties(self) -> dict[str, KnownValue]:
        """What is known of its gain, place and delay, by the names under which they are unknowns of a fit, SI.

        A gain is the part by which it reads too much; a place is how much further forward or left it sits, on the body.

        A tilt τ lowers the gain by 1 - cos τ: with a standard uncertainty s about both horizontal axes by s² on average; the
        standard deviation is s² too, and larger deviations are more frequent than normal ones. On the body it mixes in gravity
        times the angle of the body, which at an angular frequency ω is g/ω² times the angular acceleration: as if the sensor
        sat τ g/ω² elsewhere. That is 0.16 m at 1.25 Hz, and nothing at wheel hop. What a height adds is for `at_height_above`.
        """
        tilt = math.radians(self.tilt_std)
        place = math.hypot(self.position_std, tilt * _PENDULUM) if self.position is not None else 0.0
        known: dict[SensorQuantity, KnownValue] = {
            "gain": KnownValue(-(tilt**2), math.hypot(self.gain_std, _TAIL * tilt**2)),
            "x": KnownValue(0.0, place),
            "y": KnownValue(0.0, place),
            "delay": KnownValue(0.0, self.delay_std),
        }
        return {
            sensor_unknown(quantity, self.channel): value for quantity, value in known.items() if not value.is_exact
        }


def uncertainties_of(sensors: Iterable[Sensor]) -> dict[str, KnownValue]:
    """Return what is known of gain, place and delay of several sensors, SI, by the names of these unknowns of a fit.

    Parameters
    ----------
    sensors
        The sensors; those that are exact add nothing.

    Returns
    -------
    dict
    """
    return {name: known for sensor in sensors for name, known in sensor.uncertainties.items()}
