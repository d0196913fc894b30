"""Outputs: what an exported model shows, as rows of displacements, velocities and accelerations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.errors import Problem
from sprung.units import SI_UNITS
from sprung.vehicle import STATIONS, Row, Rows, Sensor, Vehicle, Wheel, linear_elements

Array = NDArray[np.float64]

_BODY: Mapping[str, tuple[str, str, str]] = {
    "z_s": ("heave", "m", "rise of the sprung mass's centre of gravity"),
    "theta": ("pitch", "rad", "pitch angle of the body, positive nose down"),
    "phi": ("roll", "rad", "roll angle of the body, positive left side up"),
}
"""By coordinate: name, unit and meaning of the motion of the rigid body."""

_RATES = {"m": "m/s^2", "rad": "rad/s^2"}


@shown
@dataclass(frozen=True, slots=True)
class Signal:
    """An input or output of an exported model.

    Attributes
    ----------
    name
        Identifier.
    unit
        SI.
    meaning
        In words.
    """

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Output:
    """An output.

    Attributes
    ----------
    signal
        Name, unit and meaning.
    rows
        By the order of the derivative of X by time, 0, 1 or 2; the output is their sum.
    tyre
        Wheel station whose tyre force it is; None for any other output, and then `rows` are not empty.
    """

    signal: Signal
    rows: Mapping[int, Row] = field(default_factory=lambda: MappingProxyType({}))
    tyre: Wheel | None = None


def identifier(name: str) -> str:
    """Return a name as C, Modelica and MATLAB write it: letters, digits and underscores, a letter first."""
    text = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in name)
    return text if text[:1].isalpha() else f"n{text}"


def of_wheel(what: str, wheel: Wheel) -> str:
    """Return the name of a signal at a wheel station, by what it is; without the station where there is one only."""
    return what if wheel == "wheel" else f"{what}_{wheel}"


def road_inputs(vehicle: Vehicle) -> tuple[Signal, ...]:
    """Return the inputs: road under each wheel, then its velocity where tyres have damping."""
    at = {wheel: "the wheel" if wheel == "wheel" else f"wheel {wheel}" for wheel in vehicle.layout.wheels}
    heights = [Signal(of_wheel("road", wheel), "m", f"height of road or pad under {at[wheel]}") for wheel in at]
    rates = [Signal(of_wheel("road_rate", wheel), "m/s", f"rate of the road under {at[wheel]}") for wheel in at]
    return (*heights, *rates) if "tyre-damping" in vehicle.extras else tuple(heights)


def outputs_of(vehicle: Vehicle, sensors: Iterable[Sensor] = ()) -> tuple[Output, ...]:
    """Return the outputs of a vehicle: motions of body and wheels, suspension travel, tyre forces, accelerations, sensors."""
    moving = _moving(vehicle)
    found = [Output(signal, {0: row}) for signal, row in moving]
    found += [
        Output(Signal(of_wheel("travel", wheel), "m", f"suspension travel {_at(wheel)}, positive in rebound"), {0: row})
        for wheel, row in _travels(vehicle).items()
    ]
    found += [
        Output(Signal(of_wheel("tyre_force", wheel), "N", f"force of the ground on the tyre {_at(wheel)}"), tyre=wheel)
        for wheel in vehicle.layout.wheels
    ]
    found += [
        Output(Signal(f"acceleration_{one.name}", _RATES[one.unit], f"second derivative of {one.name}"), {2: row})
        for one, row in moving
    ]
    return (*found, *(_sensed(sensor, vehicle) for sensor in sensors))


def rest_of(output: Output, vehicle: Vehicle, rest: Array) -> float:
    """Return what an output shows at rest of displacements there, X, shape (coordinate,); 0 for forces and derivatives."""
    if 0 not in output.rows:
        return 0.0
    return float(Rows.of([output.rows[0]], tuple(vehicle.parameters)).at(list(vehicle.parameters.values()))[0] @ rest)


def sensor_problems(sensors: Sequence[Sensor], outputs: Sequence[Output], where: str) -> list[Problem]:
    """Return what prevents sensors from being outputs."""
    own = [output.signal.name for output in outputs]
    return [
        Problem(where, f"sensor '{sensor.channel}' on a pad", "a sensor on body or wheel", "The pad is an input.")
        for sensor in sensors
        if sensor.pad is not None and sensor.quantity != "force"
    ] + [
        Problem(where, f"several outputs named '{name}'", "different names", "Rename the channel of the sensor.")
        for name in dict.fromkeys(own)
        if own.count(name) > 1
    ]


def _at(wheel: Wheel) -> str:
    return "of the wheel" if wheel == "wheel" else f"at {wheel}"


def _moving(vehicle: Vehicle) -> list[tuple[Signal, Row]]:
    """Return what moves with a mass: the rigid body and the wheels."""
    layout = vehicle.layout
    body = [(Signal(*_BODY[coordinate]), Row({coordinate: 1.0})) for coordinate in layout.body]
    wheels = [
        (
            Signal(of_wheel("wheel", wheel), "m", f"rise of the wheel {_at(wheel)}"),
            Row({STATIONS[wheel].coordinate: 1.0}),
        )
        for wheel in layout.wheels
    ]
    return body + wheels


def _travels(vehicle: Vehicle) -> dict[Wheel, Row]:
    """Return the row of the spring at each wheel station."""
    elements = linear_elements(vehicle.tracks, vehicle.extras, vehicle.heights, vehicle.wheelbase, vehicle.layout)
    rates = [f"k_s{STATIONS[wheel].axle}" for wheel in vehicle.layout.wheels]
    springs = {rate: [one.row for one in elements if one.coefficient == rate] for rate in rates}
    return {wheel: springs[rate].pop(0) for wheel, rate in zip(vehicle.layout.wheels, rates, strict=True)}


def _sensed(sensor: Sensor, vehicle: Vehicle) -> Output:
    signal = Signal(identifier(f"sensor_{sensor.channel}"), SI_UNITS[sensor.quantity], f"sensor {sensor.channel}")
    if sensor.quantity == "force":
        return Output(signal, tyre=sensor.pad)
    return Output(signal, sensor.rows(tuple(vehicle.parameters), vehicle.wheelbase))
