"""Records for modal identification whose modes are known: the Table 1 car after the paper's bump, and their bound."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.modal import cramer_rao_bound
from sprung.simulation import drive_over_half_sine_bump, tyre_rates
from sprung.vehicle import TABLE_1_CAR, Vehicle, Wheel, free_decay
from sprung.vibration import Mode, compute_modes

Real = NDArray[np.float64]

BUMPS: tuple[tuple[Wheel, ...], ...] = (("fl", "rl"), ("fl", "fr", "rl", "rr"), ("fl", "fr"), ("fl", "rr"))
"""The wheels that run over the bump: left, all, front, diagonal."""

HEIGHT, PASSAGE = 0.09, 0.2
"""Of the bump, m and s, eq. (19) of the paper."""

RATE, SECONDS = 1000.0, 4.0

CAR = compute_modes(TABLE_1_CAR.matrices())
"""Modes of the Table 1 car."""


def bumps(vehicle: Vehicle = TABLE_1_CAR, rate: float = RATE, seconds: float = SECONDS) -> list[Real]:
    """Return accelerations of the seven coordinates from the end of the bump on, one recording for each of BUMPS."""
    matrices = vehicle.matrices()
    found = []
    for wheels in BUMPS:
        _, state = drive_over_half_sine_bump(matrices, tyre_rates(vehicle), wheels, HEIGHT, PASSAGE, 1 / rate, 1)
        found.append(free_decay(matrices, state, 1 / rate, round(seconds * rate)).acceleration)
    return found


def noise_of(records: Sequence[Real], decibels: float) -> Real:
    """Return noise levels so many dB below the root-mean-square of each channel in the first recording."""
    return np.asarray(np.sqrt((records[0] ** 2).mean(axis=1)) * 10 ** (-decibels / 20))


def noisy(records: Sequence[Real], decibels: float, seed: int) -> list[Real]:
    """Add white noise so far below the root-mean-square of each channel in the first record."""
    random = np.random.default_rng(seed)
    size = noise_of(records, decibels)[:, None]
    return [record + size * random.standard_normal(record.shape) for record in records]


def bound(records: Sequence[Real], decibels: float, rate: float = RATE) -> tuple[Mode, ...]:
    """Return the true modes of the car with the Cramér-Rao bound as their uncertainty."""
    return cramer_rao_bound(records, rate, CAR, noise_of(records, decibels))
