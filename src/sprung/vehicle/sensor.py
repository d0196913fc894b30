"""Sensors: what they measure and where, their readings as functions of the motion, and how well they are known."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import Annotated, Literal, cast

from pydantic import Field, model_validator

from sprung.errors import InputError, Problem
from sprung.uncertainty import KnownValue
from sprung.units import SI_UNITS, Quantity, quantity_name, si_factor
from sprung.vehicle import kinematics
from sprung.vehicle.checked_record import checked_record
from sprung.vehicle.kinematics import Row
from sprung.vehicle.layout import STATIONS, Wheel, parameter_name, rates_of_tyre
from sprung.vehicle.load import Finite, Positive
from sprung.vehicle.nuisances import SensorQuantity, sensor_unknown

Pad = Literal["pad fl", "pad fr", "pad rl", "pad rr", "pad front", "pad rear", "pad left", "pad right", "pad wheel"]
"""A pad under the tyre of a wheel station."""

SensorPlace = Literal["body", Wheel, Pad]
"""The body, a wheel station, or a pad under a tyre."""

PADS: Mapping[str, Wheel] = {f"pad {wheel}": wheel for wheel in STATIONS}
"""Wheel station over each pad."""

_ORDERS: Mapping[Quantity, int] = {"displacement": 0, "velocity": 1, "angular-rate": 1, "acceleration": 2}
"""Which derivative of a displacement by time each quantity is."""

LARGEST_PLACE = 1.0
"""Largest standard uncertainty of a position, m."""

_TAIL = 2.4
"""Standard deviation, in means, of a normal distribution of which four are as rare as they are of τ²/2 (exponential): as rare
as what lies 9.4 means beyond the mean."""


@checked_record
class Sensor:
    """One sensor, as a campaign file describes it: an accelerometer unless it says otherwise."""

    # In a draft whose places are not known yet, `on` is None for a wheel station, and a body sensor has no position.

    channel: Annotated[str, Field(min_length=1)]
    """Column or channel name in the recordings."""
    on: SensorPlace | None
    """The body, a wheel station, or a pad under a tyre."""
    quantity: Quantity = "acceleration"
    """What it measures."""
    axis: Literal["vertical", "pitch", "roll"] = "vertical"
    """Axis about which a gyroscope on the body turns: pitch is positive nose down, roll positive left side up."""
    relative_to: Wheel | None = None
    """Wheel station from which a sensor on the body measures: suspension travel, positive in rebound."""
    position: tuple[Finite, Finite, Finite] | None = None
    """x forward of the front axle, y left of the centreline, z above the ground, m. Body sensors only."""
    unit: str | None = None
    """Unit; overrides that of the file; m/s² for an acceleration if neither states one."""
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

    @model_validator(mode="after")
    def _consistent(self) -> Sensor:
        if self.quantity == "angular-rate" and self.axis == "vertical":
            raise ValueError('an angular rate needs axis = "pitch" or axis = "roll"')
        if self.quantity != "angular-rate" and self.axis != "vertical":
            raise ValueError(
                f'axis = "{self.axis}" is for an angular rate; write quantity = "angular-rate", or leave it out'
            )
        if self.quantity == "angular-rate" and self.on not in ("body", None):
            raise ValueError('an angular rate is that of the body; write on = "body"')
        if self.quantity == "force" and self.on is not None and self.on not in PADS:
            raise ValueError('a force is measured by a pad under a tyre; write on = "pad fl" or another pad')
        if self.quantity not in ("displacement", "force") and self.on in PADS:
            raise ValueError(f"a pad's displacement or force is measured, not its {quantity_name(self.quantity)}")
        if self.relative_to is not None and (self.on != "body" or self.quantity not in ("displacement", "velocity")):
            raise ValueError(
                'suspension travel is a displacement, or a velocity, of the body relative to a wheel; write on = "body" and '
                'quantity = "displacement"'
            )
        return self

    @property
    def needs_position(self) -> bool:
        """Whether its reading depends on a position on the body that nothing else states."""
        return self.on == "body" and self.relative_to is None and self.quantity != "angular-rate"

    @property
    def wheel(self) -> Wheel | None:
        """Wheel station that it is on; None for one on the body, on a pad, or where it is not known."""
        return None if self.on is None or self.on == "body" or self.on in PADS else cast("Wheel", self.on)

    @property
    def pad(self) -> Wheel | None:
        """Wheel station over the pad that it is on; None for any other place."""
        return PADS.get(self.on or "")

    @property
    def reads_gravity(self) -> bool:
        """Whether gravity is a part of what it reads at rest."""
        return self.quantity == "acceleration"

    @property
    def si_factor(self) -> float:
        """SI units in one of its own unit.

        Raises
        ------
        ValueError
            If that is no unit of what it measures.
        """
        return si_factor(self.unit or SI_UNITS[self.quantity], self.quantity)

    def rows(self, names: Collection[str], wheelbase: float = 0.0) -> dict[int, Row]:
        """Return what it reads of a vehicle: rows of displacements, of their rates and of their second derivatives.

        Parameters
        ----------
        names
            Parameters of the vehicle: they say what lies over a wheel, and how a tyre presses.
        wheelbase
            Of a body that twists unevenly, m.

        Returns
        -------
        dict of int to Row
            By the order of the derivative, 0, 1 or 2; the reading is their sum. Positive up, in rebound, about the stated axis,
            and for a force as it presses up on the tyre.

        Raises
        ------
        InputError
            If its place is not known.
        """
        if self.quantity == "force":
            station = PADS[str(self.on)]
            coordinate = STATIONS[station].coordinate
            return {
                order: Row({}, {name: {coordinate: -factor} for name, factor in rates.items()})
                for order, rates in rates_of_tyre(station, names).items()
            }
        if self.pad is not None:
            return {0: Row({})}  # a pad's own displacement is no motion of the vehicle
        return {_ORDERS[self.quantity]: self._row(names, wheelbase)}

    def _row(self, names: Collection[str], wheelbase: float) -> Row:
        """Return the row of the displacement, or the angle, that it observes itself or by a derivative."""
        if self.wheel is not None:
            return kinematics.wheel(self.wheel)
        if self.axis == "pitch":
            return kinematics.pitch()
        if self.axis == "roll":
            return kinematics.roll()
        if self.relative_to is not None and self.position is None:
            _, axle, *_ = STATIONS[self.relative_to]
            possible = (parameter_name("t", axle, "2"), parameter_name("t", axle))
            return kinematics.travel(self.relative_to, next((name for name in possible if name in names), possible[-1]))
        if self.on is None or self.position is None:
            found, expected = ("no position", "[x, y, z], m") if self.on else ("no wheel station", "fl, fr, rl or rr")
            raise InputError([Problem(f"sensor '{self.channel}'", found, expected, "State the place of the sensor.")])
        own = kinematics.body_point(self.position[0], self.position[1], names, wheelbase)
        return own if self.relative_to is None else own - kinematics.wheel(self.relative_to)

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
        if self.position is None or not self.reads_gravity:
            return self
        beside = math.radians(self.tilt_std) * (self.position[2] - height)
        return replace(self, position_std=min(math.hypot(self.position_std, beside), LARGEST_PLACE))

    @property
    def uncertainties(self) -> dict[str, KnownValue]:
        """What is known of its gain, place, tilt and delay, by the names under which they are unknowns of a fit, SI.

        A gain is the part by which it reads too much; a place is how much further forward or left it sits, on the body.

        A tilt τ lowers the gain by 1 - cos τ: with a standard uncertainty s about both horizontal axes by s² on average; the
        standard deviation is s² too, and larger deviations are more frequent than normal ones. On the body it mixes in gravity
        times the angle of the body; what a height adds is for `at_height_above`.
        """
        tilt = 0.0 if self.pad else math.radians(self.tilt_std)
        place = self.position_std if self.position is not None else 0.0
        leans = tilt if self.position is not None and self.reads_gravity else 0.0
        known: dict[SensorQuantity, KnownValue] = {
            "gain": KnownValue(-(tilt**2), math.hypot(self.gain_std, _TAIL * tilt**2)),
            "x": KnownValue(0.0, place),
            "y": KnownValue(0.0, place),
            "tilt_x": KnownValue(0.0, leans),
            "tilt_y": KnownValue(0.0, leans),
            "delay": KnownValue(0.0, self.delay_std),
        }
        return {
            sensor_unknown(quantity, self.channel): value for quantity, value in known.items() if not value.is_exact
        }


def uncertainties_of(sensors: Iterable[Sensor]) -> dict[str, KnownValue]:
    """Return what is known of gain, place, tilt and delay of several sensors, SI, by the names of these unknowns of a fit.

    Parameters
    ----------
    sensors
        The sensors; those that are exact add nothing.

    Returns
    -------
    dict
    """
    return {name: known for sensor in sensors for name, known in sensor.uncertainties.items()}
