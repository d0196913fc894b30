"""Vehicles that do what no element of ours does: never accepted, and no wrong number with a small error bar."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

import sprung
from sprung.simulation import drop_from_blocks
from sprung.vehicle import TABLE_1_CAR, Rows, Vehicle, sensor_rows
from sprung.vehicle.kinematics import body_point

Array = NDArray[np.float64]

LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}
DROPS: list[dict[str, Any]] = [
    {"wheels": wheels, "load": load} for load in ("empty", "ballast") for wheels in (("fl", "fr"), ("fl", "rl"))
]
RATE = 250


def with_a_loose_mass(mass: float, frequency: float, damping: float, play: float = 0.0) -> sprung.Campaign:
    """Decays of the car with a mass on a soft spring above its front axle: an eighth degree of freedom.

    With play, m, it is stopped that far above and below where it rests; solved exactly while it touches the same, which is
    asked ten thousand times a second.
    """
    clean = sprung.simulate(TABLE_1_CAR, loads=[LOAD], drops=DROPS, noise=0.0, seed=1, rate=RATE)
    names, values = tuple(TABLE_1_CAR.parameters), np.array(list(TABLE_1_CAR.parameters.values()))
    at = Rows.of([body_point(0.1, 0.0)], names).at(values)[0]
    sensors = sensor_rows(clean.sensors, names).at(values)
    felt, rate = np.append(at, -1.0), 2 * np.pi * frequency
    random, recordings = np.random.default_rng(1), []
    for drop, recording in zip(clean.drops, clean.recordings, strict=True):
        load = clean.load(drop.load)
        M, C, K = (np.pad(one, (0, 1)) for one in TABLE_1_CAR.matrices(load))
        M[7, 7] = mass
        K += mass * rate**2 * np.outer(felt, felt)
        C += 2 * damping * mass * rate * np.outer(felt, felt)
        free, stopped = (_generator(M, C, K, felt, stop, play) for stop in (0.0, 2e6))
        fall = drop_from_blocks(TABLE_1_CAR, load, drop.wheels, 0.05)
        state = fall.state(fall.decay_start)
        X = np.concatenate([state[:7], [at @ state[:7]], state[7:], [at @ state[7:]], [1.0]])
        fine = 1 if play == 0 else round(10_000 / RATE)
        steps, accelerations = [expm(each / (RATE * fine)) for each in (free, stopped)], []
        for sample in range(3 * RATE * fine):
            gone = felt @ X[:8]
            touching = bool(0 < play < abs(gone))
            X[16] = np.sign(gone) if touching else 1.0
            if sample % fine == 0:
                accelerations.append(((stopped if touching else free) @ X)[8:15])
            X = steps[touching] @ X
        readings = sensors @ np.array(accelerations).T + 9.80665
        noisy = readings + 0.02 * random.standard_normal(readings.shape)
        recordings.append(replace(recording, values=noisy, start=0.0))
    begun = replace(clean, drops=tuple(replace(drop, start=0.0) for drop in clean.drops))
    return begun.with_recordings(recordings)


def _generator(M: Array, C: Array, K: Array, felt: Array, stop: float, play: float) -> Array:
    """Return the generator for {X, Ẋ, s}, a stop of some stiffness, N/m, being met a way from rest, m, on the side s."""
    generator = np.zeros((17, 17))
    generator[:8, 8:16] = np.eye(8)
    driving = np.hstack([K + stop * np.outer(felt, felt), C, -stop * play * felt[:, None]])
    generator[8:16] = -np.linalg.solve(M, driving)
    return generator


def with_hard_stops() -> sprung.Campaign:
    """Stops six times as stiff as the springs, met within the static stroke."""
    car = Vehicle.from_parameters(
        TABLE_1_CAR.parameters | {"k_bf": 1e5, "k_br": 1e5, "x_bf": 0.03, "x_br": 0.03}, name="on its stops"
    )
    return sprung.simulate(car, loads=[LOAD], drops=DROPS, noise=0.02, seed=1, rate=RATE)


@pytest.mark.long
def test_a_mass_on_a_spring_is_an_engine_on_its_mounts() -> None:
    """What hangs beside the body is a part of it by our names: mass, centre of gravity and inertia are those of both."""
    result = sprung.identify(with_a_loose_mass(150.0, 9.0, 0.08))
    car, mass = TABLE_1_CAR, 150.0
    share, arm = mass / (car.m_s + mass), car.a + 0.1
    truth = car.parameters | {
        "m_s": car.m_s + mass,
        "a": car.a - share * arm,
        "b": car.b + share * arm,
        "I_yy": car.I_yy + (1 - share) * mass * arm**2,
        "m_e": mass,
        "k_e": mass * (2 * np.pi * 9.0) ** 2,
        "c_e": 2 * 0.08 * mass * 2 * np.pi * 9.0,
        "x_e": 0.1,
    }
    assert (result.verdict.state, result.fit.model) == ("accept", ("engine",))
    for name, value in truth.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - value) < 4 * found.std, name


@pytest.mark.long
@pytest.mark.parametrize("kind", ["loose mass", "hard stops"])
def test_what_no_element_explains_is_not_accepted(kind: str) -> None:
    """Rejected; or, where stops are found to be what it is, accepted with every number within four standard errors."""
    loose = kind == "loose mass"
    result = sprung.identify(with_a_loose_mass(60.0, 2.0, 0.02, play=0.003) if loose else with_hard_stops())
    explained = kind == "hard stops" and result.fit.model == ("bump-stop",)
    assert result.verdict.state == ("accept" if explained else "reject")
    for name, truth in TABLE_1_CAR.parameters.items():
        found = result.parameters.get(name)
        if found is not None and found.value is not None and found.std is not None:
            assert abs(found.value - truth) < 4 * found.std
