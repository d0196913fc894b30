"""Alternatives to a test: further measurements and other tests, with their cost."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import DEFAULT_HEIGHT, Excitation
from sprung.planning.cramer_rao import CramerRaoBound
from sprung.planning.setup import PlannedDrop, PlannedTest
from sprung.simulation import DEFAULT_SPEED, USUAL_NOISE
from sprung.uncertainty import KnownValue
from sprung.vehicle import EMPTY, STATIONS, WHEELS, Item, Load, Sensor, Wheel, evaluate_quantity, parameter_name

Real = NDArray[np.float64]

SCALES = 0.001
"""Standard uncertainty of a weighing, as a part of the vehicle's total mass: 5 kg for a bus of 5 t."""

REPEATS = (2, 4)
"""How often every drop is done."""

FRACTIONS = (0.05, 0.1, 0.2, 0.3)
"""Mass of the load in the middle, as a part of the vehicle's total mass."""

ELSEWHERE = 0.2
"""The same of a load elsewhere."""

QUIETER = (2, 5)
"""By how much the noise of other sensors is smaller."""

RATES = (0.5, 2.0)
"""Other sampling rates, as multiples of the planned one."""

DROP_LABELS: Mapping[frozenset[Wheel], str] = {
    frozenset(WHEELS): "all wheels",
    frozenset(("fl", "fr")): "front wheels",
    frozenset(("rl", "rr")): "rear wheels",
    frozenset(("fl", "rl")): "left wheels",
    frozenset(("fr", "rr")): "right wheels",
    frozenset(("fl", "rr")): "fl and rr",
    frozenset(("fl",)): "fl alone",
    frozenset(("front", "rear")): "all wheels",
    frozenset(("front",)): "front wheel",
    frozenset(("rear",)): "rear wheel",
    frozenset(("left", "right")): "all wheels",
    frozenset(("left",)): "left wheel",
    frozenset(("right",)): "right wheel",
    frozenset(("wheel",)): "all wheels",
}
"""Labels of drops by their wheels."""


_KMH = 3.6

_INSTEAD: Mapping[Excitation, tuple[str, str]] = {
    "drop": ("drops instead", "dropping the vehicle off blocks in place of all else"),
    "push": ("pushes instead", "pushing the body by hand at the same places in place of all else"),
    "pass": ("passes instead", f"driving over a bump at {_KMH * DEFAULT_SPEED:.0f} km/h as often in place of all else"),
}
"""Label and text of the test with one excitation alone."""


class Cost(IntEnum):
    """Cost of a step, the cheapest first.

    A weighbridge is on the way; weighing axles takes two readings there. Dropping again what is rigged costs minutes, moving
    the blocks more. A load has to be found, weighed and placed; other sensors have to be bought.
    """

    TOTAL_MASS = 1
    AXLE_LOADS = 2
    REPEATS = 3
    DROP = 4
    LOAD = 5
    SENSORS = 6


@dataclass(frozen=True, eq=False)
class Alternative:
    """A test that differs from another one.

    Attributes
    ----------
    label
        A few words, for a table.
    text
        What is done, for a sentence: ``weighing both axles``.
    cost
        None for what is no step beyond the test but another one.
    factor
        Multiplies the information in all drops: repeats, or sensors with less noise.
    added
        Additional drops.
    known
        Additional quantities known beforehand.
    instead, rate
        Drops done in place of the test's own, if any, and samples per second in place of the planned ones.
    sensors
        Further sensors, with usual noise.
    test
        The test that it changes.
    """

    label: str
    text: str
    test: PlannedTest = field(repr=False)
    cost: Cost | None = None
    factor: float = 1.0
    added: tuple[PlannedDrop, ...] = ()
    known: Mapping[str, KnownValue] = field(default_factory=dict)
    instead: tuple[PlannedDrop, ...] | None = None
    rate: float | None = None
    sensors: tuple[Sensor, ...] = ()

    @cached_property
    def added_information(self) -> Real:
        """Information in the additional drops, or in those done instead less that in the test's; (direction, direction)."""
        setup = self.test.setup
        if self.sensors:
            noise = [USUAL_NOISE[sensor.quantity] for sensor in self.sensors]
            of_all = setup.information_with(self.sensors, noise, self.test.drops)
            return of_all - self.test.information if self.test.recorded_information is None else of_all
        if self.instead is not None:
            return setup.drop_information(self.instead, self.rate) - self.test.information
        return setup.drop_information(self.added)

    @cached_property
    def known_information(self) -> Real:
        """Information in the additional known quantities; shape (direction, direction)."""
        return self.test.setup.prior_information(self.known)


def compute_bound(test: PlannedTest, *alternatives: Alternative) -> CramerRaoBound:
    """Compute the Cramér-Rao bound of a test with all these changes together.

    Raises
    ------
    InputError
        If the vehicle cannot be dropped so.
    """
    information, known, factor = test.information, test.known_information, 1.0
    for alternative in alternatives:
        information = information + alternative.added_information
        known = known + alternative.known_information
        factor *= alternative.factor
    return CramerRaoBound(test.setup, factor * information + known)


def list_alternatives(test: PlannedTest) -> Iterator[Alternative]:
    """Yield the alternatives to a test: further steps in the order of their cost, then other tests."""
    yield from _weighings(test)
    yield from _repeats(test)
    yield from _drops(test)
    yield from _passes(test)
    yield from _loads(test)
    yield from _further_sensors(test)
    for factor in QUIETER:
        part = "half" if factor == 2 else f"1/{factor} of"
        text = f"sensors with {part} the noise, every drop repeated"
        more = factor**2 if test.recorded_information is None else 1 + factor**2  # what is recorded already remains
        yield Alternative(f"noise / {factor}", text, test, Cost.SENSORS, factor=more)
    if test.recorded_information is None:
        yield from _other_tests(test)


def _weighings(test: PlannedTest) -> Iterator[Alternative]:
    setup = test.setup
    std = SCALES * setup.vehicle.total_mass

    def weighed(*names: str) -> dict[str, KnownValue]:
        values = {name: evaluate_quantity(name, setup.names, setup.values)[0] for name in names}
        return {name: KnownValue(value, std) for name, value in values.items() if name not in setup.known}

    has_axles = setup.vehicle.layout.pitches
    axles = weighed("front_axle_mass", "rear_axle_mass") if has_axles else {}
    total = weighed("total_mass") if axles or not has_axles else {}
    if total:
        yield Alternative("total mass", "knowing the total mass", test, Cost.TOTAL_MASS, known=total)
    if axles:
        yield Alternative("axle loads", "weighing both axles", test, Cost.AXLE_LOADS, known=axles)


def _repeats(test: PlannedTest) -> Iterator[Alternative]:
    for times in REPEATS:
        how = "twice" if times == 2 else f"{times} times"
        yield Alternative(f"drops {how}", f"doing every drop {how}", test, Cost.REPEATS, factor=times)


def _drops(test: PlannedTest) -> Iterator[Alternative]:
    done = {frozenset(drop.wheels) for drop in test.drops if drop.load == EMPTY and drop.excitation == "drop"}
    height = test.drops[0].height if test.drops else DEFAULT_HEIGHT
    stations = test.setup.vehicle.layout.wheels
    for wheels, name in DROP_LABELS.items():
        if wheels not in done and wheels <= {*stations}:
            ordered = tuple(wheel for wheel in stations if wheel in wheels)
            text = f"a drop of {name if name.startswith('fl') else f'the {name}'.replace('the all', 'all')}"
            added = (PlannedDrop(EMPTY, ordered, height),)
            yield Alternative(f"+ {name}", text, test, Cost.DROP, added=added)


def _passes(test: PlannedTest) -> Iterator[Alternative]:
    """Yield passes over a bump where nothing is dropped: to drive costs less than to drop."""
    if {drop.excitation for drop in test.drops} == {"push"}:
        passes = tuple(drop for drop in _excited(test, "pass") if drop.load == EMPTY)
        text = f"driving over a bump at {_KMH * DEFAULT_SPEED:.0f} km/h"
        yield Alternative("+ passes", text, test, Cost.DROP, added=passes)


def _excited(test: PlannedTest, excitation: Excitation) -> tuple[PlannedDrop, ...]:
    """Return the drops of a test done in another way: no pass is one of front or of rear wheels alone."""
    stations = test.setup.vehicle.layout.wheels
    others = [drop._replace(excitation=excitation, speed=None) for drop in test.drops]
    if excitation != "pass":
        return tuple(others)
    sides = {STATIONS[wheel].side for wheel in stations}
    of_sides = [{STATIONS[wheel].side for wheel in drop.wheels} for drop in others]
    return tuple(
        drop._replace(wheels=tuple(wheel for wheel in stations if STATIONS[wheel].side in (own or sides)))
        for drop, own in zip(others, of_sides, strict=True)
    )


def _loads(test: PlannedTest) -> Iterator[Alternative]:
    vehicle = test.setup.vehicle
    layout = vehicle.layout
    middle = (-vehicle.a if layout.pitches else 0.0, 0.0)
    places = [(fraction, "middle", "in the middle", middle) for fraction in FRACTIONS]
    if layout.pitches:
        places.append((ELSEWHERE, "front", "over the front axle", (0.0, 0.0)))
        places.append((ELSEWHERE, "rear", "over the rear axle", (-vehicle.wheelbase, 0.0)))
    if layout.rolls:
        half = max(float(getattr(vehicle, parameter_name("t", layout.axles[0], which))) for which in "12")
        places.append((ELSEWHERE, "left", "on the left", (middle[0], half)))
    ways = dict.fromkeys(drop[1:] for drop in test.drops)
    for fraction, label, where, (x, y) in places:
        # Level with the centre of gravity: how high it sits is a matter of the vehicle, not of the plan.
        item = Item(mass=fraction * vehicle.total_mass, position=(x, y, vehicle.cg_height or 0.0))
        load = Load(name=f"{100 * fraction:g} % {where}", items=(item,))
        text = f"the same drops with a load of {100 * fraction:g} % of the total mass {where}"
        added = tuple(PlannedDrop(load, *way) for way in ways)
        yield Alternative(f"+ {100 * fraction:g} % {label}", text, test, Cost.LOAD, added=added)


def _further_sensors(test: PlannedTest) -> Iterator[Alternative]:
    """Yield further sensors with which the drops are done again, or once: suspension travel by axle, and gyroscopes."""
    setup, layout = test.setup, test.setup.vehicle.layout
    measured = {sensor.relative_to for sensor in setup.sensors} | {
        sensor.axis for sensor in setup.sensors if sensor.quantity == "angular-rate"
    }
    travels = {
        wheel: Sensor(channel=f"travel {wheel}", on="body", quantity="displacement", relative_to=wheel)
        for wheel in layout.wheels
        if wheel not in measured
    }
    ends = {"f": "front ", "r": "rear ", "": ""}
    for axle in layout.axles:
        own = tuple(travels[wheel] for wheel in layout.wheels_of(axle) if wheel in travels)
        if own:
            text = f"measuring {ends[axle]}suspension travel as well"
            yield Alternative(f"+ {ends[axle]}travel", text, test, Cost.SENSORS, sensors=own)
    turns: dict[Literal["pitch", "roll"], bool] = {"pitch": layout.pitches, "roll": layout.rolls}
    gyroscopes = tuple(
        Sensor(channel=f"{axis} rate", on="body", quantity="angular-rate", axis=axis)
        for axis, does in turns.items()
        if does and axis not in measured
    )
    if gyroscopes:
        text = "measuring the body's angular rates as well"
        yield Alternative("+ gyroscopes", text, test, Cost.SENSORS, sensors=gyroscopes)


def _other_tests(test: PlannedTest) -> Iterator[Alternative]:
    """Yield tests with fewer drops or another rate; a completed test can only be extended."""
    empty = tuple(drop for drop in test.drops if drop.load == EMPTY)
    if empty and len(empty) < len(test.drops):
        yield Alternative("without load", "leaving the load out", test, instead=empty)
    for wheels, name in DROP_LABELS.items():
        some = tuple(drop for drop in test.drops if frozenset(drop.wheels) == wheels)
        if some and len(some) < len(test.drops):
            yield Alternative(f"only {name}", f"drops of {name} only", test, instead=some)
    for excitation, (label, text) in _INSTEAD.items():
        if any(drop.excitation not in (excitation, "pads") for drop in test.drops):
            yield Alternative(label, text, test, instead=_excited(test, excitation))
    for times in RATES:
        rate = times * test.setup.rate
        text = f"sampling at {rate:g} Hz with the same noise density"
        yield Alternative(f"{rate:g} Hz", text, test, instead=test.drops, rate=rate)
