"""Rigs drawn at random: parts of vehicles with further properties, and the sensors on them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import sprung
from sprung.simulation import default_sensors
from sprung.vehicle import Sensor, Vehicle, VehicleModel

GRAVITY = 9.81

MODELS: Mapping[VehicleModel, float] = {"quarter": 0.4, "pitch-plane": 0.25, "roll-plane": 0.25, "full": 0.1}
"""Share of each part of a vehicle."""

HOW_MANY = (0.35, 0.4, 0.25)
"""Share of vehicles with one, two and three further properties."""

READINGS = (
    "accelerometers",
    "displacements",
    "accelerometers and travel",
    "travel and wheel accelerometers",
    "travel and wheel displacements",
)

NOISE = {"acceleration": 0.02, "displacement": 5e-5, "angular-rate": 2e-3}
"""Root-mean-square, SI."""


class Draw:
    """Random sizes of one rig."""

    def __init__(self, number: int) -> None:
        self.random = np.random.default_rng([number, 0x51675])

    def size(self, least: float, most: float) -> float:
        """Return a number in a range."""
        return float(self.random.uniform(least, most))


EFFECTS: Mapping[str, Mapping[str, tuple[float, float, str]]] = {
    "damper mount": {"k_d": (8, 16, "k_s")},
    "knee": {"v_k": (0.08, 0.2, ""), "q": (0.25, 0.6, "")},
    "rebound": {"r": (1.4, 2.5, "")},
    "Zener branch": {"k_z": (0.1, 0.25, "k_s"), "c_z": (0.03, 0.1, "k_z")},
    "friction": {"F": (0.01, 0.03, "weight"), "s": (500, 2000, "F")},
    "tyre damping": {"c_t": (0.03, 0.1, "c_s")},
    "tyre curve": {"h_t": (3, 10, "")},
    "progressive spring": {"p": (3, 8, "")},
}
"""Parameters of each further property at an axle, of usual size: least and most, SI, or as multiples of another quantity."""


class Rig(NamedTuple):
    """A part of a vehicle, and how it is tested.

    Attributes
    ----------
    number
        Its number, from which all follows.
    vehicle, effects
        The vehicle, and its further properties.
    readings, sensors
        What is measured, and with which sensors.
    noise
        Of each channel, SI.
    loaded
        Whether it is dropped with a load, too.
    are_exact
        Whether the sensors are stated to be exact, and are.
    rate, duration
        Hz; s of each recording.
    """

    number: int
    vehicle: Vehicle
    effects: tuple[str, ...]
    readings: str
    sensors: tuple[Sensor, ...]
    noise: Mapping[str, float]
    loaded: bool
    are_exact: bool
    rate: float
    duration: float

    @property
    def label(self) -> str:
        """What is tested, and how."""
        more = [*(["with a load"] if self.loaded else []), *(["sensors exact"] if self.are_exact else [])]
        return ", ".join([f"{self.vehicle.model} with {' and '.join(self.effects)}", self.readings, *more])

    def record(self) -> sprung.Campaign:
        """Simulate the campaign."""
        load = {"name": "load", "added": {"mass": 0.1 * self.vehicle.m_s}}
        return sprung.simulate(
            self.vehicle,
            sensors=self.sensors,
            loads=[load] if self.loaded else None,
            drops=self._drops(),
            rate=self.rate,
            duration=self.duration,
            noise=self.noise,
            seed=self.number,
            known={"total_mass": self.vehicle.total_mass},
            sensor_errors=not self.are_exact,
        )

    def _drops(self) -> list[dict[str, object]]:
        wheels = self.vehicle.layout.wheels
        ways = [wheels]
        if len(wheels) == 2:
            ways += [(wheel,) for wheel in wheels]
        elif len(wheels) == 4:
            ways += [("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr")]
        heights = (0.03, 0.05, 0.04, 0.06, 0.05)[: 4 if len(wheels) == 1 else 5]
        drops: list[dict[str, object]] = []
        for n, height in enumerate(heights):
            drop: dict[str, object] = {"wheels": ways[n % len(ways)], "height": height}
            drops += [drop, drop | {"load": "load"}] if self.loaded and n < 3 else [drop]
        return drops


def draw_rig(number: int) -> Rig:
    """Draw a rig and its test."""
    draw = Draw(number)
    models = tuple(MODELS)
    model = models[draw.random.choice(len(models), p=tuple(MODELS.values()))]
    many = 1 + int(draw.random.choice(len(HOW_MANY), p=HOW_MANY))
    effects = tuple(str(one) for one in draw.random.permutation(tuple(EFFECTS))[:many])
    vehicle = Vehicle.from_parameters(_parameters(draw, model, effects), name=f"rig {number}")
    readings = str(draw.random.choice(READINGS))
    sensors = _sensors(draw, vehicle, readings)
    return Rig(
        number,
        vehicle,
        effects,
        readings,
        sensors,
        {one.channel: NOISE[one.quantity] * float(draw.random.choice([0.5, 1, 2])) for one in sensors},
        loaded=bool(draw.random.random() < 1 / 2),
        are_exact=bool(draw.random.random() < 1 / 3),
        rate=float(draw.random.choice([400, 500, 1000])),
        duration=float(draw.random.choice([3, 5])),
    )


def _parameters(draw: Draw, model: VehicleModel, effects: tuple[str, ...]) -> dict[str, float]:
    """Return all parameters, SI; those of an axle have its letter."""
    axles = ("f", "r") if model in {"pitch-plane", "full"} else ("",)
    wheels = {"quarter": 1, "pitch-plane": 2, "roll-plane": 2, "full": 4}[model]
    mass = draw.size(220, 600)
    found = {"m_s": mass * wheels}
    if len(axles) == 2:
        base, front = draw.size(2.3, 3.2), draw.size(0.42, 0.55)
        found |= {"a": base * front, "b": base * (1 - front)}
        found["I_yy"] = found["m_s"] * found["a"] * found["b"] * draw.size(0.8, 1.05)
    if model in {"roll-plane", "full"}:
        track = draw.size(0.6, 0.8)
        found["I_xx"] = found["m_s"] * (track * draw.size(0.65, 0.95)) ** 2
        found |= {"t": track} if model == "roll-plane" else {"t_f": track, "t_r": track * draw.size(0.92, 1.05)}
    for axle in axles:
        k_s = mass * (2 * np.pi * draw.size(1.1, 1.7)) ** 2
        own = {
            "m_u": mass * draw.size(0.09, 0.16),
            "k_s": k_s,
            "k_t": k_s * draw.size(6, 10),
            "c_s": 2 * draw.size(0.2, 0.35) * np.sqrt(k_s * mass),
        }
        for name, (least, most, of) in (one for effect in effects for one in EFFECTS[effect].items()):
            own[name] = draw.size(least, most) * ({"": 1.0, "weight": mass * GRAVITY} | own)[of]
        found |= {_name(one, axle): value for one, value in own.items()}
    return found


def _name(parameter: str, axle: str) -> str:
    """Return the name of a parameter of an axle: ``k_s`` is ``k_sf`` there, ``F`` is ``F_f``."""
    return parameter + axle if "_" in parameter or not axle else f"{parameter}_{axle}"


def _sensors(draw: Draw, vehicle: Vehicle, readings: str) -> tuple[Sensor, ...]:
    usual = default_sensors(vehicle)
    on_wheels = tuple(one for one in usual if one.on != "body")
    travel = tuple(
        Sensor(channel=f"travel_{wheel}", on="body", quantity="displacement", relative_to=wheel)
        for wheel in vehicle.layout.wheels
    )
    found = {
        "accelerometers": usual,
        "displacements": tuple(replace(one, quantity="displacement") for one in usual),
        "travel and wheel accelerometers": (*travel, *on_wheels),
        "accelerometers and travel": (*usual, *travel),
        "travel and wheel displacements": (*travel, *(replace(one, quantity="displacement") for one in on_wheels)),
    }[readings]
    turns = {"roll-plane": ("roll",), "pitch-plane": ("pitch",), "full": ("roll", "pitch"), "quarter": ()}[
        vehicle.model
    ]
    # Where nothing on the body says where it is, only a gyroscope tells its roll from the travel at the wheels.
    has_gyroscope = draw.random.random() < 1 / 3 or (readings.startswith("travel") and "roll" in turns)
    if has_gyroscope:
        found += tuple(
            Sensor(channel=f"gyro_{axis}", on="body", quantity="angular-rate", axis=axis)  # type: ignore[arg-type]
            for axis in turns
        )
    return found
