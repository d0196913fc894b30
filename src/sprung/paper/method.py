"""The paper's method: State Variable Method, added mass, least squares; and the simulated tests it is applied to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import DEFAULT_HEIGHT, Campaign
from sprung.estimation import parameters_from_matrices
from sprung.modal import state_variable_method
from sprung.paper.added_mass import added_mass
from sprung.preprocess import prepare
from sprung.simulation import drop_from_blocks, half_sine_bumps, simulate
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, WHEELS, Load, Tracks, Vehicle, Wheel, sensor_rows

Real = NDArray[np.float64]

RATE = 500.0
"""Sampling rate, Hz. The paper states neither this nor lag and duration; they determine the rounding error."""

LAG = 10
"""Samples between the states of eq. (6): 20 ms, about a fifth of a period of wheel hop. A lag of one loses a digit."""

DECAY = 2.0
"""Duration of the free vibration after the bump or the landing, s."""

REST = 0.4
"""Time on the blocks before a drop, s."""

BUMP_HEIGHT, BUMP_PASSAGE = 0.09, 0.2
"""Height and duration of the bump of eq. (19), m and s."""

LEFT: tuple[Wheel, ...] = ("fl", "rl")
"""The wheels of the paper's roll mode excitation, A and C."""

FIVE_BUMPS: tuple[tuple[Wheel, ...], ...] = (WHEELS, ("fl", "fr"), ("rl", "rr"), LEFT, ("fr", "rr"))
"""Wheels of the five drops of the experiment: all, front, rear, left, right."""


def bump_campaign(
    vehicle: Vehicle,
    load: Load,
    bumps: Sequence[tuple[Wheel, ...]] = (LEFT,),
    *,
    noise: float = 0.0,
    seed: int = 0,
) -> Campaign:
    """Simulate runs over the bump of eq. (19), empty and loaded, with eight accelerometers.

    Parameters
    ----------
    vehicle, load
        Of the simulation.
    bumps
        Wheels that run over it, one run for each.
    noise
        White noise of every sensor, m/s² rms.
    seed
        Of the noise.

    Returns
    -------
    Campaign
        With the start of the free vibration at the end of the bump.
    """
    runs = [
        half_sine_bumps(
            vehicle,
            wheels=wheels,
            height=BUMP_HEIGHT,
            passage=BUMP_PASSAGE,
            loads=[load],
            rate=RATE,
            noise=noise,
            seed=1000 * seed + i,
            duration=BUMP_PASSAGE + DECAY,
            gravity=0.0,
        )
        for i, wheels in enumerate(bumps)
    ]
    drops = []
    for i, run in enumerate(runs):
        for drop in run.drops:
            name = f"{i}_{drop.recording.name}"
            drops.append(replace(drop, file=name, recording=replace(drop.recording, name=name)))
    return replace(runs[0], drops=tuple(drops))


def drop_campaign(vehicle: Vehicle, load: Load) -> Campaign:
    """Simulate the experiment's drops off blocks, empty and loaded, without noise.

    Parameters
    ----------
    vehicle, load
        Of the simulation.

    Returns
    -------
    Campaign
        Without gravity, and with the start of the free vibration at the last landing of a tyre.
    """
    campaign = simulate(vehicle, loads=[load], rate=RATE, noise=0.0, rest=REST, duration=DECAY + 1.0)
    drops = []
    for drop in campaign.drops:
        height = DEFAULT_HEIGHT if drop.height is None else drop.height
        fall = drop_from_blocks(vehicle, campaign.load(drop.load), drop.wheels, height)
        recording = replace(drop.recording, values=drop.recording.values - STANDARD_GRAVITY)
        drops.append(replace(drop, start=REST + fall.decay_start, recording=recording))
    return replace(campaign, drops=tuple(drops))


def state_matrices(campaign: Campaign, a: float) -> dict[str, Real]:
    """Identify the state matrix of every load by the State Variable Method, all its decays at once.

    Parameters
    ----------
    campaign
        Without offsets in its recordings.
    a
        Front axle to the centre of gravity of the body, m, which the paper's coordinates require.

    Returns
    -------
    dict
        By load, A of eq. (12), shape (14, 14).
    """
    coordinates = np.linalg.pinv(sensor_rows(campaign.sensors, ("a",)).at([a]))
    decays = prepare(campaign).decays
    return {
        load.name: state_variable_method(
            [coordinates @ decay.values for decay in decays if decay.load == load.name], RATE, LAG
        ).state_matrix
        for load in campaign.loads
    }


def identify_by_paper_method(
    campaign: Campaign, added: Real, a: float, tracks: Tracks = "shared"
) -> Mapping[str, float]:
    """Identify the parameters: state matrices, eq. (18), then least squares from M, C and K.

    Parameters
    ----------
    campaign
        Two loads, the empty one first.
    added
        ΔM, shape (7, 7), of full rank.
    a
        Front axle to the body's centre of gravity, m.
    tracks
        Whether springs and dampers of an axle share their half-distance.

    Returns
    -------
    mapping
        Value of each parameter by name.
    """
    matrices = state_matrices(campaign, a)
    loaded = next(load.name for load in campaign.loads if load != EMPTY)
    return parameters_from_matrices(added_mass(matrices[EMPTY.name], matrices[loaded], added), tracks)
