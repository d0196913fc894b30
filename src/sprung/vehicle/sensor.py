"""Accelerometers: their places and directions, and the rows of their displacements."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sprung.errors import InputError, Problem
from sprung.vehicle import kinematics
from sprung.vehicle.checked_record import checked_record
from sprung.vehicle.kinematics import Row
from sprung.vehicle.load import Finite, Positive


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
