"""Five vehicles, and how each is tested: no two with the same sensors, drops, loads, rate or noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from at_the_bound import SMALL_CAR, VAN
from campaigns import AXLES, WEIGHING, Measure, ballast, white

import sprung
from sprung.campaign import Drop
from sprung.uncertainty import KnownValue
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, WHEELS, Item, Load, Sensor, Vehicle, Wheel, evaluate_quantity

OFFSET = 0.05
"""m/s² root-mean-square: what a sensor that feels gravity reads too much at rest, anew in every drop."""

TRUCK = Vehicle(
    name="Truck",
    m_s=5800,
    I_yy=15_500,
    I_xx=3300,
    m_uf=190,
    m_ur=340,
    k_sf=140_000,
    k_sr=260_000,
    k_tf=650_000,
    k_tr=1_300_000,
    c_sf=7500,
    c_sr=9500,
    a=1.75,
    b=1.95,
    t_f=0.52,
    t_r=0.47,
)
"""Made up: a two-axle truck of 6.9 t on coil springs, body at 1.4 to 2 Hz, wheel hop at 10 Hz."""

FRONT, REAR, LEFT, RIGHT = WHEELS[:2], WHEELS[2:], WHEELS[::2], WHEELS[1::2]


@dataclass(frozen=True, eq=False)
class VehicleTest:
    """One vehicle, and how it is tested.

    Attributes
    ----------
    vehicle
        What is dropped.
    sensors, loads, drops
        As `sprung.simulate` takes them.
    rate, noise, rest
        Samples per second, m/s² root-mean-square, and seconds recorded before the release.
    weighed
        What is known of it beside the wheelbase, each with an uncertainty of `WEIGHING` of its mass.
    """

    vehicle: Vehicle
    sensors: tuple[Sensor, ...]
    loads: tuple[Load, ...]
    drops: tuple[Drop, ...]
    rate: float
    noise: float
    rest: float
    weighed: tuple[str, ...] = ()

    @cached_property
    def exact(self) -> sprung.Campaign:
        """The campaign without noise, offsets and anything weighed."""
        return self.simulated(self.vehicle, self.loads, self.drops)

    def simulated(self, vehicle: Vehicle, loads: Sequence[Load], drops: Sequence[Drop]) -> sprung.Campaign:
        """Simulate without noise, with these sensors."""
        return sprung.simulate(
            vehicle, sensors=self.sensors, loads=loads, drops=drops, rate=self.rate, noise=0.0, rest=self.rest
        )

    def campaign(self, seed: int, measure: Measure = white) -> sprung.Campaign:
        """Return a campaign with its own noise, offsets and weighing errors."""
        random = np.random.default_rng([len(self.sensors), len(self.drops), int(self.rate), seed])
        felt = np.array([one.high_pass is None for one in self.sensors])[:, None]
        recordings = []
        for one in self.exact.recordings:
            off = OFFSET * felt * random.standard_normal((len(self.sensors), 1))
            recordings.append(replace(one, values=measure(one.values + off, self.noise, random)))
        return replace(self.exact.with_recordings(recordings), known=self._known(random))

    def _known(self, random: np.random.Generator) -> dict[str, KnownValue]:
        names, values = tuple(self.vehicle.parameters), np.array(list(self.vehicle.parameters.values()))
        std = WEIGHING * self.vehicle.total_mass
        return {
            name: KnownValue(evaluate_quantity(name, names, values)[0] + std * random.standard_normal(), std)
            for name in self.weighed
        }

    @property
    def label(self) -> str:
        """How it is tested, in words."""
        body = sum(one.on == "body" for one in self.sensors)
        coupled = sum(one.high_pass is not None for one in self.sensors)
        loaded = sum(one.load != "empty" for one in self.drops)
        scales = {(): "nothing weighed", ("total_mass",): "total mass weighed", AXLES: "axles weighed"}[self.weighed]
        return (
            f"{len(self.drops)} drops, {loaded or 'none'} of them with a load; {body} sensors on the body, "
            f"{len(self.sensors) - body} on the wheels, {coupled or 'none'} of all AC-coupled; {self.rate:g} Hz, "
            f"{self.noise:g} m/s² of noise; {scales}"
        )


def _body(unit: str | None, high_pass: float | None, **places: tuple[float, float]) -> tuple[Sensor, ...]:
    return tuple(
        Sensor(channel=name, on="body", position=(x, y, 0.6), unit=unit, high_pass=high_pass)
        for name, (x, y) in places.items()
    )


def _wheels(unit: str | None, *coupled: Wheel, high_pass: float = 0.2) -> tuple[Sensor, ...]:
    return tuple(
        Sensor(channel=f"wheel_{one}", on=one, unit=unit, high_pass=high_pass if one in coupled else None)
        for one in WHEELS
    )


def _drops(height: float, **kinds: Sequence[tuple[Wheel, ...]]) -> tuple[Drop, ...]:
    """Return the dropped wheels of every drop, by load."""
    ways = {WHEELS: "all", FRONT: "front", REAR: "rear", LEFT: "left", RIGHT: "right"}
    return tuple(
        Drop(file=f"{load}_{ways.get(wheels, '_'.join(wheels))}.csv", load=load, wheels=wheels, height=height)
        for load, each in kinds.items()
        for wheels in each
    )


FLEET = (
    VehicleTest(
        TABLE_1_CAR,
        (
            *_body("g", None, body_fl=(0.1, 0.74), body_fr=(0.1, -0.74), body_rl=(-2.86, 0.74), body_rr=(-2.86, -0.74)),
            *_wheels("g"),
        ),
        (ballast(TABLE_1_CAR),),
        _drops(0.05, empty=(WHEELS, FRONT, REAR, LEFT, RIGHT), ballast=(WHEELS, FRONT, REAR, LEFT, RIGHT)),
        rate=500.0,
        noise=0.02,
        rest=0.4,
    ),
    VehicleTest(
        SMALL_CAR,
        (*_body(None, None, tower=(0.3, 0.52), sill=(-0.6, -0.66), boot=(-2.2, 0.25)), *_wheels(None, *WHEELS)),
        (Load(name="driver", items=(Item(mass=95, position=(-1.0, 0.35, 0.7)),)),),
        _drops(0.04, empty=(WHEELS, FRONT, LEFT, RIGHT), driver=(WHEELS, REAR)),
        rate=1000.0,
        noise=0.005,
        rest=0.6,
        weighed=("total_mass",),
    ),
    VehicleTest(
        VAN,
        (
            *_body(
                "g",
                0.1,
                cab_left=(0.2, 0.7),
                cab_right=(0.05, -0.8),
                side_left=(-1.9, 0.85),
                tail_left=(-3.9, 0.6),
                tail_right=(-3.7, -0.75),
            ),
            *_wheels("g", *WHEELS, high_pass=0.1),
        ),
        (
            Load(
                name="sacks",
                items=(Item(mass=150, position=(-2.4, 0.5, 0.8)), Item(mass=130, position=(-3.3, -0.4, 0.8))),
            ),
        ),
        _drops(0.06, empty=(WHEELS, FRONT, REAR, LEFT, RIGHT), sacks=(WHEELS, REAR, LEFT)),
        rate=400.0,
        noise=0.02,
        rest=0.5,
    ),
    VehicleTest(
        SCHOOL_BUS,
        (
            *_body(None, None, body_fl=(0.9, 1.0), body_fr=(0.6, -1.1), body_rl=(-4.9, 1.1), body_rr=(-5.3, -0.7)),
            *_wheels(None, "rl", "rr"),
        ),
        (),
        _drops(0.06, empty=(WHEELS, FRONT, REAR, LEFT, ("fr",))),
        rate=200.0,
        noise=0.05,
        rest=1.0,
        weighed=AXLES,
    ),
    VehicleTest(
        TRUCK,
        (
            *_body("g", None, cab_left=(0.8, 0.9), cab_right=(0.9, -0.7), frame_left=(-1.6, 0.4)),
            *_body("g", 0.1, frame_right=(-2.6, -0.45), bed_left=(-5.0, 1.1), bed_right=(-5.1, -1.1)),
            *_wheels("g", "fl", "rr"),
        ),
        (
            Load(
                name="blocks",
                items=(Item(mass=500, position=(-2.0, 0.6, 1.2)), Item(mass=450, position=(-3.9, -0.5, 1.2))),
            ),
        ),
        _drops(0.08, empty=(WHEELS, FRONT, REAR, LEFT, ("rr",)), blocks=(WHEELS, FRONT, RIGHT, ("rl",))),
        rate=250.0,
        noise=0.03,
        rest=0.8,
        weighed=("total_mass",),
    ),
)
"""What is tested, and how."""
