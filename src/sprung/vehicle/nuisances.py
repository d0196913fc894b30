"""Parameters of a fit that belong to a load or to the sensors, not to the vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from sprung.vehicle.parameters import PARAMETERS, Parameter

LOAD_MASS = "mass of "
"""First words of the name of a parameter that is the mass of a load, or of one of its items, known with an uncertainty."""

SensorQuantity = Literal["gain", "x", "y", "tilt_x", "tilt_y", "delay"]
"""What may be uncertain of a sensor."""

SENSOR_UNKNOWNS: Mapping[SensorQuantity, Parameter] = {
    "gain": Parameter("1", "part by which a channel reads too much", False, False, True),
    "x": Parameter("m", "how much further forward than stated a body sensor sits", False, False, True),
    "y": Parameter("m", "how much further left than stated a body sensor sits", False, False, True),
    "tilt_x": Parameter("rad", "how far the direction of a body sensor leans forward", False, False, True),
    "tilt_y": Parameter("rad", "how far the direction of a body sensor leans to the left", False, False, True),
    "delay": Parameter("s", "how much later than the other channels a channel is", False, False, True),
}
"""Each of these as an unknown of a fit, where it has the name `sensor_unknown`."""


LOW_PASS_CORNER = "corner of the low-pass"  # noqa: S105 (a name, no password)
"""Name of the corner frequency of the low-pass of the loggers that all channels passed."""

_CORNER = Parameter("Hz", "corner frequency of the low-pass of the loggers that all channels passed", False)


def parameter_of(name: str) -> Parameter:
    """Return unit and meaning of any parameter of a fit: of the vehicle, the mass of a load, or an unknown of the sensors.

    Parameters
    ----------
    name
        Its name.

    Returns
    -------
    Parameter

    Raises
    ------
    KeyError
        If nothing has that name.
    """
    if (of_vehicle := PARAMETERS.get(name)) is not None:
        return of_vehicle
    if name.startswith(LOAD_MASS):
        return Parameter("kg", f"{name}, estimated from the recordings and its stated value", True)
    if name == LOW_PASS_CORNER:
        return _CORNER
    for quantity, unknown in SENSOR_UNKNOWNS.items():
        if name.startswith(sensor_unknown(quantity, "")):
            return unknown
    raise KeyError(name)


def sensor_unknown(quantity: SensorQuantity, channel: str) -> str:
    """Return the name of an unknown of a sensor among the parameters of a fit.

    Parameters
    ----------
    quantity
        What is uncertain.
    channel
        The sensor's.

    Returns
    -------
    str
    """
    return f"{quantity} of {channel}"


_OF_SENSORS = (*(sensor_unknown(quantity, "") for quantity in SENSOR_UNKNOWNS), LOW_PASS_CORNER)
"""First words of the names of what may be unknown of sensors."""


def is_of_sensor(name: str) -> bool:
    """Whether a parameter is an unknown of a sensor, or of all of them.

    Parameters
    ----------
    name
        Of any parameter.

    Returns
    -------
    bool
    """
    return name not in PARAMETERS and name.startswith(_OF_SENSORS)


def is_nuisance(name: str) -> bool:
    """Whether a parameter belongs to a load or to the sensors, not to the vehicle.

    Parameters
    ----------
    name
        Of any parameter.

    Returns
    -------
    bool
    """
    return name not in PARAMETERS and name.startswith((LOAD_MASS, *_OF_SENSORS))
