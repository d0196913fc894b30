"""Free decays and nothing else: the simplest records from which a vehicle can be identified."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sprung.campaign import Campaign, Drop, KnownValueLike, ModelChoice
from sprung.errors import Problems
from sprung.simulation.arguments import name_files
from sprung.simulation.nonlinear_motion import simulate_nonlinear_decays
from sprung.simulation.setup import SimulationSetup, check_not_negative
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Load, Sensor, Vehicle, free_decay, nonlinear_elements, state_variables


def free_decays(
    vehicle: Vehicle,
    *,
    states: int | ArrayLike | Mapping[str, ArrayLike] = 4,
    sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    loads: Sequence[Load | Mapping[str, Any]] | None = None,
    rate: float = 500.0,
    noise: float | Mapping[str, float] = 0.0,
    seed: int | None = None,
    duration: float = 3.2,
    offset: float = 0.0,
    known: Mapping[str, KnownValueLike] | None = None,
    model: ModelChoice | Mapping[str, Any] | None = None,
    gravity: float = STANDARD_GRAVITY,
) -> Campaign:
    """Simulate nothing but free decays, eq. (3): every recording starts in the decay. For tests and studies.

    Parameters
    ----------
    vehicle, sensors, loads, rate, noise, seed, duration, offset, known, model, gravity
        As for `simulate`; here there is no noise unless asked for.
    states
        Where the decays start, {X, Ẋ}: how many random ones with each load, or states of shape (drop, state) used with
        every load, or such states by the name of the load.

    Returns
    -------
    Campaign
        With the start of every drop given as 0.

    Raises
    ------
    InputError
        If something does not fit together; all faults at once.
    """
    problems = Problems()
    setup = SimulationSetup.of(
        vehicle,
        sensors=sensors,
        loads=loads,
        rate=rate,
        noise=noise,
        offset=offset,
        gravity=gravity,
        known=known,
        model=model,
        problems=problems,
    )
    check_not_negative(problems, duration=duration)
    random = np.random.default_rng(seed)
    orders = np.array([order for _, order in state_variables(vehicle.parameters)])
    starts, size = {}, len(orders)
    for load in setup.loads:
        if isinstance(states, int):
            # About what a drop from a few centimetres leaves in a vehicle: m and rad, m/s and rad/s.
            given: ArrayLike = random.standard_normal((states, size)) * np.array([0.02, 0.3])[orders]
        else:
            given = states.get(load.name, np.empty((0, size))) if isinstance(states, Mapping) else states
        starts[load.name] = np.atleast_2d(np.asarray(given, dtype=float))
        if starts[load.name].shape[1:] != (size,):
            found = f"shape {np.shape(given)} for load '{load.name}'"
            problems.add("simulate: states", found, f"shape (drop, {size})", "Give displacements, then velocities.")
    problems.raise_if_any()

    samples = round(duration * rate)
    cases = [(load, state) for load in setup.loads for state in starts[load.name]]
    drops = [Drop(load=load.name, start=0.0) for load, _ in cases]
    if nonlinear_elements(vehicle.tracks, vehicle.extras):
        loads_of, states_of = [load for load, _ in cases], np.array([state for _, state in cases])
        motions = simulate_nonlinear_decays(vehicle, loads_of, states_of, 1 / rate, samples)
    else:
        motions = [free_decay(vehicle.matrices(load), state, 1 / rate, samples) for load, state in cases]
    return setup.campaign(name_files(drops, "decay"), motions, "free decay", random)
