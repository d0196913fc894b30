"""Part of a vehicle: which of it the sensors are on, and the wheel stations of sensors and drops in its terms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

from sprung.drafting.layout_names import Station, part_of_vehicle, stations_named, wheel_at, wheels_in_part
from sprung.drafting.records import DraftDrop, DraftSensor
from sprung.vehicle import PADS, WHEELS, SensorPlace, VehicleModel, Wheel


def find_part(
    sensors: Sequence[DraftSensor], drops: Sequence[DraftDrop]
) -> tuple[VehicleModel, tuple[DraftSensor, ...], tuple[DraftDrop, ...]]:
    """Find which part of a vehicle the sensors are on, and place sensors and drops at its wheel stations.

    Parameters
    ----------
    sensors, drops
        Of a campaign.

    Returns
    -------
    model
        Which part it is.
    sensors
        With the stations that their names state.
    drops
        With the wheels that the sensors show.
    """
    stations = stations_named([sensor.channel for sensor in sensors])
    model = part_of_vehicle(
        [
            (sensor.quantity, _kind(sensor), stations[sensor.channel])
            for sensor in sensors
            if sensor.quantity != "angular-rate"
        ]
    )
    placed = tuple(_placed(sensor, stations[sensor.channel], model) for sensor in sensors)
    return model, placed, tuple(_on_wheels(drop, placed, model) for drop in drops)


def stations_of(sensors: Sequence[DraftSensor], model: VehicleModel) -> Mapping[str, Wheel | None]:
    """Return the wheel station that each sensor is on, or over, by its place or its name."""
    stations = stations_named([sensor.channel for sensor in sensors])
    return {sensor.channel: wheel_at(stations[sensor.channel], model) for sensor in sensors}


def is_on_pad(sensor: DraftSensor) -> bool:
    """Return whether a sensor is on a pad under a tyre, known or not."""
    return sensor.on == "pad" or sensor.on in PADS


def _kind(sensor: DraftSensor) -> str:
    """Return whether a sensor is on the body, on a wheel, on a pad, or between body and wheel."""
    if sensor.is_travel:
        return "travel"
    if is_on_pad(sensor):
        return "pad"
    return {"body": "body", None: "unknown"}.get(sensor.on, "wheel")


def _placed(sensor: DraftSensor, station: Station, model: VehicleModel) -> DraftSensor:
    wheel = wheel_at(station, model)
    if sensor.is_travel:
        return replace(sensor, relative_to=wheel)
    if wheel is None or (model == "full" and sensor.quantity == "acceleration" and sensor.on in ("body", *WHEELS)):
        return sensor
    if sensor.on == "wheel" or sensor.on in WHEELS:
        return replace(sensor, on=wheel)
    if sensor.on == "pad":
        return replace(sensor, on=cast("SensorPlace", next(pad for pad, over in PADS.items() if over == wheel)))
    return sensor


def _on_wheels(drop: DraftDrop, sensors: Sequence[DraftSensor], model: VehicleModel) -> DraftDrop:
    """Return a drop with wheels of the part: those that it names, or those whose sensors fell."""
    if model == "full":
        return drop
    if drop.wheels:
        return replace(drop, wheels=wheels_in_part(drop.wheels, model))
    accelerometers = [sensor for sensor in sensors if sensor.quantity == "acceleration"]
    dropped = {accelerometers[i].on for i in drop.found.dropped_channels if i < len(accelerometers)}
    return replace(drop, wheels=tuple(wheel for wheel in _wheels(model) if wheel in dropped))


def _wheels(model: VehicleModel) -> tuple[Wheel, ...]:
    return wheels_in_part(WHEELS, model)
