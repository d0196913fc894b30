"""Campaigns recorded with real cars: in memory as `sprung.Campaign`, with the truth beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from real_kinds import FIVE, LATER, RELEASE, RealTest
from real_motion import Motion, Row, follow
from real_rotations import follow_turning
from real_sensors import recorded
from real_vehicle import Real, RealCar

import sprung
from sprung.campaign import Drop, Recording
from sprung.uncertainty import KnownValue
from sprung.vehicle import Item, Load, Sensor

EMPTY, LOADED = "empty", "ballast"

_LABELS = ("bounce", "pitch_front", "pitch_rear", "roll_left", "roll_right")


class Truth(NamedTuple):
    """What a campaign was recorded with.

    Attributes
    ----------
    test
        The car and its test.
    last_lift_off
        Of each drop: the last time at which a tyre carries nothing, s.
    fastest
        Largest rates of the dampers in extension and compression after that, by axle, (axle, 2), m/s.
    """

    test: RealTest
    last_lift_off: tuple[float, ...]
    fastest: Real

    @property
    def parameters(self) -> dict[str, float]:
        """Return the true parameters by their names in results, SI; of terms only those that the car has."""
        return true_parameters(self.test.car)


def true_parameters(car: RealCar) -> dict[str, float]:
    """Return a car's parameters by their names in results, SI; of terms only those that the car has."""
    found = car.parameters
    branch = (car.zener[0] * car.k_sf, car.zener[1] * car.k_sr)
    pairs = {
        "k_a": car.anti_roll,
        "c_t": car.tyre_damping,
        "F_": car.friction,
        "r_": tuple(x if x != 1 else 0.0 for x in car.rebound),
        "k_d": tuple(x if np.isfinite(x) else 0.0 for x in car.mount),
        "k_z": branch,
        "c_z": tuple(rate * time for rate, time in zip(branch, car.relaxation, strict=True)),
        "v_k": tuple(x if np.isfinite(x) else 0.0 for x in car.knee),
        "q_": tuple(x if x != 1 else 0.0 for x in car.slope),
        "e_": tuple(1 / x for x in car.column),
    }
    for name, pair in pairs.items():
        found |= {f"{name}{axle}": value for axle, value in zip("fr", pair, strict=True) if value}
    return found


def rows_of(test: RealTest) -> list[Row]:
    """Return the drops of a test."""
    rows = []
    for i, (loaded, wheels) in enumerate(test.drops):
        release = RELEASE + LATER * (FIVE.index(wheels) if wheels in FIVE else i % 5)
        car = test.car if test.other is None or i % 2 == 0 else test.other
        rows.append(Row(car, test.items if loaded else (), wheels, test.height, release))
    return rows


def record(tests: Sequence[RealTest]) -> list[tuple[sprung.Campaign, Truth]]:
    """Record campaigns and read them."""
    return [(campaign_of(truth.test, values), truth) for values, truth in simulate_recordings(tests)]


def simulate_recordings(tests: Sequence[RealTest]) -> list[tuple[list[Real], Truth]]:
    """Return the recordings of campaigns, each (channel, time), m/s²."""
    motions = _motions(tests)
    return [(_recordings(test, motion), _truth(test, motion)) for test, motion in zip(tests, motions, strict=True)]


def _motions(tests: Sequence[RealTest]) -> list[Motion]:
    """Return the motion of each test; drops with small angles that are sampled alike are followed at once."""
    small: dict[tuple[float, float], list[Row]] = {}
    for test in tests:
        if test.cg_height is None:
            small.setdefault((test.rate, test.duration), []).extend(rows_of(test))
    followed = {sampling: follow(rows, *sampling) for sampling, rows in small.items()}
    first = dict.fromkeys(followed, 0)
    found = []
    for test in tests:
        sampling = test.rate, test.duration
        if test.cg_height is not None and test.wheel_height is not None:
            heights = test.cg_height, test.wheel_height
            found.append(follow_turning(rows_of(test), test.sensors, *heights, *sampling))
        else:
            last = first[sampling] + len(test.drops)
            found.append(followed[sampling].of_rows(slice(first[sampling], last)))
            first[sampling] = last
    return found


def _truth(test: RealTest, motion: Motion) -> Truth:
    last = [int(np.flatnonzero(np.logical_or.reduce(one, axis=0)).max(initial=0)) for one in motion.lifted]
    fastest = np.zeros((2, 2))
    for rates, start in zip(motion.rate, last, strict=True):
        for axle in (0, 1):
            after = rates[2 * axle : 2 * axle + 2, start:]
            fastest[axle] = np.maximum(fastest[axle], [after.max(), -after.min()])
    return Truth(test, tuple(one * motion.step for one in last), fastest)


def _recordings(test: RealTest, motion: Motion) -> list[Real]:
    random = np.random.default_rng([test.own_seed, 1])
    return [
        recorded(
            row.car,
            test.sensors,
            motion,
            i,
            rate=test.rate,
            noise=test.noise,
            random=random,
            filtered=test.filtered,
            cg_height=_cg_height(test),
            slaps=test.slaps,
        )
        for i, row in enumerate(rows_of(test))
    ]


def _cg_height(test: RealTest) -> float:
    return 0.55 if test.cg_height is None else test.cg_height


def campaign_of(test: RealTest, recordings: Sequence[Real]) -> sprung.Campaign:
    """Return the campaign of a test; the axles are weighed with an error, if at all.

    Parameters
    ----------
    test
        What was recorded.
    recordings
        Of each drop, (channel, time), m/s².
    """
    height = round(_cg_height(test), 2)
    items = tuple(Item(mass=one.mass, position=(one.x, one.y, height), inertia=one.inertia) for one in test.items)
    channels = tuple(one.channel for one in test.sensors)
    drops = []
    for (loaded, wheels), values in zip(test.drops, recordings, strict=True):
        load = LOADED if loaded else EMPTY
        label = f"{load}_{_LABELS[FIVE.index(wheels)] if wheels in FIVE else '_'.join(wheels)}"
        drop = Drop(file=f"{label}.csv", load=load, wheels=wheels, height=test.height)
        drops.append(
            drop.with_recording(Recording(name=label, channels=channels, values=values, start=0.0, rate=test.rate))
        )
    return sprung.Campaign(
        name=f"{test.kind} {test.seed}",
        sensors=tuple(
            Sensor(channel=one.channel, on=one.on, position=(one.x, one.y, one.z) if one.on == "body" else None)
            for one in test.sensors
        ),
        drops=tuple(drops),
        loads=(Load(name=EMPTY), Load(name=LOADED, items=items)),
        wheelbase=KnownValue(test.car.wheelbase),
        known=_weighed(test),
    )


def _weighed(test: RealTest) -> dict[str, KnownValue]:
    if test.weighing is None:
        return {}
    errors = test.weighing * np.random.default_rng([test.own_seed, 2]).standard_normal(2)
    axles = zip(("front", "rear"), np.array(test.car.axle_masses) + errors, strict=True)
    return {f"{axle}_axle_mass": KnownValue(float(mass), test.weighing) for axle, mass in axles}
