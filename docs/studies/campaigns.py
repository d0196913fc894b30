"""Noisy campaigns by the thousand: what the studies have in common.

A case is one vehicle, one test of it and one noise. Its records are simulated once without noise; every campaign is those
records with noise of its own, the very samples that `sprung.simulate` would give, and everything that was weighed is drawn
from its own uncertainty. Each goes through the whole of `sprung.identify`, and errors are counted in units of the
Cramér-Rao bound of the drops that were used.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import sprung
from sprung.campaign import Excitation
from sprung.planning import CramerRaoBound, MeasurementSetup, PlannedDrop, PlannedTest
from sprung.simulation import USUAL_NOISE, Acting, Push, default_drops, default_sensors
from sprung.uncertainty import NORMAL_95, KnownValue
from sprung.vehicle import (
    EMPTY,
    PARAMETERS,
    STATIONS,
    Item,
    Load,
    Sensor,
    Vehicle,
    Wheel,
    evaluate_quantity,
    parameter_name,
    parameter_of,
)

Real = NDArray[np.float64]

RATE, REST, DURATION = 500.0, 0.4, 3.2
"""Samples per second, and seconds recorded before and after the release."""

LOAD = 0.1
"""Mass of the load, as a part of the vehicle's."""

WEIGHING = 0.001
"""Standard uncertainty of everything weighed, as a part of the vehicle's mass."""

_COUNTS = {1: "one", 2: "two", 3: "three", 5: "five", 6: "six", 10: "ten"}

AXLES = ("front_axle_mass", "rear_axle_mass")

WITH_LOAD = ", with and without load"

Measure = Callable[[Real, Real | float, np.random.Generator], Real]
"""What sensors make of a record without noise: record (channel, time), noise levels, SI (channel, 1), source of noise."""


def white(record: Real, levels: Real | float, random: np.random.Generator) -> Real:
    """Add white noise, drawn as `sprung.simulate` draws it."""
    random.standard_normal(len(record))  # the zero-g offsets, of which there are none
    return record + levels * random.standard_normal(record.shape)


def ballast(vehicle: Vehicle) -> Load:
    """Put a tenth of the vehicle's mass on it: more of it ahead and left, the rest behind and right, as far as it has sides."""
    mass, wheelbase = LOAD * vehicle.total_mass, vehicle.wheelbase
    side = (
        0.4 * float(getattr(vehicle, parameter_name("t", vehicle.layout.axles[0], "1")))
        if vehicle.layout.rolls
        else 0.0
    )
    items = (
        Item(mass=0.6 * mass, position=(-0.4 * wheelbase, side, 0.5)),
        Item(mass=0.4 * mass, position=(-0.75 * wheelbase, -side, 0.5)),
    )
    return Load(name="ballast", items=items)


Sensors = tuple[Sensor, ...] | None
"""The sensors of a test; None for an accelerometer at each corner and on each wheel."""


@dataclass(frozen=True)
class Done:
    """What is done with a vehicle.

    Attributes
    ----------
    excitations
        Each on all, front, rear, left and right wheels, as far as these can be.
    push
        How it is pushed.
    """

    excitations: tuple[Excitation, ...] = ("drop",)
    push: Push = field(default_factory=Push)


@lru_cache(maxsize=32)
def _without_noise(vehicle: Vehicle, loaded: bool, sensors: Sensors, done: Done) -> sprung.Campaign:
    loads = [ballast(vehicle)] if loaded else []
    drops = [
        replace(drop, excitation=excitation)
        for drop in default_drops((EMPTY, *loads), vehicle.layout)
        for excitation in done.excitations
        if excitation != "pass" or goes_over_a_bump(drop.wheels, vehicle)
    ]
    return sprung.simulate(
        vehicle,
        sensors=sensors,
        loads=loads,
        drops=drops,
        push=done.push,
        rate=RATE,
        noise=0.0,
        duration=DURATION,
        rest=REST,
    )


def goes_over_a_bump(wheels: Sequence[Wheel], vehicle: Vehicle) -> bool:
    """Whether wheels can run over a bump without others of their side: what the front does the rear does after it."""
    axles = vehicle.layout.axles
    return all(sum(STATIONS[wheel].axle == axle for wheel in wheels) == len(wheels) / len(axles) for axle in axles)


def _levels(vehicle: Vehicle, sensors: Sensors, noise: float) -> Real:
    """Return the noise of each channel, SI root-mean-square: that of accelerometers, of others as much above what is usual."""
    usual = [USUAL_NOISE[sensor.quantity] for sensor in sensors or default_sensors(vehicle)]
    return noise / USUAL_NOISE["acceleration"] * np.array(usual)


@dataclass(frozen=True)
class Case:
    """One vehicle, one test of it and one noise.

    Attributes
    ----------
    vehicle
        What is dropped: on all wheels, front, rear, left and right ones, as far as it has them.
    loaded
        Whether it is dropped the same ways again with a load.
    weighed
        What is known of it beside the wheelbase, each with an uncertainty of `WEIGHING`.
    noise
        m/s² root-mean-square.
    measure
        What sensors make of a record.
    sensors
        Of the test.
    done
        What is done with it, if not dropped.
    """

    vehicle: Vehicle
    loaded: bool
    weighed: tuple[str, ...]
    noise: float
    measure: Measure = white
    sensors: Sensors = None
    done: Done = field(default_factory=Done)

    @property
    def test(self) -> str:
        """The test in words."""
        scales = {(): "nothing weighed", ("total_mass",): "total mass weighed", AXLES: "axles weighed"}
        layout = self.vehicle.layout
        ways = 1 + 2 * layout.pitches + 2 * layout.rolls
        drops = f"{_COUNTS[2 * ways]} drops{WITH_LOAD}" if self.loaded else f"{_COUNTS[ways]} drop{'s' * (ways > 1)}"
        return f"{drops}, {scales[self.weighed]}"

    @property
    def label(self) -> str:
        """All of it in words."""
        channels = "".join(f", {sensor.channel}" for sensor in self.sensors or ())
        done = "" if self.done == Done() else f", {' '.join(self.done.excitations)} {self.done.push.shape}"
        return f"{self.vehicle.name}, {self.test}, {self.noise:g} m/s², {self.measure.__name__}{channels}{done}"

    @property
    def drops(self) -> int:
        """How many drops there are."""
        return len(_without_noise(self.vehicle, self.loaded, self.sensors, self.done).drops)

    @property
    def scaled(self) -> bool:
        """Whether load or scales fix masses and rates absolutely; else they are judged per total mass."""
        return self.loaded or bool(self.weighed)

    def known(self, random: np.random.Generator | None = None) -> dict[str, KnownValue]:
        """Return the weighed quantities: with a random error, or the true values without a random generator."""
        names, values = tuple(self.vehicle.parameters), np.array(list(self.vehicle.parameters.values()))
        std = WEIGHING * self.vehicle.total_mass
        draws = np.zeros(len(self.weighed)) if random is None else random.standard_normal(len(self.weighed))
        truth = [evaluate_quantity(name, names, values)[0] for name in self.weighed]
        return {
            name: KnownValue(x + std * z, std) for name, x, z in zip(self.weighed, truth, draws.tolist(), strict=True)
        }

    def seed(self, number: int) -> int:
        """Return the seed of a campaign, different for every case."""
        mixed = np.random.SeedSequence([zlib.crc32(self.label.encode()), number])
        return int(mixed.generate_state(1, np.uint64)[0])

    def campaign(self, number: int) -> sprung.Campaign:
        """Return one noisy campaign."""
        clean, seed = _without_noise(self.vehicle, self.loaded, self.sensors, self.done), self.seed(number)
        random, levels = np.random.default_rng(seed), _levels(self.vehicle, self.sensors, self.noise)[:, None]
        recordings = tuple(replace(one, values=self.measure(one.values, levels, random)) for one in clean.recordings)
        return replace(clean.with_recordings(recordings), known=self.known(np.random.default_rng([seed, 1])))

    @cached_property
    def truth(self) -> dict[str, float]:
        """What is to be found: parameters, SI; where nothing fixes the scale, per total mass where they scale."""
        total = 1.0 if self.scaled else self.vehicle.total_mass
        return {n: x / total if PARAMETERS[n].scales else x for n, x in self.vehicle.parameters.items()}

    def bound(self, used: Sequence[int]) -> Real:
        """Return the relative Cramér-Rao bound of all quantities in `truth`, from the drops used; shape (quantity,).

        Decays start where the last tyre last touches; what was weighed counts as one more measurement.
        """
        return _bound(self, tuple(used))

    def identify(self, number: int) -> Trial:
        """Identify the vehicle from one noisy campaign."""
        return self.judge(sprung.identify(self.campaign(number), fall=False))

    def judge(self, result: sprung.Result) -> Trial:
        """Hold a result against the truth."""
        stated = _statements(result, self.scaled)
        used = tuple(i for i, drop in enumerate(result.drops) if drop.start is not None)
        held = np.array([_held(stated.get(name), truth) for name, truth in self.truth.items()]).T
        error, spread = held[:2] / self.bound(used)
        right = result.fit.tracks == self.vehicle.tracks
        return Trial(error, spread, held[2], result.verdict.state, result.fit.inflation, right, len(used))


Statement = tuple[float, float, float, float]
"""Value, standard uncertainty, and the limits of the 95 % interval."""


def _statements(result: sprung.Result, scaled: bool) -> dict[str, Statement]:
    """Return all estimates with a value; without an absolute scale, masses and rates per total mass."""
    found: dict[str, Statement] = {}
    for name, one in result.parameters.items():
        if one.value is not None and one.std is not None and one.interval95 is not None:
            low, high = one.interval95
            found[name] = (one.value, one.std, -np.inf if low is None else low, np.inf if high is None else high)
    if not scaled:
        for name, ratio in result.scale.per_total_mass.items():
            half = NORMAL_95 * ratio.std
            found[name] = (ratio.value, ratio.std, ratio.value - half, ratio.value + half)
    return found


def _held(stated: Statement | None, truth: float) -> tuple[float, float, float]:
    """Return relative error, relative standard uncertainty, and whether the interval holds the truth; NaN if undetermined."""
    if stated is None:
        return np.nan, np.nan, np.nan
    value, std, low, high = stated
    return value / truth - 1, std / truth, float(low <= truth <= high)


class Trial(NamedTuple):
    """What came of one campaign.

    Attributes
    ----------
    error, stated
        Error and stated standard uncertainty in units of the bound; NaN where nothing was stated. Shape (quantity,).
    covered
        Whether the 95 % interval holds the truth, NaN where there is none; shape (quantity,).
    verdict, inflation
        Of the result.
    right_model
        Whether the half-distances were rightly taken to be shared or separate.
    drops
        How many were used.
    """

    error: Real
    stated: Real
    covered: Real
    verdict: str
    inflation: float
    right_model: bool
    drops: int


def _measurement_setup(case: Case, known: Mapping[str, KnownValue]) -> MeasurementSetup:
    vehicle, sensors = case.vehicle, _without_noise(case.vehicle, False, case.sensors, Done()).sensors
    tape = {"wheelbase": KnownValue(vehicle.wheelbase)} if vehicle.layout.pitches else {}
    everything = {**tape, **known}
    levels = _levels(vehicle, case.sensors, case.noise)
    acting = Acting(case.done.push)
    return MeasurementSetup(vehicle, vehicle.tracks, (), everything, sensors, levels, RATE, DURATION, acting=acting)


@lru_cache(maxsize=256)
def _information(case: Case, used: tuple[int, ...]) -> Real:
    """Return the information of drops, without weighings; shape (direction, direction)."""
    clean = _without_noise(case.vehicle, case.loaded, case.sensors, case.done)
    drops = (clean.drops[i] for i in used)
    planned = tuple(PlannedDrop.of(one, clean.load(one.load)) for one in drops)
    return PlannedTest(_measurement_setup(case, {}), planned).information


@lru_cache(maxsize=1024)
def _bound(case: Case, used: tuple[int, ...]) -> Real:
    setup = _measurement_setup(case, case.known())
    information = _information(replace(case, weighed=()), used)
    covariance = CramerRaoBound(setup, information + PlannedTest(setup, ()).known_information).covariance
    gradients = np.eye(len(setup.names))
    if not case.scaled:
        total, gradient = evaluate_quantity("total_mass", setup.names, setup.values)
        scales = np.array([parameter_of(name).scales for name in setup.names])
        gradients[scales] -= gradient * setup.slopes / total
    spread: Real = np.sqrt(np.einsum("ij,jk,ik->i", gradients, covariance, gradients))
    return spread
