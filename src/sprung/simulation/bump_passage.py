"""The paper's numerical example: a vehicle driven over a half-sine bump."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sprung.campaign import Campaign, Drop, KnownValueLike, ModelChoice
from sprung.errors import Problems
from sprung.simulation.arguments import name_files
from sprung.simulation.ground import tyre_rates
from sprung.simulation.half_sine_bump import drive_over_half_sine_bump
from sprung.simulation.setup import SimulationSetup, check_not_negative
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import STATIONS, Load, Sensor, Vehicle, Wheel, after_rest


def half_sine_bumps(
    vehicle: Vehicle,
    *,
    wheels: tuple[Wheel, ...] | None = None,
    height: float = 0.09,
    passage: float = 0.2,
    sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    loads: Sequence[Load | Mapping[str, Any]] | None = None,
    rate: float = 500.0,
    noise: float | Mapping[str, float] = 0.0,
    seed: int | None = None,
    duration: float = 3.2,
    rest: float = 0.1,
    known: Mapping[str, KnownValueLike] | None = None,
    model: ModelChoice | Mapping[str, Any] | None = None,
    gravity: float = STANDARD_GRAVITY,
) -> Campaign:
    """Simulate the paper's numerical example: wheels driven over a half-sine bump, eq. (19), once with each load.

    Parameters
    ----------
    vehicle, sensors, loads, rate, noise, seed, known, model, gravity
        As for `simulate`; here there is no noise unless asked for.
    wheels
        That run over the bump, all at once: the left ones unless given, as in the paper. They stay on the ground.
    height, passage
        Of the bump, m, and how long it takes to pass it, s.
    duration, rest
        Seconds recorded from the start of the bump on, and before it, the latter rounded to whole samples.

    Returns
    -------
    Campaign
        With the start of every drop given as the end of the bump.

    Raises
    ------
    InputError
        If something does not fit together; all faults at once.
    """
    problems = Problems()
    if wheels is None:
        wheels = tuple(wheel for wheel in vehicle.layout.wheels if STATIONS[wheel].side >= 0)
    setup = SimulationSetup.of(
        vehicle,
        sensors=sensors,
        loads=loads,
        rate=rate,
        noise=noise,
        offset=0.0,
        gravity=gravity,
        known=known,
        model=model,
        problems=problems,
    )
    check_not_negative(problems, duration=duration, rest=rest, height=height, passage=passage)
    problems.raise_if_any()

    before, samples = round(rest * rate), round(duration * rate)
    drops, motions = [], []
    for load in setup.loads:
        matrices = vehicle.matrices(load)
        motion, _ = drive_over_half_sine_bump(matrices, tyre_rates(vehicle), wheels, height, passage, 1 / rate, samples)
        drops.append(Drop(load=load.name, wheels=wheels, start=before / rate + passage))
        motions.append(after_rest(motion, before))
    return setup.campaign(name_files(drops, "bump"), motions, "half-sine bump", np.random.default_rng(seed))
