"""The paper's method from records to parameters: State Variable Method, added mass, least squares."""

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
from sprung.vehicle import EMPTY, WHEELS, Load, Rows, Tracks, Vehicle, Wheel

Real = NDArray[np.float64]

RATE = 500.0
"""Samples per second. The paper states neither this nor the next two; they decide how much rounding grows."""

LAG = 10
"""Samples between the states of eq. (6), 20 ms: about a fifth of a period of wheel hop. One sample loses a digit."""

DECAY = 2.0
"""s of free vibration after the bump or the landing."""

REST = 0.4
"""s on the blocks before a drop."""

BUMP_HEIGHT, BUMP_PASSAGE = 0.09, 0.2
"""Eq. (19): m and s."""

LEFT: tuple[Wheel, ...] = ("fl", "rl")
"""The wheels of the paper's roll mode excitation, A and C."""

FIVE_BUMPS: tuple[tuple[Wheel, ...], ...] = (WHEELS, ("fl", "fr"), ("rl", "rr"), LEFT, ("fr", "rr"))
"""As the drops of the experiment: all, front, rear, left and right wheels."""


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
        What runs.
    bumps
        The wheels that run over it, one run for each.
    noise
        White noise of every sensor, m/s² rms.
    seed
        Of the noise.

    Returns
    -------
    Campaign
        With the free vibration marked: it starts at the end of the bump.
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
        What falls.

    Returns
    -------
    Campaign
        Gravity taken off, and the free vibration marked: it starts when the last tyre has landed for good.
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
        Without offsets in its records.
    a
        Front axle to the body's centre of gravity, m: the paper's coordinates need it before anything is identified.

    Returns
    -------
    dict
        By load, A of eq. (12), shape (14, 14).
    """
    coordinates = np.linalg.pinv(Rows.of([sensor.row for sensor in campaign.sensors], ("a",)).at([a]))
    decays = prepare(campaign).decays
    return {
        load.name: state_variable_method(
            [coordinates @ decay.values for decay in decays if decay.load == load.name], RATE, LAG
        ).state_matrix
        for load in campaign.loads
    }


def identify_as_the_paper(campaign: Campaign, added: Real, a: float, tracks: Tracks = "shared") -> Mapping[str, float]:
    """Walk the paper's whole way: state matrices, eq. (18), then the parameters from M, C and K by least squares.

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
    found = state_matrices(campaign, a)
    loaded = next(load.name for load in campaign.loads if load != EMPTY)
    return parameters_from_matrices(added_mass(found[EMPTY.name], found[loaded], added), tracks)
