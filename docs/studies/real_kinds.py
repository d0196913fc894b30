"""Real cars drawn at random, kind by kind, and how each is tested.

Sizes are log-uniform in the ranges that are usual; every parameter of the plain car is drawn around its type's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from types import MappingProxyType
from typing import Any
from zlib import crc32

import numpy as np
from real_motion import BallastItem
from real_sensors import RealSensor, sensors_of
from real_vehicle import STATIONS, BodyMode, Occupant, Pair, RealCar, Station

RATE, DURATION, NOISE = 500.0, 3.6, 0.02
"""Samples per second, s of each recording, and m/s² root-mean-square."""

RELEASE, LATER = 0.4, 0.03
"""s from the start of the first recording to its release, and how much later that of each further drop is."""

WEIGHING = 3.0
"""kg: standard uncertainty of each axle's mass."""

GAIN, TILT, PLACE = 0.01, math.radians(2.0), 0.01
"""Standard deviations of sensors as they are: part of the reading, rad and m."""

FIVE: tuple[tuple[Station, ...], ...] = (STATIONS, ("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr"))
"""Wheels of the five drops."""

SPREAD = 0.15
"""Logarithmic half-width of the range of each parameter around its type's."""


def _type(name: str, *values: float) -> RealCar:
    m_s, pitch, roll, m_uf, m_ur, k_sf, k_sr, k_tf, k_tr, c_sf, c_sr, a, b, t_f, t_r = values
    return RealCar(
        name=name,
        m_s=m_s,
        I_yy=pitch,
        I_xx=roll,
        m_uf=m_uf,
        m_ur=m_ur,
        k_sf=k_sf,
        k_sr=k_sr,
        k_tf=k_tf,
        k_tr=k_tr,
        c_sf=c_sf,
        c_sr=c_sr,
        a=a,
        b=b,
        t_f=t_f,
        t_r=t_r,
    )


TYPES = (
    _type("small car", 820, 1080, 270, 30, 27, 16e3, 14.5e3, 155e3, 155e3, 1150, 1050, 0.98, 1.37, 0.68, 0.67),
    _type("hatchback", 1190, 1780, 430, 37, 35, 22e3, 21e3, 200e3, 200e3, 1550, 1400, 1.06, 1.53, 0.745, 0.735),
    _type("sedan", 1390, 2480, 560, 41, 44, 24.8e3, 28.3e3, 231e3, 238e3, 1900, 1750, 1.21, 1.49, 0.765, 0.755),
    _type("SUV", 1950, 3550, 870, 54, 57, 33e3, 37e3, 270e3, 270e3, 2700, 2800, 1.40, 1.47, 0.81, 0.815),
    _type("van", 2050, 5000, 1000, 55, 70, 40e3, 52e3, 270e3, 310e3, 3000, 3300, 1.45, 1.85, 0.80, 0.70),
    _type("bus", 5600, 31e3, 6900, 190, 390, 92e3, 171e3, 690e3, 1380e3, 8200, 17500, 2.35, 1.95, 0.82, 0.70),
)
"""Plain cars of each type: hatchback to van like many on the road, the bus one with 5.6 t of body."""


@dataclass(frozen=True)
class RealTest:
    """One car, and how it is tested.

    Attributes
    ----------
    kind, seed
        What it was drawn from.
    car
        The car.
    sensors
        As they are.
    items
        Of the load.
    drops
        Whether each is loaded, and its wheels.
    height
        Of the blocks, m.
    rate, duration, noise
        Samples per second, s of each recording, and m/s² root-mean-square.
    weighing
        Standard uncertainty of each axle's mass, kg; None where nothing is weighed.
    filtered
        Whether the loggers have a low-pass filter.
    other
        For no vehicle: a second car of which every other recording is.
    slaps
        For no vehicle: the channel of a sensor that is loose.
    cg_height, wheel_height
        m above the ground, where the body turns with finite angles; None where angles are small.
    """

    kind: str
    seed: int
    car: RealCar
    sensors: tuple[RealSensor, ...]
    items: tuple[BallastItem, ...]
    drops: tuple[tuple[bool, tuple[Station, ...]], ...]
    height: float = 0.05
    rate: float = RATE
    duration: float = DURATION
    noise: float = NOISE
    weighing: float | None = WEIGHING
    filtered: bool = False
    other: RealCar | None = None
    slaps: str | None = None
    cg_height: float | None = None
    wheel_height: float | None = None

    @property
    def own_seed(self) -> int:
        """Seed of its noise and of its errors of weighing."""
        return crc32(f"{self.kind} {self.seed}".encode())


class Draw:
    """Sizes drawn at random; front and rear ones differ a little."""

    def __init__(self, kind: str, seed: int) -> None:
        self.random = np.random.default_rng([crc32(kind.encode()), seed])

    def size(self, low: float, high: float) -> float:
        """Return a size, log-uniform."""
        return float(np.exp(self.random.uniform(math.log(low), math.log(high))))

    def pair(self, low: float, high: float) -> Pair:
        """Return the sizes at both axles: one for the car, and 15 % of difference between them at most."""
        mean = self.size(low, high)
        return mean * self.size(0.93, 1.07), mean * self.size(0.93, 1.07)

    def car(self, names: tuple[str, ...] = ()) -> RealCar:
        """Return a plain car of any type, or of those named."""
        types = [one for one in TYPES if not names or one.name in names]
        one = types[int(self.random.integers(len(types)))]
        drawn: dict[str, Any] = {
            name: value * self.size(math.exp(-SPREAD), math.exp(SPREAD)) for name, value in one.parameters.items()
        }
        # The geometry of a type varies less, and both axles have about the same track.
        for name in ("a", "b", "t_f", "t_r"):
            drawn[name] = getattr(one, name) * self.size(0.95, 1.05)
        return replace(one, **drawn)


def add_mount(car: RealCar, draw: Draw) -> RealCar:
    """Add a rubber mount in series with each damper: 5 to 30 spring rates, with up to a fifth of the damper's own damping."""
    front, rear = draw.pair(5, 30)
    part = float(draw.random.choice([0.0, draw.size(0.05, 0.2)]))
    return replace(car, mount=(front * car.k_sf, rear * car.k_sr), mount_damping=(part * car.c_sf, part * car.c_sr))


def add_knee(car: RealCar, draw: Draw) -> RealCar:
    """Add a damper curve: a knee at 0.05 to 0.2 m/s, 20 to 60 % beyond it, rebound 1.3 to 3 times harder.

    The knee of every other car is rounded. Damping before it is larger, so that at 0.3 m/s the curve's mean of both
    directions is the car's.
    """
    return _with_curve(car, draw, (0.2, 0.6), (1.4, 2.8))


def add_orifice(car: RealCar, draw: Draw) -> RealCar:
    """Add dampers that an orifice makes the harder the faster they move, as `add_knee`, with 1.5 to 3 times beyond the knee.

    Rebound is up to twice as hard.
    """
    return _with_curve(car, draw, (1.6, 2.8), (1.07, 1.9))


def _with_curve(car: RealCar, draw: Draw, slopes: Pair, rebounds: Pair) -> RealCar:
    knee, slope = draw.pair(0.05, 0.2), draw.pair(*slopes)
    ratio = [1 / (min(k / 0.3, 1) * (1 - s) + s) for k, s in zip(knee, slope, strict=True)]
    rebound = draw.pair(*rebounds)
    front, rear = (r * 2 / (1 + e) for r, e in zip(ratio, rebound, strict=True))
    part = float(draw.random.choice([0.0, 0.3]))
    rounding = (part * knee[0], part * knee[1])
    curve = replace(car, knee=knee, rounding=rounding, slope=slope, rebound=rebound)
    return replace(curve, c_sf=car.c_sf * front, c_sr=car.c_sr * rear)


def add_zener(car: RealCar, draw: Draw) -> RealCar:
    """Add rubber beside each spring: 10 to 30 % of its rate, relaxing in 20 to 200 ms."""
    time = draw.size(0.02, 0.2)
    return replace(car, zener=draw.pair(0.1, 0.28), relaxation=(time, time))


def add_tyre(car: RealCar, draw: Draw) -> RealCar:
    """Add tyres whose secant rate grows by 3 to 8 of its size per metre (a bus: a third), and damp 50 to 200 N s/m."""
    growth, damping = draw.pair(3, 8), draw.pair(50, 200)
    part = 3.0 if car.name == "bus" else 1.0
    scale = 0.5 * (car.k_tf + car.k_tr) / 220e3
    return replace(
        car, hard=(growth[0] / part, growth[1] / part), tyre_damping=(damping[0] * scale, damping[1] * scale)
    )


def add_friction(car: RealCar, draw: Draw) -> RealCar:
    """Add dry friction of 0.5 to 1.5 % of the load on each suspension, built up within 0.1 to 1 mm."""
    part, length = draw.size(0.005, 0.015), draw.size(1e-4, 1e-3)
    front, rear = (part * 9.81 * car.m_s * x / (2 * car.wheelbase) for x in (car.b, car.a))
    return replace(car, friction=(front, rear), presliding=(front / length, rear / length))


def add_twist(car: RealCar, draw: Draw) -> RealCar:
    """Add torsion of the body, 8 to 15 Hz on a bus or van, 15 to 30 Hz on a car."""
    low = 8 if car.name in ("bus", "van") else 15
    return replace(car, body_mode=BodyMode("twist", draw.size(low, 15 * low / 8)))


def add_bending(car: RealCar, draw: Draw) -> RealCar:
    """Add bending of the body, 9 to 16 Hz on a bus or van, 16 to 28 Hz on a car."""
    low = 9 if car.name in ("bus", "van") else 16
    return replace(car, body_mode=BodyMode("bending", draw.size(low, 16 * low / 9)))


def add_air(car: RealCar, draw: Draw) -> RealCar:
    """Add air springs with a column of 0.1 to 0.25 m."""
    return replace(car, column=draw.pair(0.12, 0.25))


def add_people(car: RealCar, draw: Draw) -> RealCar:
    """Add two people on the front seats: 60 to 95 kg, 3.5 to 5.5 Hz, damped to 0.2 to 0.4.

    Their mass is part of the sprung mass.
    """
    x, y = -0.42 * car.wheelbase, 0.5 * car.t_f
    people = tuple(
        Occupant(x, side * y, draw.size(60, 95), draw.size(3.5, 5.5), draw.size(0.2, 0.4)) for side in (1.0, -1.0)
    )
    return replace(car, occupants=people, m_s=car.m_s + sum(one.mass for one in people))


def add_usual(car: RealCar, draw: Draw) -> RealCar:
    """Add everything that every car has: mount, damper curve, rubber, tyre, friction."""
    for add in (add_mount, add_knee, add_zener, add_tyre, add_friction):
        car = add(car, draw)
    return car


def add_play(car: RealCar, draw: Draw) -> RealCar:
    """Let one wheel strike a stop after 2 to 6 mm of free travel each way."""
    station = STATIONS[int(draw.random.integers(4))]
    return replace(car, play={station: draw.size(0.002, 0.006)}, play_rate=draw.size(5, 20) * car.k_sf)


Add = Callable[[RealCar, Draw], RealCar]

_LONG = ("SUV", "van", "bus")

KINDS: Mapping[str, tuple[tuple[Add, ...], tuple[str, ...]]] = MappingProxyType(
    {
        "plain": ((), ()),
        "mount": ((add_mount,), ()),
        "knee": ((add_knee,), ()),
        "orifice": ((add_orifice,), ()),
        "Zener": ((add_zener,), ()),
        "tyre": ((add_tyre,), ()),
        "twist": ((add_twist,), _LONG),
        "bending": ((add_bending,), _LONG),
        "air": ((add_air,), _LONG),
        "seats": ((add_people,), ()),
        "sensors": ((), ()),
        "usual": ((add_usual,), ("small car", "hatchback", "sedan", "SUV", "van")),
        "no roll drops": ((), ("hatchback", "sedan", "SUV")),
        "two effects": ((), ()),
        "tall": ((), ("SUV", "van")),
    }
)
"""What is added to which types of cars; all types where none is named."""

EFFECTS: tuple[Add, ...] = (
    add_mount,
    add_knee,
    add_zener,
    add_tyre,
    add_friction,
    add_twist,
    add_bending,
    add_air,
    add_people,
)

PAIRS = tuple(pair for pair in combinations(EFFECTS, 2) if pair != (add_twist, add_bending))
"""Two effects at once: 35 pairs, one after the other. A body twists or bends."""

NO_VEHICLE = ("play", "slapping sensor", "two vehicles")
"""What no vehicle is."""


def draw_test(kind: str, seed: int) -> RealTest:
    """Draw a car of a kind, its load and its sensors."""
    draw = Draw(kind, seed)
    adds, types = KINDS.get(kind, ((add_play,) if kind == "play" else (), ()))
    if kind == "two effects":
        adds = PAIRS[seed % len(PAIRS)]
        types = _LONG if {*adds} & {add_twist, add_bending, add_air} else ()
    car = draw.car(types)
    for add in adds:
        car = add(car, draw)
    bus = car.name == "bus"
    sensors = sensors_of(car, height=0.9 if bus else 0.55)
    if kind in ("sensors", "usual", "two effects"):
        sensors = tuple(_as_it_is(one, draw) for one in sensors)
    drops = tuple((loaded, wheels) for loaded in (False, True) for wheels in FIVE)
    if kind == "no roll drops":
        drops = tuple(one for one in drops if len({station[1] for station in one[1]}) > 1)
    test = RealTest(kind, seed, car, sensors, _load(car, draw), drops, 0.07 if bus else 0.05)
    if kind == "tall":
        bars = (0.5 * car.k_sf * draw.size(0.7, 1.4), 0.3 * car.k_sr * draw.size(0.7, 1.4))
        heights: dict[str, Any] = {"cg_height": draw.size(0.75, 1.0), "wheel_height": draw.size(0.3, 0.36)}
        return replace(test, car=replace(car, anti_roll=bars), **heights)
    if kind == "two vehicles":
        return replace(test, other=draw.car((car.name,)))
    if kind == "slapping sensor":
        return replace(test, slaps=sensors[4 + int(draw.random.integers(4))].channel)
    return replace(test, filtered=kind in ("sensors", "usual"))


def _as_it_is(sensor: RealSensor, draw: Draw) -> RealSensor:
    """Return a sensor with the errors of every sensor; one on a wheel turns with nothing."""
    gain, *others = draw.random.standard_normal(5).tolist()
    tilt, place = (TILT * others[0], TILT * others[1]), (PLACE * others[2], PLACE * others[3])
    return replace(sensor, gain=1 + GAIN * gain, tilt=tilt, misplaced=place if sensor.on == "body" else (0.0, 0.0))


def _load(car: RealCar, draw: Draw) -> tuple[BallastItem, ...]:
    """Return two items of 12 % of the car's mass together, one ahead, one behind on the other side."""
    mass, side = 0.12 * car.m_s * draw.size(0.8, 1.25), float(draw.random.choice([-1.0, 1.0]))
    parts = (0.6, -0.34, 0.27), (0.4, -0.95, -0.33)
    return tuple(
        BallastItem(
            round(part * mass),
            round(x * car.wheelbase, 2),
            round(side * y * car.t_f, 2),
            (round(0.06 * part * mass, 1), round(0.08 * part * mass, 1)),
        )
        for part, x, y in parts
    )
