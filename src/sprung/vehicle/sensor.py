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
from sprung.vehicle.load import Finite, NotNegative, Positive
from sprung.vehicle.parameters import SENSOR_DELAY, SENSOR_GAIN, SENSOR_X, SENSOR_Y

_LEVER = 0.4
"""m by which a sensor that is tilted by an angle seems to sit elsewhere, over that angle; see `Sensor.uncertainties`."""


@checked_record
class Sensor:
    """One accelerometer, as a campaign file describes it."""

    # In a draft whose places are not known yet, `on` is None for a wheel station, and a body sensor has no position.

    channel: Annotated[str, Field(min_length=1)]
    """Column or channel name in the recordings."""
    on: Literal["body", "fl", "fr", "rl", "rr"] | None
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
    gain_std: NotNegative = 0.01
    """Standard uncertainty of its gain, relative; 0 means exact."""
    tilt_std: NotNegative = 2.0
    """Standard uncertainty of its tilt about each horizontal axis, degrees; 0 means exact."""
    position_std: NotNegative = 0.01
    """Standard uncertainty of its position, in each direction, m; 0 means exact. Body sensors only."""
    delay_std: NotNegative = 0.0
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

    @property
    def uncertainties(self) -> dict[str, KnownValue]:
        """What is known of its gain, place and delay, by the names under which they are unknowns of a fit, SI.

        A gain is the part by which it reads too much; a place is how much further forward or left it sits, on the body.

        A tilt τ has three effects. It lowers the gain by 1 - cos τ: with a standard uncertainty s about both horizontal axes by
        s² on average, with the standard deviation s². On the body it mixes in the horizontal acceleration, which is the
        angular acceleration times the height h above the axis of rotation, and gravity times the angle: with an angular
        frequency ω together (h + g/ω²) times the angular acceleration, as if the sensor sat τ (h + g/ω²) elsewhere. g/ω² is
        0.16 m at 1.25 Hz, and nothing at wheel hop; a sensor is within some 0.25 m of the height of the centre of gravity.
        """
        tilt = math.radians(self.tilt_std)
        place = math.hypot(self.position_std, tilt * _LEVER) if self.position is not None else 0.0
        known = {
            SENSOR_GAIN: KnownValue(-(tilt**2), math.hypot(self.gain_std, tilt**2)),
            SENSOR_X: KnownValue(0.0, place),
            SENSOR_Y: KnownValue(0.0, place),
            SENSOR_DELAY: KnownValue(0.0, self.delay_std),
        }
        return {f"{kind.prefix}{self.channel}": value for kind, value in known.items() if not value.is_exact}


def uncertainties_of(sensors: Iterable[Sensor]) -> dict[str, KnownValue]:
    """Return what is known of gain, place and delay of several sensors, SI, by the names of these unknowns of a fit.

    Parameters
    ----------
    sensors
        The sensors; those that are exact add nothing.
    """
    return {name: known for sensor in sensors for name, known in sensor.uncertainties.items()}
