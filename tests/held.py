"""Recordings of displacements of a vehicle, or of a part of it, that is held and let go: simulated, in mm."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sessions import write_table
from sprung.vehicle import Vehicle

RATE, REST = 500.0, 0.3
CHANNELS = (
    "Disp Sprung LH (Filtered)",
    "Disp Sprung RH (Filtered)",
    "Disp Unsprung LH (Filtered)",
    "Disp Unsprung RH (Filtered)",
)
HALF = 0.7
"""m from the middle to the sensors of the rig below."""


def half_car(added: float = 0.0, damping: float = 1.0) -> Vehicle:
    """A vehicle that moves in the roll plane, with added mass."""
    return Vehicle(
        model="roll-plane",
        m_s=400.0 + added, I_xx=100.0 + 0.5 * added, m_u=40.0, k_s=16000.0, k_t=180000.0, c_s=600.0 * damping, t=0.6
    )  # fmt: skip


def let_go(
    vehicle: Vehicle, held: Sequence[float], duration: float = 4.0, seed: int = 1, noise: float = 0.02
) -> NDArray[np.float64]:
    """Coordinates of a vehicle that rests at `held` and is let go, mm, shape (coordinate, time), with noise."""
    mass, damping, stiffness = vehicle.matrices()[:3]
    inverse, size = np.linalg.inv(mass), len(mass)
    rates = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ stiffness, -inverse @ damping]])
    step, state = expm(rates / RATE), np.concatenate([held, np.zeros(size)])
    states = [state] * int(REST * RATE)
    while len(states) < duration * RATE:
        state = step @ state
        states.append(state)
    clean = 1e3 * np.array(states).T[:size]
    return clean + noise * np.random.default_rng(seed).standard_normal(clean.shape)


def lifted(vehicle: Vehicle, force: float, at: float) -> NDArray[np.float64]:
    """Coordinates at rest, m, of a half car that a force lifts at some distance to the left of its middle."""
    return np.asarray(np.linalg.solve(vehicle.matrices()[2], [force, force * at, 0.0, 0.0]))


def rig_readings(coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
    """What four sensors read: the body over both wheels, and both wheels; their zeros are arbitrary."""
    bounce, roll, left, right = coordinates
    zeros = np.array([[6.0], [-3.0], [1.0], [1.5]])
    readings: NDArray[np.float64] = np.vstack([bounce + HALF * roll, bounce - HALF * roll, left, right])
    return np.asarray(readings + zeros)


def write_rig(folder: Path, recordings: dict[str, tuple[Vehicle, float]]) -> None:
    """Write recordings of a half car by name: the vehicle, and where it was lifted, m to the left."""
    for seed, (name, (vehicle, at)) in enumerate(recordings.items()):
        values = rig_readings(let_go(vehicle, lifted(vehicle, 900.0, at).tolist(), seed=seed))
        write_table(folder / name, values, RATE, [f"{channel} [mm]" for channel in CHANNELS])
