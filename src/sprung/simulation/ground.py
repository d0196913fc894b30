"""The vehicle on the ground: static wheel loads, tyre forces, and the equations of motion with wheels off the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, WHEELS, WHEELS_AT, Load, Matrices, Vehicle, Wheel, highest_derivatives

Array = NDArray[np.float64]


def tyre_rates(vehicle: Vehicle) -> dict[Wheel, tuple[float, float]]:
    """Return stiffness and damping of the tyre at each wheel station, with those of uneven axles.

    Parameters
    ----------
    vehicle
        With its tyres.

    Returns
    -------
    dict
        By wheel station: stiffness, N/m, and damping, N s/m.
    """
    return {
        "fl": (vehicle.k_tf + vehicle.d_ktf, vehicle.c_tf),
        "fr": (vehicle.k_tf - vehicle.d_ktf, vehicle.c_tf),
        "rl": (vehicle.k_tr + vehicle.d_ktr, vehicle.c_tr),
        "rr": (vehicle.k_tr - vehicle.d_ktr, vehicle.c_tr),
    }


def static_wheel_loads(vehicle: Vehicle, load: Load = EMPTY, gravity: float = STANDARD_GRAVITY) -> Array:
    """Return the force of flat ground on each wheel at rest.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    gravity
        m/s².

    Returns
    -------
    ndarray
        N, shape (4,), in the order of `WHEELS`. Negative where the wheel would have to be held down.
    """
    return Ground.under(vehicle, load, gravity).wheel_loads


@dataclass(frozen=True, eq=False)
class Ground:
    """A loaded vehicle on flat ground, and its tyre forces as functions of Y = {X, Ẋ, 1}.

    Attributes
    ----------
    matrices
        M, C and K of the loaded vehicle with all wheels on the ground.
    stiffness, damping
        Of each tyre, N/m and N s/m, shape (4,).
    wheel_loads
        Static, N, shape (4,).
    """

    matrices: Matrices
    stiffness: Array
    damping: Array
    wheel_loads: Array

    @classmethod
    def under(cls, vehicle: Vehicle, load: Load, gravity: float) -> Ground:
        """Return a vehicle with its load on the ground; gravity in m/s²."""
        stiffness, damping = np.array([tyre_rates(vehicle)[station] for station in WHEELS]).T
        model = vehicle.model(load)
        matrices = vehicle.matrices(load)
        sag = matrices.deflection(gravity * matrices.M @ model.heave)
        return cls(matrices, stiffness, damping, stiffness * sag[WHEELS_AT])

    @property
    def compression(self) -> Array:
        """Tyre rate times tyre compression, N: rows over Y, shape (4, n + m + 1) with n coordinates, m with mass."""
        rows = np.zeros((4, len(self.matrices.M) + self.matrices.massive + 1))
        rows[:, WHEELS_AT] = -np.diag(self.stiffness)
        rows[:, -1] = self.wheel_loads
        return rows

    @property
    def force(self) -> Array:
        """Force of each tyre if it is in contact, N: rows over Y, shape (4, n + m + 1)."""
        rows = self.compression
        rows[:, len(self.matrices.M) :][:, WHEELS_AT] = -np.diag(self.damping)
        return rows

    def generator(self, contact: NDArray[np.bool_]) -> Array:
        """Return the generator of Ẏ = generator Y: eq. (3) without the tyre forces of the wheels off the ground.

        Parameters
        ----------
        contact
            Which wheels are on the ground, shape (4,).

        Returns
        -------
        ndarray
            Shape (n + m + 1, n + m + 1); its last column holds the constant force.
        """
        n, m = len(self.matrices.M), self.matrices.massive
        size = n + m + 1
        generator = np.zeros((size, size))
        generator[:-1, :-1] = self.matrices.state
        lost = np.linalg.solve(self.matrices.leading, self._wheels.T[:, ~contact] @ self.force[~contact])
        generator[highest_derivatives(n, m)] -= lost
        return generator

    @property
    def _wheels(self) -> Array:
        """The rows of the wheels, shape (4, n)."""
        wheels: Array = np.eye(len(self.matrices.M))[WHEELS_AT]
        return wheels

    def rest(self, blocks: Array) -> Array:
        """Return the rest position on blocks.

        Parameters
        ----------
        blocks
            Height under each wheel, m, shape (4,).

        Returns
        -------
        ndarray
            X, shape (n,). One wheel at most is off its block: a vehicle that stands on flat ground rests on any three.
        """
        candidates = []
        for lifted in (-1, 0, 1, 2, 3):
            on = np.arange(4) != lifted
            K = self.matrices.K - np.diag(np.where(on, 0.0, self.stiffness) @ self._wheels)
            F = np.where(on, self.stiffness * blocks, -self.wheel_loads) @ self._wheels
            X = self.matrices._replace(K=K).deflection(F)
            force = self.wheel_loads - self.stiffness * (X[WHEELS_AT] - blocks)
            candidates.append((float(np.min(np.where(on, force, -force))), X))
        # In one of the five no tyre pulls and none sinks into the ground; where two are equal but for rounding, either will do.
        return max(candidates, key=lambda candidate: candidate[0])[1]

    def keeps_contact(self, Y: Array) -> bool:
        """Return whether, with all wheels on the ground, the energy left is too little for any tyre force to reach zero."""
        M, _, K = self.matrices
        m = self.matrices.massive
        X, V = np.split(Y[:-1], [len(M)])
        M = M[:m, :m]
        energy = 0.5 * (X @ K @ X + V @ M @ V)
        # Energy never grows, and by the Cauchy-Schwarz inequality |k z + c ż|² <= 2 E (k² / K_z + c² / M_z),
        # where 1 / K_z and 1 / M_z are the wheel's diagonal entries of K⁻¹ and M⁻¹: no tyre unloads by more.
        flexibility = np.diag(self.matrices.deflection(np.eye(len(K))))[WHEELS_AT]
        mobility = np.diag(np.linalg.inv(M))[WHEELS_AT]
        largest = np.sqrt(self.stiffness**2 * flexibility + self.damping**2 * mobility)
        return bool(np.all(math.sqrt(2 * energy) * largest < self.wheel_loads))
