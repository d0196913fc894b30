"""A test set up: what is tested, with which sensors and loads, and how that becomes a campaign."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import (
    Campaign,
    Drop,
    KnownValueLike,
    ModelChoice,
    Recording,
    check_statements,
    explain_implausible,
    parse_known_values,
    unique_recording_names,
)
from sprung.errors import Problems, did_you_mean
from sprung.simulation.arguments import (
    check_unique,
    default_drops,
    default_sensors,
    has_pads,
    name_files,
    record,
    records,
)
from sprung.simulation.pads import DrivenMotion
from sprung.simulation.sensor_errors import SensorErrors
from sprung.simulation.sensor_model import Sensing
from sprung.uncertainty import KnownValue
from sprung.vehicle import EMPTY, Load, Motion, Readout, Sensor, Vehicle

Array = NDArray[np.float64]

_ON_PADS = {"pads": "response to pads"}
"""What is simulated, for the history, where that is no drop."""


@dataclass(frozen=True, eq=False)
class SimulationSetup:
    """A vehicle, and everything around it that fits together.

    Attributes
    ----------
    vehicle
        What is tested.
    loads
        The first one is ``empty``.
    drops
        Each with a load that exists and a file name of its own.
    sensing
        Sensors, and what they and the logger make of an acceleration.
    known
        Measured beforehand, ``wheelbase`` among it.
    model
        What is said about the model to identify.
    """

    vehicle: Vehicle
    loads: tuple[Load, ...]
    drops: tuple[Drop, ...]
    sensing: Sensing
    known: dict[str, KnownValue]
    model: ModelChoice

    @classmethod
    def of(
        cls,
        vehicle: Vehicle,
        *,
        sensors: Sequence[Sensor | Mapping[str, Any]] | None,
        loads: Sequence[Load | Mapping[str, Any]] | None,
        drops: Sequence[Drop | Mapping[str, Any]] | None = None,
        rate: float,
        noise: float | Mapping[str, float],
        offset: float,
        gravity: float,
        known: Mapping[str, KnownValueLike] | None,
        model: ModelChoice | Mapping[str, Any] | None,
        problems: Problems,
        sensor_errors: bool = False,
    ) -> SimulationSetup:
        """Return the setup of a test from the arguments of `simulate`; every mistake in them is added to the problems.

        Parameters
        ----------
        vehicle, sensors, loads, drops, rate, noise, offset, gravity, known, model, sensor_errors
            As for `simulate`.
        problems
            Takes what does not fit.
        """
        usual = default_sensors(vehicle, on_pads=has_pads(drops or ()))
        chosen_sensors = usual if sensors is None else records(Sensor, "sensors", sensors, problems)
        placed = [
            sensor.on is not None and not (sensor.needs_position and sensor.position is None)
            for sensor in chosen_sensors
        ]
        for i, known_place in enumerate(placed):
            if not known_place:
                do = "A body sensor needs its position = [x, y, z], m; a wheel sensor its station."
                problems.add(f"simulate: sensors[{i}]", "no place", "where the sensor sits", do)
        # What is faulty itself has been named, and is not asked for anything else.
        chosen_sensors = tuple(
            sensor for sensor, known_place in zip(chosen_sensors, placed, strict=True) if known_place
        )
        given_loads = records(Load, "loads", loads or (), problems)
        for i, load in enumerate(given_loads):
            if not load.is_described:
                do = "A load needs items = [...] or added = {...}."
                problems.add(f"simulate: loads[{i}]", "neither items nor added", "what the load adds", do)
        all_loads = (EMPTY, *(load for load in given_loads if load != EMPTY))
        given_drops = (
            default_drops(all_loads, vehicle.layout) if drops is None else records(Drop, "drops", drops, problems)
        )
        chosen_drops = tuple(drop.on_wheels_of(vehicle.layout) for drop in given_drops)

        for i, drop in enumerate(chosen_drops):
            if not drop.wheels:
                problems.add(f"simulate: drops[{i}].wheels", "[]", "the wheels that fall, not empty", "Name them.")
        for kind, given in (("sensors", sensors), ("drops", drops)):
            if given is not None and not len(given):
                problems.add(
                    f"simulate: {kind}", "none", "at least one", "Leave the argument out for the default ones."
                )
        check_unique("sensors", "channel", [sensor.channel for sensor in chosen_sensors], problems)
        check_unique("loads", "name", [load.name for load in given_loads], problems)
        check_unique("drops", "file", [drop.file for drop in chosen_drops if drop.file is not None], problems)
        check_unique("drops", "name", [drop.name for drop in chosen_drops if drop.name is not None], problems)
        # A load that is faulty itself has been named above, and the drops with it are not at fault.
        names = {load.name for load in all_loads}
        names |= {load.name if isinstance(load, Load) else str(load.get("name")) for load in loads or ()}
        for name in sorted({drop.load for drop in chosen_drops} - names):
            problems.add("simulate: drops", f"load '{name}'", "the name of a load", did_you_mean(name, names))
        stated_sensors = chosen_sensors if sensor_errors else tuple(sensor.exact for sensor in chosen_sensors)
        sensing = Sensing.of(stated_sensors, rate, noise, offset=offset, gravity=gravity, problems=problems)
        tape = {"wheelbase": KnownValue(vehicle.wheelbase)} if vehicle.layout.pitches else {}
        stated = tape | parse_known_values(known or {}, "simulate: known", problems)
        _check_plausible(vehicle, chosen_sensors, all_loads, chosen_drops, stated, problems)
        return cls(
            vehicle,
            all_loads,
            name_files(chosen_drops),
            sensing,
            stated,
            record(ModelChoice, "model", model or {}, problems) or ModelChoice(),
        )

    def campaign(
        self,
        drops: Sequence[Drop],
        motions: Iterable[Motion | DrivenMotion],
        what: str,
        random: np.random.Generator,
        sensor_errors: bool = False,
    ) -> Campaign:
        """Return the campaign that the sensors would have recorded.

        Parameters
        ----------
        drops
            One for each recording, with a file name.
        motions
            In each of them, of the coordinates, from static equilibrium with the load, SI, shape (coordinate, time); on pads
            with theirs.
        what
            What was simulated, for the history.
        random
            Where noise and offsets come from.
        sensor_errors
            Whether the sensors deviate from what is stated of them.
        """
        sensors, rate = self.sensing.sensors, self.sensing.rate
        # A generator of their own: noise is the same with them and without.
        errors = SensorErrors.drawn(sensors, random.spawn(1)[0]) if sensor_errors else None
        seen = [self._seen(motion, errors) for motion in motions]
        recorded = [
            drop.with_recording(
                Recording(
                    name=name,
                    channels=tuple(sensor.channel for sensor in sensors),
                    values=self.sensing.readings(reading, random),
                    start=0.0,
                    rate=rate,
                    history=(
                        f"simulated: {_ON_PADS.get(drop.excitation, what)} of {self.vehicle.name}, load '{drop.load}'",
                    ),
                )
            )
            for drop, name, reading in zip(drops, unique_recording_names(drops), seen, strict=True)
        ]
        return Campaign(
            name=self.vehicle.name,
            sensors=sensors,
            drops=tuple(recorded),
            loads=self.loads,
            vehicle_model=self.vehicle.model,
            wheelbase=self.known.get("wheelbase"),
            cg_height=self.vehicle.cg_height,
            wheel_height=self.vehicle.wheel_height,
            roll_axis_height=self.vehicle.roll_axis_height,
            known={name: quantity for name, quantity in self.known.items() if name != "wheelbase"},
            model=self.model,
        )

    def _seen(self, motion: Motion | DrivenMotion, errors: SensorErrors | None) -> Array:
        """Return what the sensors read of a motion beside gravity, SI, shape (channel, time)."""
        vehicle, sensors, rate = self.vehicle, self.sensing.sensors, self.sensing.rate
        of_pads: Array | float = motion.readings(vehicle, sensors) if isinstance(motion, DrivenMotion) else 0.0
        of_coordinates = motion.motion if isinstance(motion, DrivenMotion) else motion
        if errors is not None:
            return errors.readings(vehicle, sensors, of_coordinates, rate, of_pads)
        parameters = vehicle.parameters
        readout = Readout.of(sensors, tuple(parameters), vehicle.wheelbase)
        return np.asarray(readout.read(list(parameters.values()), of_coordinates) + of_pads)


def _check_plausible(
    vehicle: Vehicle,
    sensors: Sequence[Sensor],
    loads: Sequence[Load],
    drops: Sequence[Drop],
    known: Mapping[str, KnownValue],
    problems: Problems,
) -> None:
    """Add a problem for every statement that a vehicle file may not make either."""
    check_statements(
        "simulate",
        sensors=sensors,
        loads=loads,
        drops=drops,
        known={name: quantity for name, quantity in known.items() if name != "wheelbase"},
        vehicle_model=vehicle.model,
        wheelbase=known.get("wheelbase"),
        heights=vehicle.heights,
        whole=False,
        problems=problems,
    )
    for name, value in vehicle.parameters.items():
        limits = explain_implausible(name, value)
        if limits is not None:
            problems.add(f"simulate: vehicle.{name}", f"{value:g}", *limits)


def check_not_negative(problems: Problems, **lengths: float) -> None:
    """Add a problem for every length of time or space that is negative or not finite."""
    for name, value in lengths.items():
        if not (math.isfinite(value) and value >= 0):
            problems.add(f"simulate: {name}", repr(value), "a number that is not negative", "Correct it.")
