"""Estimates of a fleet drawn from a known population, with errors of known covariance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.fleets import FleetEstimates

Real = NDArray[np.float64]

NAMES = ("m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "t_f", "t_r")
SPREAD = np.array([2, 3, 3, 2, 2, 3, 3, 4, 4, 3, 3, 0.5, 0.5]) / 100
"""Standard deviation between vehicles, relative."""


def random_correlation(random: np.random.Generator, width: int, shared: float = 1.0) -> Real:
    """Return a random correlation matrix, mixed with independence."""
    factors = random.normal(size=(width, width))
    matrix = factors @ factors.T
    std = np.sqrt(np.diag(matrix))
    return np.asarray(shared * matrix / np.outer(std, std) + (1 - shared) * np.eye(width))


def draw_fleet(
    count: int, random: np.random.Generator, *, drift: int | None = None, weak: int | None = None
) -> FleetEstimates:
    """Return estimates of vehicles; from one on everything with a mass is 1 % more, another has a damper rate 15 % less."""
    width = len(NAMES)
    true = SPREAD * random.normal(size=(count, width))
    if drift is not None:
        true[drift:, :11] += np.log(1.01)
    if weak is not None:
        true[weak, NAMES.index("c_sf")] += np.log(0.85)
    stds = random.uniform(0.003, 0.01, size=(count, width))
    covariances = np.array(
        [random_correlation(random, width) * np.outer(std, std) + 1e-8 * np.eye(width) for std in stds]
    )
    positions = np.array([random.multivariate_normal(t, c) for t, c in zip(true, covariances, strict=True)])
    labels = tuple(f"car {i + 1}" for i in range(count))
    return FleetEstimates(
        campaigns=labels,
        labels=labels,
        names=NAMES,
        positive=np.ones(width, dtype=bool),
        sizes=np.ones(width),
        positions=positions,
        covariances=covariances,
        known=np.ones((count, width), dtype=bool),
        exact=np.zeros((count, width), dtype=bool),
    )
