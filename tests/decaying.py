"""Free decays of known systems, in closed form: truth for every method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.vibration import Mode, make_modes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class System:
    """M ẍ + C ẋ + K x = 0 of any size."""

    M: Array
    C: Array
    K: Array

    @classmethod
    def of(cls, M: ArrayLike, C: ArrayLike, K: ArrayLike) -> System:
        """Take up the matrices; each of shape (n, n)."""
        return cls(*(np.asarray(matrix, dtype=float) for matrix in (M, C, K)))

    @property
    def state(self) -> Array:
        """State matrix, eq. (4)."""
        n = len(self.M)
        solved = np.linalg.solve(self.M, np.hstack([self.K, self.C]))
        return np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), -solved])

    @property
    def modes(self) -> tuple[Mode, ...]:
        """From the eigenvalue problem of the state matrix."""
        poles, vectors = np.linalg.eig(self.state)
        return make_modes(poles, vectors[: len(self.M)])

    def decays(self, count: int, rate: float, seconds: float, seed: int = 0) -> list[Array]:
        """Return accelerations from as many random states."""
        A, n = self.state, len(self.M)
        states = np.random.default_rng(seed).standard_normal((count, 2 * n))
        left, vectors = np.linalg.eig(A)
        time = np.arange(round(seconds * rate)) / rate
        parts = np.linalg.solve(vectors, states.T.astype(complex))
        return [((A @ vectors) * part @ np.exp(left[:, None] * time)).real[n:] for part in parts.T]


COMPLEX = System.of(
    np.diag([2.0, 1.0, 1.5]),
    [[9, -4, 0], [-4, 6, -1], [0, -1, 3]],
    [[900, -300, 0], [-300, 800, -200], [0, -200, 2000]],
)
"""Three vibrations, damped out of proportion: shapes are complex."""

REAL = System.of(np.eye(2), [[60.0, -10.0], [-10.0, 8.0]], [[500.0, -60.0], [-60.0, 700.0]])
"""One overdamped motion, with two real poles, and one vibration."""

REPEATED = System.of(np.eye(2), np.diag([4.0, 4.0]), np.diag([400.0, 400.0]))
"""Two equal oscillators: one pole twice, with two shapes."""

SYSTEMS = {"complex": COMPLEX, "real": REAL, "repeated": REPEATED}


def poles(modes: Sequence[Mode]) -> NDArray[np.complex128]:
    """Return the poles of modes in an order of their own."""
    return np.sort_complex(np.array([mode.pole for mode in modes]))
